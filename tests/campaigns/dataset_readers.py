"""Programs that read a set as others do, in processes of their own: h5py, and tonic."""

READ = """
import json, sys, h5py, hdf5plugin
count = 0
for line in open(sys.argv[1] + "/manifest.jsonl"):
    record = json.loads(line)
    with h5py.File(sys.argv[1] + "/" + record["path"]) as file:
        assert file["events/t"].shape == (record["events"],), record["path"]
        assert int(file["events/p"][:].sum()) == record["on"], record["path"]
        assert file["frames"].shape == (record["frames"], record["height"], record["width"])
        count += record["events"]
print(count)
"""
TONIC = """
import json, sys, hdf5plugin
from pathlib import Path
from tonic.datasets import DSEC
DSEC.__init__ = lambda self: None
root, count = Path(sys.argv[2]), 0
for line in list(open(sys.argv[1] + "/manifest.jsonl"))[::50]:
    record = json.loads(line)
    name = "item" + str(count)
    folder = root / name / "events_left"
    folder.mkdir(parents=True)
    (folder / "events.h5").symlink_to(Path(sys.argv[1], record["path"]).absolute())
    data = DSEC()
    data.location_on_system, data.split = str(root), "train"
    data.recording_selection, data.data_selection, data.target_selection = [name], ["events_left"], []
    data.transform = data.target_transform = data.transforms = None
    events = data[0][0][0]["events_left"]
    assert len(events) == record["events"] and int(events["p"].sum()) == record["on"]
    count += 1
print(count)
"""

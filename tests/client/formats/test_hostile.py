"""Files made to do harm: one line, little memory, nothing read but the file."""

import json
import struct
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from voltcam_client.formats import FormatError, RecordingError, open_writer, read

h5py = pytest.importorskip("h5py", reason="h5py is in the extra [lab]")

MEMORY_BYTES = 4_000_000_000  # of address space: libraries take half of it
READ = """
import resource, sys
from voltcam_client.formats import FormatError, RecordingError, read
import numpy, h5py, rosbags.highlevel
limit = int(sys.argv[2])
resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
try:
    recording = read(sys.argv[1])
    print("read", recording.events.size)
except (FormatError, RecordingError) as error:
    print(error)
"""


def _npy(shape: tuple[int, ...], dtype: str, data: bytes) -> bytes:
    header = f"{{'descr': {dtype!r}, 'fortran_order': False, 'shape': {shape!r}, }}".encode()
    header += b" " * (63 - (10 + len(header)) % 64) + b"\n"
    return b"\x93NUMPY\1\0" + struct.pack("<H", len(header)) + header + data


def _npz(path: Path, **arrays: bytes) -> None:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in arrays.items():
            archive.writestr(f"{name}.npy", data)


def huge_shape(path: Path) -> None:
    _npz(path, **{name: _npy((10**12,), "<i8", b"\0" * 80) for name in "txyp"})


def shape_beyond_integers(path: Path) -> None:
    _npz(path, **{name: _npy((2**62, 2**62), "<i8", b"\0" * 80) for name in "txyp"})


def bomb(path: Path) -> None:
    """400 MB of zeros in 400 kB."""
    zeros = _npy((10**8 // 8,), "<i8", b"\0" * 10**8)
    _npz(path, t=zeros, x=zeros, y=zeros, p=zeros)


def python_objects(path: Path) -> None:
    np.savez(path, t=np.array([{}], object), x=[1], y=[1], p=[1])


def hdf5_huge(path: Path) -> None:
    with h5py.File(path, "w") as file:
        for name in "txyp":
            file.create_dataset(f"events/{name}", (2**40,), "<i8", chunks=(2**20,))


def hdf5_external_storage(path: Path) -> None:
    with h5py.File(path, "w") as file:
        for name in "txyp":
            file.create_dataset(f"events/{name}", (100,), "u1", external=[("/etc/passwd", 0, 100)])


def hdf5_external_link(path: Path) -> None:
    other = path.with_name("other.hdf5")
    with h5py.File(other, "w") as file:
        for name in "txyp":
            file[f"events/{name}"] = np.arange(5)
    with h5py.File(path, "w") as file:
        file["events"] = h5py.ExternalLink(str(other), "/events")


def mvsec_external_link(path: Path) -> None:
    other = path.with_name("other.hdf5")
    with h5py.File(other, "w") as file:
        file["left/events"] = [[7.0, 3.0, 0.5, 1.0]]
    with h5py.File(path, "w") as file:
        file["davis"] = h5py.ExternalLink(str(other), "/")


def hdf5_virtual(path: Path) -> None:
    other = path.with_name("other.hdf5")
    with h5py.File(other, "w") as file:
        file["t"] = np.arange(5)
    layout = h5py.VirtualLayout((5,), "<i8")
    layout[:] = h5py.VirtualSource(other, "t", (5,))
    with h5py.File(path, "w") as file:
        for name in "txyp":
            file.create_virtual_dataset(f"events/{name}", layout)


def hdf5_deep_loop(path: Path) -> None:
    with h5py.File(path, "w") as file:
        group = file.create_group("events")
        for name in "txyp":
            group[name] = h5py.SoftLink(f"/events/{name}")


def raw_huge_size(path: Path) -> None:
    path.write_bytes(b"% evt 3.0\n% geometry 999999999999x999999999999\n% end\n" + b"\0\x80" * 100)


def raw_huge_t0(path: Path) -> None:
    path.write_bytes(b"% evt 3.0\n% t0 " + b"9" * 400 + b"\n% end\n" + b"\0\x80" * 100)


def raw_endless_header(path: Path) -> None:
    path.write_bytes(b"% evt " * 10**6)


def evt2_random(path: Path) -> None:
    words = np.random.default_rng(0).integers(0, 2**32, 10**5, np.uint32)
    path.write_bytes(b"% evt 2.0\n% end\n" + words.tobytes())


def dat_random(path: Path) -> None:
    words = np.random.default_rng(0).integers(0, 2**32, 10**5, np.uint32)
    path.write_bytes(b"% Version 2\n% Width 999999999999\n% Height 5\n\x0c\x08" + words.tobytes())


def es_overflows(path: Path) -> None:
    """30 MB of nothing, and an event outside."""
    head = b"Event Stream\2\0\0\1" + struct.pack("<HH", 346, 260)
    path.write_bytes(head + b"\xff" * 30_000_000 + b"\0\xff\xff\xff\xff")


def aedat2_endless_header(path: Path) -> None:
    path.write_bytes(b"#!AER-DAT3.0" + b"\n#" * 10**6)


def csv_endless_header(path: Path) -> None:
    path.write_bytes(b"t,x@" + b"9" * 10**7)


def csv_huge_size(path: Path) -> None:
    path.write_bytes(b"t,x@999999999,y@999999999,on\n5,1,2,1\n")


def txt_nuls(path: Path) -> None:
    path.write_bytes(b"\0" * 10**6)


def txt_deep_number(path: Path) -> None:
    path.write_bytes(b"0.1 " + b"1" * 10**6 + b" 2 1\n")


def aedat_offsets(path: Path) -> None:
    path.write_bytes(b"#!AER-DAT4.0\r\n" + struct.pack("<I", 2**31) + b"\xff" * 200)


def aedat_tables(path: Path) -> None:
    path.write_bytes(
        b"#!AER-DAT4.0\r\n" + struct.pack("<I", 64) + struct.pack("<16I", *[2**32 - 4] * 16) + b"x" * 64
    )


def bag_chunks(path: Path) -> None:
    path.write_bytes(b"#ROSBAG V2.0\n" + struct.pack("<I", 2**31) + b"\xff" * 400)


def mcap_records(path: Path) -> None:
    path.write_bytes(b"\x89MCAP0\r\n" + b"\1" + struct.pack("<Q", 2**60) + b"\xff" * 400)


HOSTILE: dict[str, tuple[str, Callable[[Path], None]]] = {
    make.__name__: (suffix, make)
    for suffix, make in (
        (".npz", huge_shape), (".npz", shape_beyond_integers), (".npz", bomb), (".npz", python_objects),
        (".h5", hdf5_huge), (".h5", hdf5_external_storage), (".h5", hdf5_external_link),
        (".h5", mvsec_external_link), (".h5", hdf5_virtual), (".h5", hdf5_deep_loop), (".raw", raw_huge_size),
        (".raw", raw_huge_t0), (".raw", raw_endless_header),
        (".evt2.raw", evt2_random), (".dat", dat_random), (".dat", txt_nuls), (".es", es_overflows),
        (".es", txt_nuls), (".aedat", aedat2_endless_header), (".aedat", txt_nuls),
        (".csv", csv_endless_header), (".csv", csv_huge_size),
        (".txt", txt_nuls), (".txt", txt_deep_number), (".csv", txt_nuls), (".aedat4", aedat_offsets),
        (".aedat4", aedat_tables), (".bag", bag_chunks), (".mcap", mcap_records), (".db3", txt_nuls),
    )
}  # fmt: skip


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_files_give_one_line(name: str, tmp_path: Path) -> None:
    suffix, make = HOSTILE[name]
    path = tmp_path / f"hostile{suffix}"
    make(path)
    done = subprocess.run(
        [sys.executable, "-c", READ, str(path), str(MEMORY_BYTES)],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 0
    assert done.stderr == ""
    assert done.stdout.count("\n") == 1
    assert str(path) in done.stdout
    assert "root:" not in done.stdout
    assert len(done.stdout) < 400


def test_a_list_of_images_stays_in_its_folder(tmp_path: Path) -> None:
    folder = tmp_path / "walk"
    folder.mkdir()
    (folder / "events.txt").write_text("0.1 1 2 1\n")
    for name in ("../secret.png", "/etc/passwd"):
        (folder / "images.txt").write_text(f"0.1 {name}\n")
        with pytest.raises(FormatError, match="line 1: the image is outside") as refusal:
            read(folder)
        assert "passwd" not in str(refusal.value)


def test_what_is_in_a_line_is_not_told(tmp_path: Path) -> None:
    path = tmp_path / "secret.txt"
    path.write_text("0.1 1 2 1\npassword: swordfish\n0.2 1 2 1\n")
    with pytest.raises(FormatError, match="line 2") as refusal:
        read(path)
    assert "swordfish" not in str(refusal.value)


def test_a_file_that_another_program_made_meanwhile_is_kept(tmp_path: Path, make_events) -> None:
    path = tmp_path / "walk.npz"
    writer = open_writer(path, width=346, height=260)
    writer.events(make_events(100))
    path.write_text("theirs")
    with pytest.raises(RecordingError, match="another program") as refusal:
        writer.close()
    assert path.read_text() == "theirs"
    assert ".partial" in str(refusal.value)
    assert read(tmp_path / "walk.npz.partial").events.size == 100


def test_a_spool_that_is_damaged_is_one_line(tmp_path: Path) -> None:
    folder = tmp_path / "a.npz.partial"
    folder.mkdir()
    for geometry in (
        {"width": -5, "height": 10**9},
        {"width": 10**12, "height": 10**12},
        [1],
        {"width": "x"},
    ):
        (folder / "geometry.json").write_text(json.dumps(geometry))
        (folder / "events.bin").write_bytes(b"\xff" * 1300)
        (folder / "frames.bin").write_bytes(b"\0" * 1000)
        with pytest.raises(FormatError) as refusal:
            read(folder)
        assert "\n" not in str(refusal.value)
    (folder / "geometry.json").write_text("[" * 100_000)
    with pytest.raises(FormatError):
        read(folder)


BEGINNINGS = {
    ".raw": b"% evt 3.0\n% geometry 346x260\n% end\n",
    ".evt2.raw": b"% evt 2.0\n% geometry 346x260\n% end\n",
    ".dat": b"% Version 2\n\x0c\x08",
    ".es": b"Event Stream\2\0\0\1" + struct.pack("<HH", 346, 260),
    ".aedat": b"#!AER-DAT2.0\r\n",
    ".csv": b"t,x,y,on\n",
    ".txt": b"",
}


@pytest.mark.parametrize("suffix", BEGINNINGS)
@settings(deadline=None)  # disks are slow at times
@given(begun=st.booleans(), content=st.binary(max_size=300))
def test_any_bytes_are_a_recording_or_one_line(suffix: str, begun: bool, content: bytes) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"a{suffix}"
        path.write_bytes(BEGINNINGS[suffix] * begun + content)
        said, recording = "", None
        try:
            recording = read(path)
        except FormatError as error:
            said = str(error)
    if recording is None:
        assert said.startswith(str(path))
        assert "\n" not in said
    else:
        assert (np.diff(recording.events["t"]) >= 0).all()
        assert recording.events.size <= 6 * len(content)  # of EVT 3.0: 12 events in a word

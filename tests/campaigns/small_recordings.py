"""A small recording of each format that can be read, by the libraries of those whose format it is."""

from functools import partial
from pathlib import Path

import faery
import h5py
import numpy as np
from rosbags import rosbag1, rosbag2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from voltcam_client.encodings import EVENT
from voltcam_client.formats import SUFFIXES, open_writer, read


def small_recordings(folder: Path) -> list[Path]:
    """A small recording of each format."""
    rng = np.random.default_rng(0)
    events = np.zeros(400, EVENT)
    events["t"] = np.cumsum(rng.integers(0, 500, 400))
    events["x"], events["y"], events["p"] = rng.integers(0, 20, (3, 400))
    events["p"] = rng.random(400) < 0.5
    frames = rng.integers(0, 255, (3, 20, 20), np.uint8)
    paths = []
    for suffix in SUFFIXES:
        path = folder / f"ours{suffix}"
        with open_writer(path, width=20, height=20) as writer:
            writer.events(events)
            if writer.holds_frames:
                for i, image in enumerate(frames):
                    writer.frame(image, 1000 * i)
        paths.append(path)
    for name, options in (("plain", {}), ("packed", {"compression": "gzip", "chunks": (100,)})):
        path = folder / f"{name}.h5"
        with h5py.File(path, "w") as file:
            for column in "txyp":
                file.create_dataset(f"events/{column}", data=events[column].astype("<i8"), **options)
            file["t_offset"] = 5
        paths.append(path)
    return paths + _aedat2(folder, events) + _aedat4(folder, events) + _bags(folder, events)


def _aedat2(folder: Path, events: "np.ndarray") -> list[Path]:
    paths = []
    for chip, x_bit, y_bit, on_bit in (("Davis346blue", 12, 22, 11), ("DVS128", 1, 8, 0)):
        records = np.empty((events.size, 2), ">u4")
        x, y, p = (events[name].astype("<u4") for name in "xyp")
        records[:, 0] = x << x_bit | y << y_bit | p << on_bit
        records[:, 1] = events["t"]
        paths.append(folder / f"{chip}.aedat")
        paths[-1].write_bytes(f"#!AER-DAT2.0\r\n# AEChip: {chip}\r\n".encode() + records.tobytes())
    return paths


def _aedat4(folder: Path, events: "np.ndarray") -> list[Path]:
    aedat = faery.aedat
    attribute, node = aedat.DescriptionAttribute, aedat.DescriptionNode
    root = "/mainloop/Recorder/outInfo/"
    info = node("info", f"{root}0/info/", {"sizeX": attribute("int", 20), "sizeY": attribute("int", 20)}, [])
    kind = {"compression": attribute("string", "LZ4"), "typeIdentifier": attribute("string", "EVTS")}
    tree = node("outInfo", root, {}, [node("0", f"{root}0/", kind, [info])])
    theirs = np.empty(events.size, faery.EVENTS_DTYPE)
    for name, their_name in (("t", "t"), ("x", "x"), ("y", "y"), ("p", "on")):
        theirs[their_name] = events[name]
    path = folder / "packed.aedat4"
    with aedat.Encoder(path, [tree], ("lz4", 1)) as encoder:
        encoder.write(0, theirs)
    return [path]


def _bags(folder: Path, events: "np.ndarray") -> list[Path]:
    """ROS 1, and ROS 2 as MCAP and SQLite."""
    paths = []
    for kind in ("bag", "mcap", "db3"):
        store = get_typestore(Stores.ROS1_NOETIC if kind == "bag" else Stores.ROS2_HUMBLE)
        time_type = "time" if kind == "bag" else "builtin_interfaces/Time"
        fields = f"uint16 x\nuint16 y\n{time_type} ts\nbool polarity"
        store.register(get_types_from_msg(fields, "dvs_msgs/msg/Event"))
        array = "std_msgs/Header header\nuint32 height\nuint32 width\ndvs_msgs/Event[] events"
        store.register(get_types_from_msg(array, "dvs_msgs/msg/EventArray"))
        types = store.types
        stamp = types["builtin_interfaces/msg/Time"]
        sequence = {"seq": 0} if kind == "bag" else {}
        header = types["std_msgs/msg/Header"](stamp=stamp(sec=0, nanosec=0), frame_id="", **sequence)
        rows = [
            types["dvs_msgs/msg/Event"](x=x, y=y, ts=stamp(sec=0, nanosec=1000 * t), polarity=p)
            for t, x, y, p in events[:100].tolist()
        ]
        message = types["dvs_msgs/msg/EventArray"](header=header, height=20, width=20, events=rows)
        target = folder / ("seed.bag" if kind == "bag" else f"seed-{kind}")
        plugin = rosbag2.StoragePlugin.MCAP if kind == "mcap" else rosbag2.StoragePlugin.SQLITE3
        ros2 = partial(rosbag2.Writer, version=9, storage_plugin=plugin)
        with (rosbag1.Writer if kind == "bag" else ros2)(target) as writer:
            connection = writer.add_connection("/events", "dvs_msgs/msg/EventArray", typestore=store)
            write = store.serialize_ros1 if kind == "bag" else store.serialize_cdr
            writer.write(connection, 1000, write(message, "dvs_msgs/msg/EventArray"))
        paths.append(target if kind == "bag" else next(target.glob(f"*.{kind}")))
    for path in paths:
        read(path)  # they are good, as they are
    return paths

"""A plain client of Foxglove's protocol: python foxglove_client.py PORT FILE.npz TOPIC COUNT [TOPIC COUNT...]

Messages are decoded by Google's protobuf and Foxglove's published schemas, and by json. "subscribed" is said
once the server has been asked.
"""

import json
import struct
import sys

import numpy as np
from foxglove_schemas_protobuf.RawImage_pb2 import RawImage
from websockets.sync.client import connect

DATA = struct.Struct("<BIQ")  # opcode 1, subscription, log time in ns


def main() -> None:
    port, file = sys.argv[1:3]
    wanted = {topic: int(count) for topic, count in zip(sys.argv[3::2], sys.argv[4::2], strict=True)}
    with connect(
        f"ws://127.0.0.1:{port}", subprotocols=["foxglove.sdk.v1"], max_size=None, proxy=None
    ) as server:
        channels: dict[str, int] = {}
        while set(wanted) - set(channels):
            said = json.loads(server.recv(30))
            channels |= {each["topic"]: each["id"] for each in said.get("channels", [])}
        names = dict(enumerate(wanted))
        asked = [{"id": number, "channelId": channels[topic]} for number, topic in names.items()]
        server.send(json.dumps({"op": "subscribe", "subscriptions": asked}))
        print("subscribed", flush=True)  # noqa: T201
        images: dict[str, list[np.ndarray]] = {topic: [] for topic in wanted}
        times: dict[str, list[int]] = {topic: [] for topic in wanted}
        while any(len(images[topic]) < count for topic, count in wanted.items()):
            data = server.recv(60)
            if isinstance(data, str):
                continue
            opcode, subscription, log_time = DATA.unpack_from(data)
            assert opcode == 1
            topic, payload = names[subscription], data[DATA.size :]
            times[topic].append(log_time)
            images[topic].append(_decoded(topic, payload, log_time))
    arrays = {topic.strip("/").replace("/", "_"): np.array(each) for topic, each in images.items()}
    arrays |= {f"{topic.strip('/').replace('/', '_')}_ns": np.array(each) for topic, each in times.items()}
    np.savez(file, **arrays)


def _decoded(topic: str, payload: bytes, log_time: int) -> np.ndarray:
    if topic == "/events/rate":
        return np.array(json.loads(payload)["events_per_s"])
    image = RawImage.FromString(payload)
    assert image.encoding == "mono8"
    assert image.frame_id == "tiny"
    assert image.timestamp.ToNanoseconds() == log_time
    return np.frombuffer(image.data, np.uint8).reshape(image.height, image.step)[:, : image.width]


if __name__ == "__main__":
    main()

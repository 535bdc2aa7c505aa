"""faery's UDP input until it has so many events: python faery_reader.py PORT COUNT WIDTH HEIGHT FILE.npy"""

import sys

import faery
import numpy as np


def main() -> None:
    port, count, width, height = map(int, sys.argv[1:5])
    stream = faery.events_stream_from_udp((width, height), ("127.0.0.1", port), "t32_x16_y15_on1")
    events: list[np.ndarray] = []
    for packet in stream:
        events.append(packet.copy())
        if sum(each.size for each in events) >= count:
            np.save(sys.argv[5], np.concatenate(events))
            return


if __name__ == "__main__":
    main()

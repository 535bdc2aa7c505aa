"""AEStream's UDP input until it has so many: python aestream_reader.py PORT COUNT WIDTH HEIGHT FILE.npy

AEStream adds events up in a picture, (width, height); polarity and time it does not keep.
"""

import sys
import time

import numpy as np
from aestream import UDPInput


def main() -> None:
    port, count, width, height = map(int, sys.argv[1:5])
    total = np.zeros((width, height))
    until_s = time.monotonic() + 60
    with UDPInput((width, height), device="cpu", port=port) as stream:
        while total.sum() < count and time.monotonic() < until_s:
            total += np.array(stream.read())
            time.sleep(0.001)
    np.save(sys.argv[5], total)


if __name__ == "__main__":
    main()

"""Events packed into 64 bits: what is unpacked is what was packed, and numbers sort as times do."""

import numpy as np

from voltcam_simulator.event_key import AXIS_BITS, TIME_BITS, event_address, event_key, unpack

LARGEST = 1 << AXIS_BITS


def test_all_corners_come_back_and_are_in_order_of_time() -> None:
    width = LARGEST
    pixels = np.array([0, width - 1, width, width * LARGEST - 1, width * LARGEST - width, 12_345_678])
    times = np.array([0, 1, 1000, (1 << TIME_BITS) - 1, 2, 3])
    sides = np.array([1, -1, 1, -1, 1, -1])
    keys = np.array(
        [
            event_key(float(t), np.uint64(event_address(int(pixel), width, 1 / width)), int(side))
            for t, pixel, side in zip(times, pixels, sides, strict=True)
        ],
        np.uint64,
    )
    order = np.argsort(keys)
    np.testing.assert_array_equal(times[order], np.sort(times))
    t, p = np.empty(6, np.int64), np.empty(6, np.bool_)
    x, y = np.empty(6, np.uint16), np.empty(6, np.uint16)
    unpack(keys, 5_000_000_000, t, x, y, p)
    np.testing.assert_array_equal(t, times + 5_000_000_000)
    np.testing.assert_array_equal(y.astype(int) * width + x, pixels)
    np.testing.assert_array_equal(p, sides > 0)


def test_no_pixel_of_a_large_sensor_is_put_in_another_row() -> None:
    for width in (346, 1280, 8191):
        edges = np.arange(width, width * 5000, width)
        for pixel in [*edges[:200], *edges[-200:]]:
            for one in (int(pixel) - 1, int(pixel)):
                address = int(event_address(one, width, 1 / width))
                assert (address >> 14, address >> 1 & (LARGEST - 1)) == divmod(one, width)

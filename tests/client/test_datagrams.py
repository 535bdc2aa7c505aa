"""Events in datagrams: lengths, limits, bits. Readers of others: `tests/server/transports/test_udp.py`."""

import numpy as np
import pytest

from voltcam_client.datagrams import FORMS, DatagramForm, datagrams
from voltcam_client.encodings import EVENT


@pytest.mark.parametrize(("form", "event_bytes"), [("t32_x16_y15_on1", 8), ("spif", 4)])
@pytest.mark.parametrize("count", [0, 1, 128, 129, 176, 177, 1000])
def test_none_is_longer_than_may_be_and_nothing_is_lost(
    form: DatagramForm, event_bytes: int, count: int
) -> None:
    found = list(datagrams(np.zeros(count, EVENT), form))
    most = FORMS[form].most_events
    assert all(0 < len(one) <= event_bytes * most for one in found)
    assert sum(map(len, found)) == event_bytes * count
    assert len(found) == -(-count // most)


def test_the_words_to_the_bit() -> None:
    events = np.array([(2**32 + 3, 40, 7, True), (2**32 + 4, 32767, 32766, False)], EVENT)
    (timed,), (untimed,) = (list(datagrams(events, form)) for form in ("t32_x16_y15_on1", "spif"))
    assert timed.hex(" ") == "03 00 00 00 28 00 0f 00 04 00 00 00 ff 7f fc ff"
    assert untimed.hex(" ") == "07 80 28 80 fe 7f ff ff"

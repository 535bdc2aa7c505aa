"""`voltcam bench transports`, small: all that it measures is there and above 0. Speed is not tested."""

import importlib.util

import numpy as np
import pytest

from voltcam_client.errors import VoltcamError
from voltcam_server.bench_senders import SENDERS, Kind, tcp
from voltcam_server.bench_transports import LATENCY_EVENTS, beside_tcp, events_at, late, transports

HALVES = ("throughput", ": plain socket, same bytes", "latency p50", "latency p99",
          ": plain socket latency p50", ": plain socket latency p99")  # fmt: skip


@pytest.mark.parametrize("name", SENDERS)
def test_a_transport_and_the_plain_socket_have_positive_figures(name: str) -> None:
    if name == "dv" and importlib.util.find_spec("dv_processing") is None:
        pytest.skip("dv-processing is not installed")
    figures = beside_tcp(name, SENDERS[name], 0.3)
    assert [one.name.removeprefix(name).strip() for one in figures] == list(HALVES)
    assert all(0 < one.least <= one.median <= one.most < np.inf for one in figures)
    assert [one.unit for one in figures] == ["Mevents/s"] * 2 + ["ms"] * 4


def test_every_transport_is_measured() -> None:
    assert len(list(transports())) == len(SENDERS)


def test_one_without_its_library_has_no_figures() -> None:
    assert beside_tcp("dv", SENDERS["dv"]._replace(there=False), 1) == []


def test_a_receiver_that_ends_is_named_in_a_line() -> None:
    kind = Kind(lambda: tcp(16), lambda _: 16)
    with pytest.raises(VoltcamError, match="there_is_none: its receiver"):
        beside_tcp("there_is_none", kind, 0.1)


def test_percentiles_are_of_all_parts() -> None:
    p50, p99 = late("x", np.tile(np.arange(101.0), 5))
    assert (p50.median, p99.median) == (50, 99)


def test_events_have_one_time_and_lie_on_the_sensor() -> None:
    events = events_at(7, LATENCY_EVENTS)
    assert set(events["t"]) == {7}
    assert (events["x"].max(), events["y"].max()) == (345, 259)

"""`voltcam bench transports`, small: all that it measures is there and above 0. Speed is not tested."""

import argparse
import contextlib
import json
from collections.abc import Iterator
from functools import partial
from itertools import count
from typing import Any

import numpy as np
import pytest

from voltcam_client.encodings import Events
from voltcam_client.errors import VoltcamError
from voltcam_server.bench import cli, senders
from voltcam_server.bench import transports as transports_module
from voltcam_server.bench.figure import Figure
from voltcam_server.bench.plain import Sender, plain_tcp
from voltcam_server.bench.senders import SENDERS, Kind, left_out
from voltcam_server.bench.transports import (
    LATENCY_EVENTS,
    beside_plain,
    events_at,
    late,
    throughput,
    transports,
)

OURS = ("throughput", "latency p50", "latency p99")
PLAIN = (", same bytes", " latency p50", " latency p99")


def measured(name: str, kind: Kind) -> list[Figure]:
    """Skips where the library is not there."""
    if not kind.there:
        pytest.skip(f"voltcam[{kind.needs[1] if kind.needs else ''}] is not installed")
    figures = beside_plain(name, kind, 0.6)
    assert all(0 < one.least <= one.median <= one.most < np.inf for one in figures)
    assert {one.unit for one in figures} == {"pictures/s" if kind.pictures else "Mevents/s", "ms"}
    return figures


@pytest.mark.parametrize("name", SENDERS)
def test_a_transport_has_positive_figures(name: str) -> None:
    figures = measured(name, SENDERS[name]._replace(plain=None))
    assert [one.name for one in figures] == [f"{name} {figure}" for figure in OURS]


@pytest.mark.parametrize("name", ["zeromq", "udp spif", "foxglove frames"])
def test_the_plain_socket_beside_it_has_positive_figures(name: str) -> None:
    """By TCP and by datagrams, for events and for pictures."""
    figures = measured(name, SENDERS[name])
    assert {one.name for one in figures} == {f"{name} {figure}" for figure in OURS} | {
        f"{name}: plain socket{figure}" for figure in PLAIN
    }


def test_every_transport_is_measured() -> None:
    assert len(list(transports())) + len(left_out()) == len(SENDERS)


def test_one_without_its_library_is_named_in_a_line_and_the_others_are_measured(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    missing = SENDERS["zeromq"]._replace(needs=("no_such_module", "rare"))
    kinds = {"rare": missing, "zeromq": SENDERS["zeromq"]}
    monkeypatch.setattr(senders, "SENDERS", kinds)
    monkeypatch.setattr(transports_module, "SENDERS", kinds)
    monkeypatch.setattr(cli, "transports", partial(transports, 0.3))
    arguments: Any = argparse.Namespace(what="transports", json=True, compare=None)
    assert cli.run(arguments) == 0
    printed = capsys.readouterr()
    assert "rare is left out: pip install 'voltcam[rare]'\n" in printed.err
    names = [figure["name"] for figure in json.loads(printed.out)["figures"]]
    assert len(names) == 6
    assert all(name.startswith("zeromq") for name in names)


@contextlib.contextmanager
def half_lost() -> Iterator[Sender]:
    """Every second packet goes to nobody."""
    calls = count()
    skipped: list[int] = []
    with senders.udp_spif() as sender:
        taken = sender.taken
        assert taken is not None

        def send(events: Events) -> None:
            if next(calls) % 2:
                sender.send(events)
            else:
                skipped.append(1)

        yield sender._replace(send=send, taken=lambda: taken() + len(skipped))


def test_what_leaves_and_is_lost_has_not_arrived() -> None:
    kind = SENDERS["udp spif"]
    seen = throughput("udp spif", kind._replace(open=half_lost), 0.3)
    assert seen.arrived is not None
    assert 0 < seen.arrived < 0.55


def test_a_receiver_that_ends_is_named_in_a_line() -> None:
    kind = Kind(lambda: plain_tcp(16), lambda _: 16)
    with pytest.raises(VoltcamError, match="there_is_none: its receiver"):
        beside_plain("there_is_none", kind, 0.1)


def test_percentiles_are_of_all_parts() -> None:
    p50, p99 = late("x", np.tile(np.arange(101.0), 5))
    assert (p50.median, p99.median) == (50, 99)


def test_events_have_one_time_and_lie_on_the_sensor() -> None:
    events = events_at(7, LATENCY_EVENTS)
    assert set(events["t"]) == {7}
    assert (events["x"].max(), events["y"].max()) == (345, 259)

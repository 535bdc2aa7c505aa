"""Rates, as `voltcam listen` prints them."""

from typing import Any

import pytest

from voltcam_client import EventCamera
from voltcam_client.meter import measure, short


def test_rates_are_those_of_the_packets(publisher: Any, make_packet: Any) -> None:
    with EventCamera(publisher.url) as camera:
        publisher.wait_for_subscribers()
        publisher.send(*(make_packet(seq, 100) for seq in (0, 1, 2, 5)))
        rates = measure(camera, 0.5)
    assert rates.seconds == pytest.approx(0.5, abs=0.3)
    assert rates.events_per_s * rates.seconds == pytest.approx(400)
    assert rates.packets_per_s * rates.seconds == pytest.approx(4)
    assert rates.on_share == 0.25
    assert (rates.lost_packets, rates.restarts) == (2, 0)
    assert (rates.dropped, rates.parameters_version) == (7, 3)
    assert rates.latency_median_ms is not None
    assert rates.latency_p99_ms is not None
    assert 0 <= rates.latency_median_ms <= rates.latency_p99_ms
    assert "25.0% ON" in str(rates)
    assert "2 lost" in str(rates)


def test_silence_has_no_shares(publisher: Any) -> None:
    with EventCamera(publisher.url) as camera:
        rates = measure(camera, 0.01)
    assert rates.events_per_s == rates.packets_per_s == 0
    assert rates.on_share is rates.latency_median_ms is rates.dropped is None
    assert str(rates) == "no packets, 0 lost"


def test_packets_without_events_have_no_share_of_on(publisher: Any, make_packet: Any) -> None:
    with EventCamera(publisher.url) as camera:
        publisher.wait_for_subscribers()
        publisher.send(make_packet(0, 0))
        rates = measure(camera, 0.2)
    assert rates.on_share is None
    assert "- ON" in str(rates)


@pytest.mark.parametrize(
    ("number", "text"),
    [(0, "0"), (7, "7"), (999, "999"), (1000, "1k"), (1_234_567, "1.23M"), (999_900, "1M"), (2.5e9, "2.5G")],
)
def test_short_numbers(number: float, text: str) -> None:
    assert short(number) == text

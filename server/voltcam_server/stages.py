"""How long intervals spend in each stage of the loop, and how old events are behind it."""

from prometheus_client import Histogram


def stage_histogram() -> Histogram:
    """Of the time that an interval spends in each stage; belongs to one camera."""
    return Histogram(
        "voltcam_stage_seconds",
        "of an interval: waiting for the simulation, being simulated, waiting to leave and leaving",
        ["stage"],
        registry=None,
        buckets=(0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10),
    )


def age_histogram() -> Histogram:
    """Of the age of the newest event of each packet, as it leaves; belongs to one camera."""
    finest, coarser = range(1, 31), (35, 40, 50, 70, 100, 200, 500, 1000, 2000, 5000, 10_000)
    return Histogram(
        "voltcam_sent_age_seconds",
        "of the newest event of a packet, as it leaves",
        registry=None,
        buckets=[ms / 1000 for ms in (*finest, *coarser)],
    )

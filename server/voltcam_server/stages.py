"""How long intervals spend in each stage of the loop."""

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

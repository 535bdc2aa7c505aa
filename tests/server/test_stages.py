"""The histogram of a camera's stages belongs to that camera alone."""

from prometheus_client import REGISTRY, CollectorRegistry, generate_latest
from prometheus_client.parser import text_string_to_metric_families

from voltcam_server.stages import stage_histogram


def test_cameras_do_not_share_one_nor_the_program_s_registry() -> None:
    left, right = stage_histogram(), stage_histogram()
    left.labels("leaving").observe(0.003)
    assert [sample for metric in right.collect() for sample in metric.samples] == []
    assert "voltcam_stage_seconds" not in {metric.name for metric in REGISTRY.collect()}


def test_its_buckets_go_from_a_millisecond_to_ten_seconds() -> None:
    histogram, registry = stage_histogram(), CollectorRegistry()
    registry.register(histogram)
    for seconds in (0.0005, 0.003, 0.003, 7.0, 60.0):
        histogram.labels("simulating").observe(seconds)
    families = text_string_to_metric_families(generate_latest(registry).decode())
    family = next(each for each in families if each.name == "voltcam_stage_seconds")
    below = {
        float(sample.labels["le"]): sample.value
        for sample in family.samples
        if sample.name.endswith("bucket")
    }
    assert (below[0.001], below[0.002], below[0.005], below[5.0], below[10.0]) == (1, 1, 3, 3, 4)
    assert below[float("inf")] == 5

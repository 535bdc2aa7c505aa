"""Levels of x86-64, and which of them a processor is given."""

from voltcam_simulator.processor import TARGETS, best_target


def test_the_best_target_is_one_whose_instructions_the_processor_has() -> None:
    haswell, skylake = ",".join(TARGETS[1].needs), ",".join(TARGETS[0].needs)
    assert best_target(f"{haswell},-avx512f") == TARGETS[1]
    assert best_target(f"{skylake},+vaes") == TARGETS[0]
    assert best_target(haswell.replace("+fma", "-fma")) is None
    assert best_target("") is None

"""The function that a thread runs for the effects of its pixel."""

from voltcam_simulator.cuda.program import source
from voltcam_simulator.plane_kernels import add, copy


def test_its_text_names_each_kernel_and_what_it_is_given() -> None:
    calls = ((copy, ("band.light", "band.copies[0]")), (add, ("band.noise", "numbers[0]")))
    assert source(calls) == (
        "def effects(band, place, planes, tables, numbers, i):\n"
        "    kernel_0(band.light, band.copies[0])\n"
        "    kernel_1(band.noise, numbers[0])\n"
    )


def test_without_effects_it_does_nothing() -> None:
    assert source(()).endswith("    pass\n")

"""A line of the table: median, spread and unit; and each run by itself."""

from itertools import count

from voltcam_server.bench.figure import Figure, repeated


def test_a_figure_is_its_median_and_spread() -> None:
    assert str(Figure.of("sort", [3.0, 1.0, 2.0], "ns", "quiet")).split() == [
        "sort", "2", "1", "to", "3", "ns", "quiet",
    ]  # fmt: skip


def test_runs_are_timed_one_by_one_by_the_clock_that_is_given() -> None:
    ticks, runs = count(), []
    seconds = repeated(lambda: runs.append(next(ticks)), 3, lambda: 10.0 * next(ticks))
    assert (len(runs), seconds) == (3, [20.0] * 3)


def test_an_even_number_of_runs_has_the_mean_of_the_middle_two() -> None:
    figure = Figure.of("copy", [40.0, 1.0, 2.0, 3.0], "GB/s")
    assert (figure.median, figure.least, figure.most) == (2.5, 1, 40)
    assert not str(figure).endswith(" ")

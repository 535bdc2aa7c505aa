"""A stream of frames, and threads: the events are those of frame by frame, on one."""

from collections.abc import Iterator

import numpy as np
import pytest

from voltcam_simulator import Parameters, Simulator

from .scenes import still


@pytest.mark.parametrize("camera", ["paper", "noisy"])
def test_threads_do_not_show_in_the_events(camera: str) -> None:
    frames = np.random.default_rng(2).integers(0, 256, (4, 60, 80), np.uint8)
    parameters = Parameters.of(camera).changed({"aps_coupling": {"exposure_kick": 0.1}})
    runs = []
    for threads in (1, 2, 3):
        simulator = Simulator(80, 60, parameters, seed=4, threads=threads)
        events = [simulator.advance(frame, 9000 * i) for i, frame in enumerate(frames)]
        runs.append(np.concatenate(events).tobytes())
    assert len(runs[0]) > 13 * 4800
    assert runs[0] == runs[1] == runs[2]


@pytest.mark.parametrize("coupling", [0.0, 0.02], ids=["ahead", "fed back"])
@pytest.mark.parametrize("threads", [1, 2, 3])
def test_a_stream_gives_the_events_of_frame_by_frame(threads: int, coupling: float) -> None:
    frames = np.random.default_rng(2).integers(0, 256, (5, 60, 80), np.uint8)
    parameters = Parameters.of("noisy").changed(
        {"latency": {"delay_us": 3000}, "crosstalk": {"coupling": coupling}}
    )
    one_by_one = Simulator(80, 60, parameters, seed=4)
    streaming = Simulator(80, 60, parameters, seed=4, threads=threads)
    for start in (0, 60_000):  # a second stream goes on from the first
        timed = [(frame, start + 9000 * i) for i, frame in enumerate(frames)]
        expected = [one_by_one.advance(*frame) for frame in timed]
        found = list(streaming.stream(timed))
        assert [events.tobytes() for events in found] == [events.tobytes() for events in expected]
        assert streaming.complete_us == one_by_one.complete_us
    assert sum(map(len, expected)) > 1000


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("error", [ValueError, OSError])
def test_what_goes_wrong_in_a_stream_comes_after_the_events_before_it(
    error: type[Exception], threads: int
) -> None:
    def frames() -> Iterator[tuple[np.ndarray, int]]:
        yield still(0, 8, 8), 0
        yield still(255, 8, 8), 1000
        yield still(0, 8, 8), 2000
        if error is ValueError:
            yield still(0, 8, 8), 2000  # time stands still
        raise OSError("the cable is out")

    stream = Simulator(8, 8, Parameters.of("paper"), seed=1, threads=threads).stream(frames())
    found = [len(next(stream)) for _ in range(3)]
    assert found[0] == 0
    assert min(found[1:]) > 64
    with pytest.raises(error):
        next(stream)


def test_who_stops_listening_to_a_stream_ends_it() -> None:
    frames = [(still(level, 8, 8), 1000 * i) for i, level in enumerate((0, 255, 0, 255))]
    simulator = Simulator(8, 8, Parameters.of("paper"), seed=1, threads=2)
    stream = simulator.stream(frames)
    assert len(next(stream)) == 0
    assert len(next(stream)) > 64
    stream.close()
    assert len(simulator.advance(still(255, 8, 8), 9000)) > 64  # the third frame had been read

"""What every source has from its base: it is iterated to its end, and closed whatever happens."""

import threading

import numpy as np
import pytest

from voltcam_video import Clock, Frame, Source, SourceError, SourceRequest


class Three(Source):
    """Three frames, then the end."""

    live = False

    def __init__(self, fails: bool = False) -> None:
        super().__init__(SourceRequest(uri="three"), Clock(), threading.Event())
        self.given, self.closed, self.fails = 0, 0, fails

    def read(self) -> Frame | None:
        if self.fails:
            raise SourceError("three: it broke; mend it")
        self.given += 1
        return Frame(np.zeros((2, 2), np.uint8), self.given) if self.given <= 3 else None

    def close(self) -> None:
        self.closed += 1


def test_frames_come_until_the_end() -> None:
    with Three() as source:
        assert [frame.t_us for frame in source] == [1, 2, 3]
        assert not source.closed
    assert source.closed == 1


def test_leaving_early_closes_and_the_next_frame_is_still_there() -> None:
    with Three() as source:
        assert next(iter(source)).t_us == 1
        assert [frame.t_us for frame in source] == [2, 3]
    assert source.closed == 1


def test_an_error_goes_on_and_closes() -> None:
    source = Three(fails=True)
    with pytest.raises(SourceError, match="mend it"), source:
        list(source)
    assert source.closed == 1


def test_by_default_it_ends_and_answers_to_no_uri() -> None:
    source = Three()
    assert not source.endless
    assert not Three.reads(SourceRequest(uri="three"))
    assert source.request.uri == "three"


def test_a_source_without_read_or_close_cannot_be_made() -> None:
    with pytest.raises(TypeError, match="abstract"):
        Source(SourceRequest(), Clock(), threading.Event())  # type: ignore[abstract]

"""Frames between the frames of a source, for the simulation that takes these one by one."""

from voltcam_simulator import Camera
from voltcam_video import Frame, along_cubic, along_flow, fit, follows

from .camera_settings import Upsample
from .mailbox import Arrival


class Upsampling:
    """For one camera. how: with "cubic" frames are taken one later, when the curve beyond them is known."""

    def __init__(self, how: Upsample, camera: Camera) -> None:
        self.how: Upsample = how
        self._camera = camera
        self._next: Arrival | None = None  # with "cubic": what comes after the frame at hand
        self._before: Frame | None = None  # the last two frames, as simulated
        self._former: Frame | None = None

    def next(self, arrival: Arrival) -> Arrival | None:
        """The frame to be simulated now that this one is there."""
        if self.how != "cubic":
            return arrival
        current, self._next = self._next, arrival
        return current

    @property
    def follows(self) -> bool:
        """Whether the next frame goes on from the former one."""
        return self._former is not None

    def up_to(self, frame: Frame, shift_us: int) -> list[Frame]:
        """The frames between the former one and this, and this; shift_us: see `Simulation.shift_us`."""
        if self._former is None or self.how in ("off", "linear"):
            return [frame]
        if self.how == "cubic":
            return [*along_cubic(self._before, self._former, frame, self._after(frame, shift_us)), frame]
        return [*along_flow(self._former, frame, self.how if isinstance(self.how, int) else None), frame]

    def _after(self, frame: Frame, shift_us: int) -> Frame | None:
        """The frame that comes next, where the scene goes on to it."""
        if self._next is None or self._next.cut:
            return None
        image = fit(self._next.frame.image, self._camera.width, self._camera.height, self._next.fit)
        after = Frame(image, self._next.frame.t_us + shift_us)
        return after if follows(frame, after) else None

    def went_on(self, frame: Frame) -> None:
        """This frame has been simulated."""
        self._before, self._former = self._former, frame

    def cut(self) -> None:
        """The next frame does not go on from the former one."""
        self._former = None

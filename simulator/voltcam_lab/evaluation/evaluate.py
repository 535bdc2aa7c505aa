"""Models against real recordings: a table of distances beside the recording's own floor, and its figures."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from voltcam_simulator.effect import Events
from voltcam_video import Upsampling

from ..distances import (
    DISTANCES,
    HEADLINES,
    MEASURES,
    FrameLight,
    Region,
    Yardstick,
    closest,
    gap,
    held_out,
)
from ..health import Inspection
from ..health.lag import Lag
from ..light.scene import Scene, scene_of
from ..models.model import Model, simulate
from ..recordings import Footage
from .lags import REAL, lags_of, told

Progress = Callable[[str], None]
FEWEST_FRAMES, FEWEST_EVENTS = 10, 1000


@dataclass(frozen=True, eq=False)
class Evaluation:
    """rows: model -> measure (distances.MEASURES) -> value, in the region of `yardstick`; floors: the same
    between halves of the real events; simulated: model -> all its events; lags: the same and REAL -> how far
    behind the frames. protocols: other ways to judge, by title."""

    name: str
    recording: Footage
    yardstick: Yardstick
    rows: dict[str, dict[str, float]]
    floors: dict[str, dict[str, float]]
    simulated: dict[str, Events]
    lags: dict[str, Lag] = field(default_factory=dict)
    protocols: dict[str, "Evaluation"] = field(default_factory=dict)

    def to_markdown(self) -> str:
        """Two tables, distances and rates, who is closest in each headline distance, and lags."""
        distances = {**self.rows, **self.floors}
        own = {REAL: self.yardstick.figures(self.yardstick.real)}
        differences = {f"{name} (difference)": row for name, row in self.floors.items()}
        rates = [name for name in MEASURES if name not in DISTANCES]
        return "\n\n".join([
            _table(DISTANCES, distances, bold=self.rows),
            "\n".join(f"- {line}" for line in self.verdict()),
            _table(rates, {**own, **self.rows, **differences}),
            *([told(self.lags)] if self.lags else []),
        ])  # fmt: skip

    def verdict(self) -> list[str]:
        """For each headline distance, the closest model, and what is left between it and the floor."""
        lines = []
        for name in HEADLINES:
            best = closest(self.rows, name)
            if best is None:
                lines.append(f"{name}: too few events to say.")
                continue
            value = self.rows[best][name]
            floor = next(
                (row[name] for row in self.floors.values() if row.get(name, value) == row.get(name)), None
            )
            left = "" if floor is None else f", {gap(name, value, floor):.3g} from the floor {floor:.3g}"
            lines.append(f"**{name}**: {best} is closest, {value:.3g}{left}.")
        return lines


def _table(
    measures: Sequence[str],
    rows: Mapping[str, Mapping[str, float]],
    bold: Mapping[str, Mapping[str, float]] | None = None,
) -> str:
    """In Markdown; the closest of the models in `bold` is set so."""
    winners = {name: closest(bold, name) for name in measures} if bold else {}
    lines = ["| | " + " | ".join(measures) + " |", "|---" * (len(measures) + 1) + "|"]
    for model, row in rows.items():
        cells = []
        for name in measures:
            text = "–" if row.get(name, float("nan")) != row.get(name) else f"{row[name]:.3g}"
            cells.append(f"**{text}**" if winners.get(name) == model else text)
        lines.append(f"| {model} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def yardstick_of(inspection: Inspection, name: str = "the recording") -> Yardstick:
    """All of a recording, less hot pixels and the windows in which events are locked to frames.

    Raises ValueError for one with too little in it to compare anything.
    """
    recording = inspection.footage
    frames, t_us, events = recording.frames, recording.frame_t_us, recording.events
    if len(frames) < FEWEST_FRAMES:
        raise ValueError(
            f"{name} has {len(frames)} frames: give a recording with frames "
            f"({FEWEST_FRAMES} at least), since they are what models are shown"
        )
    light = FrameLight(frames, t_us)
    region = Region.whole(recording.width, recording.height, int(t_us[0]), int(t_us[-1]))
    seen = region.of(events)
    if seen.size < FEWEST_EVENTS:
        raise ValueError(
            f"{name} has {seen.size} events between its first and last frame, fewer than {FEWEST_EVENTS}: "
            "record longer, or see whether frames and events are on one clock"
        )
    clean = region.on(~inspection.hot).without(inspection.exposure_windows)
    return Yardstick(events, clean, light)


def evaluate(
    inspection: Inspection,
    models: Mapping[str, Callable[[], Model]],
    *,
    name: str = "the recording",
    region: Region | None = None,
    scene: Scene | None = None,
    upsampling: Upsampling = "auto",
    progress: Progress = lambda _: None,
) -> Evaluation:
    """Show the recording's frames to each model and measure what comes out in `region`.

    models: makers of models of the recording's width and height. region: where and when to measure; by
    default the second half of `distances.held_out`. scene: the frames' light, made with `upsampling` where
    none is given. Raises ValueError as `yardstick_of` does.
    """
    whole = yardstick_of(inspection, name)
    progress("frames between frames")
    scene = scene or scene_of(whole.light.images, whole.light.t_us, upsampling)
    simulated = {}
    for model, make in models.items():
        progress(model)
        simulated[model] = simulate(make(), scene)
    return judged(inspection, simulated, region or held_out(whole.region)[1], name, progress)


def judged(
    inspection: Inspection,
    simulated: Mapping[str, Events],
    region: Region,
    name: str = "the recording",
    progress: Progress = lambda _: None,
) -> Evaluation:
    """Measure what models gave out, {model: events}, in a region. Raises ValueError as `yardstick_of`."""
    whole = yardstick_of(inspection, name)
    yardstick = Yardstick(whole.real, region, whole.light)
    rows = {}
    for model, events in simulated.items():
        progress(f"distances of {model}")
        rows[model] = yardstick.distances(events)
    progress("lags")
    lags = lags_of(inspection.footage, {REAL: whole.real, **simulated}, region)
    progress("real against real")
    floors = {
        "real, other pixels": yardstick.floor_by_pixels(),
        "real, other times": yardstick.floor_by_time(),
    }
    return Evaluation(name, inspection.footage, yardstick, rows, floors, dict(simulated), lags)

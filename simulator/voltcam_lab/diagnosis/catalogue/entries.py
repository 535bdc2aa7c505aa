"""The catalogue: one entry for each effect that a diagnosis may find, in the order of the search."""

from collections.abc import Sequence
from math import log

from voltcam_simulator import Parameters

from ...health.bus_waits import row_wait_us
from ...health.token_scan import find_token_scan
from . import aps_coupling, flicker
from .candidate import Candidate
from .clues import Clues
from .entry import Entry
from .temperature_drift import Warming
from .thresholds import ThresholdRatio

STILL_SCENE = "half a minute of a still scene, from dark to bright, on a tripod"
REPEATED_MOTION = "the same slow motion back and forth over every pixel, many times"
FAST_THEN_SLOW = "fast motion that fills the sensor with events, then slow motion of the same scene"

LAMP, READOUT = flicker.LampSearch(), aps_coupling.ReadoutSearch()


def sizes(*numbers: float) -> tuple[tuple[float, ...], ...]:
    """Sizes of a candidate with one name."""
    return tuple((number,) for number in numbers)


def _latencies(clues: Clues) -> tuple[Candidate, ...]:
    return (
        Candidate("latency", ("delay_us", "jitter_us"), ((200, 200), (1200, 1200))),
        Candidate("latency", ("delay_us",), sizes(1000, -1000)),
    )


def _hot_pixels(clues: Clues) -> tuple[Candidate, ...]:
    names, tried = ("fraction", "rate_hz"), ((0.003, 20), (0.012, 20))
    return (Candidate("hot_pixels", names, tried, least=1 / clues.pixels),)


def _warmings(clues: Clues) -> tuple[Candidate, ...]:
    rate = 10 * log(2) / log(2.03) / clues.seconds  # doubles the leak over the recording
    tried = sizes(rate, 2.3 * rate, -rate)
    return (Warming("temperature_drift", ("rate_c_per_s",), tried, seconds=clues.seconds),)


def _overflows(clues: Clues) -> tuple[Candidate, ...]:
    tried, others = sizes(0.4 * clues.peak_rate_per_s), {"buffer_events": 64}
    return (Candidate("usb_overflow", ("max_rate_events_per_s",), tried, others, growth="weaker"),)


def _token_scans(clues: Clues) -> tuple[Candidate, ...]:
    """Only where stamps show one: a round of a wrong time explains nothing."""
    token = find_token_scan(clues.events, clues.setting.scene.height)
    if token is None:
        return ()
    names = ("rows_together", "busy_per_us", "steepness", "burst_per_us")
    others = {name: float(getattr(token, name)) for name in names}
    return (Candidate("arbiter_scan", ("round_us",), sizes(token.round_us), others),)


def _row_requests(clues: Clues) -> tuple[Candidate, ...]:
    """Only where stamps show that rows ask late."""
    wait_us = row_wait_us(clues.events)
    return (Candidate("row_request", ("wait_us",), sizes(wait_us)),) if wait_us > 0 else ()


ENTRIES: tuple[Entry, ...] = (
    Entry(
        "refractory_period",
        "fast motion of sharp, high-contrast edges over the whole sensor",
        lambda clues: (Candidate("refractory_period", ("period_us",), sizes(700, 3000)),),
    ),
    Entry(
        "photoreceptor_bandwidth",
        "the same edges moved fast, once in bright light and once in the dark",
        lambda clues: (
            Candidate(
                "photoreceptor_bandwidth",
                ("cutoff_hz", "follower_hz"),
                ((400, 3200), (80, 640)),
                growth="weaker",
            ),
        ),
    ),
    Entry(
        "comparator",
        "slow brightening and darkening of the whole scene by the same amount",
        lambda clues: (ThresholdRatio("comparator", ("ratio",), sizes(1.15, 1 / 1.15), growth="ratio"),),
        in_words="unequal thresholds",
    ),
    Entry(
        "flicker",
        "a still, evenly lit wall under the lamp, frames not at a multiple of the mains",
        LAMP.candidates,
        on_clock=flicker.lamp_on_clock,
        tuned=LAMP.in_step,
    ),
    Entry(
        "aps_coupling",
        "a still scene with the frame rate changed half way",
        READOUT.candidates,
        on_clock=aps_coupling.readout_on_clock,
        lead_in_us=READOUT.lead_in_us,
    ),
    Entry(
        "latency",
        "a light switched on and off at known times",
        _latencies,
        delay_us=lambda parameters: parameters.latency.delay_us,
    ),
    Entry(
        "readout",
        FAST_THEN_SLOW,
        lambda clues: (Candidate("readout", ("event_us",), sizes(20, 60)),),
        in_words="readout saturation",
        acts_across_columns=lambda parameters: parameters.readout.active,
    ),
    Entry("hot_pixels", "half a minute with the lens cap on, after some motion", _hot_pixels),
    Entry(
        "low_light_shot_noise",
        STILL_SCENE,
        lambda clues: (Candidate("low_light_shot_noise", ("c",), sizes(0.005, 0.012)),),
    ),
    Entry(
        "threshold_mismatch",
        REPEATED_MOTION,
        lambda clues: (Candidate("threshold_mismatch", ("sigma",), sizes(0.07, 0.2)),),
    ),
    Entry(
        "reset_noise",
        REPEATED_MOTION,
        lambda clues: (Candidate("reset_noise", ("sigma",), sizes(0.1, 0.25)),),
    ),
    Entry(
        "leak_mismatch",
        STILL_SCENE,
        lambda clues: (Candidate("leak_mismatch", ("sigma",), sizes(0.3, 0.8)),),
    ),
    Entry(
        "dead_pixels",
        REPEATED_MOTION,
        lambda clues: (Candidate("dead_pixels", ("fraction",), sizes(0.01), least=1 / clues.pixels),),
    ),
    Entry("temperature_drift", "two minutes of a still scene from a cold start", _warmings),
    Entry(
        "usb_overflow",
        FAST_THEN_SLOW,
        _overflows,
        acts_across_columns=lambda parameters: parameters.usb_overflow.active,
    ),
    Entry("arbiter_scan", FAST_THEN_SLOW, _token_scans),
    Entry("row_request", FAST_THEN_SLOW, _row_requests),
    Entry("crosstalk", STILL_SCENE, lambda clues: (Candidate("crosstalk", ("coupling",), sizes(0.05)),)),
    Entry("noise_pairs", STILL_SCENE, lambda clues: (Candidate("noise_pairs", ("rate_hz",), sizes(2)),)),
    Entry(
        "timestamp_quantum",
        "any recording with many events",
        lambda clues: (Candidate("timestamp_quantum", ("quantum_us",), sizes(max(clues.tick_us, 2))),),
    ),
    Entry(
        "vignetting",
        "an evenly lit wall, still, then the lamp dimmed",
        lambda clues: (Candidate("vignetting", ("corner_loss",), sizes(0.3)),),
        needs_all_columns=True,
        acts_across_columns=lambda parameters: parameters.vignetting.active,
    ),
    Entry(
        "exposure_blur",
        "the same fast motion with a short exposure",
        lambda clues: (Candidate("exposure_blur", ("exposure_us",), sizes(5000)),),
    ),
    Entry(
        "input_response",
        "a still scene at three exposure times",
        lambda clues: (
            Candidate("input_response", ("gamma_exponent",), sizes(0.8, 1.4), growth="ratio"),
            Candidate("input_response", ("black_level_dn",), sizes(8)),
        ),
    ),
    # The open route: its forms are in search/unlisted.py.
    Entry(
        "residual_drift",
        STILL_SCENE,
        acts_across_columns=lambda parameters: (
            parameters.residual_drift.active and parameters.residual_drift.across != 0
        ),
    ),
    Entry("residual_noise", STILL_SCENE),
)


def catalogue(clues: Clues, entries: Sequence[Entry] = ENTRIES) -> tuple[Candidate, ...]:
    """What is looked for, at sizes that a recording of seconds shows plainly."""
    return tuple(candidate for entry in entries for candidate in entry.candidates(clues))


def event_delay_us(parameters: Parameters) -> float:
    """By how much a camera's effects delay all events."""
    return sum(entry.delay_us(parameters) for entry in ENTRIES)


def lead_in_us(parameters: Parameters) -> int:
    """How long a camera must run before the recording begins, for its effects to be as they stay."""
    return max(entry.lead_in_us(parameters) for entry in ENTRIES)


def acts_across_columns(parameters: Parameters) -> bool:
    """Whether the camera has an effect on that the columns of the sensor share."""
    return any(entry.acts_across_columns(parameters) for entry in ENTRIES)


def in_words(effect: str) -> str:
    """An effect's name for a sentence."""
    entry = next((one for one in ENTRIES if one.effect == effect), None)
    return entry.in_words if entry and entry.in_words else effect.replace("_", " ")


def next_recording(effect: str, rivals: Sequence[str]) -> str:
    """What to record so that an effect and its rivals can be told apart, in words."""
    shown_by = {entry.effect: entry.best_shown_by for entry in ENTRIES}
    wanted = dict.fromkeys(shown_by[one] for one in (effect, *rivals) if one in shown_by)
    return "; and ".join(wanted) or STILL_SCENE

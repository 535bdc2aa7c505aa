"""The recording that shows an effect best, for when another one explains the data as well."""

from collections.abc import Sequence

STILL = "half a minute of a still scene, from dark to bright, on a tripod"
FAST = "fast motion of sharp, high-contrast edges over the whole sensor"
REPEATED = "the same slow motion back and forth over every pixel, many times"

BEST_SHOWN_BY = {
    "refractory_period": FAST,
    "photoreceptor_bandwidth": "the same edges moved fast, once in bright light and once in the dark",
    "comparator": "slow brightening and darkening of the whole scene by the same amount",
    "flicker": "a still, evenly lit wall under the lamp, frames not at a multiple of the mains",
    "aps_coupling": "a still scene with the frame rate changed half way",
    "latency": "a light switched on and off at known times",
    "readout": "fast motion that fills the sensor with events, then slow motion of the same scene",
    "usb_overflow": "fast motion that fills the sensor with events, then slow motion of the same scene",
    "hot_pixels": "half a minute with the lens cap on, after some motion",
    "dead_pixels": REPEATED,
    "threshold_mismatch": REPEATED,
    "reset_noise": REPEATED,
    "leak_mismatch": STILL,
    "low_light_shot_noise": STILL,
    "noise_pairs": STILL,
    "crosstalk": STILL,
    "temperature_drift": "two minutes of a still scene from a cold start",
    "timestamp_quantum": "any recording with many events",
    "vignetting": "an evenly lit wall, still, then the lamp dimmed",
    "exposure_blur": "the same fast motion with a short exposure",
    "input_response": "a still scene at three exposure times",
    "residual_drift": STILL,
    "residual_noise": STILL,
}


def next_recording(effect: str, rivals: Sequence[str]) -> str:
    """What to record so that an effect and its rivals come apart, in words."""
    wanted = dict.fromkeys(BEST_SHOWN_BY[one] for one in (effect, *rivals) if one in BEST_SHOWN_BY)
    return "; and ".join(wanted) or STILL

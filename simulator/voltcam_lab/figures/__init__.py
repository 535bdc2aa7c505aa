"""Figures of reports and documents: functions from data to a matplotlib Figure, all in one style."""

from .clouds import Window, busiest, clouds
from .dots import dots
from .histograms import interval_histograms
from .noise import HeldImage, at_rest, noise_against_intensity, noise_in_recording
from .residuals import residual_maps
from .style import as_uri, save
from .temperature import LeakByTemperature, leak_by_temperature, temperature

__all__ = [
    "HeldImage",
    "LeakByTemperature",
    "Window",
    "as_uri",
    "at_rest",
    "busiest",
    "clouds",
    "dots",
    "interval_histograms",
    "leak_by_temperature",
    "noise_against_intensity",
    "noise_in_recording",
    "residual_maps",
    "save",
    "temperature",
]

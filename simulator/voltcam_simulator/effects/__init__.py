"""EFFECTS: the registry, in the order light meets them. Adding an effect: its file, a line here, its test."""

from ..effect import Effect
from .comparator import Comparator
from .contrast_response import ContrastResponse
from .junction_leak import JunctionLeak
from .leak_noise import LeakNoise
from .parasitic_photocurrent import ParasiticPhotocurrent
from .photon_noise import PhotonNoise

EFFECTS: tuple[type[Effect], ...] = (
    ContrastResponse,
    PhotonNoise,
    JunctionLeak,
    ParasiticPhotocurrent,
    LeakNoise,
    Comparator,
)

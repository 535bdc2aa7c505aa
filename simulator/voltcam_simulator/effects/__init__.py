"""EFFECTS: the registry, in the order light meets them. Adding an effect: its file, a line here, its test."""

from ..effect import Effect
from .aps_coupling import ApsCoupling
from .arbiter_scan import ArbiterScan
from .comparator import Comparator
from .contrast_response import ContrastResponse
from .crosstalk import Crosstalk
from .dark_current import DarkCurrent
from .dead_pixels import DeadPixels
from .exposure_blur import ExposureBlur
from .flicker import Flicker
from .frame_noise import FrameNoise
from .hot_pixels import HotPixels
from .input_response import InputResponse
from .junction_leak import JunctionLeak
from .latency import Latency
from .leak_mismatch import LeakMismatch
from .leak_noise import LeakNoise
from .low_light_shot_noise import LowLightShotNoise
from .noise_pairs import NoisePairs
from .parasitic_photocurrent import ParasiticPhotocurrent
from .photon_noise import PhotonNoise
from .photoreceptor_bandwidth import PhotoreceptorBandwidth
from .readout import Readout
from .refractory_period import RefractoryPeriod
from .reset_noise import ResetNoise
from .residual_clock import ResidualClock
from .residual_coupling import ResidualCoupling
from .residual_drift import ResidualDrift
from .residual_kick import ResidualKick
from .residual_noise import ResidualNoise
from .residual_pattern import ResidualPattern
from .row_request import RowRequest
from .temperature_drift import TemperatureDrift
from .threshold_mismatch import ThresholdMismatch
from .timestamp_quantum import TimestampQuantum
from .usb_overflow import UsbOverflow
from .vignetting import Vignetting

EFFECTS: tuple[type[Effect], ...] = (
    TemperatureDrift,
    FrameNoise,
    InputResponse,
    ExposureBlur,
    Vignetting,
    Flicker,
    DarkCurrent,
    ContrastResponse,
    PhotoreceptorBandwidth,
    PhotonNoise,
    LowLightShotNoise,
    JunctionLeak,
    ParasiticPhotocurrent,
    LeakNoise,
    ResidualDrift,
    ResidualNoise,
    ApsCoupling,
    ResidualClock,
    LeakMismatch,
    Comparator,
    ThresholdMismatch,
    ResidualPattern,
    DeadPixels,
    RefractoryPeriod,
    ResetNoise,
    HotPixels,
    NoisePairs,
    ResidualKick,
    ResidualCoupling,
    Crosstalk,
    Latency,
    RowRequest,
    ArbiterScan,
    Readout,
    UsbOverflow,
    TimestampQuantum,
)

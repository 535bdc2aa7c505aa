"""The numbers of the exact law, and where each stands in a camera file: (effect, parameter)."""

Place = tuple[str, str]

K1_TO_K6: dict[str, Place] = {
    "k1": ("contrast_response", "k1"),
    "k2_dn": ("contrast_response", "k2_dn"),
    "k3": ("photon_noise", "k3"),
    "k4_per_us": ("junction_leak", "k4_per_us"),
    "k5_per_dn_us": ("parasitic_photocurrent", "k5_per_dn_us"),
    "k6": ("leak_noise", "k6"),
}
"""The six of DVS-Voltmeter (Lin et al., ECCV 2022, equation 10), under its names."""

IN_THRESHOLDS = tuple(name for name in K1_TO_K6 if name != "k2_dn")
"""Those of them that are in units of the threshold: with another threshold they change alike."""

SPREADS: dict[str, Place] = {
    "threshold_spread": ("threshold_mismatch", "sigma"),
    "leak_spread": ("leak_mismatch", "sigma"),
    "reset_spread": ("reset_noise", "sigma"),
}
"""How much pixels differ, and one pixel from event to event."""

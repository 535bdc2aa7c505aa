"""Other people's pixel models, from their published descriptions, to compare with."""

from .esim import Esim, EsimParameters
from .v2e import V2e, V2eParameters

__all__ = ["Esim", "EsimParameters", "V2e", "V2eParameters"]

"""The two laws by which a pixel's voltage becomes events."""

from typing import Literal

Law = Literal["exact", "paper"]
"""exact: Brownian motion itself, see `first_passage`. paper: Algorithm 1, see `paper_law`."""

"""Grey levels and what they stand for."""

USUAL_DARK_DN = 20.0
"""Added to a grey level before its logarithm, as k2 in the paper: below it, frames tell mostly of noise."""
WHITE_DN = 255.0
"""The largest of 8 bits."""

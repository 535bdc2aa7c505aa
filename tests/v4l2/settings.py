"""What the guest and what is done before it have in common."""

MEMORY_BYTES = 8_000_000_000  # of a daemon's address space
WIDTH, HEIGHT, FPS = 320, 180, 10
LONG_S = 90.0
"""All waits of an emulated processor, on a machine that does other things, too."""

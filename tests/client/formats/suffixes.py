"""What suffixes have in common."""

SPOOLED = (".npz", ".h5", ".hdf5", ".bag", ".mcap", ".db3")
"""Endings of the formats that are put together on close, from a folder that can be read before."""

FROM_BEGINNING = (".es",)
"""Of those that say times from the file's beginning only."""

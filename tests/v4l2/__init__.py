"""`make v4l2`: Debian's kernel in QEMU, its test camera vivid, and a daemon that looks at it."""

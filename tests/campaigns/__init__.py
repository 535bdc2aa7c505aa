"""Long runs that try what may happen in weeks: each has a make target, and a small part in CI."""

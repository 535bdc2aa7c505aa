"""The daemon's diagnosis: `gather` records what to diagnose, `runner` has it done, `api` shows it."""

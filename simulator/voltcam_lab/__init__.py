"""A recording against the model: statistics, calibrate, evaluate, diagnose."""

"""A recording looked at before it is used: what is wrong with it, and what it can and cannot determine.

    found = inspect(load("street.aedat4"))
    print(found.health.text())

`mask` and `hot` are what a calibration leaves out; `exposure_windows` are the same for all rows.
"""

from .finding import Determination, EventsLate, Finding, Health
from .inspection import Inspection, inspect

__all__ = ["Determination", "EventsLate", "Finding", "Health", "Inspection", "inspect"]

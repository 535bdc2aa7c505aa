"""Reads {type: definition} as JSON, and prints what genpy makes of them: {type: [sum of the distribution's
class, sum of the definition, whether both have the same fields]}.
"""

import importlib
import json
import sys

from genpy.dynamic import generate_dynamic

sums = {}
for name, definition in json.load(sys.stdin).items():
    package, _, kind = name.partition("/")
    theirs = getattr(importlib.import_module(package + ".msg"), kind)
    ours = generate_dynamic(name, definition)[name]
    same = theirs.__slots__ == ours.__slots__ and theirs._slot_types == ours._slot_types
    sums[name] = [theirs._md5sum, ours._md5sum, same]
json.dump(sums, sys.stdout)

"""Random legal parameters, drawn from their whole ranges as the schema of the REST interface tells them."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

Change = dict[str, dict[str, Any]]
AT_A_LIMIT = 0.15  # share of values that are exactly a limit
LEAST = 1e-9  # of the values drawn by their logarithm


class Legal:
    """Draws changes of parameters, `schema` being `GET /api/v1/parameters/schema`."""

    def __init__(self, schema: Mapping[str, Any], seed: int) -> None:
        self._rng = np.random.default_rng(seed)
        self._fields = [
            (effect, name, field)
            for effect, model in _effects(schema)
            for name, field in schema["$defs"][model]["properties"].items()
        ]

    def change(self, most: int = 8) -> Change:
        """Some parameters, each anywhere in its range."""
        change: Change = {}
        for place in self._rng.choice(len(self._fields), self._rng.integers(1, most + 1), replace=False):
            effect, name, field = self._fields[place]
            change.setdefault(effect, {})[name] = self._value(field)
        return change

    def _value(self, field: Mapping[str, Any]) -> Any:
        rng = self._rng
        if "enum" in field:
            return str(rng.choice(field["enum"]))
        open_low = "exclusiveMinimum" in field
        low = field["exclusiveMinimum"] if open_low else field["minimum"]
        high = field["maximum"]
        if rng.random() < AT_A_LIMIT:
            value = high if open_low or rng.random() < 0.5 else low
        elif low >= 0 and rng.random() < 0.5:
            least = max(low, LEAST * high)
            value = math.exp(rng.uniform(math.log(least), math.log(high)))
        else:
            value = rng.uniform(low, high)
        value = min(max(value, LEAST * high if open_low else low), high)
        return round(value) if field["type"] == "integer" else float(value)


def _effects(schema: Mapping[str, Any]) -> list[tuple[str, str]]:
    """(name of the effect, name of its model)."""
    return [
        (name, field["$ref"].rsplit("/", 1)[1])
        for name, field in schema["properties"].items()
        if "$ref" in field
    ]

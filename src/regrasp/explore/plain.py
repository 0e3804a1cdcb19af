"""Numbers as JSON holds them."""

from math import isfinite
from typing import Any

import numpy as np

from regrasp.mechanics.checks import Array


def plain(values: Array) -> Any:
    """Nested lists of seven digits, null where a number is none.

    Args:
        values: of any shape.
    """
    rounded: Any = np.vectorize(lambda v: float(f"{v:.7g}"), otypes=[float])(values)
    return _finite(rounded.tolist())


def _finite(value: Any) -> Any:
    if isinstance(value, list):
        return [_finite(entry) for entry in value]
    return value if isfinite(value) else None

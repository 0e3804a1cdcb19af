"""Outlines from plain coordinates: CSV, TXT, DAT."""

import re
from io import StringIO

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array
from regrasp.outline.drawing import Budget
from regrasp.outline.opening import decoded

_SEPARATOR = re.compile(r"[\s,;]+")


def coordinate_rings(data: bytes) -> list[Array]:
    """The rings (k, 2) of a file of two columns, apart by commas, semicolons or spaces.

    A line that begins with # is a comment, a first line of words a heading; a blank line begins another ring.
    """
    text = decoded(data)
    if "\0" in text:
        raise InvalidInput("the file cannot be read as text: it has bytes of 0")
    rings: list[list[tuple[float, float]]] = [[]]
    begun, budget = False, Budget()
    for count, line in enumerate(StringIO(text, newline=None), start=1):
        words = line.partition("#")[0].strip()
        if words:
            point = _point(words)
            if point:
                rings[-1].append(point)
                budget.spend(points=1)
            elif begun:
                raise InvalidInput(f"line {count} must be two numbers, x and y; got {line.strip()[:60]!r}")
            begun = True
        elif not line.strip() and rings[-1]:
            rings.append([])
            budget.spend(pieces=1)
    found = [np.array(ring) for ring in rings if ring]
    if not found:
        raise InvalidInput("the file is empty: it has no lines of two numbers, x and y")
    return found


def _point(words: str) -> tuple[float, float] | None:
    try:
        x, y = (float(word) for word in _SEPARATOR.split(words))
    except ValueError:
        return None
    return x, y

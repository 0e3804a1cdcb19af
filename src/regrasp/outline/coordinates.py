"""Outlines from plain coordinates: CSV, TXT, DAT."""

import re
from pathlib import Path

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array

_SEPARATOR = re.compile(r"[\s,;]+")


def coordinate_rings(path: Path) -> list[Array]:
    """The rings (k, 2) of a file of two columns, apart by commas, semicolons or spaces.

    A line that begins with # is a comment, a first line of words a heading; a blank line begins another ring.
    """
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise InvalidInput(f"the file cannot be read as text: {error}") from None
    rings: list[list[tuple[float, float]]] = [[]]
    begun = False
    for count, line in enumerate(lines, start=1):
        text = line.partition("#")[0].strip()
        if text:
            point = _point(text)
            if point:
                rings[-1].append(point)
            elif begun:
                raise InvalidInput(f"line {count} must be two numbers, x and y; got {line.strip()!r}")
            begun = True
        elif not line.strip() and rings[-1]:
            rings.append([])
    found = [np.array(ring) for ring in rings if ring]
    if not found:
        raise InvalidInput("the file is empty: it has no lines of two numbers, x and y")
    return found


def _point(text: str) -> tuple[float, float] | None:
    words = _SEPARATOR.split(text)
    try:
        x, y = (float(word) for word in words)
    except ValueError:
        return None
    return x, y

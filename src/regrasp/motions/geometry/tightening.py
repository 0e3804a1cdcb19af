"""Polygonal ways drawn tight."""

import itertools

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.motions.roadmap import Clear

_SWEEPS = 12
_GAIN = 2e-3  # of the length: a sweep that wins less is the last
_STEPS = (1.0, 0.5, 0.2)  # of a corner towards the line past it
_PARTS = 16  # sides at most, halved where they are long


def tightened(points: Array, clear: Clear) -> Array:
    """The way (k, d) with corners left out, and drawn towards the lines past them, as long as it is clear."""
    way = _skipped(list(points), clear)
    for sweep in range(_SWEEPS):
        before = _length(way)
        if sweep < 2 and 2 < len(way) <= _PARTS // 2:
            way = [p for a, b in itertools.pairwise(way) for p in (a, (a + b) / 2)] + [way[-1]]
        for i in range(1, len(way) - 1):
            a, p, b = way[i - 1 : i + 2]
            side = b - a
            foot = a + np.clip((p - a) @ side / max(float(side @ side), 1e-300), 0.0, 1.0) * side
            for step in _STEPS:
                q = p + step * (foot - p)
                if clear(a, q) and clear(q, b):
                    way[i] = q
                    break
        way = _skipped(way, clear)
        if _length(way) > (1 - _GAIN) * before and sweep >= 2:
            break
    return np.array(way)


def _skipped(way: list[Array], clear: Clear) -> list[Array]:
    """Without corners that need not be passed."""
    result, i = [way[0]], 0
    while i < len(way) - 1:
        j = next((j for j in range(len(way) - 1, i + 1, -1) if clear(way[i], way[j])), i + 1)
        result.append(way[j])
        i = j
    return result


def _length(way: list[Array]) -> float:
    return float(np.linalg.norm(np.diff(np.array(way), axis=0), axis=1).sum())

"""A box with a larger least width or product of widths, where questions whether one holds are dear.

Boxes are ways (n,) from places, all at least 0. What contains a box that was refused is not asked about.
"""

from collections.abc import Callable
from itertools import product

import numpy as np

from regrasp.mechanics.checks import Array

MOST = {"least": 80, "product": 50}  # questions; those about a product twice, for the least come first
_STEPS = (0.5, 0.25, 0.12, 0.06, 0.03)  # of widths
_BETTER = 0.01  # least gain


class Seeking:
    """Questions about boxes no longer than ``most``, which are answered by ``holds``, so many at most."""

    def __init__(self, holds: Callable[[Array], bool], longest: Array, left: int) -> None:
        self.holds, self.longest, self.left = holds, longest, left
        self._refused: list[Array] = []

    def product(self, ways: Array, score: Callable[[Array], float]) -> Array:
        """Ways of a larger score, e.g. the logarithm of a product: one is drawn in, another grows."""
        pairs = [(i, j) for i, j in product(range(len(ways)), repeat=2) if i != j]

        def traded(of: Array, number: int, step: float, better: float) -> Array | None:
            i, j = pairs[number]
            found, needed = of.copy(), score(of) + better
            found[i] *= 1 - step
            lo, found[j] = found[j], self.longest[j]
            if score(found) < needed:
                return None
            hi = found[j]
            for _ in range(30):
                found[j] = 0.5 * (lo + hi)
                lo, hi = (lo, found[j]) if score(found) >= needed else (found[j], hi)
            found[j] = hi
            return found

        return self._climbed(ways, len(pairs), traded)

    def least(self, ways: Array) -> Array:
        """Ways back and ahead (k, 2), as a row, all of one sum, which is as large as can be."""
        width = float((ways[::2] + ways[1::2]).min())
        back = np.clip(0.5 * width, width - ways[1::2], ways[::2])
        turns = sorted(product((0.0, -1.0, 1.0), repeat=len(back)), key=np.count_nonzero)

        def slid(of: Array, number: int, step: float, better: float) -> Array | None:
            old = of[0] + of[1]
            wide = old * (1 + better)
            to = np.clip(of[::2] * (1 + better) + step * old * np.array(turns[number]), 0.0, wide)
            return np.stack([to, wide - to], axis=1).ravel()

        return self._climbed(np.stack([back, width - back], axis=1).ravel(), len(turns), slid)

    def _climbed(
        self, ways: Array, count: int, moved: Callable[[Array, int, float, float], Array | None]
    ) -> Array:
        for step in _STEPS:
            helped = True
            while helped:
                helped = False
                for number in range(count):
                    start, better = ways, _BETTER
                    while (tried := moved(start, number, step, better)) is not None and self._held(tried):
                        ways, helped, better = tried, True, 2 * better
        return ways

    def _held(self, tried: Array) -> bool:
        if self.left == 0 or (tried > self.longest).any():
            return False
        if any((tried >= refused).all() for refused in self._refused):
            return False
        self.left -= 1
        if not self.holds(tried):
            self._refused.append(tried)
            return False
        return True

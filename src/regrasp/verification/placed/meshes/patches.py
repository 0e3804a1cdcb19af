"""The tree of patches that a surface is split into, in doubles and in rationals."""

from fractions import Fraction
from typing import Any, Protocol

import numpy as np

from regrasp.mechanics.checks import Array

Corner = tuple[list[Fraction], list[float]]
"""A point and a normal."""


class Surface(Protocol):
    """What is needed to know of a proof."""

    corners: Array
    normals: Array
    spans: Any
    halves: Any


class Patches:
    """The tree of patches: groups of triangles, and triangles halved across edges."""

    def __init__(self, proof: Surface) -> None:
        self.spans, self.halves = np.asarray(proof.spans), np.asarray(proof.halves)
        self.corners, self.normals = np.asarray(proof.corners), np.asarray(proof.normals)

    def wrong(self) -> list[str]:
        """What is wrong with the halves; and where the parts of triangles are, for ``rows``."""
        p, q, m = len(self.spans), len(self.halves), len(self.normals)
        if not p or p > q or tuple(self.spans[0]) != (0, m):
            return ["proof: patch 0 must be the whole surface"]
        self._part: dict[int, tuple[int, Array]] = {}
        self._half_of: dict[int, tuple[int, int]] = {}  # the patch, and the edge that is halved
        for patch in range(q):
            left, right, edge = (int(c) for c in self.halves[patch])
            first, count = (int(c) for c in self.spans[patch]) if patch < p else (0, 1)
            if not 0 <= first < first + count <= m:
                return [f"proof: patch {patch} is no group of triangles"]
            if patch >= p and patch not in self._part:
                return [f"proof: patch {patch} is a half of none"]
            if patch < p and count == 1:
                self._part[patch] = first, self.corners[first]
            if left < 0:
                continue
            good = all(patch < half < q and (half < p) == (count > 1) for half in (left, right))
            if not good or left == right or not (count > 1 or edge in (0, 1, 2)):
                return [f"proof: patch {patch} has no two halves"]
            if count > 1:
                (at, some), (then, more) = (tuple(self.spans[half]) for half in (left, right))
                if at != first or then != first + some or some + more != count:
                    return [f"proof: the halves of patch {patch} do not cover it"]
                continue
            if left in self._part or right in self._part:
                return [f"proof: a half of patch {patch} is another's"]
            on, t = self._part[patch]
            a, b, o = t[edge], t[(edge + 1) % 3], t[(edge + 2) % 3]
            middle = 0.5 * (a + b)
            self._part[left] = on, np.array([a, middle, o])
            self._part[right] = on, np.array([middle, b, o])
            self._half_of[left] = self._half_of[right] = patch, edge
        return []

    def rows(self, patch: int) -> tuple[Array, Array]:
        """(c, 3) corners and their normals, where halves of edges are as doubles."""
        if patch in self._part:
            on, corners = self._part[patch]
            return corners, np.repeat(self.normals[on : on + 1], len(corners), axis=0)
        first, count = self.spans[patch]
        corners = self.corners[first : first + count]
        return np.concatenate(corners), np.repeat(self.normals[first : first + count], 3, axis=0)

    def exactly(self, patch: int) -> list[Corner]:
        """Corners, halves of edges as they are, and normals."""
        halvings, at = [], patch
        while at in self._half_of:
            whole, edge = self._half_of[at]
            halvings.append((edge, at == int(self.halves[whole, 0])))
            at = whole
        points, normals = self.rows(at)
        corners = [[Fraction(c) for c in p] for p in points.tolist()]
        for edge, is_left in reversed(halvings):
            a, b, o = corners[edge], corners[(edge + 1) % 3], corners[(edge + 2) % 3]
            middle = [(x + y) / 2 for x, y in zip(a, b, strict=True)]
            corners = [a, middle, o] if is_left else [middle, b, o]
        return list(zip(corners, normals.tolist(), strict=True))

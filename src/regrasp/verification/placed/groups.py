"""Whether duals of all loads together exclude a box, each finger on some edges or parts of a curve.

While every finger stays on its edge, what they may do at most is convex in the places (``whole_sets``), and
largest where each is at an end of its edge, or at a control point of its part, with the forces of that one.
Stretches of curves are cut in up to ``CUTS`` equal parts, as long as there are no more than ``MOST`` corners.
Doubles decide where they show more than all of their rounding together; else rationals do, the corner first
that is worst in doubles.
"""

from fractions import Fraction
from itertools import combinations, pairwise, product
from math import prod
from typing import Protocol

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.verification.placed.protocol import Point
from regrasp.verification.placed.protocol import Proof as Placements
from regrasp.verification.placed.whole_sets import ties_of, works

MOST, MOST_AT_CORNERS, CUTS = 4096, 2**22, 8
"""Corners of a box, loads at all of these together, and parts of a stretch of a curve."""
_ROUNDING = 1e-13  # of the terms of a sum of a few products: more than a hundred roundings
_SMALL = 1e-140  # squares of less lose digits, and doubles of less than 1e-308 all of them
_TERMS = 24.0  # of a tie: three fingers moved to and fro by two differences of places, two coordinates each

Stretch = tuple[int, Fraction, Fraction]
"""An edge, and from which to which fraction of it."""


class Edges(Protocol):
    """The boundary."""

    def hull(self, edge: int, lo: Fraction, hi: Fraction) -> list[Point]:
        """Points whose hull contains a stretch."""

    def most_along(self, edge: int, lo: Fraction, hi: Fraction, along: list[Point]) -> Fraction:
        """The most that a force of size 1 anywhere on a stretch does along any of some velocities."""

    def outlined(self, edge: int, lo: float, hi: float) -> tuple[Array, Array] | None:
        """In doubles, such points, and edges of a sector that has all forces; None where they do not tell."""


class Groups:
    """Boxes of one proof."""

    def __init__(self, proof: Placements, boundary: Edges) -> None:
        self.proof, self.boundary = proof, boundary
        self.loads, self.plain = proof.loads.tolist(), False  # whether doubles may tell
        self.bound = Fraction(proof.bound)
        self.points = 2 if proof.control is None else 4
        points = np.reshape(proof.vertices if proof.control is None else proof.control, (-1, 2))
        self.reach = float(np.hypot(*np.abs(points).max(axis=0)) + np.hypot(*proof.centre_of_mass))

    def corners(self, box: list[list[Stretch]]) -> int:
        """How many at the least."""
        return prod(self.points * len(on) for on in box)

    def excludes(self, row: Array, box: list[list[Stretch]]) -> bool:
        """Whether duals exclude a box, of one stretch for each finger and each edge of its arc."""
        if self.bound <= 0:
            return True
        parts = [[part for stretch in on for part in self._cut(stretch, box)] for on in box]
        with np.errstate(all="ignore"):
            clear, worst = self._roughly(row, parts) if self.plain else (False, None)
        if clear:
            return True
        numbers = row.tolist()
        if worst is not None:
            on = [each[i // self.points] for each, i in zip(parts, worst, strict=True)]
            hulls = [[self.boundary.hull(*part)[i % self.points]] for part, i in zip(on, worst, strict=True)]
            if not self._holds(numbers, on, hulls):
                return False
        return all(
            self._holds(numbers, list(on), [self.boundary.hull(*part) for part in on])
            for on in product(*parts)
        )

    def _cut(self, stretch: Stretch, box: list[list[Stretch]]) -> list[Stretch]:
        """Equal parts of a stretch of a curve."""
        edge, lo, hi = stretch
        if self.points == 2:
            return [stretch]
        n = 1
        while n < CUTS and self.corners(box) * (n + 1) ** len(box) <= MOST:
            n += 1
        at = [lo + (hi - lo) * i / n for i in range(n + 1)]
        return [(edge, a, b) for a, b in pairwise(at)]

    def _holds(self, row: list[float], on: list[Stretch], hulls: list[list[Point]]) -> bool:
        """In rationals, of one stretch for each finger."""

        def most(finger: int, u: Point) -> Fraction:
            return self.boundary.most_along(*on[finger], [u])

        work, done = works(row, self.loads, hulls, most)
        return work > 0 and work >= self.bound * done

    def _roughly(self, row: Array, parts: list[list[Stretch]]) -> tuple[bool, tuple[int, ...] | None]:
        """Whether doubles show that a box is excluded; and the worst corner, where they tell of it."""
        points, edges = [], []
        for on in parts:
            told = [self.boundary.outlined(edge, float(lo), float(hi)) for edge, lo, hi in on]
            if any(each is None for each in told):
                return False, None
            points.append(np.concatenate([p for p, _ in told]))  # type: ignore[misc]
            edges.append(np.concatenate([np.broadcast_to(e, (len(p), 2, 2)) for p, e in told]))  # type: ignore[misc]
        k, loads = len(parts), len(self.loads)
        twists, ties = row[: 3 * loads].reshape(loads, 3), row[3 * loads :].reshape(loads - 1, ties_of(k))
        moves = _moves(twists, ties, k)
        done = np.zeros([len(p) for p in points])
        for i in range(k):
            u = np.broadcast_to(twists[:, :2], (*done.shape, loads, 2))
            for j, p in enumerate(points):
                moved = p @ moves[:, i, j].transpose(0, 2, 1)  # (L, T, 2)
                u = u + moved.transpose(1, 0, 2).reshape([-1 if j == a else 1 for a in range(k)] + [loads, 2])
            rays = edges[i].reshape([-1 if i == a else 1 for a in range(k)] + [1, 2, 2])
            done = done + _on_sector(rays[..., 0, :], rays[..., 1, :], u).sum(axis=-1)
        terms = -np.asarray(self.loads) * twists
        sizes = k * np.abs(twists) @ [1.0, 1.0, self.reach]
        lost = _ROUNDING * np.abs(terms).sum()
        sizes = sizes.sum() + _TERMS * self.reach * np.abs(ties).sum()
        room = _ROUNDING * sizes
        most = self.proof.bound * (done.max() + (1 + self.proof.friction) * room) * (1 + _ROUNDING)
        clear = bool(terms.sum() - lost > most and min(lost, room) > _SMALL)
        if not np.isfinite(done).all():
            return False, None
        return clear, tuple(int(i) for i in np.unravel_index(done.argmax(), done.shape))


def _moves(twists: Array, ties: Array, k: int) -> Array:
    """(L, k, k, 2, 2): by which the place of a finger moves another, or itself, under each load."""
    turn = np.array([[0.0, -1.0], [1.0, 0.0]])
    tied = np.zeros((len(ties), k, k, 2, 2))
    left = iter(ties.T)
    for i, j in combinations(range(k), 2):
        c = next(left)[:, None, None] * np.eye(2)
        for one, other in ((i, j), (j, i)):
            tied[:, one, one] += c
            tied[:, one, other] -= c
    for few in combinations(range(k), 3):
        a, b, c = next(left), next(left), next(left)
        s = np.stack([np.stack([a, c], axis=1), np.stack([c, b], axis=1)], axis=1) @ turn
        for f, g, h in (few, few[1:] + few[:1], few[2:] + few[:2]):
            tied[:, f, g] += s
            tied[:, f, h] -= s
    moves = np.concatenate([-tied.sum(axis=0)[None], tied])
    moves[:, range(k), range(k)] += twists[:, None, 2, None, None] * turn
    return moves


def _on_sector(a: Array, b: Array, v: Array) -> Array:
    """The most of v . f over f of length 1 from a counter-clockwise to b, less than 3/4 of a turn; or 0."""
    across = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    narrow = (across > 0) | ((a * b).sum(axis=-1) > 0.5)  # 1 where it is no turn at all
    after = a[..., 0] * v[..., 1] > a[..., 1] * v[..., 0]
    before = v[..., 0] * b[..., 1] > v[..., 1] * b[..., 0]
    edge = np.maximum((a * v).sum(axis=-1), (b * v).sum(axis=-1))
    inside = np.where(narrow, after & before, after | before)
    result: Array = np.where(inside, np.hypot(v[..., 0], v[..., 1]), np.maximum(edge, 0.0))
    return result

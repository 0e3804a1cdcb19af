"""The verdict on a cut of an outline that no hold crosses, in rational arithmetic.

A finger anywhere between two ends of a straight side makes only sums of what it makes at both ends, so a box
of two stretches is excluded by a twist y along which the load does more work than the forces of the fingers
there can take up,

    min_1 y . w + min_2 y . w + min y . w_ext > 0,

each minimum over both ends. Without limits those over forces are zero, or there is none. Between both ends of
a turn of less than half a turn the load is in the triangle of these two and of where the tangents of its arc
meet.
"""

from collections.abc import Iterator
from fractions import Fraction
from itertools import combinations, pairwise
from math import atan2, degrees, inf, isfinite
from typing import Protocol

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.verification.exact import RESOLUTION, cross, dot, exact
from regrasp.verification.refusals.limited_work import corners, least_work
from regrasp.verification.verdict import Verification

Span = tuple[Fraction, Fraction]
Place = tuple[int, Fraction]


class OutlineCut(Protocol):
    """What ``verify`` needs to know of a cut of an outline, whoever made it."""

    @property
    def vertices(self) -> Array:
        """(k, 2) counter-clockwise, relative to the centre of mass [m]."""

    @property
    def friction(self) -> float:
        """Of all fingers."""

    @property
    def force(self) -> Array:
        """(2,) on the object [N]."""

    @property
    def turned(self) -> Array | None:
        """(2,) at the other end of the turn [N]."""

    @property
    def forbidden(self) -> Array:
        """Sides that no finger touches."""

    @property
    def min_normal(self) -> float:
        """Of both fingers of a hold [N]."""

    @property
    def max_force(self) -> float | None:
        """Of every finger [N]; None for none."""

    @property
    def start(self) -> Array:
        """(3, 2) sides and fractions."""

    @property
    def goal(self) -> Array:
        """(3, 2) sides and fractions."""

    @property
    def reached(self) -> Array:
        """(r, 3) sides and the fractions of the ends of arcs."""

    @property
    def boxes(self) -> Array:
        """(m, 6) two sides, and ends on either."""

    @property
    def twists(self) -> Array:
        """(m, 3)."""


def verify_outline_cut(cut: OutlineCut) -> Verification:
    """Whether no regrasp on this outline leads from the start to the goal at these orientations."""
    if not _is_formed(cut):
        words = "a cut has three places at either end and a twist for every box, all on sides of its outline"
        return Verification((words,), inf, 0.0, -inf)
    if not np.diff(cut.vertices, axis=0, append=cut.vertices[:1]).any(axis=1).all():
        return Verification(("a side of the outline has no length",), inf, 0.0, -inf)
    judged = _Cut(cut)
    broken = [] if judged.is_counter_clockwise() else ["the vertices do not run counter-clockwise"]
    broken += [*judged.turn(), *judged.twists_at_work(), *judged.ends(), *judged.gaps()]
    asked = f"{judged.orientations()}{_in_words(cut.min_normal, cut.max_force)}"
    return Verification(tuple(broken), 0.0, inf, inf, excluded=len(cut.boxes), asked=asked)


def _in_words(min_normal: float, max_force: float | None) -> str:
    least = [f"normal forces of at least {min_normal:g} N"] if min_normal > 0 else []
    most = [] if max_force is None else [f"forces of at most {max_force:g} N"]
    return f", with {' and '.join(least + most)} in every hold" if least or most else ""


def _is_formed(cut: OutlineCut) -> bool:
    """Whether sides, fractions and counts are such that the rest can be judged."""
    count = len(cut.vertices)
    forbidden, turned = np.asarray(cut.forbidden, dtype=float), _turned(cut)
    tables = (
        cut.vertices,
        cut.force,
        turned,
        forbidden,
        cut.twists,
        cut.start,
        cut.goal,
        cut.reached,
        cut.boxes,
    )
    sides = [cut.start[:, :1], cut.goal[:, :1], cut.reached[:, :1], cut.boxes[:, :2]]
    fractions = [cut.start[:, 1:], cut.goal[:, 1:], cut.reached[:, 1:], cut.boxes[:, 2:]]
    return (
        all(np.isfinite(table).all() for table in tables)
        and isfinite(cut.friction)
        and cut.friction > 0
        and isfinite(cut.min_normal)
        and cut.min_normal >= 0
        and (cut.max_force is None or (isfinite(cut.max_force) and cut.max_force > 0))
        and np.shape(turned) == np.shape(cut.force) == (2,)
        and bool(np.isin(forbidden, np.arange(count)).all())
        and len(cut.start) == len(cut.goal) == 3
        and len(cut.boxes) == len(cut.twists)
        and all(((s >= 0) & (s < count) & (s == np.floor(s))).all() for s in sides)
        and all(((f >= 0) & (f <= 1)).all() for f in fractions)
    )


def _turned(cut: OutlineCut) -> Array:
    return cut.force if cut.turned is None else cut.turned


class _Cut:
    """A cut in rationals."""

    def __init__(self, cut: OutlineCut) -> None:
        self.points = [exact(p) for p in cut.vertices.tolist()]
        self.friction = Fraction(cut.friction)
        self.forces = [[*exact(force.tolist()), Fraction(0)] for force in (cut.force, _turned(cut))]
        most = None if cut.max_force is None else Fraction(cut.max_force)
        self.limits = Fraction(cut.min_normal), most
        self.forbidden = {int(side) for side in np.asarray(cut.forbidden).tolist()}
        self.start, self.goal = (
            [(int(i), Fraction(f)) for i, f in end.tolist()] for end in (cut.start, cut.goal)
        )
        self.arcs: dict[int, list[Span]] = {}
        for side, lo, hi in cut.reached.tolist():
            self.arcs.setdefault(int(side), []).append((Fraction(lo), Fraction(hi)))
        self.twists = [exact(y) for y in cut.twists.tolist()]
        self.sides = [(int(i), int(j)) for i, j in cut.boxes[:, :2].tolist()]
        self.boxes = [exact(box) for box in cut.boxes[:, 2:].tolist()]
        # Boxes by their sides, both ways round.
        self.tiles: dict[tuple[int, int], list[tuple[Span, Span]]] = {}
        for (i, j), (a, b, c, d) in zip(self.sides, self.boxes, strict=True):
            self.tiles.setdefault((i, j), []).append(((a, b), (c, d)))
            self.tiles.setdefault((j, i), []).append(((c, d), (a, b)))

    def is_counter_clockwise(self) -> bool:
        after = [*self.points[1:], self.points[0]]
        return sum((cross(p, q)[0] for p, q in zip(self.points, after, strict=True)), Fraction(0)) > 0

    def orientations(self) -> str:
        """Which ones the cut is of, in words."""
        one, other = self.forces
        aside, along = abs(cross(one, other)[2]), dot(one, other)
        size = max(aside, abs(along)) or Fraction(1)  # products of doubles need not be doubles
        turn = atan2(aside / size, along / size)
        return f"any orientation within a turn of {degrees(turn):.4g} deg" if turn else "this orientation"

    def turn(self) -> Iterator[str]:
        """Loads at the ends of a turn that is half a turn: between them it may be from either side."""
        one, other = self.forces
        # Without limits what works at both ends works between them, however far they are apart.
        limited = self.limits != (Fraction(0), None)
        if (cross(one, other)[2] == 0 and dot(one, other) <= 0) or (limited and not corners(one, other)):
            yield "the ends of the turn are half a turn apart"
        squares = [dot(force, force) for force in self.forces]
        if limited and max(squares) > min(squares) * (1 + 4 * RESOLUTION):  # cones alone have no size
            yield "the loads at the ends of the turn are of different sizes"

    def twists_at_work(self) -> Iterator[str]:
        """Boxes that their twists do not exclude."""
        around = corners(*self.forces) or self.forces
        for k, ((i, j), (a, b, c, d), y) in enumerate(
            zip(self.sides, self.boxes, self.twists, strict=True), 1
        ):
            least = [
                min(self.least_work(y, (side, f)) for f in ends) for side, ends in ((i, (a, b)), (j, (c, d)))
            ]
            work = min(dot(y, force) for force in around)
            if min(least) == -inf:
                yield f"box {k}: some force of a finger in it opposes its twist"
            elif sum(least) + work <= 0:
                words = ", beyond what forces within the limits take up" if any(least) else ""
                yield f"box {k}: the load does no work along its twist{words}"

    def least_work(self, y: list[Fraction], place: Place) -> Fraction | float:
        """Of the forces of a finger there, along a twist."""
        side, f = place
        p, q = self.points[side], self.points[(side + 1) % len(self.points)]
        t = [q[0] - p[0], q[1] - p[1]]
        at = [p[0] + f * t[0], p[1] + f * t[1]]
        way = [y[0] - y[2] * at[1], y[1] + y[2] * at[0]]
        return least_work(dot(way, [-t[1], t[0]]), dot(way, t), dot(t, t), self.friction, *self.limits)

    def ends(self) -> Iterator[str]:
        """Pairs of the start or the goal that may hold on the wrong side."""
        if sorted(self.start) == sorted(self.goal):
            yield "the start and the goal are the same places"
        for p, q in combinations(self.start, 2):
            if not (self.reaches(p) and self.reaches(q)) and not self.excludes(p, q):
                yield f"places of the start on sides {p[0]} and {q[0]} may hold and are not both on its side"
        for p, q in combinations(self.goal, 2):
            if (self.reaches(p) or self.reaches(q)) and not self.excludes(p, q):
                yield f"places of the goal on sides {p[0]} and {q[0]} may hold and are on the start's side"

    def reaches(self, place: Place) -> bool:
        return any(lo <= place[1] <= hi for lo, hi in self.arcs.get(place[0], []))

    def excludes(self, p: Place, q: Place) -> bool:
        tiles = self.tiles.get((p[0], q[0]), [])
        return any(a <= p[1] <= b and c <= q[1] <= d for (a, b), (c, d) in tiles)

    def gaps(self) -> Iterator[str]:
        """Pairs of places across the cut that no box covers, strip by strip of the first place."""
        rest = {j: self.rest(j) for j in range(len(self.points))}
        for i, arcs in self.arcs.items():
            for j, (lo, hi) in ((j, span) for j, spans in rest.items() for span in spans):
                tiles = self.tiles.get((i, j), [])
                if not all(_covered(arc, (lo, hi), tiles) for arc in arcs):
                    yield f"boxes do not cover all pairs across the cut on sides {i} and {j}"

    def rest(self, side: int) -> list[Span]:
        """What the reached arcs leave of a side, ends included."""
        if side in self.forbidden:
            return []
        rest, at = [], Fraction(0)
        for lo, hi in sorted(self.arcs.get(side, [])):
            if lo > at:
                rest.append((at, lo))
            at = max(at, hi)
        if at < 1:
            rest.append((at, Fraction(1)))
        return rest


def _covered(one: Span, other: Span, tiles: list[tuple[Span, Span]]) -> bool:
    """Whether boxes cover the rectangle of two spans: every strip between their ends in a chain.

    The other span has a length.
    """
    near = [(x, y) for x, y in tiles if x[0] <= one[1] and x[1] >= one[0]]
    cuts = sorted({*one, *(end for x, _ in near for end in x if one[0] < end < one[1])})
    strips = list(pairwise(cuts)) if len(cuts) > 1 else [(one[0], one[1])]
    for lo, hi in strips:
        at = other[0]
        for low, high in sorted(y for x, y in near if x[0] <= lo and x[1] >= hi):
            if low <= at:
                at = max(at, high)
        if at < other[1]:
            return False
    return True

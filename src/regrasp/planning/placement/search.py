"""Running the compiled branch and bound, and reading what it found."""

from collections.abc import Callable
from copy import copy
from itertools import combinations
from math import hypot, inf
from typing import Any

import numpy as np

from regrasp.mechanics.checks import Array, read_only
from regrasp.mechanics.reserve import RESERVE, kept_friction
from regrasp.planning.placement.boxes import Boxes
from regrasp.planning.placement.laws import Law
from regrasp.planning.placement.parts import Queue, search_in_parts
from regrasp.planning.placement.proofs.box_rows import rows_of
from regrasp.planning.placement.proofs.placement_proof import PlacementProof
from regrasp.planning.placement.sides import RingSides, Sides

MOST_BOXES = 200_000
"""Boxes of a search unless told otherwise: 500 to 800 bytes each with their proof, 1,600 by pairs."""
_AT_A_TIME, _WORK = 256, 5000  # boxes, of so many sides times loads, lest an interrupt waits
_TRIED = 4096
_LATE = 4096  # boxes without any placement found, after which points are tried
_POINTS = {2: 60, 3: 24, 4: 14}  # of so many fingers: about 2,000 placements
_NARROWER, _NARROWEST = 0.1, 1e-8  # where nothing was found, of arcs as fractions of the size
_PRECISE = 1e-7
_SAFE = 1e-9  # of a bound, given up to rounding

Progress = Callable[[float, float], object]
Limits = tuple[float, float]
ANY_FORCE = (inf, 0.0)


class Search(Boxes):
    """A search for the best places of fingers on sides: boxes, the placements tried, and how it ended.

    apart: least distance of fingers [m]. narrow: arcs shorter than this fraction of the size are not split.
    limits: largest force and least normal force of every finger [N].
    """

    turned = False  # (``circles``)

    def __init__(
        self, sides: Sides, fingers: int, friction: float, loads: Array, law: Law, apart: float,
        narrow: float, limits: Limits = ANY_FORCE,
    ) -> None:  # fmt: skip
        super().__init__(sides, fingers)
        self.friction, self.law, self.apart = friction, law, apart
        self.unit = max(float(np.abs(loads / [1, 1, sides.size]).max()), limits[1]) or 1.0
        self.loads = loads[:0]
        self.under(loads)
        self._table = np.ascontiguousarray(sides.table())
        self._found, self._tried = np.full(1 + 2 * fingers, inf), np.zeros((_TRIED, 1 + 2 * fingers))
        self.closed = self.interrupted = self._only = False
        self.narrow, self.limits, self._least = narrow, limits, apart / sides.size
        self.limit, self.margin = 0.0, 0.0  # of forces that keep a distance from the edges of cones [N]
        self._kept: list[tuple[float, np.ndarray, Array]] = []
        self.duals: list[Array] = []

    def under(self, loads: Array) -> None:
        """From now on, of these loads (L, 3) [N, N m]."""
        from regrasp.closed_form.compiled.places.placement_search import spare

        if len(loads) != len(self.loads):
            self._spare = spare(self.fingers, len(loads))
        self.loads = loads
        self._wanted = np.ascontiguousarray(-loads / [1, 1, self.sides.size] / self.unit)

    def run(self, tolerance: float, most: int, progress: Progress | None) -> None:
        """Search until no placement can be better by the fraction ``tolerance``, or ``most`` boxes are used.

        An interrupt from the keyboard ends the search, too, and leaves what it has found, if anything.
        """
        try:
            going, tried = True, False
            while going:
                going = self.goes_on(inf, tolerance, most) and self.count < most
                late = self.count >= _LATE or not going
                if late and self.best == inf and not self.closed and not tried:
                    tried = True
                    for placed in self.on_points()[:1]:
                        self.note(*placed)
                if self.best == inf and self.closed and self.count < most:
                    going = self._narrowed()
                if progress is not None:
                    progress(self.bound, self.best)
        except KeyboardInterrupt:
            self.interrupted = True

    def _narrowed(self) -> bool:
        """Whether boxes too narrow to be split are left, which are from now on, for nothing was found."""
        left = self.left
        if not len(left) or self.narrow < _NARROWEST:
            return False
        self.narrow *= _NARROWER
        self._heap[: len(left)], self._state[1], self.closed = left, len(left), False
        return True

    def on_points(self) -> list[tuple[float, np.ndarray, Array]]:
        """Placements on some points spread evenly, the best first, as ``placements``."""
        on, u = self.sides.spread(_POINTS[self.fingers])
        each = [list(few) for few in combinations(range(len(u)), self.fingers)]
        found = [(self.norm_at(on[i], u[i]), on[i], u[i]) for i in each if self.are_apart(on[i], u[i])]
        return sorted((placed for placed in found if placed[0] < inf), key=lambda placed: placed[0])

    def goes_on(self, fixed: float, tolerance: float, most: int, *, only: bool = False) -> bool:
        """Some more boxes. False where none is left, or no room for more of them.

        fixed: a level of the norm [N], at which the search is interrupted when a placement reaches it; or
        infinite, to follow the least value times 1 - tolerance. only: to note placements tried
        (``tried_since``), and take none for found.
        """
        from regrasp.closed_form.compiled.places.placement_search import CLOSED, FULL, search, spare

        law = self._law(self.friction, kept_friction(self.friction, 2 * RESERVE), self.law)
        self._only = only

        def part(queue: Queue, budget: int) -> int:
            return int(search(
                self._table, self._wanted, law, fixed / self.unit, tolerance, self._least, self.narrow,
                queue.boxes, queue.heap, queue.state, queue.found, queue.tried, budget,
                spare(self.fingers, len(self._wanted)),
            ))  # fmt: skip

        each = max(_AT_A_TIME * _WORK // max(_WORK, len(self._wanted) * len(self._table)), 1)
        found = np.zeros_like(self._found) if only else self._found
        queue = Queue(self._boxes, self._heap, self._state, found, self._tried)
        if not only and queue.is_for_parts:
            while not queue.has_room and self._grow(most):
                queue.boxes, queue.heap = self._boxes, self._heap
            if queue.has_room:
                ended = search_in_parts(queue, part, each)
                if any(end != CLOSED for end in ended):
                    return True
        ended_by = part(queue, each)
        self.closed = ended_by == CLOSED
        return not self.closed and (ended_by != FULL or self._grow(most))

    @property
    def left(self) -> np.ndarray:
        """Numbers of boxes not excluded: not looked at, or too small to be split; the least bound first."""
        left = np.flatnonzero(self._boxes[5][: self.count] == 0)
        return left[np.argsort(self._boxes[2][left], kind="stable")]

    def excluded(self, boxes: np.ndarray, fixed: float) -> int:
        """How many of some boxes are excluded at a level of the norm [N] now, before one that is not."""
        from regrasp.closed_form.compiled.places.placement_search import search

        done, some = 0, 1
        bounds, kinds = self._boxes[2], self._boxes[5]
        while done < len(boxes):
            heap = boxes[done : done + some].copy()
            bounds[heap], kinds[heap] = -1.0, 0  # to be bounded anew, which is all that is done with each
            state, none = np.array([2, len(heap), 0]), np.full(1 + 2 * self.fingers, inf)
            search(
                *self.terms(fixed), 0.0, 0.0, 0.0, self._boxes, heap, state, none, self._tried[:1], len(heap),
                self._spare,
            )  # fmt: skip
            if state[1]:
                return done + int(kinds[boxes[done : done + some]].argmin())
            done, some = done + len(heap), min(2 * some, _AT_A_TIME)
        return done

    def reopen(self) -> None:
        """Look again at what was excluded: another level is sought now, at which forces may be less."""
        again = np.flatnonzero(self._boxes[5][: self.count] == 1)
        self._boxes[5][again], self._boxes[2][again] = 0, -1.0
        self._heap[: len(again)], self._state[1], self.closed = again, len(again), False
        self._found[:] = inf

    def terms(self, fixed: float) -> tuple[Any, ...]:
        """Sides, loads, law and a level [N] as compiled loops take them."""
        return self._table, self._wanted, self._law(self.friction, self.friction, self.law), fixed / self.unit

    def are_apart(self, places: np.ndarray, u: Array) -> bool:
        """Whether fingers are as far apart as they must be."""
        points = self.sides.points(places, u).tolist()
        return all(hypot(p[0] - q[0], p[1] - q[1]) >= self.apart for p, q in combinations(points, 2))

    def forget(self, level: float, places: np.ndarray, u: Array) -> None:
        """Look for a first placement again: one on these sides reaches a level, a better one is sought."""
        self._kept.append((-level, places, u))
        self._found[:], self.closed = inf, False

    def accept(self, norm: float, places: np.ndarray, u: Array) -> None:
        """Take a placement for found, of this norm [N]."""
        self._kept.append((norm, places, u))
        self.note(norm, places, u)

    def note(self, norm: float, places: np.ndarray, u: Array) -> None:
        """The best placement found, beside those tried, of this norm [N]."""
        self._found[0], self._found[1::2], self._found[2::2] = norm / self.unit, places, u

    def take(self, placements: list[tuple[float, np.ndarray, Array]]) -> None:
        """Take these for the placements found, whatever was."""
        self._kept = placements

    def anew(self, friction: float | None = None) -> "Search":
        """A search for the same from the beginning, perhaps with other ``friction``."""
        mu = self.friction if friction is None else friction
        return Search(
            self.sides, self.fingers, mu, self.loads, self.law, self.apart, self.narrow, self.limits
        )

    def norm_at(self, places: np.ndarray, u: Array, law: Law | None = None, most: float = inf) -> float:
        """The norm of forces of a placement for the worst load [N]; of another law without any limits.

        most: beyond this it need not be known.
        """
        from regrasp.closed_form.compiled.places.placement_search import value_of

        friction = kept_friction(self.friction, 2 * RESERVE)
        codes = self._law(friction, friction, law or self.law)
        at = np.repeat(places[:, None], 2, axis=1), np.repeat(u[:, None], 2, axis=1)
        found, _ = value_of(self._table, self._wanted, codes, most / self.unit, *at, 0, self._spare)
        return float(found) * self.unit

    def is_within(self, places: np.ndarray, u: Array, most: float) -> bool:
        """Whether the norm of forces of a placement is at most this [N]."""
        return self.norm_at(places, u, most=most * (1 + _PRECISE)) <= most

    def holds(self, places: np.ndarray, u: Array, most: float) -> bool:
        """The same, with fingers as far apart as they must be."""
        return self.is_within(places, u, most) and self.are_apart(places, u)

    def beside(self) -> "Search":
        """This search for a thread of its own, which looks at boxes and changes none but those."""
        from regrasp.closed_form.compiled.places.placement_search import spare

        other = copy(self)
        other._boxes = (*self._boxes[:-1], np.zeros_like(self._boxes[-1]))
        other._spare = spare(self.fingers, len(self._wanted))
        return other

    def _law(self, mu: float, usable: float, law: Law) -> tuple[float, ...]:
        """As the compiled search takes it; forces of another law than that of the search have no limits."""
        size, norm = law.codes()
        limits = self.limits if law is self.law else ANY_FORCE
        limit, least = (self.limit, self.margin) if law.size == "margin" else limits
        return (mu, usable, size, norm, _PRECISE, limit / self.unit, least / self.unit)

    @property
    def best(self) -> float:
        """The least norm found [N]; infinite before one is."""
        return float(self._found[0]) * self.unit

    @property
    def bound(self) -> float:
        """No placement has a smaller norm [N]."""
        bounds, kinds = self._boxes[2][: self.count], self._boxes[5][: self.count]
        leaves = np.flatnonzero((kinds == 0) | (kinds == 1))
        return float(self._proven(bounds[leaves], leaves).min(initial=inf)) * self.unit * (1 - _SAFE)

    def _proven(self, bounds: Array, _: np.ndarray) -> Array:
        return bounds

    @property
    def largest(self) -> float:
        """What a box proves that holds a load for no forces, at least [N]."""
        from regrasp.closed_form.compiled.places.wrench_gauge import FAR

        sizes = np.abs(self._wanted).sum(axis=1) + self.limits[1] / self.unit
        return FAR * float(sizes[sizes > 0].min(initial=inf)) * self.unit * (1 - _SAFE)

    @property
    def found(self) -> tuple[np.ndarray, Array]:
        """Sides and u of the best placement."""
        return self._found[1::2].astype(int), self._found[2::2].copy()

    @property
    def tries(self) -> int:
        """Placements tried."""
        return int(self._state[2])

    def tried_since(self, before: int) -> list[tuple[float, np.ndarray, Array]]:
        """Those tried after so many others, as ``placements``; at most some thousands."""
        rows = self._tried[np.arange(max(before, self.tries - _TRIED), self.tries) % _TRIED]
        return self._read(rows)

    def placements(self) -> list[tuple[float, np.ndarray, Array]]:
        """Placements tried, the best first: their norm [N], the sides and the u of their fingers.

        Where a level was sought, those that raised it, with its negative in the place of the norm.
        """
        if self._kept or self._only:
            return sorted(self._kept, key=lambda kept: kept[0])
        return self._read(np.vstack([self._found, self._tried[: min(int(self._state[2]), _TRIED)]]))

    def _read(self, rows: Array) -> list[tuple[float, np.ndarray, Array]]:
        rows = rows[np.isfinite(rows[:, 0])]
        rows = rows[np.argsort(rows[:, 0], kind="stable")]
        norms = rows[:, 0] * self.unit
        return list(zip(norms.tolist(), rows[:, 1::2].astype(int), rows[:, 2::2], strict=True))

    def proof(self, bound: float, edges: Array, centre: Array) -> PlacementProof:
        """That no norm is below ``bound`` [N].

        edges: (k, 2) vertices or (k, 4, 2) control points, and ``centre`` of mass, as they were given [m].
        """
        boxes = [values[: self.count] for values in self._boxes[:-1]]
        if self.limits != ANY_FORCE and self.law.norm == "squares":  # there twists are forces
            boxes[3] = boxes[3] * self.unit
        excluded = self.tied, self.moving, self.by_side
        given = rows_of(boxes, self.loads, self.sides.size, *excluded)
        given["sides"] = np.column_stack([self.sides.edges, self.sides.ends])
        smooth = edges.ndim == 3
        return PlacementProof(
            read_only(edges[:, 0].copy()) if smooth else edges, centre, fingers=self.fingers, bound=bound,
            friction=self.friction, margin=self.margin, norm=self.law.norm, min_distance=self.apart,
            size="force" if self.law.size == "margin" and not self.margin else self.law.size,
            control=edges if smooth else None, turned=self.turned,
            rings=read_only(self.sides.rings.copy()) if isinstance(self.sides, RingSides) else None,
            tied=read_only(np.array(self.duals)) if self.tied else None,
            max_force=None if self.limits[0] == inf else self.limits[0], min_normal=self.limits[1],
            **{name: read_only(values) for name, values in given.items()},
        )  # fmt: skip

"""Constraints on chosen grasps that no box knows of: they are asked of placements, bounds do without them.

A constraint leaves out placements, so what no placement at all goes below, no placement that keeps it does.
"""

from dataclasses import dataclass
from itertools import combinations
from math import inf

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, Flags, function
from regrasp.planning.holds.pairs import Filter
from regrasp.planning.placement.constrained.sampled import LARGEST, drawn, sampled
from regrasp.planning.placement.laws import LEVELS
from regrasp.planning.placement.search import Progress, Search
from regrasp.planning.placement.sliding import Placed, Value, slid

CONSTRAINED_BOXES = 20_000
"""Boxes of a search with constraints that bounds know nothing of, unless told otherwise."""
_EVERYTHING = 1e200  # a level that leaves no box out
_ENOUGH = 1e3  # times the loads, forces of those that stay without any limit
_SURELY = 1 - 1e-6  # of a limit, which rounding does not take beyond it
_JUDGED = 3  # placements of a batch of boxes that are asked for, the best first
_GAIN = 1e-6  # of a value, the least that counts
_SEEDS = 200  # placements of points to begin with
_FIRST, _LAST = 0.125, 1e-4  # steps of sliding, as parts of an edge
_STAGES = ((14, _FIRST, 0.1), (6, 0.06, 0.02), (2, 0.015, _LAST))  # how many slide, from which step to which


@dataclass(frozen=True)
class Constraints:
    """What placements and their forces must keep besides; see ``regrasp.choose_grasp``."""

    max_force: float | None
    min_normal: float
    keep: Filter | None
    removable: bool

    @property
    def unbounded(self) -> bool:
        """Whether there are any that bounds know nothing of."""
        return bool(self.keep or self.removable)

    def allows(self, search: Search, places: np.ndarray, u: Array) -> bool:
        """Whether places may be taken."""
        return self._reached(search, places, u) and (
            not self.removable or self._one_can_leave(search, places, u)
        )

    def _reached(self, search: Search, places: np.ndarray, u: Array) -> bool:
        order = np.argsort(u, kind="stable")
        points = search.sides.points(places[order], u[order])
        first, second = np.array(list(combinations(range(len(u)), 2))).T
        return bool(self.may(points[first], points[second]).all())

    def may(self, first: Array, second: Array) -> Flags:
        """(m,) which fingers at a first and a second point (m, 2) [m], in their order, may hold together."""
        if self.keep is None:
            return np.ones(len(first), np.bool_)
        given = self.keep(first, second, 0.0)
        try:
            kept = np.asarray(given)
        except (TypeError, ValueError):
            kept = np.asarray(None)
        if kept.shape != (len(first),) or kept.dtype.kind not in "biu":
            raise InvalidInput(
                f"keep must return which of {len(first)} pairs are allowed, {len(first)} booleans; it "
                f"returned {shown(given)}"
            )
        return kept.astype(np.bool_)

    def _one_can_leave(self, search: Search, places: np.ndarray, u: Array) -> bool:
        limit = self.leaving(search)
        return any(
            search.norm_at(np.delete(places, i), np.delete(u, i), LARGEST) <= limit for i in range(len(u))
        )

    def leaving(self, search: Search) -> float:
        """Limit on the forces of those that hold when one has left [N]."""
        return _SURELY * (_ENOUGH * search.unit if self.max_force is None else self.max_force)


def check_constraints(
    constraints: Constraints, goal: str, fingers: int, *, of_levels: tuple[str, ...] = ()
) -> None:
    """``InvalidInput`` for constraints that no force meets, or that an objective does not go with.

    of_levels: those that levels go with.
    """
    if constraints.keep is not None:
        function(constraints.keep, "keep", "a function of first points, second points and an angle", 3)
    if not isinstance(constraints.removable, bool):
        raise InvalidInput(f"removable must be True or False, got {shown(constraints.removable)}")
    if constraints.max_force is not None and constraints.min_normal > constraints.max_force:
        raise InvalidInput(
            f"min_normal {constraints.min_normal:g} is above max_force {constraints.max_force:g}, which no "
            "force meets"
        )
    norms = [name for name in ("min_normal", "keep", "removable") if name not in of_levels]
    more = [name for name in norms if getattr(constraints, name)]
    if goal in LEVELS and more:
        raise InvalidInput(
            f"{', '.join(more)}: for objectives sum_normal, peak_normal, peak and effort; got {goal!r}"
        )
    if constraints.removable and fingers < 3:
        raise InvalidInput("removable asks for three fingers or more: one finger alone is no grasp")


def run_constrained(
    search: Search, kept: Constraints, tolerance: float, most: int, progress: Progress | None
) -> None:
    """Search, taking for found only what keeps the constraints; ``search`` is left with these placements."""

    def value(places: np.ndarray, u: Array, level: float) -> float:
        """The norm [N]; infinite where it is not below ``level`` or nothing is kept."""
        norm = search.norm_at(places, u) if search.are_apart(places, u) else inf
        return norm if norm < level and kept.allows(search, places, u) else inf

    try:
        for placed in _begun(search, kept, value):
            search.accept(*placed)
        going = not search.interrupted
        while going:
            before = search.tries
            level = min(search.best * (1 - tolerance), _EVERYTHING)
            going = search.goes_on(level, 0.0, most, only=True)
            for norm, places, u in search.tried_since(before)[:_JUDGED]:
                if norm >= level:
                    break
                if kept.allows(search, places, u):
                    search.accept(norm, places, u)
                    break
            if progress is not None:
                progress(search.bound, search.best)
        if search.best < inf and not search.interrupted:
            search.accept(*_slid(search, (search.best, *search.found), value, _FIRST, _LAST))
    except KeyboardInterrupt:
        search.interrupted = True


def _begun(search: Search, kept: Constraints, value: Value) -> list[Placed]:
    """Placements that keep the constraints, the best last: of points on the sides, or slid from there.

    An interrupt leaves those found before, and the search knows (``interrupted``).
    """
    seeds = sampled(search, kept.may, kept.leaving(search) if kept.removable else None)[:_SEEDS]
    found = sorted(seeds, key=lambda placed: -placed[0])
    best = {tuple(places): (norm, places, u) for norm, places, u in found}  # of the same edges
    sliding = list(best.values())
    try:
        for many, step, last in _STAGES if not search.interrupted else ():
            sliding = [_slid(search, placed, value, step, last) for placed in sliding[-many:]]
            sliding.sort(key=lambda placed: -placed[0])
            found += sliding
    except KeyboardInterrupt:
        search.interrupted = True
    return sorted(found, key=lambda placed: -placed[0])


def _slid(search: Search, placed: Placed, value: Value, step: float, last: float) -> Placed:
    """The best placement that fingers find by sliding, one alone or all at once."""

    def less(places: np.ndarray, u: Array, than: float) -> float:
        return value(places, u, than * (1 - _GAIN))

    return slid(search, placed, less, step, last, drawn(search.fingers))

"""Constraints on chosen grasps that no box knows of: they are asked of placements, bounds do without them.

A constraint leaves out placements, so what no placement at all goes below, no placement that keeps it does.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations
from math import inf, sqrt

import numpy as np

from regrasp.errors import Infeasible, InvalidInput, RegraspError, shown
from regrasp.mechanics.checks import Array, Flags
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.holds.pairs import Filter
from regrasp.planning.placement.constrained.sampled import LARGEST, drawn, sampled
from regrasp.planning.placement.results import Asked, grasp_at, proof_of
from regrasp.planning.placement.search import Progress, Search
from regrasp.planning.placement.sliding import Placed, Value, slid
from regrasp.planning.states.choosing import choose_state

CONSTRAINED_BOXES = 20_000
"""Boxes of a search with constraints unless told otherwise."""
_EVERYTHING = 1e200  # a level that leaves no box out
_ENOUGH = 1e3  # times the loads, forces of those that stay without any limit
_ABOUT = 1 + 1e-6  # rounding
_JUDGED = 3  # placements of a batch of boxes whose forces are computed, the best first
_LEAST, _ROUGH = 20, 0.01  # placements of the least largest forces to begin with, and their gap [-]
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
    def any(self) -> bool:
        """Whether there are any."""
        return bool(self.max_force is not None or self.min_normal or self.keep or self.removable)

    def allows(self, search: Search, places: np.ndarray, u: Array) -> bool:
        """Whether places may be taken, if their forces keep ``min_normal``."""
        if self.max_force is not None and search.norm_at(places, u, LARGEST) > _ABOUT * self.max_force:
            return False  # as its forces would say, later
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
        for i in range(len(u)):
            on, at = np.delete(places, i), np.delete(u, i)
            if search.norm_at(on, at, LARGEST) <= limit:
                grasp = grasp_at(search.sides, on, at, search.friction)
                if _worst(grasp, search.loads, "peak", inf, {"max_force": limit}) < inf:
                    return True
        return False

    def leaving(self, search: Search) -> float:
        """Limit on the forces of those that hold when one has left [N]."""
        return _ENOUGH * search.unit if self.max_force is None else self.max_force


def run_constrained(
    search: Search, asked: Asked, kept: Constraints, tolerance: float, most: int, progress: Progress | None
) -> None:
    """Search, taking for found only what keeps the constraints; ``search`` is left with these placements."""

    def value(places: np.ndarray, u: Array, level: float) -> float:
        """The norm of the best forces [N]; infinite where it is not below ``level`` or nothing is kept."""
        if not search.are_apart(places, u) or search.norm_at(places, u) >= level:
            return inf
        return _norm(search, asked, kept, places, u, level) if kept.allows(search, places, u) else inf

    try:
        for placed in _begun(search, asked, kept, most, value):
            search.accept(*placed)
        going = True
        while going:
            before = search.tries
            level = min(search.best * (1 - tolerance), _EVERYTHING)
            going = search.goes_on(level, 0.0, most, only=True)
            judged = 0
            for norm, places, u in search.tried_since(before):
                if norm >= level or judged == _JUDGED:
                    break
                if not kept.allows(search, places, u):
                    continue
                judged += 1
                found = _norm(search, asked, kept, places, u, search.best)
                if found < search.best:
                    search.accept(found, places, u)
            if progress is not None:
                progress(search.bound, search.best)
        if search.best < inf:
            search.accept(*_slid(search, (search.best, *search.found), value, _FIRST, _LAST))
    except KeyboardInterrupt:
        if search.best == inf:
            raise


def _begun(search: Search, asked: Asked, kept: Constraints, most: int, value: Value) -> list[Placed]:
    """Placements that keep the constraints, the best last: of points on the sides, or slid from there.

    ``Infeasible`` where no placement is within the limit.
    """
    limit, seeds = inf if kept.max_force is None else kept.max_force, []
    if limit < inf:
        least = Search(
            search.sides, search.fingers, search.friction, search.loads, LARGEST, search.apart, search.narrow
        )
        least.run(_ROUGH, most, None)
        if least.bound > limit:
            raise Infeasible(
                f"no {search.fingers} fingers anywhere on this outline hold the loads, with friction "
                f"{asked.friction:g} and forces of at most {limit:g} N",
                proof_of(least, asked, min(least.bound, least.largest)),
            )
        seeds = least.placements()[:_LEAST]
    seeds += sampled(
        search, kept.may, limit, kept.min_normal, kept.leaving(search) if kept.removable else None
    )[:_SEEDS]
    found = sorted(
        ((value(places, u, inf), places, u) for _, places, u in seeds), key=lambda placed: -placed[0]
    )
    found = [placed for placed in found if placed[0] < inf]
    best = {tuple(places): (norm, places, u) for norm, places, u in found}  # of the same edges
    sliding = list(best.values())
    for many, step, last in _STAGES:
        sliding = [_slid(search, placed, value, step, last) for placed in sliding[-many:]]
        sliding.sort(key=lambda placed: -placed[0])
        found += sliding
    return sorted(found, key=lambda placed: -placed[0])


def _slid(search: Search, placed: Placed, value: Value, step: float, last: float) -> Placed:
    """The best placement that fingers find by sliding, one alone or all at once."""

    def less(places: np.ndarray, u: Array, than: float) -> float:
        return value(places, u, than * (1 - _GAIN))

    return slid(search, placed, less, step, last, drawn(search.fingers))


def _norm(
    search: Search, asked: Asked, kept: Constraints, places: np.ndarray, u: Array, level: float
) -> float:
    """The norm of the best forces for the worst load [N]; infinite where none below ``level`` keep limits."""
    order = np.argsort(u, kind="stable")
    grasp = grasp_at(search.sides, places[order], u[order], asked.friction)
    limits = {"max_force": kept.max_force, "min_normal": kept.min_normal or None}
    power = float(asked.law.power)
    worst: float = _worst(grasp, asked.loads, asked.objective, level**power, limits)
    return worst if power == 1.0 else sqrt(worst)


def _worst(
    grasp: Grasp | None, loads: Array, objective: str, level: float, limits: Mapping[str, float | None]
) -> float:
    """The value for the worst load; infinite where it is not below ``level``."""
    worst = 0.0 if grasp is not None else inf
    for load in loads if grasp is not None else ():
        try:
            with np.errstate(all="ignore"):
                value = choose_state(grasp, Wrench.from_vector(load), objective, **limits).value  # type: ignore[arg-type]
        except RegraspError:
            return inf
        worst = max(worst, value)
        if worst >= level:
            return inf
    return worst

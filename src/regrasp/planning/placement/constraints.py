"""Constraints on chosen grasps that no box knows of: they are asked of placements, bounds do without them.

A constraint leaves out placements, so what no placement at all goes below, no placement that keeps it does.
"""

from dataclasses import dataclass
from itertools import combinations
from math import inf

import numpy as np

from regrasp.errors import Infeasible, InvalidInput, RegraspError
from regrasp.mechanics.checks import Array
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.holds.pairs import Filter
from regrasp.planning.placement.laws import Law
from regrasp.planning.placement.results import Asked, grasp_at, proof_of
from regrasp.planning.placement.search import Progress, Search
from regrasp.planning.states.choosing import choose_state

CONSTRAINED_BOXES = 20_000
"""Boxes of a search with constraints unless told otherwise."""
_EVERYTHING = 1e200  # a level that leaves no box out
_JUDGED = 6  # placements of a batch of boxes whose forces are computed, the best first
_SEEDS, _ROUGH = 20, 0.01  # placements of small largest forces to begin with, and how small: [-]
LARGEST = Law("force", "largest")


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
        """Whether places may be taken, whatever their forces."""
        return self._reached(search, places, u) and (
            not self.removable or self._one_can_leave(search, places, u)
        )

    def _reached(self, search: Search, places: np.ndarray, u: Array) -> bool:
        if self.keep is None:
            return True
        points = search.sides.points(places, u)
        first, second = np.array(list(combinations(range(len(u)), 2))).T
        kept = np.asarray(self.keep(points[first], points[second], 0.0))
        if kept.shape != first.shape:
            raise InvalidInput(
                f"keep must return which of {first.size} pairs are allowed, shape {first.shape}; it returned "
                f"shape {kept.shape}"
            )
        return bool(kept.astype(np.bool_).all())

    def _one_can_leave(self, search: Search, places: np.ndarray, u: Array) -> bool:
        limit = inf if self.max_force is None else self.max_force
        stay = (np.delete(np.arange(len(u)), i) for i in range(len(u)))
        return any(
            norm < inf and norm <= limit for norm in (search.norm_at(places[i], u[i], LARGEST) for i in stay)
        )


def run_constrained(
    search: Search, asked: Asked, kept: Constraints, tolerance: float, most: int, progress: Progress | None
) -> None:
    """Search, taking for found only what keeps the constraints; ``search`` is left with these placements."""
    best = inf
    try:
        best = _begun(search, asked, kept, most)
        going = True
        while going:
            before = search.tries
            level = min(best * (1 - tolerance), _EVERYTHING)
            going = search.goes_on(level, 0.0, most, only=True)
            judged = 0
            for norm, places, u in search.tried_since(before):
                if norm >= level or judged == _JUDGED:
                    break
                if not kept.allows(search, places, u):
                    continue
                judged += 1
                value = _norm(search, asked, kept, places, u)
                if value < best:
                    best = value
                    search.accept(value, places, u)
            if progress is not None:
                progress(search.bound, best)
    except KeyboardInterrupt:
        if best == inf:
            raise


def _begun(search: Search, asked: Asked, kept: Constraints, most: int) -> float:
    """The least norm among placements of small forces, and of those that can be squeezed [N].

    Fingers that hold a load and its opposite make no wrench with both forces together: they can push harder.
    ``Infeasible`` where no placement is within the limit.
    """
    seeds, best = [], inf
    if kept.max_force is not None:
        least = _search_like(search, search.loads, most)
        if least.bound > kept.max_force:
            raise Infeasible(
                f"no {search.fingers} fingers anywhere on this outline hold the loads, with friction "
                f"{asked.friction:g} and forces of at most {kept.max_force:g} N",
                proof_of(least, asked, min(least.bound, least.largest)),
            )
        seeds += least.placements()[:_SEEDS]
    if kept.min_normal:
        seeds += _search_like(search, np.vstack([search.loads, -search.loads]), most).placements()[:_SEEDS]
    for _, places, u in seeds:
        if kept.allows(search, places, u):
            value = _norm(search, asked, kept, places, u)
            if value < best:
                best = value
                search.accept(value, places, u)
    return best


def _search_like(search: Search, loads: Array, most: int) -> Search:
    found = Search(search.sides, search.fingers, search.friction, loads, LARGEST, search.apart, search.narrow)
    found.run(_ROUGH, most, None)
    return found


def _norm(search: Search, asked: Asked, kept: Constraints, places: np.ndarray, u: Array) -> float:
    """The norm of the best forces for the worst load [N], infinite where none keep the limits."""
    order = np.argsort(u, kind="stable")
    grasp = grasp_at(search.sides, places[order], u[order], asked.friction)
    if grasp is None:
        return inf
    limits = {"max_force": kept.max_force, "min_normal": kept.min_normal or None}
    try:
        with np.errstate(all="ignore"):
            loads = map(Wrench.from_vector, asked.loads)
            worst = max(choose_state(grasp, load, asked.objective, **limits).value for load in loads)  # type: ignore[arg-type]
    except RegraspError:
        return inf
    return float(worst ** (1 / asked.law.power))

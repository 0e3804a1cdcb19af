"""The value of placements over the boundary: of one or two fingers, others staying where they are."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from math import comb, inf

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, array, number, read_only, whole
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.value import ArrayValue
from regrasp.mechanics.wrench import Wrench
from regrasp.outline.outline import Outline
from regrasp.planning.placement.asking import check_task, length_of, level_of
from regrasp.planning.placement.laws import LARGEST, LEVELS, law_of
from regrasp.planning.placement.levels.ball import BallLevel
from regrasp.planning.placement.levels.level import Level
from regrasp.planning.placement.loads import check_sizes, inner_and_outer
from regrasp.planning.placement.reachable import sides_of
from regrasp.planning.placement.search import Search
from regrasp.planning.states.objectives import Objective

MOST_PLACEMENTS = 2_000_000
_ROUND = 1e-3  # by which loads around a round set are farther out
_APART = 1e-6  # of the size


@dataclass(frozen=True, eq=False, repr=False)
class PlacementMap(ArrayValue):
    """The value of an objective where fingers are at places of an outline.

    Args:
        shape: the outline.
        objective: its word.
        fixed: (f,) arc lengths of the fingers that stay [m].
        places: (m,) arc lengths of the others [m].
        values: (m,) for one finger, (m, m) for two, the same both ways; NaN where the loads are not held.
        best: (m,) the best value with one of the fingers at a place; NaN for none.
        more: whether more is better.
    """

    shape: Outline
    objective: str
    fixed: Array
    places: Array
    values: Array
    best: Array
    more: bool

    @property
    def at(self) -> Array:
        """(1,) or (2,) arc lengths of the best of the placements [m]; empty if none holds."""
        if np.isnan(self.best).all():
            return np.zeros(0)
        sought = np.nanargmax(self.values) if self.more else np.nanargmin(self.values)
        return self.places[np.array(np.unravel_index(sought, self.values.shape))]

    @property
    def share(self) -> float:
        """The share of the placements, of fingers at different places, that hold the loads [-]."""
        m = len(self.places)
        of = m if self.values.ndim == 1 else m * (m - 1)
        return float((~np.isnan(self.values)).sum() / of)

    def __repr__(self) -> str:
        return (
            f"PlacementMap({self.objective} of {self.values.ndim} beside {len(self.fixed)}, "
            f"{len(self.places)} places, {self.share:.0%} hold)"
        )


def placement_map(
    shape: Outline,
    load: Wrench | LoadSet,
    *,
    friction: float,
    fixed: Sequence[float] = (),
    free: int = 2,
    objective: str | Objective = "sum_normal",
    max_force: float | None = None,
    disturbance: LoadSet | None = None,
    length: float | None = None,
    count: int = 120,
) -> PlacementMap:
    """The value of one or two fingers wherever on an outline they are, beside fingers that stay.

    What ``choose_grasp`` searches, at places evenly spread.

    Args:
        shape: a polygon or a smooth outline; fingers are on its outer boundary.
        load: external wrench on the object about its centre of mass, or a set of them; the value is that of
            the worst load [N, N m].
        friction: coefficient of all fingers [-].
        fixed: arc lengths of the fingers that stay, up to three, from 0 to the length of the outline [m].
        free: how many fingers move, 1 or 2.
        objective: as of ``choose_grasp``.
        max_force: limit on every force, as of ``choose_grasp`` [N].
        disturbance: hull of deviations for ``answered`` and ``wrench``.
        length: by which torques are divided, for ``wrench_ball`` [m].
        count: places, evenly spread; those near a corner are left out.

    Raises:
        InvalidInput: For arguments that are not what they must be.
    """
    check_task(shape, load, "an Outline (surface_map is for meshes)")
    mu, goal = number(friction, "friction", least=0), law_of(objective)
    stays = array(fixed, "fixed", (None,))
    check_sizes(mu, load)
    if ((stays < 0) | (stays > shape.length)).any():
        raise InvalidInput(
            f"fixed must be arc lengths of the outer boundary, 0 to {shape.length:.6g}; got {shown(fixed)}"
        )
    whole(free, "free", least=1, most=2)
    if not 2 <= len(stays) + free <= 4:
        raise InvalidInput(
            f"two to four fingers make a map: got {len(stays)} in fixed and {free} that move; give fixed"
        )
    whole(count, "count", least=4, most=10_000)
    if comb(count, free) > MOST_PLACEMENTS:
        raise InvalidInput(f"count {count} makes more than {MOST_PLACEMENTS} placements; give fewer")
    word, law = goal
    level = level_of(word, mu, load, max_force, disturbance, length_of(word, length, shape))
    if max_force is not None and word not in LEVELS:
        raise InvalidInput(f"max_force is for {', '.join(LEVELS)}; got objective {word!r}")
    _, loads = inner_and_outer(load, _ROUND)
    if isinstance(level, BallLevel):
        loads = level.loads(level.max_force)
    sides = sides_of(shape, 0.0)
    search = Search(sides, len(stays) + free, mu, loads, law, _APART * sides.size, 0.0)
    places = shape.sample(count)
    u = np.array([sides.u_at(float(s)) for s in places])
    kept = np.array([sides.u_at(float(s) % shape.length) for s in stays])
    values = np.full((len(places),) * free, np.nan)
    for at in combinations(range(len(places)), free):
        fingers = np.concatenate([kept, u[list(at)]])
        value = _value(search, level, law.power, sides.on(fingers), fingers)
        values[at] = value
        values[at[::-1]] = value
    more = word in LARGEST
    return PlacementMap(
        shape,
        word,
        read_only(stays),
        read_only(places),
        read_only(values),
        read_only(_best(values, more)),
        more,
    )


def _value(search: Search, level: Level | None, power: int, places: np.ndarray, u: Array) -> float:
    if not search.are_apart(places, u):
        return np.nan
    if level is None:
        norm = search.norm_at(places, u)
        return norm**power if norm < inf else np.nan
    return level.of(search, places, u)


def _best(values: Array, more: bool) -> Array:
    """(m,) over the other finger; NaN where none holds."""
    if values.ndim == 1:
        return values.copy()
    worst = -inf if more else inf
    filled = np.where(np.isnan(values), worst, values)
    best: Array = filled.max(axis=1) if more else filled.min(axis=1)
    return np.where(np.isfinite(best), best, np.nan)

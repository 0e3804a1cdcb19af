"""The value of placements over the boundary: of one or two fingers, others staying where they are."""

from collections.abc import Sequence
from itertools import combinations
from math import comb, inf

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, Flags, array, number, read_only, whole
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.wrench import Wrench
from regrasp.outline.outline import Outline
from regrasp.planning.holds.pairs import Filter
from regrasp.planning.placement.asking import asked_distance, asked_sides, check_task, length_of, level_of
from regrasp.planning.placement.constrained.constraints import Constraints, check_constraints
from regrasp.planning.placement.laws import LARGEST, law_of
from regrasp.planning.placement.levels.ball import BallLevel
from regrasp.planning.placement.levels.level import Level
from regrasp.planning.placement.loads import check_sizes, inner_and_outer
from regrasp.planning.placement.maps.placed_values import PlacementMap
from regrasp.planning.placement.maps.rings import Rings
from regrasp.planning.placement.search import ANY_FORCE, Search
from regrasp.planning.placement.sides import Sides
from regrasp.planning.states.objectives import Objective

MOST_PLACEMENTS = 2_000_000
_ROUND = 1e-3  # by which loads around a round set are farther out
_APART = 1e-6  # of the size
_ROUNDING = 1e-9  # of an edge


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
    min_normal: float = 0.0,
    keep: Filter | None = None,
    arcs: Sequence[Sequence[float]] | None = None,
    tip_radius: float = 0.0,
    in_holes: bool = False,
    min_distance: float | None = None,
    from_corners: float | None = None,
    count: int = 120,
) -> PlacementMap:
    """The value of one or two fingers wherever on an outline they are, beside fingers that stay.

    What ``choose_grasp`` searches, at places evenly spread. Where constraints let no fingers be, nothing is
    computed (``PlacementMap.allowed``).

    Args:
        shape: a polygon or a smooth outline; fingers are on its outer boundary unless ``in_holes``.
        load: external wrench on the object about its centre of mass, or a set of them; the value is that of
            the worst load [N, N m].
        friction: coefficient of all fingers [-].
        fixed: arc lengths of the fingers that stay, up to three, from 0 to the length of the outline [m]; at
            no corner, and where the constraints let fingers be.
        free: how many fingers move, 1 or 2.
        objective: as of ``choose_grasp``.
        max_force: limit on every force, as of ``choose_grasp`` [N].
        disturbance: hull of deviations for ``answered`` and ``wrench``.
        length: by which torques are divided, for ``wrench_ball`` [m].
        min_normal: with which every finger pushes at the least, under every load, for the four norms [N].
        keep: which two fingers may hold together, as of ``choose_grasp``, for every objective.
        arcs: the only stretches where fingers may be, as of ``choose_grasp`` [m].
        tip_radius: of round fingertips, as of ``choose_grasp`` [m].
        in_holes: whether fingers may be in the holes of a polygon, too, as of ``choose_grasp``; places are
            spread over all boundaries then.
        min_distance: least distance between two fingers [m]; a millionth of the object's size if not given.
        from_corners: least distance of a finger from a corner, along the boundary [m]; none if not given.
        count: places, evenly spread; those within a quarter of their distance from a corner are left out.

    Raises:
        InvalidInput: For arguments that are not what they must be.
    """
    check_task(shape, load, "an Outline (surface_map is for meshes)")
    mu, goal = number(friction, "friction", least=0), law_of(objective)
    stays = array(fixed, "fixed", (None,))
    check_sizes(mu, load)
    whole(free, "free", least=1, most=2)
    fingers = len(stays) + free
    if not 2 <= fingers <= 4:
        raise InvalidInput(
            f"two to four fingers make a map: got {len(stays)} in fixed and {free} that move; give fixed"
        )
    whole(count, "count", least=4, most=10_000)
    if comb(count, free) > MOST_PLACEMENTS:
        raise InvalidInput(f"count {count} makes more than {MOST_PLACEMENTS} placements; give fewer")
    word, law = goal
    limit = None if max_force is None else number(max_force, "max_force", above=0)
    constraints = Constraints(limit, number(min_normal, "min_normal", least=0), keep, removable=False)
    check_constraints(constraints, word, fingers, of_levels=("keep",))
    level = level_of(word, mu, load, max_force, disturbance, length_of(word, length, shape))
    apart = asked_distance(min_distance, shape.polygon())
    away = 0.0 if from_corners is None else number(from_corners, "from_corners", least=0)
    sides = asked_sides(shape, away, arcs, tip_radius, in_holes)
    _, loads = inner_and_outer(load, _ROUND)
    if isinstance(level, BallLevel):
        loads = level.loads(level.max_force)
    limits = ANY_FORCE if level else (inf if limit is None else limit, constraints.min_normal)
    distance = _APART * sides.size if apart is None else apart
    search = Search(sides, fingers, mu, loads, law, distance, 0.0, limits)
    rings = Rings(shape, in_holes)
    kept = _places_of(stays, rings, search, constraints)
    places = rings.sample(count)
    u = np.array([sides.u_at(float(s)) for s in places])
    allowed = _allowed(search, constraints, kept, u, free)
    values = np.full(allowed.shape, np.nan)
    for at in zip(*np.nonzero(np.triu(allowed) if free == 2 else allowed), strict=True):
        both = np.concatenate([kept, u[list(at)]])
        values[at] = values[at[::-1]] = _value(search, level, law.power, sides.on(both), both)
    more = word in LARGEST
    allowed.setflags(write=False)
    return PlacementMap(
        shape, word, read_only(stays), read_only(places), read_only(values), read_only(_best(values, more)),
        more, allowed, in_holes,
    )  # fmt: skip


def _places_of(stays: Array, rings: Rings, search: Search, constraints: Constraints) -> Array:
    """(f,) the u of fingers that stay, which are where fingers may be."""
    if ((stays < 0) | (stays > rings.length)).any():
        of = "boundaries" if len(rings.starts) > 2 else "outer boundary"
        raise InvalidInput(
            f"fixed must be arc lengths of the {of}, 0 to {rings.length:.6g}; got {shown(stays.tolist())}"
        )
    stays = stays % rings.length
    u = np.array([search.sides.u_at(float(s)) for s in stays])
    corners, on_sides = rings.at_corner(stays), _on_sides(search.sides, u)
    for s, cornered, on in zip(stays.tolist(), corners, on_sides, strict=True):
        if cornered:
            raise InvalidInput(
                f"fixed: arc length {s:.6g} is at a corner, where no normal is defined; take one beside it"
            )
        if not on:
            raise InvalidInput(
                f"fixed: from_corners, arcs or tip_radius let no finger be at arc length {s:.6g}"
            )
    for (s, a), (t, b) in combinations(zip(stays.tolist(), u, strict=True), 2):
        if not _together(search, constraints, np.array([a]), np.array([b]))[0]:
            raise InvalidInput(
                f"fixed: min_distance or keep let no two fingers be at arc lengths {s:.6g} and {t:.6g}"
            )
    return u


def _allowed(search: Search, constraints: Constraints, kept: Array, u: Array, free: int) -> Flags:
    """(m,) or (m, m) where the fingers that move may be."""
    allowed = _on_sides(search.sides, u)
    for stays in kept:
        at = np.flatnonzero(allowed)
        allowed[at] = _together(search, constraints, np.full(len(at), stays), u[at])
    if free == 1:
        return allowed
    at = np.flatnonzero(allowed)
    first, second = at[np.array(np.triu_indices(len(at), 1))]
    both = np.zeros((len(u), len(u)), np.bool_)
    both[first, second] = both[second, first] = _together(search, constraints, u[first], u[second])
    return both


def _on_sides(sides: Sides, u: Array) -> Flags:
    """(m,) whether places are on any side."""
    least, most = sides.ends[sides.on(u)].T
    result: Flags = (u >= least - _ROUNDING) & (u <= most + _ROUNDING)
    return result


def _together(search: Search, constraints: Constraints, first: Array, second: Array) -> Flags:
    """(m,) whether two fingers may be at these u: as far apart as they must be, and kept."""
    u = np.sort([first, second], axis=0)
    a, b = (search.sides.points(search.sides.on(each), each) for each in u)
    may: Flags = np.hypot(*(a - b).T) >= search.apart
    may[may] = constraints.may(a[may], b[may])
    return may


def _value(search: Search, level: Level | None, power: int, places: np.ndarray, u: Array) -> float:
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

"""Choosing where the fingers go on a mesh."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from heapq import heapify, heappop, heappush
from math import inf, sqrt
from types import MappingProxyType

import numpy as np

from regrasp.errors import Infeasible, InvalidInput, RegraspError, shown
from regrasp.mechanics.checks import Array, read_only
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.wrench import Wrench
from regrasp.mesh.clear import clear_faces
from regrasp.mesh.mesh import Mesh
from regrasp.planning.placement.chosen import ChosenGrasp, OtherGrasp
from regrasp.planning.placement.laws import LARGEST, LEVELS, Law
from regrasp.planning.placement.levels.level import AnsweredLevel, FrictionLevel, Level
from regrasp.planning.placement.proofs.patch_proof import PatchProof
from regrasp.planning.placement.results import as_it_ended
from regrasp.planning.placement.search import Progress
from regrasp.planning.placement.space.climbing import Climb
from regrasp.planning.placement.space.patches import patches_of
from regrasp.planning.placement.space.surface_boxes import HELD
from regrasp.planning.placement.space.surface_search import MOST_BOXES, MOST_LOOKS, SurfaceSearch
from regrasp.planning.states.choosing import choose_state
from regrasp.planning.states.criteria import ChosenState

FROM_EDGES = 1e-3
"""Default distance of fingers from sharp edges, as a fraction of the root of the surface's area."""
SPACE_LEVELS = ("friction_use", "angle", "answered")
_ATTEMPTS = 20  # placements whose forces are computed, the best first, until one has them
_AS_FOUND = 1.01  # a grasp whose forces come out larger than the search found is at the edge of what holds
_DIFFERENT = 0.05  # of the root of the area
_OTHERS = 4
_PASSED_OVER = 128  # placements tried, the best first, among which others are looked for
_NARROW = 1e-6  # of the size: triangles of smaller sides are not halved
_SAMPLED, _SAMPLED_GAP = 200, 0.01  # points, on which a first placement is sought, and to what gap at least
_SAMPLED_BOXES = 3000

_OF_LEVELS = ("max_force", "disturbance")


def check_space(
    shape: Mesh, load: Wrench | LoadSet, goal: str = "peak", given: Mapping[str, bool] = MappingProxyType({})
) -> Array:
    """(L, 6) the loads. ``InvalidInput`` for what a mesh is not searched with; given: options of outlines."""
    if not isinstance(load, Wrench | LoadSet):
        raise InvalidInput(f"load must be a Wrench or a LoadSet, got {shown(load)}")
    if load.dimension != 3:
        raise InvalidInput("the shape is in space and load in the plane; give a load in space")
    if goal in LEVELS and goal not in SPACE_LEVELS:
        raise InvalidInput(
            f"objective {goal!r} has no bound on meshes: sum_normal, peak_normal, peak, effort, "
            f"{', '.join(SPACE_LEVELS)} have"
        )
    if shape.smooth:
        raise InvalidInput(
            "a smooth mesh has no bound: its normals turn within a face; give Mesh(vertices, faces), whose "
            "faces are flat"
        )
    unknown = [name for name, there in given.items() if there and name not in _OF_LEVELS]
    if unknown:
        raise InvalidInput(f"{', '.join(unknown)}: on outlines only, and the shape is a mesh")
    more = [name for name in _OF_LEVELS if given.get(name)] if goal not in SPACE_LEVELS else []
    if more:
        raise InvalidInput(
            f"{', '.join(more)}: on a mesh for objectives {', '.join(SPACE_LEVELS)} alone; got {goal!r}"
        )
    if isinstance(load, Wrench):
        return load.vector[None]
    if load.vertices is None:
        raise InvalidInput("in space load is a Wrench or the LoadSet.hull of some; got a round set")
    return np.unique(load.vertices, axis=0)


def choose_on_mesh(
    shape: Mesh, fingers: int, loads: Array, friction: float, objective: str, law: Law, *, tolerance: float,
    apart: float, away: float | None, most: int | None, progress: Progress | None, level: Level | None = None,
) -> ChosenGrasp:  # fmt: skip
    """The best places on the faces; the arguments are those of ``choose_grasp``, checked."""
    root = sqrt(shape.area)
    corners, normals = clear_faces(shape, FROM_EDGES * root if away is None else away)
    if not len(corners):
        raise InvalidInput("from_corners leaves no place for a finger: no face reaches so far from its edges")
    boxes, looks = (MOST_BOXES, MOST_LOOKS) if most is None else (most, inf)
    half = 0.5 * tolerance / law.power
    search = SurfaceSearch(
        patches_of(corners, normals), fingers, friction, loads, law, apart, half,
        None if level is None else level.max_force,
    )  # fmt: skip
    if isinstance(level, FrictionLevel | AnsweredLevel):
        climb = Climb(search, level, tolerance)
        if isinstance(level, AnsweredLevel):
            climb.put(1.0)
        few = _on_samples(corners, normals, search, half)
        climb.run([spots for _, spots in few.placements()[:_OTHERS]], _NARROW, boxes, looks, progress)
        return _at_level(climb, shape, loads, friction, objective, _DIFFERENT * root)
    few = _on_samples(corners, normals, search, half)
    for _, spots in few.placements()[:_OTHERS]:
        search.accept(spots)
    looks = -1 if few.interrupted else looks  # some boxes, for a bound, and no more after an interrupt
    search.run(half, boxes, _NARROW, progress, looks)
    power = law.power
    for norm, spots in search.placements()[:_ATTEMPTS]:
        try:
            grasp = _grasp(spots, friction)
            states = _states(grasp, loads, objective)
        except RegraspError:
            continue
        worst = max(state.value for state in states)
        if worst > _AS_FOUND * norm**power:
            continue
        bound = min(search.bound, worst ** (1 / power))
        return ChosenGrasp(
            shape, objective, grasp, tuple(GraspState(s.grasp, s.load, s.forces) for s in states), worst,
            min(bound**power, worst), read_only(spots[:, :3] + shape.centre_of_mass),
            _others(search, few, spots, objective, shape, _DIFFERENT * root), _proof(search, bound),
        )  # fmt: skip
    raise as_it_ended(_none_holds(search), search.interrupted)


def _at_level(
    climb: Climb, shape: Mesh, loads: Array, friction: float, objective: str, least: float
) -> ChosenGrasp:
    """The best placement of a climb, with the proof that none is beyond."""
    search, level = climb.search, climb.level
    limit = level.max_force
    if not climb.kept:
        what = "hold the loads"
        if not search.closed:
            ended = " (an interrupt ended the search)" if search.interrupted else ""
            what = f"were found to hold the loads, and that there are none is not proven{ended},"
        refusal = Infeasible(
            f"no {search.fingers} fingers anywhere on this mesh {what}, with friction {friction:g} and "
            f"forces of at most {limit:g} N",
            _proof(search, float(np.nextafter(limit, inf)) if search.closed else 0.0),
        )
        raise as_it_ended(refusal, search.interrupted)
    found: list[tuple[Array, Grasp, Sequence[GraspState], float]] = []
    for reached, spots in climb.kept[::-1][:_ATTEMPTS]:
        if any(_apart(spots, other[0]) < least for other in found):
            continue
        with suppress(RegraspError):
            grasp = _grasp(spots, friction)
            shown = level.shown(grasp, objective, loads, reached)
            found += [] if shown is None else [(spots, grasp, *shown)]
    if not found:
        raise Infeasible(
            "placements that hold the loads are so few that rounding decides, and none of those tried has "
            "forces inside the cones and the limit"
        )
    spots, grasp, states, value = found[0]
    bound = level.value(climb.beyond)
    bound = max(bound, value) if objective in LARGEST else min(bound, value)
    trivial = not search.closed or bound == 0.0
    others = [
        OtherGrasp(grasp, read_only(at[:, :3] + shape.centre_of_mass), there)
        for at, grasp, _, there in found[1 : 1 + _OTHERS]
    ]
    return ChosenGrasp(
        shape, objective, grasp, tuple(GraspState(s.grasp, s.load, s.forces) for s in states), value, bound,
        read_only(spots[:, :3] + shape.centre_of_mass), tuple(others),
        _proof(search, 0.0 if trivial else float(np.nextafter(limit, inf))), max_force=limit,
        deviations=read_only(level.deviations.copy()) if isinstance(level, AnsweredLevel) else None,
    )  # fmt: skip


def _on_samples(corners: Array, normals: Array, search: SurfaceSearch, tolerance: float) -> SurfaceSearch:
    """A search on some points spread over the faces, as on faces: exact on these points."""
    gap = max(tolerance, _SAMPLED_GAP)
    sides = corners[:, 1:] - corners[:, :1]
    areas = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    steps = (np.arange(_SAMPLED) + 0.5) / _SAMPLED * areas.sum()
    on = np.minimum(np.searchsorted(np.cumsum(areas), steps), len(areas) - 1)
    # a sequence that fills the square evenly (Roberts, 2018), folded into the triangle
    u, v = ((np.arange(_SAMPLED)[:, None] + 0.5) * [0.7548776662466927, 0.5698402909980532] % 1.0).T
    u, v = np.where(u + v > 1, 1 - u, u), np.where(u + v > 1, 1 - v, v)
    points = corners[on, 0] + u[:, None] * sides[on, 0] + v[:, None] * sides[on, 1]
    few = SurfaceSearch(
        patches_of(np.repeat(points[:, None], 3, axis=1), normals[on]), search.fingers, search.friction,
        search.loads, search.law, search.apart, gap,
    )  # fmt: skip
    few.run(gap, _SAMPLED_BOXES, _NARROW, None)
    return few


def _grasp(spots: Array, friction: float) -> Grasp:
    return Grasp(Contact(s[:3], s[3:] + 0.0, friction, name=f"F{i + 1}") for i, s in enumerate(spots))


def _states(grasp: Grasp, loads: Array, objective: str) -> list[ChosenState]:
    return [choose_state(grasp, Wrench.from_vector(w), objective) for w in loads]


def _others(
    search: SurfaceSearch, few: SurfaceSearch, spots: Array, objective: str, shape: Mesh, least: float
) -> tuple[OtherGrasp, ...]:
    """The best placements tried that differ from the chosen one and from one another.

    Their values are those of forces: on a knife's edge the search may take a placement for better than it is.
    """
    kept = [spots]
    found: list[OtherGrasp] = []
    passed = search.placements()[:_PASSED_OVER] + few.placements()[:_PASSED_OVER]
    # those that are not the best yet were judged by as many loads as it takes: they need no less
    waiting = [(norm, i, False) for i, (norm, _) in enumerate(passed)]
    heapify(waiting)
    while waiting and len(kept) <= _ATTEMPTS and len(found) < _OTHERS:
        norm, i, judged = heappop(waiting)
        other = passed[i][1]
        if norm == inf or min(_apart(other, one) for one in kept) < least:
            continue
        if not judged:
            heappush(waiting, (search.norm_at(other), i, True))
            continue
        kept.append(other)
        try:
            grasp = _grasp(other, search.friction)
            value = max(state.value for state in _states(grasp, search.loads, objective))
        except RegraspError:
            continue
        found.append(OtherGrasp(grasp, read_only(other[:, :3] + shape.centre_of_mass), value))
    return tuple(sorted(found, key=lambda other: other.value))


def _apart(spots: Array, other: Array) -> float:
    """The farthest finger of one placement from all of another, either way [m]."""
    away = np.linalg.norm(spots[:, None, :3] - other[None, :, :3], axis=2)
    return float(max(away.min(axis=0).max(), away.min(axis=1).max()))


def _proof(search: SurfaceSearch, bound: float) -> PatchProof:
    patches, arrays = search.patches, search.arrays()
    points = patches.rows.reshape(-1, 3, 6)
    return PatchProof(
        read_only(points[:, :, :3].copy()), read_only(points[:, 0, 3:].copy()), search.fingers,
        search.friction, read_only(search.loads.copy()), search.law.size, search.law.norm, search.apart,
        bound, **{name: read_only(values) for name, values in arrays.items()},
    )  # fmt: skip


def _none_holds(search: SurfaceSearch) -> Infeasible:
    from regrasp.closed_form.compiled.patches.patch_gauge import NEVER

    most = HELD * NEVER * search.unit * (1 - 1e-9)
    if search.best == inf and search.bound >= most:
        return Infeasible(
            f"no {search.fingers} fingers anywhere on this mesh hold the loads with friction "
            f"{search.friction:g}, not by forces of {most:.3g} N either",
            _proof(search, most),
        )
    proof = _proof(search, min(search.bound, most))
    if search.best < inf:
        two = ": two hold no torque about the line between them, three would" if search.fingers == 2 else ""
        return Infeasible(
            f"the best placements of {search.fingers} fingers that were found hold the loads on a knife's "
            f"edge alone, where rounding decides{two}; none needs less than {proof.bound:.6g} N",
            proof,
        )
    why = f"{search.count} boxes were looked at, allow more by most_boxes"
    if search.interrupted:
        why = f"an interrupt ended the search after {search.count} boxes"
    return Infeasible(
        f"no placement was found whose forces hold the loads, and none needs less than {proof.bound:.6g} N; "
        f"it is not proven that there is none: {why}",
        proof,
    )

"""Choosing where the fingers go."""

from math import inf

import numpy as np

from regrasp.errors import Infeasible, InvalidInput, RegraspError, shown
from regrasp.mechanics.checks import Array, number, read_only, whole
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.wrench import Wrench
from regrasp.outline.outline import Outline
from regrasp.outline.polygon import PolygonBoundary
from regrasp.planning.placement.chosen import ChosenGrasp, OtherGrasp
from regrasp.planning.placement.laws import law_of
from regrasp.planning.placement.loads import check_planar, inner_and_outer
from regrasp.planning.placement.proof import PlacementProof
from regrasp.planning.placement.search import MOST_BOXES, Progress, Search
from regrasp.planning.placement.sides import Sides, sides_of
from regrasp.planning.states.choosing import choose_state
from regrasp.planning.states.criteria import ChosenState
from regrasp.planning.states.objectives import Objective

FROM_CORNERS = 1e-3
"""Default distance of fingers from corners, as a fraction of the length of the outline."""
DISTINCT = 1e-6
"""Default distance of fingers, as a fraction of the object's farthest reach from its centre of mass."""
_ATTEMPTS = 20  # placements whose forces are computed, the best first, until one has them
_AS_FOUND = 1.01  # a grasp whose forces come out larger than the search found is at the edge of what holds
_DIFFERENT = 0.05  # of the length
_OTHERS = 4


def choose_grasp(
    shape: Outline,
    fingers: int,
    load: Wrench | LoadSet,
    *,
    friction: float,
    objective: str | Objective = "sum_normal",
    tolerance: float = 1e-3,
    min_distance: float | None = None,
    from_corners: float | None = None,
    most_boxes: int = MOST_BOXES,
    progress: Progress | None = None,
) -> ChosenGrasp:
    """The best places for fingers on a shape, with a proof that none are better.

    Every placement on the boundary is looked at, not a sample: boxes of placements are split until the best
    value found is within ``tolerance`` of the least bound. An interrupt from the keyboard ends the search and
    returns the best so far, with its gap.

    Args:
        shape: a polygon; contacts are on its outer boundary.
        fingers: how many, 2 to 4; all alike.
        load: external wrench on the object about its centre of mass, or a set of them that one grasp, with
            forces for each load, has to hold; the value is that of the worst load [N, N m].
        friction: coefficient of all fingers [-].
        objective: ``sum_normal``, ``peak_normal``, ``peak`` or ``effort``, as of ``choose_state``.
        tolerance: gap at which the search ends, as a fraction of the value [-].
        min_distance: least distance between two fingers [m]; a millionth of the object's size if not given,
            for two fingers at one point are one.
        from_corners: least distance of a finger from a corner, along the boundary [m]; a thousandth of the
            length if not given, and 0 lets a finger be on a corner with the normal of either side.
        most_boxes: boxes after which the search ends with the gap it has; they bound its memory.
        progress: called with the bound and the least value so far as the search goes on: the norm of forces
            behind the objective [N].

    Raises:
        Infeasible: Where no placement holds the loads; the certificate is the proof.
        InvalidInput: For arguments that are not what they must be.
    """
    _check(shape, load, progress)
    whole(fingers, "fingers", least=2, most=4)
    mu = number(friction, "friction", least=0)
    goal, law = law_of(objective)
    if number(tolerance, "tolerance", above=0) >= 1:
        raise InvalidInput(f"tolerance is a fraction below 1, got {shown(tolerance)}")
    apart = None if min_distance is None else number(min_distance, "min_distance", above=0)
    away = (
        FROM_CORNERS * shape.length if from_corners is None else number(from_corners, "from_corners", least=0)
    )
    whole(most_boxes, "most_boxes", least=64, most=10_000_000)
    sides = sides_of(shape, away)
    inner, outer = inner_and_outer(load, tolerance / 4)
    # forces are chosen with a little friction kept back, for a norm that is a power of the value's
    search = Search(sides, fingers, mu, inner, law, DISTINCT * sides.size if apart is None else apart)
    search.run(0.5 * tolerance / law.power, most_boxes, progress)
    asked = [Wrench.from_vector(vector) for vector in outer]
    all_asked = isinstance(load, Wrench) or load.vertices is not None
    for norm, places, u in search.placements()[:_ATTEMPTS]:
        order = np.argsort(u, kind="stable")
        grasp = _grasp(sides, places[order], u[order], mu)
        if grasp is None:
            continue
        try:
            with np.errstate(all="ignore"):  # forces at the edge of what can be held
                states = [choose_state(grasp, one, goal) for one in asked]
        except RegraspError:
            continue
        worst = max(states, key=lambda state: state.value)
        if not worst.value <= _AS_FOUND * norm**law.power:
            continue
        bound = min(search.bound, worst.value ** (1 / law.power))
        return ChosenGrasp(
            shape, goal.name, grasp, tuple(map(_plain, states if all_asked else [worst])), worst.value,
            min(bound**law.power, worst.value), _arc_lengths(sides, places[order], u[order]),
            _others(search, sides, mu, u[order], law.power), _proof(search, shape, bound),
        )  # fmt: skip
    if search.best < inf:
        raise Infeasible(
            "placements that hold the loads are so few that rounding decides, and none of those tried has "
            f"forces inside the cones; no placement needs less than {search.bound:.6g} N",
            _proof(search, shape, search.bound),
        )
    raise _none_holds(search, shape)


def _plain(state: ChosenState) -> GraspState:
    return GraspState(state.grasp, state.load, state.forces)


def _proof(search: Search, shape: Outline, bound: float) -> PlacementProof:
    vertices: Array = shape.boundary.vertices  # type: ignore[attr-defined]
    return search.proof(min(bound, search.largest), vertices, shape.centre_of_mass)


def _none_holds(search: Search, shape: Outline) -> Infeasible:
    proof = _proof(search, shape, search.bound)
    if search.bound == inf:
        return Infeasible(
            f"no {search.fingers} fingers anywhere on this outline hold the loads with friction "
            f"{search.friction:g}, not by forces of {proof.bound:.3g} N either",
            proof,
        )
    return Infeasible(
        f"no placement was found that holds the loads, and none needs less than {proof.bound:.6g} N; it is "
        f"not proven that there is none: {search.count} boxes were looked at, allow more by most_boxes",
        proof,
    )


def _check(shape: Outline, load: Wrench | LoadSet, progress: Progress | None) -> None:
    if not isinstance(shape, Outline):
        raise InvalidInput(f"shape must be an Outline, got {shown(shape)}")
    if not isinstance(shape.boundary, PolygonBoundary):
        raise InvalidInput("shape must be a polygon; give Outline(shape.polygon(tolerance)) of a smooth one")
    check_planar(load)
    if progress is not None and not callable(progress):
        raise InvalidInput(f"progress must be a function of bound and value, got {shown(progress)}")


def _grasp(sides: Sides, places: np.ndarray, u: Array, friction: float) -> Grasp | None:
    """The contacts; None where two fingers are at one point of one side."""
    try:
        return Grasp(
            sides.contact(int(side), float(at), friction, f"F{i + 1}")
            for i, (side, at) in enumerate(zip(places, u, strict=True))
        )
    except InvalidInput:
        return None


def _arc_lengths(sides: Sides, places: np.ndarray, u: Array) -> Array:
    return read_only(np.array([sides.arc_length(int(j), float(at)) for j, at in zip(places, u, strict=True)]))


def _others(search: Search, sides: Sides, mu: float, u: Array, power: int) -> tuple[OtherGrasp, ...]:
    """The best placements tried that differ from the chosen one and from one another."""
    length = float(sides.lengths.sum())
    kept = [_along(sides, u)]
    found: list[OtherGrasp] = []
    for value, places, at in search.placements():
        if len(found) == _OTHERS:
            break
        order = np.argsort(at, kind="stable")
        s = _along(sides, at[order])
        if min(_farthest(s, other, length) for other in kept) < _DIFFERENT * length:
            continue
        grasp = _grasp(sides, places[order], at[order], mu)
        if grasp is not None:
            kept.append(s)
            found.append(OtherGrasp(grasp, _arc_lengths(sides, places[order], at[order]), value**power))
    return tuple(found)


def _along(sides: Sides, u: Array) -> Array:
    """Arc lengths of places in rising order, from their u alone."""
    edge = np.minimum(u.astype(int), len(sides.vertices) - 1)
    result: Array = sides.starts[edge] + (u - edge) * sides.lengths[edge]
    return result


def _farthest(s: Array, other: Array, length: float) -> float:
    """The largest way of a finger from one placement to another, fingers in the order that fits best."""
    ways = []
    for turn in range(len(s)):
        way = np.abs(np.roll(s, turn) - other)
        ways.append(float(np.minimum(way, length - way).max()))
    return min(ways)

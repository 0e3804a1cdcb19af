"""From what a search found to a grasp with forces, or to words why there is none."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from heapq import heappop, heappush
from math import inf
from typing import TypeVar

import numpy as np

from regrasp.errors import Infeasible, InvalidInput, RegraspError
from regrasp.mechanics.checks import Array, read_only
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.wrench import Wrench
from regrasp.outline.outline import Outline
from regrasp.outline.polygon import PolygonBoundary
from regrasp.planning.placement.chosen import ChosenGrasp, OtherGrasp
from regrasp.planning.placement.knife_edges import on_edges
from regrasp.planning.placement.laws import LARGEST, Law
from regrasp.planning.placement.levels.ball import BallLevel
from regrasp.planning.placement.levels.level import AnsweredLevel, FrictionLevel, Level, Shown
from regrasp.planning.placement.proofs.placement_proof import PlacementProof
from regrasp.planning.placement.search import Search
from regrasp.planning.placement.sides import RingSides, Sides
from regrasp.planning.placement.symmetries import images as symmetric_images
from regrasp.planning.states.choosing import choose_state
from regrasp.planning.states.criteria import ChosenState

T = TypeVar("T")
_ATTEMPTS = 20  # placements whose forces are computed, the best first, until one has them
_AS_FOUND = 1.01  # a grasp whose forces come out larger than the search found is at the edge of what holds
_DIFFERENT = 0.05  # of the length
_OTHERS = 4
_AT_ONCE = 1_000_000  # numbers
_ALL = 0.9  # of the outline: what is left out near corners is no news
_FAR = 0.01  # of the size: a least distance that refuses placements
_FRICTIONS = (1e-6, 1e-4, 1e-2)  # more than what none holds with, where some may
_EACH, _ROUGH, _SOME_BOXES = 10, 0.5, 1000


@dataclass(frozen=True)
class Asked:
    """What a grasp was asked for.

    loads: (L, 3) that it must hold. max_force, min_normal: of every finger [N].
    """

    shape: Outline
    objective: str
    law: Law
    friction: float
    loads: Array
    max_force: float | None = None
    min_normal: float = 0.0
    constrained: bool = False


def chosen_by_norm(search: Search, asked: Asked) -> ChosenGrasp:
    """The best grasp of a search for the least norm. ``Infeasible`` where there is none."""
    power, around = asked.law.power, _around(search, asked)
    found = _with_states(search, asked, around)
    if found is None:
        raise as_it_ended(_none_holds(search, asked), _was_cut(search))
    grasp, places, u, (states, worst) = found
    bound = min(search.bound, worst.value ** (1 / power))
    shown = tuple(map(_plain, states))
    others = _others(search, asked, u, lambda norm: norm**power, around.norm_at)
    return ChosenGrasp(
        asked.shape, asked.objective, grasp, shown, worst.value, min(bound**power, worst.value),
        _arc_lengths(search.sides, places, u), others,
        proof_of(search, asked, min(bound, search.largest)), asked.max_force, asked.min_normal,
    )  # fmt: skip


def as_it_ended(refusal: Infeasible, interrupted: bool) -> BaseException:
    """The refusal; or the interrupt by which a search ended with it, in its words and caused by it."""
    if not interrupted:
        return refusal
    stop = KeyboardInterrupt(str(refusal))
    stop.__cause__ = refusal
    return stop


def _was_cut(search: Search) -> bool:
    return search.interrupted and len(search.left) > 0


def _around(search: Search, asked: Asked) -> Search:
    """For norms of the loads around a round set: more than of those in it."""
    around = search.anew()
    around.under(asked.loads)
    return around


def _with_states(
    search: Search, asked: Asked, around: Search
) -> tuple[Grasp, np.ndarray, Array, tuple[list[ChosenState], ChosenState]] | None:
    """The best placement tried of a search for the least norm, its states, and the worst of them."""
    power = asked.law.power

    def judged(
        grasp: Grasp, norm: float, places: np.ndarray, u: Array
    ) -> tuple[list[ChosenState], ChosenState] | None:
        limits = {"max_force": asked.max_force, "min_normal": asked.min_normal or None}
        states = [
            choose_state(grasp, Wrench.from_vector(w), asked.objective, **limits)  # type: ignore[arg-type]
            for w in asked.loads
        ]
        worst = max(states, key=lambda state: state.value)
        found = around.norm_at(places, u)
        return (states, worst) if worst.value <= _AS_FOUND * max(norm, found) ** power else None

    return _first(search, asked, judged)


def chosen_at_level(
    search: Search, asked: Asked, level: Level, best: float | None, beyond: float
) -> ChosenGrasp:
    """The best grasp of a search for a level. ``Infeasible`` where there is none."""
    limit = level.max_force
    if best is None:
        least = min(search.bound, limit) if isinstance(level, AnsweredLevel | FrictionLevel) else 0.0
        proof = proof_of(search, asked, _above(search, limit) if search.closed else least)
        who = f"no {search.fingers} fingers anywhere on {_where(search)}"
        given = f"with friction {asked.friction:.9g} and forces of at most {limit:g} N"
        if search.closed:
            raise Infeasible(f"{who} hold the loads, {given}", proof)
        top = level.value(level.top(search))
        needed = f", and forces of {least:.6g} N are needed at the least" if least else ""
        ended = "an interrupt ended the search" if search.interrupted else "allow more by most_boxes"
        refusal = Infeasible(
            f"{who} were found to hold the loads, {given}{needed}; {asked.objective} is nowhere better than "
            f"{top:.6g}; it is not proven that there are none: {ended}",
            proof,
        )
        raise as_it_ended(refusal, _was_cut(search))

    def judged(grasp: Grasp, negative: float, *_: Array) -> Shown | None:
        return level.shown(grasp, asked.objective, asked.loads, -negative)

    found = _first(search, asked, judged)
    level.put(search, beyond)
    bound = level.value(beyond)
    if found is None:
        trivial = not search.closed or bound == 0.0
        refusal = Infeasible(
            "placements that hold the loads are so few that rounding decides, and none of those tried has "
            f"forces inside the cones and the limit; {asked.objective} is nowhere better than {bound:.6g}",
            proof_of(search, asked, 0.0 if trivial else _above(search, limit)),
        )
        raise as_it_ended(refusal, _was_cut(search))
    grasp, places, u, (states, value) = found
    bound = max(bound, value) if asked.objective in LARGEST else min(bound, value)
    trivial = not search.closed or bound == 0.0
    return ChosenGrasp(
        asked.shape, asked.objective, grasp, tuple(map(_plain, states)), value, bound,
        _arc_lengths(search.sides, places, u), _others(search, asked, u, abs),
        proof_of(search, asked, 0.0 if trivial else _above(search, limit)), max_force=limit,
        deviations=read_only(np.array(level.deviations)) if isinstance(level, AnsweredLevel) else None,
        length=level.length if isinstance(level, BallLevel) else None,
    )  # fmt: skip


def _above(search: Search, limit: float) -> float:
    """What no forces of the limit reach; those that keep a margin are excluded at the limit itself."""
    return limit if search.margin else float(np.nextafter(limit, np.inf))


def _first(
    search: Search,
    asked: Asked,
    judged: Callable[[Grasp, float, np.ndarray, Array], T | None],
) -> tuple[Grasp, np.ndarray, Array, T] | None:
    """The best placement tried whose forces come out as found, fingers in the order of the boundary."""
    for norm, places, u in search.placements()[:_ATTEMPTS]:
        order = np.argsort(u, kind="stable")
        grasp = grasp_at(search.sides, places[order], u[order], asked.friction)
        if grasp is None or not search.are_apart(places, u):
            continue
        try:
            with np.errstate(all="ignore"):  # forces at the edge of what can be held
                found = judged(grasp, norm, places[order], u[order])
        except RegraspError:
            continue
        if found is not None:
            return grasp, places[order], u[order], found
    return None


def _plain(state: GraspState) -> GraspState:
    return GraspState(state.grasp, state.load, state.forces)


def proof_of(search: Search, asked: Asked, bound: float) -> PlacementProof:
    """The proof of a search, on the outline asked for."""
    boundary = asked.shape.boundary
    edges = boundary.vertices if isinstance(boundary, PolygonBoundary) else boundary.cubics()[1]  # type: ignore[attr-defined]
    if isinstance(search.sides, RingSides):
        edges = np.concatenate([edges, *(h.vertices[::-1] for h in asked.shape.holes)])  # type: ignore[attr-defined]
    return search.proof(bound, read_only(edges), asked.shape.centre_of_mass)


def _where(search: Search) -> str:
    """In words, the places that were asked about: a refusal may be of what keeps fingers from better ones."""
    sides = search.sides
    share = float(np.ptp(sides.ends, axis=1) @ sides.lengths[sides.edges] / sides.lengths.sum())
    where = "this outline" if share > _ALL else f"the {share:.1%} of this outline where they may be"
    return where if search.apart < _FAR * sides.size else f"{where}, {search.apart:g} m apart,"


def _none_holds(search: Search, asked: Asked) -> Infeasible:
    proof = proof_of(search, asked, min(search.bound, search.largest))
    least = f"none needs less than {proof.bound:.6g} N"
    if search.best < inf:
        return Infeasible(
            "placements that hold the loads are so few that rounding decides, and none of those tried has "
            f"forces inside the cones; {least}{_with_more_friction(search, asked)}",
            proof,
        )
    if not len(search.left):
        largest, low = search.limits
        limited = f" and forces of at most {largest:g} N" if largest < inf else ""
        limited += f", each finger pushing with {low:g} N or more" if low else ""
        far = "" if largest < inf else f", not by forces of {proof.bound:.3g} N either"
        return Infeasible(
            f"no {search.fingers} fingers anywhere on {_where(search)} hold the loads, with friction "
            f"{search.friction:.9g}{limited}{far}",
            proof,
        )
    why = f"{search.count} boxes were looked at, allow more by most_boxes"
    if search.interrupted:
        why = f"an interrupt ended the search after {search.count} boxes"
    elif search.closed:
        why = "what is left is too narrow to be split, on a knife's edge"
    if asked.constrained:
        return Infeasible(
            f"no placement was found that holds the loads and keeps the constraints; without them {least}, "
            f"and that there is none with them is not proven: {why}",
            proof,
        )
    more = _with_more_friction(search, asked)
    return Infeasible(
        f"no placement was found that holds the loads, and {least}{more}; it is not proven that there is "
        f"none: {why}",
        proof,
    )


def _with_more_friction(search: Search, asked: Asked) -> str:
    """In words, a friction a little larger with which a placement is found that holds the loads, and how."""
    if search.interrupted or asked.constrained:
        return ""
    near = search.placements()[:_EACH]
    for more in _FRICTIONS:
        wider = search.anew(search.friction + more)
        with suppress(KeyboardInterrupt):
            there = [(wider.norm_at(places, u), places, u) for _, places, u in near]
            there = [placed for placed in there if placed[0] < inf] + on_edges(wider)[:_EACH]
            if there:
                wider.take(there)
            else:
                wider.run(_ROUGH, _SOME_BOXES, None)
        found = _with_states(wider, replace(asked, friction=wider.friction), _around(wider, asked))
        if found is not None:
            value = found[-1][1].value
            return f" (with friction {wider.friction:.9g} one does hold them, {asked.objective} {value:.6g})"
    return ""


def grasp_at(sides: Sides, places: np.ndarray, u: Array, friction: float) -> Grasp | None:
    """The grasp of fingers on sides; None where two of them are at one point of one side."""
    try:
        return Grasp(
            sides.contact(int(side), float(at), friction, f"F{i + 1}")
            for i, (side, at) in enumerate(zip(places, u, strict=True))
        )
    except InvalidInput:
        return None


def _arc_lengths(sides: Sides, places: np.ndarray, u: Array) -> Array:
    return read_only(np.array([sides.arc_length(int(j), float(at)) for j, at in zip(places, u, strict=True)]))


def _others(
    search: Search,
    asked: Asked,
    u: Array,
    value: Callable[[float], float],
    exact: Callable[[np.ndarray, Array], float] | None = None,
) -> tuple[OtherGrasp, ...]:
    """The best placements tried that differ from the chosen one, from one another and from their images.

    exact: the norm of places, where that of a placement tried may be less: what is no better than the best
    was judged by as many loads as it takes.
    """
    sides, length = search.sides, float(search.sides.lengths.sum())
    kept, tried = _alike(search, u), search.placements()
    found: list[OtherGrasp] = []
    s = _along(sides, np.sort([at for _, _, at in tried], axis=1))
    differs = _apart(s, kept, length) >= _DIFFERENT * length
    queue = [(tried[number][0], number, exact is None) for number in np.flatnonzero(differs).tolist()]
    while queue and len(found) < _OTHERS:
        norm, number, known = heappop(queue)
        _, places, at = tried[number]
        order = np.argsort(at, kind="stable")
        if norm == inf or _apart(s[number, None], kept, length)[0] < _DIFFERENT * length:
            continue
        if exact is not None and not known:
            heappush(queue, (exact(places, at), number, True))
            continue
        grasp = grasp_at(sides, places[order], at[order], asked.friction)
        if grasp is not None:
            kept = np.vstack([kept, _alike(search, at)])
            found.append(OtherGrasp(grasp, _arc_lengths(sides, places[order], at[order]), float(value(norm))))
    return tuple(sorted(found, key=lambda other: abs(other.value)) if exact else found)


def _alike(search: Search, u: Array) -> Array:
    """(i, k) arc lengths of a placement and its images by symmetry, each in every order around."""
    sides, images = search.sides, u[None]
    if not isinstance(sides, RingSides):
        images = symmetric_images(sides.control_points(), search.loads, u)
    s = np.sort([_along(sides, each) for each in images], axis=1)
    return np.concatenate([np.roll(s, turn, axis=1) for turn in range(s.shape[1])])


def _along(sides: Sides, u: Array) -> Array:
    """Arc lengths of places in rising order, from their u alone."""
    edge = np.minimum(u.astype(int), len(sides.vertices) - 1)
    result: Array = sides.starts[edge] + (u - edge) * sides.lengths[edge]
    return result


def _apart(s: Array, others: Array, length: float) -> Array:
    """(n,) the largest way of a finger from each placement (n, k) to the nearest of others (i, k)."""
    parts = []
    for some in np.array_split(s, 1 + s.shape[0] * others.size // _AT_ONCE):
        way = np.abs(some[:, None] - others)
        parts.append(np.minimum(way, length - way).max(axis=2).min(axis=1))
    result: Array = np.concatenate(parts)
    return result

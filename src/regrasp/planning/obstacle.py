"""Why there is no sequence of holds, and what would make one possible."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from math import ceil, degrees, floor, log10
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from regrasp.errors import Infeasible, RegraspError, SolverFailed
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.balancing import with_limit
from regrasp.planning.bottleneck import bottleneck, connected
from regrasp.planning.choice import choose_forces
from regrasp.planning.criteria import Criteria
from regrasp.planning.holds import HoldGraph
from regrasp.planning.reach import sequences
from regrasp.planning.turn import turned_load

if TYPE_CHECKING:
    from regrasp.planning.regrasp_problem import RegraspProblem

# Friction coefficients are tried up to this one, a cone of 86 degrees, and force limits up to so many loads.
_MOST_FRICTION, _MOST_LOADS = 16.0, 1e4
_DIGITS = 3


@dataclass(frozen=True)
class RegraspObstacle:
    """Why no sequence of holds leads from a start to a goal; the ``certificate`` of its ``Infeasible``.

    start, goal: components of the hold graph, over all orientations, of the contacts that hold at each end;
    -1 stands for contacts without any hold. friction: with at least this coefficient at every contact there
    is a sequence [-]. max_force: with this limit in place of smaller ones there is one [N]. margin: the
    widest least margin of any sequence where a least margin is asked for [rad]. Each None where it is not what is
    missing, or where nothing up to a friction of 16, or limits of ten thousand loads, would do.
    without: options that alone would leave a sequence if they were not given.
    """

    start: tuple[int, ...]
    goal: tuple[int, ...]
    friction: float | None = None
    max_force: float | None = None
    margin: float | None = None
    without: tuple[str, ...] = ()


def why_not(problem: "RegraspProblem") -> Infeasible:
    """The error that says why a problem has no plan."""
    unheld = _unheld_end(problem)
    if unheld is not None:
        return unheld
    graph, (start, goal, last) = problem.graph, problem.places
    parts = [_components(graph, places, o) for places, o in ((start, 0), (goal, last))]
    if problem.least_margin > 0 and _possible(problem, graph):
        margin = _widest(problem)
        return Infeasible(
            f"no sequence of holds keeps angle margins of {problem.least_margin:.4g} rad; the widest worst "
            f"margin on the sampled points and orientations is {margin:.4g} rad",
            RegraspObstacle(parts[0], parts[1], margin=margin),
        )
    obstacle = RegraspObstacle(
        parts[0], parts[1], _friction(problem), _force(problem), without=tuple(_without(problem))
    )
    return Infeasible(f"{_reason(problem, parts[0], parts[1])}; {_remedy(problem, obstacle)}", obstacle)


def _components(graph: HoldGraph, places: tuple[int, ...], o: int) -> tuple[int, ...]:
    """The components of an end's points that hold there, or of all its points if none do."""
    held = {v for i in places for j in places if i != j and graph.margin(i, j, o) >= 0 for v in (i, j)}
    component = graph.components()
    return tuple(sorted({int(component[i]) for i in held or places}))


def _reason(problem: "RegraspProblem", start: tuple[int, ...], goal: tuple[int, ...]) -> str:
    graph, (*ends, last) = problem.graph, problem.places
    for what, places, o in (("start", ends[0], 0), ("goal", ends[1], last)):
        pairs = [graph.pair(i, j) for k, i in enumerate(places) for j in places[k + 1 :]]
        held: NDArray[np.bool_] = np.any(graph.margins[:, pairs] >= 0, axis=1)
        if not held[o]:
            some = ", ".join(f"{degrees(a):.4g}" for a in graph.angles[held][:4])
            more = ", ..." if held.sum() > 4 else ""
            where = f"only at {some}{more} deg" if some else "and at no other orientation"
            return (
                f"no two fingers of the {what} hold the load at {degrees(graph.angles[o]):.4g} deg, "
                f"{where}, so none of its fingers can leave or arrive"
            )
    count = int((graph.margins.max(axis=0) >= 0).sum())
    common = tuple(sorted(set(start) & set(goal) - {-1}))
    apart = "the turns between are too large" if problem.allowed is None else "the arcs keep them apart"
    where = (
        f"both ends have points in component {_listed(common)}, but {apart}"
        if common
        else f"the start's points are in component {_listed(start)} and the goal's in {_listed(goal)}"
    )
    return (
        f"no sequence of holds leads from the start to the goal: on {len(graph.contacts)} points and "
        f"{len(graph.angles)} orientations ({count} pairs hold at one of them) {where}"
    )


def _listed(components: tuple[int, ...]) -> str:
    return " and ".join("none" if c < 0 else str(c) for c in components)


def _remedy(problem: "RegraspProblem", obstacle: RegraspObstacle) -> str:
    now = sorted({c.friction for c in problem.contacts})
    given = f"{now[0]:g}" if len(now) == 1 else f"{now[0]:g} to {now[-1]:g}"
    ways = []
    if obstacle.friction is not None:
        ways.append(f"with friction {obstacle.friction:g} instead of {given}")
    if obstacle.max_force is not None:
        ways.append(f"with force limits of {obstacle.max_force:g}")
    ways += [f"without {option}" for option in obstacle.without]
    if not ways:
        return f"no friction up to {_MOST_FRICTION:g} would do; try more candidates or orientations"
    return f"there would be one {', or '.join(ways)}"


def _unheld_end(problem: "RegraspProblem") -> Infeasible | None:
    """The error of an end that even three fingers cannot hold."""
    graph, (start, goal, last) = problem.graph, problem.places
    for what, places, o in (("start", start, 0), ("goal", goal, last)):
        load = turned_load(problem.load, float(graph.angles[o]))
        contacts = [problem.contacts[i] for i in places]
        reason = _refusal(contacts, load, problem.criteria)
        if isinstance(reason, Infeasible):
            held = partial(_held_with, contacts, load, problem.criteria)
            friction = _least(
                lambda mu: held(friction=mu),  # noqa: B023
                min(c.friction for c in contacts),
                _MOST_FRICTION,
            )
            force = _least_force(lambda limit: held(force=limit), contacts, problem.load)  # noqa: B023
            ways = [] if friction is None else [f"with friction {friction:g}"]
            ways += [] if force is None else [f"with force limits of {force:g}"]
            needs = (
                f"they would {' or '.join(ways)}"
                if ways
                else f"no friction up to {_MOST_FRICTION:g} would do"
            )
            return Infeasible(
                f"the fingers of the {what} cannot hold the load at {degrees(graph.angles[o]):.4g} deg: "
                f"{reason}; {needs}",
                reason.certificate,
            )
    return None


def _refusal(contacts: list[Contact], load: Wrench, criteria: Criteria) -> RegraspError | None:
    try:
        choose_forces(Grasp(contacts), load, replace(criteria, objective="force"))
    except (Infeasible, SolverFailed) as error:  # at the very edge of its cones a grasp may be undecided
        return error
    return None


def _held_with(
    contacts: list[Contact], load: Wrench, criteria: Criteria, friction: float = 0.0, force: float = 0.0
) -> bool:
    """Whether a grasp holds with at least this friction, and at least this force where it is limited."""
    raised = [_allowed(_raised(c, friction), force) for c in contacts]
    return _refusal(raised, load, replace(criteria, max_force=None)) is None


def _possible(problem: "RegraspProblem", graph: HoldGraph, arcs: bool = True) -> bool:
    """Whether any sequence exists on another graph of the same contacts, whatever its margins."""
    start, goal, last = problem.places
    if problem.allowed is None or not arcs:
        return connected(graph, start, goal, last, problem.max_turn)
    return bool(sequences(graph, start, goal, last, max_turn=problem.max_turn, allowed=problem.allowed))


def _widest(problem: "RegraspProblem") -> float:
    start, goal, last = problem.places
    if problem.allowed is None:
        found = bottleneck(problem.graph, start, goal, last, max_turn=problem.max_turn)
        assert found is not None
        return found.margin
    every = sequences(
        problem.graph, start, goal, last, max_turn=problem.max_turn, allowed=problem.allowed, extra=10**6
    )
    return every[-1].margin


def _friction(problem: "RegraspProblem") -> float | None:
    def possible(mu: float) -> bool:
        return _possible(problem, problem.graph_on([_raised(c, mu) for c in problem.contacts]))

    return _least(possible, min(c.friction for c in problem.contacts), _MOST_FRICTION)


def _force(problem: "RegraspProblem") -> float | None:
    def possible(limit: float) -> bool:
        return _possible(problem, problem.graph_on([_allowed(c, limit) for c in problem.contacts]))

    least = _least_force(possible, problem.contacts, problem.load)
    if least is None:
        return None
    for share in (1.0, 1.01, 1.03, 1.1, 1.3, 2.0):  # forces grow while the object turns
        limit = _rounded_up(share * least)
        try:
            _with_force(problem, limit).plans()
        except Infeasible:
            continue
        return limit
    return None


def _with_force(problem: "RegraspProblem", limit: float) -> "RegraspProblem":
    """The same problem with at least this force where it is limited."""
    start, goal = (Grasp(_allowed(c, limit) for c in grasp) for grasp in (problem.start, problem.goal))
    most = None if problem.max_force is None else max(limit, problem.max_force)
    return replace(problem, start=start, goal=goal, max_force=most)


def _least_force(
    possible: Callable[[float], bool], contacts: Iterable[Contact], load: Wrench
) -> float | None:
    limits = [c.max_force for c in contacts if c.max_force is not None]
    return _least(possible, min(limits), _MOST_LOADS * float(np.hypot(*load.force))) if limits else None


def _without(problem: "RegraspProblem") -> Iterator[str]:
    """Options that stand in the way, each by itself."""
    graph = problem.graph
    if not problem.one_finger and _possible(problem, replace(graph, one_finger=True)):
        yield "asking that both fingers push (one_finger=True)"
    if problem.min_distance > 0 and _possible(problem, replace(graph, min_distance=0.0)):
        yield "min_distance"
    if problem.keep is not None and _possible(problem, replace(graph, keep=None)):
        yield "keep"
    if problem.allowed is not None and _possible(problem, graph, arcs=False):
        yield "arcs"


def _raised(contact: Contact, friction: float) -> Contact:
    """The contact with at least this friction."""
    mu = max(contact.friction, friction)
    return Contact(contact.position, contact.normal, mu, max_force=contact.max_force, name=contact.name)


def _allowed(contact: Contact, force: float) -> Contact:
    """The contact with at least this force, where it has a limit."""
    return contact if contact.max_force is None else with_limit(contact, max(force, contact.max_force))


def _least(possible: Callable[[float], bool], now: float, most: float) -> float | None:
    """The least value above ``now``, to three digits, with which it is possible; None up to ``most``."""
    if not possible(most):
        return None
    low, high = now, most
    while high - low > 10.0 ** (floor(log10(high)) - _DIGITS) and high > 1e-6 * most:
        middle = (low + high) / 2 if low > high / 4 else max(high / 4, 2 * low)
        low, high = (low, middle) if possible(middle) else (middle, high)
    rounded = _rounded_up(high)
    return rounded if possible(rounded) else high


def _rounded_up(value: float) -> float:
    unit = 10.0 ** (floor(log10(value)) + 1 - _DIGITS)
    return float(f"{ceil(value / unit - 1e-9) * unit:.{_DIGITS + 1}g}")

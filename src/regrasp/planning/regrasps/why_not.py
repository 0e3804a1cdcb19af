"""Why there is no sequence of holds, and what would make one possible."""

from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from regrasp.errors import Infeasible, RegraspError, SolverFailed
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.outline.outline import Outline
from regrasp.outline.polygon import PolygonBoundary
from regrasp.planning.holds.graphs import AnyGraph, Parts, holding, holds_within
from regrasp.planning.regrasps.asked import Asked
from regrasp.planning.regrasps.cut import cut_of
from regrasp.planning.regrasps.remedies import (
    allowed,
    force_needed,
    friction_needed,
    in_the_way,
    least_force,
    possible_on,
    raised,
    widest_margin,
)
from regrasp.planning.states.choosing import choose_forces
from regrasp.planning.states.criteria import Criteria
from regrasp.planning.states.objectives import FORCE
from regrasp.planning.states.refusals.least_values import MOST_FRICTION, least_value
from regrasp.plans.regrasp_cut import RegraspCut


@dataclass(frozen=True)
class RegraspObstacle:
    """Why no sequence of holds leads from a start to a goal; the ``certificate`` of its ``Infeasible``.

    Args:
        start: components of the hold graph, over all orientations, of the contacts that hold at each end, in
            space of the pairs of contacts; -1 stands for contacts without any hold.
        goal: components of the hold graph, over all orientations, of the contacts that hold at each end; -1
            stands for contacts without any hold.
        friction: with at least this coefficient at every contact there is a sequence [-].
        max_force: with this limit in place of smaller ones there is one [N].
        margin: the widest least margin of any sequence where a least margin is asked for [rad]. Each None
            where it is not what is missing, or where nothing up to a friction of 16, or limits of ten
            thousand loads, would do.
        without: options that alone would leave a sequence if they were not given.
        cut: the proof that there is none on these points at any orientation, for ``verify``; None where there
            is no proof: refusals for ``arcs``, force limits and sampled orientations have none.
    """

    start: tuple[int, ...]
    goal: tuple[int, ...]
    friction: float | None = None
    max_force: float | None = None
    margin: float | None = None
    without: tuple[str, ...] = ()
    cut: RegraspCut | None = None


def why_not(problem: Asked) -> Infeasible:
    """The error that says why a problem has no plan."""
    unheld = unheld_end(problem)
    if unheld is not None:
        return unheld
    graph, (start, goal, _) = problem.graph, problem.places
    parts = [_components(graph, places) for places in (start, goal)]
    cut = cut_of(problem) if problem.is_exact else None
    if problem.least_margin > 0 and possible_on(problem, graph):
        margin, also = widest_margin(problem), "" if problem.is_exact else " and orientations"
        return Infeasible(
            f"no sequence of holds keeps angle margins of {problem.least_margin:.4g} rad; the widest worst "
            f"margin on the sampled points{also} is {margin:.4g} rad{_proven(cut)}",
            RegraspObstacle(parts[0], parts[1], margin=margin, cut=cut),
        )
    obstacle = RegraspObstacle(
        parts[0],
        parts[1],
        friction_needed(problem),
        force_needed(problem),
        without=tuple(in_the_way(problem)),
        cut=cut,
    )
    return Infeasible(
        f"{_reason(problem, parts[0], parts[1])}; {_remedy(problem, obstacle)}{_proven(cut)}"
        f"{_elsewhere(problem) if cut is None else ''}",
        obstacle,
    )


def _proven(cut: RegraspCut | None) -> str:
    return "" if cut is None else "; none at any orientation is proven, by the cut of the certificate"


def _elsewhere(problem: Asked) -> str:
    """Where to ask about all places of an outline, if they and the options are what can be asked about."""
    shape = problem.outline
    if not isinstance(shape, Outline) or not isinstance(shape.boundary, PolygonBoundary) or shape.holes:
        return ""
    if problem.arcs is not None or problem.keep is not None or problem.min_distance or problem.judges_holds:
        return ""
    return "; whether fingers elsewhere on this outline could, regrasps_on_outline decides"


def _components(graph: AnyGraph, places: tuple[int, ...]) -> tuple[int, ...]:
    """The components of an end's holds over all orientations, or of all its points if none holds."""
    parts = Parts(graph)
    holds: NDArray[np.bool_] = np.any(holding(graph), axis=0)
    within = holds_within(graph, places)
    held = [place for place in within if holds[place]]
    component = parts.components(holds)
    return tuple(sorted({int(component[part]) for part in parts.of[held or within].ravel()}))


def _reason(problem: Asked, start: tuple[int, ...], goal: tuple[int, ...]) -> str:
    graph, (*ends, last), setting = problem.graph, problem.places, problem.setting
    few, whole, holds = ("two", "three", "pairs") if setting.fingers == 3 else ("three", "four", "triples")
    for what, places, o in (("start", ends[0], 0), ("goal", ends[1], last)):
        held: NDArray[np.bool_] = np.any(holding(graph)[:, holds_within(graph, places)], axis=1)
        if not held.any():
            others = f", nor at any of {len(held) - 1} others that all {whole} may turn the object to"
            return (
                f"no {few} fingers of the {what} hold the load {setting.where(setting.orientations[o])}"
                f"{others if len(held) > 1 else ''}, so none of its fingers can leave or arrive"
            )
    count = int(holding(graph).any(axis=0).sum())
    common = tuple(sorted(set(start) & set(goal) - {-1}))
    apart = "the turns between are too large" if problem.allowed is None else "the arcs keep them apart"
    where = (
        f"both ends have points in component {_listed(common)}, but {apart}"
        if common
        else f"the start's points are in component {_listed(start)} and the goal's in {_listed(goal)}"
    )
    return (
        f"no sequence of holds leads from the start to the goal: on {len(graph.contacts)} points and "
        f"{len(graph.loads)} orientations ({count} {holds} hold at one of them) {where}"
    )


def _listed(components: tuple[int, ...]) -> str:
    return " and ".join("none" if c < 0 else str(c) for c in components)


def _remedy(problem: Asked, obstacle: RegraspObstacle) -> str:
    now = sorted({c.friction for c in problem.contacts})
    given = f"{now[0]:g}" if len(now) == 1 else f"{now[0]:g} to {now[-1]:g}"
    ways = []
    if obstacle.friction is not None:
        ways.append(f"with friction {obstacle.friction:g} instead of {given}")
    if obstacle.max_force is not None:
        ways.append(f"with force limits of {obstacle.max_force:g}")
    ways += [f"without {option}" for option in obstacle.without]
    if not ways:
        more = (
            "candidates or orientations"
            if problem.setting.fingers == 3
            else "candidates, orientations or facets"
        )
        return f"no friction up to {MOST_FRICTION:g} would do; try more {more}"
    return f"there would be one {', or '.join(ways)}"


def unheld_end(problem: Asked) -> Infeasible | None:
    """The error of an end that even three fingers cannot hold."""
    setting, (start, goal, last) = problem.setting, problem.places
    for what, places, o in (("start", start, 0), ("goal", goal, last)):
        load = setting.seen(setting.orientations[o])
        contacts = [problem.contacts[i] for i in places]
        reason = _refusal(contacts, load, problem.criteria)
        if isinstance(reason, Infeasible):
            held = partial(_held_with, contacts, load, problem.criteria)
            friction = least_value(
                lambda mu: held(friction=mu),  # noqa: B023
                min(c.friction for c in contacts),
                MOST_FRICTION,
            )
            force = least_force(lambda limit: held(force=limit), contacts, problem.load)  # noqa: B023
            ways = [] if friction is None else [f"with friction {friction:g}"]
            ways += [] if force is None else [f"with force limits of {force:g}"]
            needs = (
                f"they would {' or '.join(ways)}" if ways else f"no friction up to {MOST_FRICTION:g} would do"
            )
            return Infeasible(
                f"the fingers of the {what} cannot hold the load {setting.where(setting.orientations[o])}: "
                f"{reason}; {needs}",
                reason.certificate,
            )
    return None


def _refusal(contacts: list[Contact], load: Wrench, criteria: Criteria) -> RegraspError | None:
    try:
        choose_forces(Grasp(contacts), load, replace(criteria, objective=FORCE))
    except (Infeasible, SolverFailed) as error:  # at the very edge of its cones a grasp may be undecided
        return error
    return None


def _held_with(
    contacts: list[Contact], load: Wrench, criteria: Criteria, friction: float = 0.0, force: float = 0.0
) -> bool:
    """Whether a grasp holds with at least this friction, and at least this force where it is limited."""
    stronger = [allowed(raised(c, friction), force) for c in contacts]
    return _refusal(stronger, load, replace(criteria, max_force=None)) is None

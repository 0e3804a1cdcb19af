"""What would make an impossible regrasp possible: friction, force, or an option less.

More friction and larger force limits only add holds, so the least that is needed is found by bisection, each
time on a graph built anew.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace

import numpy as np

from regrasp.errors import Infeasible
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.changes.given_ends import with_limit
from regrasp.planning.holds.bottleneck import bottleneck, connected
from regrasp.planning.holds.graphs import AnyGraph
from regrasp.planning.holds.pairs import HoldGraph
from regrasp.planning.holds.sequences import preferred
from regrasp.planning.holds.stances import Stances
from regrasp.planning.regrasps.asked import Asked
from regrasp.planning.regrasps.turning import turning_sequences
from regrasp.planning.states.refusals.least_values import MOST_FRICTION, least_value, rounded_up

_MOST_LOADS = 1e4  # and force limits up to so many loads


def possible_on(problem: Asked, graph: AnyGraph, arcs: bool = True) -> bool:
    """Whether any sequence exists on another graph of the same contacts, whatever its margins."""
    start, goal, last = problem.places
    if problem.allowed is None or not arcs:
        return connected(graph, start, goal, last)
    return bool(preferred(_stances(problem, graph), start, goal, last))


def _stances(problem: Asked, graph: AnyGraph) -> Stances:
    return problem.setting.stances(graph, problem.largest_turn, problem.setting.reach, problem.allowed, 0.0)


def widest_margin(problem: Asked) -> float:
    """The widest least margin of any sequence [rad], where there is one."""
    if problem.is_exact:
        return turning_sequences(problem, 10**6, 0.0)[-1].sequence.margin
    start, goal, last = problem.places
    if problem.allowed is None:
        found = bottleneck(problem.graph, start, goal, last)
        assert found is not None
        return found.margin
    return preferred(_stances(problem, problem.graph), start, goal, last, 10**6)[-1].margin


def friction_needed(problem: Asked) -> float | None:
    """The least coefficient at every contact with which there is a sequence; None up to ``MOST_FRICTION``."""

    def possible(mu: float) -> bool:
        return possible_on(problem, problem.graph_on([raised(c, mu) for c in problem.contacts]))

    return least_value(possible, min(c.friction for c in problem.contacts), MOST_FRICTION)


def force_needed(problem: Asked) -> float | None:
    """The least limit [N] in place of smaller ones with which there is a plan; None without limits."""

    def possible(limit: float) -> bool:
        return possible_on(problem, problem.graph_on([allowed(c, limit) for c in problem.contacts]))

    least = least_force(possible, problem.contacts, problem.load)
    if least is None:
        return None
    for share in (1.0, 1.01, 1.03, 1.1, 1.3, 2.0):  # forces grow while the object turns
        limit = rounded_up(share * least)
        try:
            problem.allowing(limit).plans()
        except Infeasible:
            continue
        return limit
    return None


def least_force(possible: Callable[[float], bool], contacts: Iterable[Contact], load: Wrench) -> float | None:
    """The least force limit [N] with which it is possible, of contacts some of which are limited; or None."""
    limits = [c.max_force for c in contacts if c.max_force is not None]
    return (
        least_value(possible, min(limits), _MOST_LOADS * float(np.linalg.norm(load.force)))
        if limits
        else None
    )


def in_the_way(problem: Asked) -> Iterator[str]:
    """Options that stand in the way, each by itself."""
    graph = problem.graph
    if isinstance(graph, HoldGraph):
        if not problem.one_finger and possible_on(problem, replace(graph, one_finger=True)):
            yield "asking that both fingers push (one_finger=True)"
        if problem.min_normal and possible_on(problem, replace(graph, min_normal=0.0)):
            yield "min_normal"
    if problem.min_distance > 0 and possible_on(problem, replace(graph, min_distance=0.0)):
        yield "min_distance"
    if problem.keep is not None and possible_on(problem, replace(graph, keep=None)):
        yield "keep"
    if problem.allowed is not None and possible_on(problem, graph, arcs=False):
        yield "arcs"


def raised(contact: Contact, friction: float) -> Contact:
    """The contact with at least this friction."""
    mu = max(contact.friction, friction)
    return contact.changed(friction=mu)


def allowed(contact: Contact, force: float) -> Contact:
    """The contact with at least this force, where it has a limit."""
    return contact if contact.max_force is None else with_limit(contact, max(force, contact.max_force))

"""What a sequence of holds costs, where not simply the fewest moves are wanted."""

from dataclasses import dataclass, fields
from math import inf

import numpy as np
from numpy.typing import NDArray

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, number
from regrasp.mechanics.reserve import NEGLIGIBLE
from regrasp.planning.holds.cost_search import Costs
from regrasp.planning.holds.graphs import AnyGraph
from regrasp.planning.holds.pairs import HoldGraph
from regrasp.planning.holds.triples import TripleGraph
from regrasp.planning.states.batch import best_squeezes

# Of sequences that cost the same the one of fewest steps: a step costs this fraction of the largest weight.
_TIE = 1e-9
_AT_ONCE = 20_000  # triples


@dataclass(frozen=True)
class RegraspWeights:
    """Weights of a sequence's cost; the least sum is looked for. None may be negative, one must be above 0.

    Args:
        moves: for each finger move.
        turning: per radian that the object turns, either way.
        time: per second of the plan's duration, which is that of its steps.
        effort: for each hold times its effort, the least largest force with which it can carry the load, as a
            multiple of the load [-].
    """

    moves: float = 1.0
    turning: float = 0.0
    time: float = 0.0
    effort: float = 0.0

    def __post_init__(self) -> None:
        for field in fields(self):
            number(getattr(self, field.name), f"weights: {field.name}", least=0)
        if not self.largest:
            raise InvalidInput("weights: at least one must be greater than 0")

    @property
    def largest(self) -> float:
        """The largest weight."""
        return max(self.moves, self.turning, self.time, self.effort)

    def costs(self, graph: AnyGraph, margins: NDArray[np.float32], step_duration: float) -> Costs:
        """What the search adds up.

        Args:
            graph: P holds at O orientations.
            margins: (P, O) [rad], -1 where one must not hold.
            step_duration: [s] of each step.
        """
        worth = np.where(margins >= 0, 0.0, inf)
        if self.effort:
            held = margins >= 0
            found = efforts(graph, held) if isinstance(graph, HoldGraph) else triple_efforts(graph, held)
            worth += self.effort * found
        return Costs(worth, self.moves, self.turning, self.time * step_duration + _TIE * self.largest)


def efforts(graph: HoldGraph, wanted: NDArray[np.bool_]) -> Array:
    """(P, O) least largest forces of pairs as multiples of the load; 0 where they are not ``wanted``."""
    pairs, o = np.nonzero(wanted)
    first, second = (ends[pairs] for ends in graph.pairs)
    points = np.array([c.position for c in graph.contacts])
    normals = np.array([c.normal for c in graph.contacts])
    mu = np.array([c.friction for c in graph.contacts])
    limits = np.array([inf if c.max_force is None else c.max_force for c in graph.contacts])
    loads = graph.loads[o]
    ends = [(points[k], normals[k], mu[k]) for k in (first, second)]
    x = best_squeezes(*ends[0], *ends[1], loads, objective="peak", max_force=(limits[first], limits[second]))
    line = points[second] - points[first]
    length = np.hypot(*line.T)
    u = line / length[:, None]
    phi = (u * loads).sum(axis=1)  # the second finger's force along the line is -x - phi
    b = (points[first, 0] * loads[:, 1] - points[first, 1] * loads[:, 0]) / length
    a = -(u[:, 0] * loads[:, 1] - u[:, 1] * loads[:, 0]) - b
    result = np.zeros(wanted.shape)
    size = np.hypot(*graph.load.force)
    result[pairs, o] = np.maximum(np.hypot(x, a), np.hypot(x + phi, b)) / size
    return result


def triple_efforts(graph: TripleGraph, wanted: NDArray[np.bool_]) -> Array:
    """(T, O) least largest forces of triples as multiples of the load; 0 where they are not ``wanted``.

    In the cones themselves, not in the pyramids by which holds are judged.
    """
    from regrasp.planning.states.arrays.many_states import choose_states

    t, o = np.nonzero(wanted)
    result = np.zeros(wanted.shape)
    points = np.array([c.position for c in graph.contacts])
    normals = np.array([c.normal for c in graph.contacts])
    mu = np.array([c.friction for c in graph.contacts])
    limits = np.array([inf if c.max_force is None else c.max_force for c in graph.contacts])
    for begin in range(0, t.size, _AT_ONCE):
        rows, loads = graph.triples[t[begin : begin + _AT_ONCE]], o[begin : begin + _AT_ONCE]
        force, torque = graph.loads[loads, :3], graph.loads[loads, 3:]
        found = choose_states(
            points[rows],
            normals[rows],
            np.maximum(mu[rows], 2 * NEGLIGIBLE),
            force,
            torque,
            objective="peak",
            max_force=limits[rows],
            reserve=0,
        )
        peaks = found.values.copy()
        for k in np.flatnonzero(~found.held).tolist():  # left open by rounding: the graph has forces
            forces = graph.forces(int(t[begin + k]), int(loads[k]))
            peaks[k] = np.linalg.norm(forces, axis=1).max()
        result[t[begin : begin + _AT_ONCE], loads] = peaks / np.linalg.norm(force, axis=1)
    return result

"""What loads need of fingers at the corners of a box, one end or the other of each arc, and states there."""

from math import inf

import numpy as np

from regrasp.errors import Infeasible, RegraspError
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.reserve import RESERVE, kept_friction
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.placement.laws import LAWS
from regrasp.planning.states.choosing import choose_state

_PRECISE = 1e-7


class Corners:
    """Questions about boxes of so many fingers; the corner that was worst is looked at first.

    size: what lengths are measured in [m].
    """

    def __init__(self, fingers: int, loads: Array, size: float) -> None:
        from regrasp.closed_form.compiled.places.placement_search import spare

        wanted = -loads / [1, 1, size]
        self.size, self.unit = size, float(np.abs(wanted).max()) or 1.0
        self._wanted, self._spare = np.ascontiguousarray(wanted / self.unit), spare(fingers, len(loads))
        self._worst = 0

    def need(self, table: Array, friction: float, on: np.ndarray, u: Array, limit: float = inf) -> float:
        """The largest force that a corner needs at least, or one above a limit [N]; infinite for none.

        table: (m, 9) sides, or points, as the compiled search takes them. on, u: (k, 2) where arcs end.
        """
        from regrasp.closed_form.compiled.places.placement_search import value_of

        mu = kept_friction(friction, 2 * RESERVE)
        law = (mu, mu, *LAWS["peak"].codes(), _PRECISE, inf, 0.0)
        most = limit * (1 + _PRECISE) / self.unit
        found, self._worst = value_of(table, self._wanted, law, most, on, u, self._worst, self._spare)
        return float(found) * self.unit

    def hold(self, table: Array, friction: float, on: np.ndarray, u: Array, limit: float) -> bool:
        """Whether all corners need no more than a limit [N]."""
        return self.need(table, friction, on, u, limit) <= limit

    def worst(self, box: Array) -> Array:
        """The corner of a box (k, 2) that needed most, or more than the limit, when last asked."""
        k = np.arange(len(box))
        result: Array = box[k, (self._worst >> k) & 1]
        return result


def states_at(grasp: Grasp, loads: Array, limit: float) -> list[GraspState]:
    """States of a corner, load by load, whose forces are no larger than a limit."""
    states = []
    for load in map(Wrench.from_vector, loads):
        try:  # the least effort is of one answer only, which takes a third of the time of the least peak
            forces = choose_state(grasp, load, "effort", max_force=limit).forces
        except RegraspError as error:
            raise Infeasible(
                f"a corner of the regions was left without forces by rounding: {error}"
            ) from None
        states.append(GraspState(grasp, load, forces))
    return states

"""Forces so large that their rounding exceeds the load.

Doubles of size |f| cancel to 2^-53 |f|, so that forces 2^40 times the load and more balance anything: such a
plan proves nothing of the load, and ``verify`` refuses it. It is refused here, before it is handed out.
"""

from fractions import Fraction
from itertools import pairwise

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.loads.rotated import load_between, turned_load
from regrasp.plans.straight import STRAIGHT
from regrasp.plans.transition import Transition

# Forces below this multiple of the load are balanced to far less than the load.
_NEVER = 2.0**29
# Half of what ``verify`` allows of the load.
_HELD = 2.0**-11


def refuse_lost_load(plan: Transition) -> Transition:
    """The plan, or ``InvalidInput`` where its forces round to more than a thousandth of its load."""
    start, end, is_straight = plan.start, plan.end, plan.path is STRAIGHT
    most = _NEVER * max(map(abs, start.load.plain[: start.grasp.dimension]))
    rows = start.forces.tolist() + end.forces.tolist()
    turn = None if is_straight else plan.turn
    if turn is not None:  # between its ends forces may be larger
        rows += [turn.forces.ravel().tolist(), [] if turn.middles is None else turn.middles.ravel().tolist()]
    known = is_straight or plan.course is None
    if known and not [x for row in rows for x in row if x > most or x < -most]:
        return plan  # nearly all of them, in microseconds
    refuse_lost(plan.grasp, *_held(plan))
    return plan


def refuse_lost(grasp: Grasp, forces: Array, loads: Array) -> None:
    """Raise ``InvalidInput`` where (K, n, w) forces lose the largest of the loads (K, 3 or 6) in rounding."""
    size, most = float(abs(loads / grasp.lengths).max()), float(abs(forces).max())
    if size == 0 or most <= _NEVER * size:
        return
    off = max(_residual(grasp, f, w) for f, w in zip(forces, loads, strict=True))
    if off > _HELD * size:
        raise InvalidInput(
            f"forces up to {most:.3g} N are {most / size:.2g} times the load and round to {off / size:.2g} "
            f"of it, so no plan holds it for sure; limit them by max_force, or take the load for 0"
        )


def _held(plan: Transition) -> tuple[Array, Array]:
    """(K, n, w) forces that decide the plan, and the loads (K, 3) or (K, 6) that they hold."""
    if plan.course is not None:
        return plan.course.forces, plan.course.loads
    turn, load = plan.turn, plan.start.load
    if turn is None:
        return np.stack([plan.start.forces, plan.end.forces]), np.stack([load.vector] * 2)
    angles = turn.angles.tolist()
    loads = [turned_load(load, angle, turn.axis) for angle in angles]
    if turn.middles is None:
        return turn.forces, np.stack([w.vector for w in loads])
    loads += [load_between(load, a, b, turn.axis) for a, b in pairwise(angles)]
    return np.concatenate([turn.forces, turn.middles]), np.stack([w.vector for w in loads])


def _residual(grasp: Grasp, forces: Array, load: Array) -> float:
    """The largest component of G f + w, torques over the arm [N]; products and sums exact."""
    f = [Fraction(x) for x in forces.ravel().tolist()]
    off = [
        abs(sum((Fraction(g) * x for g, x in zip(row, f, strict=True)), start=Fraction(w))) / Fraction(length)
        for row, w, length in zip(grasp.matrix.tolist(), load.tolist(), grasp.lengths.tolist(), strict=True)
    ]
    return float(max(off))

"""Every moment of a plan in order: steps by their clock, and fingers that move while it stands."""

from math import ceil
from typing import NamedTuple

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.plans.regrasp_plan import FingerMove, RegraspPlan
from regrasp.plots.regrasps.moments import Moment, joined, moment_of

LIFT = 0.08
"""A finger in the air keeps this far from where it touched, as a fraction of the object's size."""


class Instant(NamedTuple):
    """When on the plan's clock [s], in which step, whether a finger moves while it stands, what is seen."""

    time: float
    step: int
    moving: bool
    moment: Moment


def timeline(plan: RegraspPlan, rate: float, move_time: float, radius: float) -> list[Instant]:
    """What every frame shows; fingers move before the step they are needed in.

    rate: frames a second [1/s]. move_time: how long a finger is in the air [s]. radius: of the object [m],
    around which they move.
    """
    normals = joined([step.grasp for step in plan.steps])
    lift, far = 2 * LIFT * radius, (1 + 2 * LIFT) * radius
    idle: dict[int, Array] = {}
    frames: list[Instant] = []
    elapsed = 0.0
    for k, step in enumerate(plan.steps):
        for move in (m for m in plan.moves if m.step == k):
            ends = [
                move.origin - lift * normals[move.origin_name],
                move.target - lift * normals[move.target_name],
            ]
            count = max(2, ceil(move_time * rate)) if move_time else 0
            frames += [
                Instant(elapsed, k, True, _moving(plan, k, idle, move, _way(ends[0], ends[1], far, u)))
                for u in np.linspace(0, 1, count).tolist()
            ]
            idle.pop(move.finger, None)
        for t in np.linspace(0, step.duration, max(2, ceil(step.duration * rate) + 1)).tolist():
            frames.append(Instant(elapsed + t, k, False, moment_of(plan, k, t, idle)))
        elapsed += step.duration
        for number_, name in enumerate(plan.fingers[k]):
            if name is not None and name in step.idle_at_end:
                idle[number_] = step.grasp[name].position - lift * normals[name]
    return frames


def _moving(plan: RegraspPlan, k: int, idle: dict[int, Array], move: FingerMove, at: Array) -> Moment:
    """The start of a step, with the arriving finger still in the air."""
    moment = moment_of(plan, k, 0.0, {n: r for n, r in idle.items() if n != move.finger})
    others = tuple(f for f in moment.fingers if f.number != move.finger)
    here = next(f for f in moment.fingers if f.number == move.finger)
    flying = type(here)(here.number, here.name, moment.turn @ at, None, 0.0, np.zeros(at.size))
    return Moment(moment.turn, moment.load, (*others, flying))


def _way(origin: Array, target: Array, far: float, u: float) -> Array:
    """Away from the centre of mass to a distance ``far`` [m], around it the shorter way, and back."""
    a, b = (r / (np.linalg.norm(r) or 1.0) for r in (origin, target))
    across = b - (a @ b) * a
    if np.linalg.norm(across) < 1e-6:  # to the same side, or to the opposite one by any way around
        across = np.eye(a.size)[np.argmin(abs(a))]
        across = across - (across @ a) * a
    across /= np.linalg.norm(across)
    turn = float(np.arctan2(across @ b, a @ b))
    rise, around, fall = (float(np.clip((u - start) / (1 / 3), 0, 1)) for start in (0, 1 / 3, 2 / 3))
    radii = float(np.linalg.norm(origin)), float(np.linalg.norm(target))
    start_or_end, share = (radii[1], 1 - fall) if fall else (radii[0], rise)
    radius = start_or_end + share * max(0.0, far - start_or_end)
    return np.asarray(radius * (np.cos(around * turn) * a + np.sin(around * turn) * across))

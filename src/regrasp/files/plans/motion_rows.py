"""Set-points of positions and forces, read back from a file."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from regrasp.errors import InvalidInput
from regrasp.files.plans.motions_table import motion_columns, orientations
from regrasp.files.plans.setpoint_rows import check_angles, check_quaternions
from regrasp.files.plans.setpoints import check_plan, table_of
from regrasp.mechanics.checks import Array, file_path, number
from regrasp.plans.regrasp_plan import RegraspPlan
from regrasp.plans.transition import Transition

_MANY = 20  # rows of a step from which on most are as far apart as the rate says
_UNEVEN = 1e-6
_ROUNDING = 1e-9  # of the duration: how far a clock that is a sum may be off


class MotionRows(NamedTuple):
    """Set-points of positions, velocities, contacts and forces; k fingers.

    Args:
        times: (m,) rising from 0 [s].
        steps: (m,) from 0, the pause before each included.
        local: (m,) the plan's own time from the start of the step [s].
        positions: (m, k, d) of the tips' centres in the object's frame [m].
        velocities: (m, k, d) of these [m/s].
        touching: (m, k) whether each finger is at a contact.
        forces: (m, k, d) of the fingers on the object [N], (m, k, 4) with soft fingers.
    """

    times: Array
    steps: NDArray[np.intp]
    local: Array
    positions: Array
    velocities: Array
    touching: NDArray[np.bool_]
    forces: Array


def read_motions(path: str | Path, plan: Transition | RegraspPlan, rate: float | None = None) -> MotionRows:
    """The set-points of a file that ``write_motions`` wrote; ``verify_motion_rows`` judges what they say.

    Args:
        path: the file.
        plan: of the motions that were written.
        rate: rows per second that the file must have at the least; None for any even one.

    Raises:
        InvalidInput: For other columns, rows that are not numbers or are missing, clocks and steps that do
            not rise from the plan's start to its end, orientations that are not the plan's, and marks of
            contact that are neither 0 nor 1.
    """
    path = file_path(path)
    check_plan(plan)
    if rate is not None:
        number(rate, "rate", above=0)
    steps = plan.steps if isinstance(plan, RegraspPlan) else (plan,)
    fingers = len(plan.fingers[0]) if isinstance(plan, RegraspPlan) else len(steps[0].grasp)
    d, width = steps[0].grasp.dimension, steps[0].start.forces.shape[1]
    table = table_of(path, motion_columns(d, fingers, width))
    t, clock, which = table[:, 0], table[:, 1], table[:, 2] - 1
    ends = np.cumsum([0.0, *(step.duration for step in steps)])
    slack = _ROUNDING * ends[-1]
    if t[0] != 0 or not (np.diff(t) > 0).all():
        raise InvalidInput(f"{path}: times t must rise from 0")
    _refuse_gaps(path, t, rate, len(steps))
    if (np.diff(which) < 0).any() or set(which.tolist()) != set(range(len(steps))):
        raise InvalidInput(f"{path}: steps must rise from 1 to {len(steps)}, and each have rows")
    k = which.astype(np.intp)
    ran = np.diff(clock)
    ended = abs(clock[-1] - ends[-1]) <= slack
    if clock[0] != 0 or not ended or (ran < 0).any() or (ran > np.diff(t) + slack).any():
        raise InvalidInput(
            f"{path}: the plan's time plan_t must go from 0 to {ends[-1]:g} s, and no faster than t"
        )
    local = clock - ends[k]
    lengths = np.array([step.duration for step in steps])[k]
    if (local < -slack).any() or (local > lengths + slack).any():
        raise InvalidInput(f"{path}: plan_t must lie within the step of its row")
    for s, end in enumerate(ends[1:]):  # where no pause is between, the next step has no row at its start
        if clock[k == s][-1] < end - slack:
            raise InvalidInput(f"{path}: step {s + 1} must have a row at its end")
    local = np.clip(local, 0.0, lengths)
    turned = 1 if d == 2 else 4
    planned, found = orientations(plan, k, local), table[:, 3 : 3 + turned]
    if d == 2:
        check_angles(path, found[:, 0], planned[:, 0])
    else:
        check_quaternions(path, found, planned)
    each = table[:, 3 + turned :].reshape(len(t), fingers, 2 * d + 1 + width)
    marks = each[..., 2 * d]
    if not np.isin(marks, (0.0, 1.0)).all():
        raise InvalidInput(f"{path}: whether a finger touches must be 0 or 1")
    return MotionRows(t, k, local, each[..., :d], each[..., d : 2 * d], marks > 0, each[..., 2 * d + 1 :])


def _refuse_gaps(path: Path, times: Array, rate: float | None, steps: int) -> None:
    """Raise ``InvalidInput`` where a row is missing: rows come evenly, besides those at ends of steps."""
    gaps = np.diff(times)
    if rate is None and gaps.size < _MANY * steps:
        return  # too few to tell how far apart rows are
    spacing = float(np.quantile(gaps, 0.9)) if rate is None else 1 / rate
    if gaps.max() > spacing * (1 + _UNEVEN):
        raise InvalidInput(
            f"{path}: rows must come every {spacing:.9g} s; one is missing after {times[gaps.argmax()]:.9g} s"
        )

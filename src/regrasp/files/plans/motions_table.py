"""Set-points of position, velocity, contact and force of every finger over time, ways included."""

import csv
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from regrasp.disk.staging import whole_file
from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, number
from regrasp.mechanics.orientation.quaternion import quaternion
from regrasp.motions.value import Motions
from regrasp.plans.regrasp_plan import RegraspPlan, rotation_before
from regrasp.plans.transition import Transition

_MOST = 1e6  # rows; hours at a thousand per second are a slip of the pen
_FORCES = ("fx", "fy", "fz", "mn")


def write_motions(motions: Motions, path: str | Path, rate: float = 1000.0) -> None:
    """Write set-points of positions and forces in one table in CSV, pauses in which fingers move included.

    The columns are ``t`` [s]; ``plan_t``, the plan's own time, which stands in pauses [s]; ``step``, from 1,
    the pause before it included; ``angle`` of the object [rad], in space the unit quaternion ``qw``, ``qx``,
    ``qy``, ``qz`` from the object's frame to its frame at the start; and for each finger ``F1_x``, ``F1_y``
    its tip's centre in the object's frame [m], ``F1_vx``, ``F1_vy`` its velocity there [m/s], ``F1_touching``
    1 at a contact and 0 in the air, and ``F1_fx``, ``F1_fy`` its force on the object [N]; in space with a
    ``z`` each. A soft finger's torque about the normal is ``F1_mn`` [N m].

    Args:
        motions: what ``plan_motions`` returns.
        path: the file, in CSV.
        rate: rows per second; both ends of every step have one. Every number reads back as the same double.

    Raises:
        InvalidInput: For a rate of 0 or less, or one that makes more than a million rows; where the file
            cannot be written.
    """
    if not isinstance(motions, Motions):
        raise InvalidInput(f"write_motions needs motions, got {shown(motions)}")
    t = motion_times(motions, rate)
    forces = motions.forces(t)
    turned = orientations(motions.plan, *motions.step_times(t))
    columns = motion_columns(motions.tips.shape[2], *forces.shape[1:])
    numbers = zip(
        np.column_stack([t, motions.plan_time(t)]).tolist(),
        (motions.step_times(t)[0] + 1).tolist(),
        turned.tolist(),
        np.concatenate([motions.positions(t), motions.velocities(t)], axis=2).tolist(),
        motions.touching(t).astype(int).tolist(),
        forces.tolist(),
        strict=True,
    )
    with whole_file(path) as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(columns)
        for clocks, step, turn, places, touching, pushes in numbers:
            own = zip(places, touching, pushes, strict=True)
            rows.writerow([*clocks, step, *turn, *(x for p, on, f in own for x in (*p, on, *f))])


def motion_times(motions: Motions, rate: float) -> Array:
    """(m,) rising times from 0 to the end, ``rate`` a second, both ends of every step among them [s].

    Raises ``InvalidInput`` for a rate of 0 or less, or one that makes more than a million.
    """
    if motions.duration * number(rate, "rate", above=0) > _MOST:
        raise InvalidInput(
            f"rate {rate:g} for {motions.duration:g} s makes {motions.duration * rate:.3g} set-points; "
            f"at most {_MOST:g} are made"
        )
    even = np.arange(int(motions.duration * rate) + 1) / rate
    ends = motions.starts[:-1] + [step.duration for step in motions.steps]
    return np.unique(np.concatenate([even[even <= motions.duration], motions.starts, ends]))


def motion_columns(dimension: int, fingers: int, width: int) -> list[str]:
    """Names of all columns; ``width`` numbers a force."""
    place = [*"xyz"[:dimension], *(f"v{axis}" for axis in "xyz"[:dimension])]
    each = [*place, "touching", *_FORCES[:width]]
    return [
        *("t", "plan_t", "step"),
        *(["angle"] if dimension == 2 else ["qw", "qx", "qy", "qz"]),
        *(f"F{i}_{what}" for i in range(1, fingers + 1) for what in each),
    ]


def orientations(plan: Transition | RegraspPlan, k: NDArray[np.intp], local: Array) -> Array:
    """(m, 1) angles [rad] or (m, 4) quaternions (w, x, y, z) whose sign never jumps.

    k, local: (m,) the step and the time in it [s].
    """
    steps = plan.steps if isinstance(plan, RegraspPlan) else (plan,)
    in_space = steps[0].grasp.dimension == 3
    result = np.zeros((k.size, 4 if in_space else 1))
    for s, step in enumerate(steps):
        here = k == s
        if in_space:
            before = rotation_before(plan, s)
            result[here] = [quaternion(r) for r in before @ step.rotations(local[here])]
        else:
            begun = plan.orientations[s] if isinstance(plan, RegraspPlan) else 0.0
            result[here, 0] = begun + step.orientation(local[here])
    if in_space:
        same = (result[1:] * result[:-1]).sum(axis=1) >= 0
        result[1:] *= np.cumprod(np.where(same, 1.0, -1.0))[:, None]
    return result

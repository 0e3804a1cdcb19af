"""Set-points of a plan as a table in CSV."""

import csv
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.files.source import text_of
from regrasp.files.staging import whole_file
from regrasp.mechanics.checks import Array
from regrasp.planning.regrasp_plan import RegraspPlan
from regrasp.planning.transition import Transition, setpoint_columns
from regrasp.verification import Verification, verify_setpoints

# Rows computed at a time, so that memory does not grow with the duration.
_BLOCK = 8192

# More than a day at 1000 per second; a file of that many rows is a slip of the pen.
_MOST = 1e8

# An angle in a file may differ by this much from the plan's at that time [rad].
_SAME_ANGLE = 1e-9


class Rows(NamedTuple):
    """Set-points of one step, or of a plan that is one transition.

    step: its number, from 0. times: (m,) from its start [s]. angles: (m,) of the object, from its start
    [rad]. forces: (m, n, d) of the step's contacts [N].
    """

    step: int
    times: Array
    angles: Array
    forces: Array


class _Fingers(NamedTuple):
    """Where the fingers are during a step of a regrasp: (F, 2) points, and the number of each one's contact.

    A finger in the air is at its last point, and makes no contact.
    """

    points: Array
    contacts: list[int | None]


def setpoint_blocks(plan: Transition | RegraspPlan, rate: float) -> Iterator[Rows]:
    """All set-points in order, some thousand at a time; both ends of every step have one.

    Raises ``InvalidInput`` for a rate of 0 or less, or one that makes more than 1e8 set-points.
    """
    if plan.duration * rate > _MOST:
        raise InvalidInput(
            f"rate {rate:g} for {plan.duration:g} s makes {plan.duration * rate:.3g} set-points; "
            f"at most {_MOST:g} are made"
        )
    for k, step in enumerate(_steps(plan)):
        times = step.times(rate)
        for first in range(0, times.size, _BLOCK):
            t = times[first : first + _BLOCK]
            yield Rows(k, t, step.orientation(t), step.forces(t))


def checked(plan: Transition | RegraspPlan, rows: Rows) -> Verification:
    """The verdict on set-points of a plan."""
    verdict = verify_setpoints(_steps(plan)[rows.step], rows.forces, rows.times, rows.angles)
    if isinstance(plan, RegraspPlan):
        named = tuple(f"step {rows.step + 1}: {violation}" for violation in verdict.violations)
        return replace(verdict, violations=named)
    return verdict


def write_setpoints(plan: Transition | RegraspPlan, path: str | Path, rate: float = 1000.0) -> None:
    """Write ``t`` [s] and the columns ``<name>_fx``, ``<name>_fy``[, ``<name>_fz``] per contact [N].

    Where the object turns, ``angle`` [rad] follows ``t``. Of a regrasp the columns are ``t``, ``angle``,
    ``step`` (from 1) and ``F1_x``, ``F1_y``, ``F1_fx``, ``F1_fy`` per finger: its contact point and its force
    in the object frame. A finger in the air stays at its last point, without force; it moves between the last
    row of a step and the first row of the next, which have the same time.

    rate: rows per second; both ends of the plan, and of every step, have a row. Every number reads back as
    the same double.
    Raises ``InvalidInput`` as ``setpoint_blocks`` does, and where the file cannot be written.
    """
    blocks = setpoint_blocks(plan, rate)
    with whole_file(path) as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(_columns(plan))
        if isinstance(plan, RegraspPlan):
            starts, fingers = _starts(plan), _fingers(plan)
            for block in blocks:
                table = _whole_rows(plan, block, starts[block.step], fingers[block.step])
                rows.writerows([t, angle, block.step + 1, *rest] for t, angle, *rest in table.tolist())
            return
        for _, t, angles, forces in blocks:
            turned = [] if plan.turn is None else [angles]
            rows.writerows(np.column_stack([t, *turned, forces.reshape(t.size, -1)]).tolist())


def read_setpoints(path: str | Path, plan: Transition | RegraspPlan) -> list[Rows]:
    """The set-points of a file that ``write_setpoints`` wrote for this plan, one entry for each step.

    Raises ``InvalidInput`` for other columns, rows that are not numbers, times that do not rise from 0 to the
    duration, and angles, steps and finger positions that are not the plan's.
    """
    path = Path(path)
    header, *lines = text_of(path, "set-points in CSV").splitlines() or [""]
    columns = _columns(plan)
    if header.split(",") != columns:
        raise InvalidInput(f"{path}: expected the columns {','.join(columns)}, got {header[:200]}")
    try:
        table = np.array([[float(x) for x in line.split(",")] for line in lines], dtype=float)
    except ValueError as error:
        raise InvalidInput(f"{path}: expected rows of {len(columns)} numbers: {error}") from None
    if table.ndim != 2 or table.shape[1] != len(columns) or not np.isfinite(table).all():
        raise InvalidInput(f"{path}: expected rows of {len(columns)} finite numbers")
    if isinstance(plan, RegraspPlan):
        return _read_regrasp(path, plan, table)
    times = table[:, 0]
    _check_times(path, times, 0.0, plan.duration)
    turned = 0 if plan.turn is None else 1
    angles = plan.orientation(times)
    if turned:
        _check_angles(path, table[:, 1], angles)
        angles = table[:, 1]
    return [Rows(0, times, angles, table[:, 1 + turned :].reshape(times.size, *plan.start.forces.shape))]


def _read_regrasp(path: Path, plan: RegraspPlan, table: Array) -> list[Rows]:
    steps, result = table[:, 2], []
    if (np.diff(steps) < 0).any() or set(steps.tolist()) != set(range(1, len(plan.steps) + 1)):
        raise InvalidInput(f"{path}: steps must rise from 1 to {len(plan.steps)}, and each have rows")
    places = zip(_starts(plan), _fingers(plan), strict=True)
    for k, (step, (start, (points, contacts))) in enumerate(zip(plan.steps, places, strict=True)):
        here = table[steps == k + 1]
        _check_times(path, here[:, 0], start, start + step.duration)
        times = np.clip(here[:, 0] - start, 0.0, step.duration)
        angles = here[:, 1] - plan.orientations[k]
        _check_angles(path, angles, step.orientation(times))
        fingers = here[:, 3:].reshape(len(here), len(contacts), 4)
        forces = np.empty((len(here), len(step.grasp), 2))
        for i, contact in enumerate(contacts):
            if (fingers[:, i, :2] != points[i]).any():
                x, y = points[i].tolist()
                raise InvalidInput(f"{path}: F{i + 1} must be at ({x!r}, {y!r}) all through step {k + 1}")
            if contact is not None:
                forces[:, contact] = fingers[:, i, 2:]
            elif fingers[:, i, 2:].any():
                raise InvalidInput(f"{path}: F{i + 1} is in the air in step {k + 1} and carries no force")
        result.append(Rows(k, times, angles, forces))
    return result


def _check_times(path: Path, times: Array, start: float, end: float) -> None:
    if times[0] != start or times[-1] != end or not (np.diff(times) > 0).all():
        raise InvalidInput(f"{path}: times must rise from {start:g} to {end!r} s")


def _check_angles(path: Path, angles: Array, planned: Array) -> None:
    off = float(abs(angles - planned).max())
    if off > _SAME_ANGLE:
        raise InvalidInput(f"{path}: angles must be the plan's at these times; one is off by {off:.3g} rad")


def _steps(plan: Transition | RegraspPlan) -> tuple[Transition, ...]:
    return plan.steps if isinstance(plan, RegraspPlan) else (plan,)


def _columns(plan: Transition | RegraspPlan) -> list[str]:
    if isinstance(plan, RegraspPlan):
        fingers = range(1, len(plan.steps[0].grasp) + 1)
        return ["t", "angle", "step", *(f"F{i}_{what}" for i in fingers for what in ("x", "y", "fx", "fy"))]
    return ["t", *([] if plan.turn is None else ["angle"]), *setpoint_columns(plan.grasp)]


def _starts(plan: RegraspPlan) -> list[float]:
    """The time at which each step starts [s]."""
    ends = np.cumsum([step.duration for step in plan.steps])
    return [0.0, *ends[:-1].tolist()]


def _fingers(plan: RegraspPlan) -> list[_Fingers]:
    points, result = plan.steps[0].grasp.positions.copy(), []
    for step, names in zip(plan.steps, plan.fingers, strict=True):
        contacts = [None if name is None else step.grasp.index(name) for name in names]
        for i, contact in enumerate(contacts):
            if contact is not None:
                points[i] = step.grasp.positions[contact]
        result.append(_Fingers(points.copy(), contacts))
    return result


def _whole_rows(plan: RegraspPlan, rows: Rows, start: float, fingers: _Fingers) -> Array:
    """(m, 2 + 4 F) rows of a regrasp's table, without the column ``step``."""
    count = rows.times.size
    table = np.zeros((count, len(fingers.contacts), 4))
    table[:, :, :2] = fingers.points
    for i, contact in enumerate(fingers.contacts):
        if contact is not None:
            table[:, i, 2:] = rows.forces[:, contact]
    angles = plan.orientations[rows.step] + rows.angles
    return np.column_stack([start + rows.times, angles, table.reshape(count, -1)])

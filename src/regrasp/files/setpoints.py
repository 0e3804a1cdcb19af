"""Set-points of a plan as a table in CSV."""

import csv
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.files.source import text_of
from regrasp.files.staging import whole_file
from regrasp.mechanics.checks import Array
from regrasp.planning.transition import Transition, setpoint_columns

# Rows computed at a time, so that memory does not grow with the duration.
_BLOCK = 8192

# More than a day at 1000 per second; a file of that many rows is a slip of the pen.
_MOST = 1e8


def setpoint_blocks(plan: Transition, rate: float) -> Iterator[tuple[Array, Array]]:
    """Times (m,) [s] and forces (m, n, d) [N] of all set-points in order, some thousand at a time.

    Raises ``InvalidInput`` for a rate of 0 or less, or one that makes more than 1e8 set-points.
    """
    if plan.duration * rate > _MOST:
        raise InvalidInput(
            f"rate {rate:g} for {plan.duration:g} s makes {plan.duration * rate:.3g} set-points; "
            f"at most {_MOST:g} are made"
        )
    times = plan.times(rate)
    for first in range(0, times.size, _BLOCK):
        t = times[first : first + _BLOCK]
        yield t, plan.forces(t)


def write_setpoints(plan: Transition, path: str | Path, rate: float = 1000.0) -> None:
    """Write ``t`` [s] and the columns ``<name>_fx``, ``<name>_fy``[, ``<name>_fz``] per contact [N].

    rate: rows per second; both ends of the plan have a row. Every number reads back as the same double.
    Raises ``InvalidInput`` as ``setpoint_blocks`` does, and where the file cannot be written.
    """
    blocks = setpoint_blocks(plan, rate)
    with whole_file(path) as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["t", *setpoint_columns(plan.grasp)])
        for t, forces in blocks:
            rows.writerows(np.column_stack([t, forces.reshape(t.size, -1)]).tolist())


def read_setpoints(path: str | Path, plan: Transition) -> tuple[Array, Array]:
    """Times (m,) [s] and forces (m, n, d) [N] of a file that ``write_setpoints`` wrote for this plan.

    Raises ``InvalidInput`` for other columns, rows that are not numbers, and times that do not rise from 0
    to the plan's duration.
    """
    path = Path(path)
    header, *lines = text_of(path, "set-points in CSV").splitlines() or [""]
    columns = ["t", *setpoint_columns(plan.grasp)]
    if header.split(",") != columns:
        raise InvalidInput(f"{path}: expected the columns {','.join(columns)}, got {header[:200]}")
    try:
        rows = np.array([[float(x) for x in line.split(",")] for line in lines], dtype=float)
    except ValueError as error:
        raise InvalidInput(f"{path}: expected rows of {len(columns)} numbers: {error}") from None
    if rows.ndim != 2 or rows.shape[1] != len(columns) or not np.isfinite(rows).all():
        raise InvalidInput(f"{path}: expected rows of {len(columns)} finite numbers")
    times = rows[:, 0]
    if times[0] != 0 or times[-1] != plan.duration or not (np.diff(times) > 0).all():
        raise InvalidInput(f"{path}: times must rise from 0 to {plan.duration!r} s")
    return times, rows[:, 1:].reshape(times.size, *plan.start.forces.shape)

"""Set-points of a plan as a table in CSV."""

import csv
from array import array
from collections.abc import Iterator
from dataclasses import replace
from io import StringIO
from pathlib import Path

import numpy as np

from regrasp.disk.staging import whole_file
from regrasp.errors import InvalidInput, shown
from regrasp.files.plans.regrasp_table import RegraspTable
from regrasp.files.plans.setpoint_rows import Rows, check_angles, check_spacing, check_times
from regrasp.files.source import text_of
from regrasp.mechanics.checks import Array, file_path, number
from regrasp.mechanics.value import one_line
from regrasp.plans.regrasp_plan import RegraspPlan
from regrasp.plans.transition import Transition, setpoint_columns
from regrasp.verification import Verification, verify_setpoints

# Rows computed at a time, so that memory does not grow with the duration.
_BLOCK = 8192

# More than a day at 1000 per second; a file of that many rows is a slip of the pen.
_MOST = 1e8
# Of a file that is read: some hours at 1000 rows per second.
_MOST_BYTES = 2**28


def setpoint_blocks(plan: Transition | RegraspPlan, rate: float) -> Iterator[Rows]:
    """All set-points in order, some thousand at a time; both ends of every step have one.

    Raises ``InvalidInput`` for a rate of 0 or less, or one that makes more than 1e8 set-points.
    """
    check_plan(plan)
    check_rate(rate, plan.duration)
    for k, step in enumerate(_steps(plan)):
        times = step.times(rate)
        for first in range(0, times.size, _BLOCK):
            t = times[first : first + _BLOCK]
            yield Rows(k, t, step.orientation(t), step.forces(t))


def check_rate(rate: float, duration: float) -> None:
    """Raise ``InvalidInput`` for a rate of 0 or less, or one that makes more than 1e8 set-points."""
    if duration * number(rate, "rate", above=0) > _MOST:
        raise InvalidInput(
            f"rate {rate:g} for {duration:g} s makes {duration * rate:.3g} set-points; "
            f"at most {_MOST:g} are made"
        )


def checked(plan: Transition | RegraspPlan, rows: Rows) -> Verification:
    """The verdict on set-points of a plan."""
    verdict = verify_setpoints(_steps(plan)[rows.step], rows.forces, rows.times, rows.angles)
    if isinstance(plan, RegraspPlan):
        named = tuple(f"step {rows.step + 1}: {violation}" for violation in verdict.violations)
        return replace(verdict, violations=named)
    return verdict


def write_setpoints(plan: Transition | RegraspPlan, path: str | Path, rate: float = 1000.0) -> None:
    """Write ``t`` [s] and the columns ``<name>_fx``, ``<name>_fy``[, ``<name>_fz``] per contact [N].

    With soft fingers ``<name>_mn`` follows, the torque about the normal [N m]. Where the object turns,
    ``angle`` [rad] follows ``t``. Of a regrasp the columns are ``t``, ``angle``, ``step`` (from 1) and
    ``F1_x``, ``F1_y``, ``F1_fx``, ``F1_fy`` per finger: its contact point and its force in the object frame.
    A finger in the air stays at its last point, without force; it moves between the last row of a step and
    the first row of the next, which have the same time. In space points and forces have a ``z``, and in
    the place of ``angle`` stand ``qw``, ``qx``, ``qy``, ``qz``, the unit quaternion from the object's frame
    to its frame at the start; its sign never jumps.

    Args:
        plan: a ``Transition`` or a ``RegraspPlan``.
        path: the file, in CSV.
        rate: rows per second; both ends of the plan, and of every step, have a row. Every number reads back
            as the same double.

    Raises:
        InvalidInput: As ``setpoint_blocks`` does, and where the file cannot be written.
    """
    check_plan(plan)
    blocks = setpoint_blocks(plan, rate)
    with whole_file(path) as file:
        rows = csv.writer(file, lineterminator="\n")
        columns = _columns(plan)
        strange = any("\r" in column for column in columns)  # which csv leaves bare
        csv.writer(
            file, lineterminator="\n", quoting=csv.QUOTE_ALL if strange else csv.QUOTE_MINIMAL
        ).writerow(columns)
        if isinstance(plan, RegraspPlan):
            table = RegraspTable(plan)
            for block in blocks:
                rows.writerows(table.rows(block))
            return
        for _, t, angles, forces in blocks:
            turned = [] if plan.turn is None else [angles]
            rows.writerows(np.column_stack([t, *turned, forces.reshape(t.size, -1)]).tolist())


def read_setpoints(path: str | Path, plan: Transition | RegraspPlan, rate: float | None = None) -> list[Rows]:
    """The set-points of a file that ``write_setpoints`` wrote for this plan, one entry for each step.

    rate: rows per second that the file must have; None for any even one.
    Raises ``InvalidInput`` for other columns, rows that are not numbers, times that do not rise evenly from 0
    to the duration, and angles, steps and finger positions that are not the plan's (``checked``: forces).
    """
    path = file_path(path)
    check_plan(plan)
    if rate is not None:
        number(rate, "rate", above=0)
    columns = _columns(plan)
    table = table_of(path, columns)
    if isinstance(plan, RegraspPlan):
        return RegraspTable(plan).read(path, table, rate)
    times = table[:, 0]
    check_times(path, times, 0.0, plan.duration)
    check_spacing(path, [(times, plan.duration)], rate)
    turned = 0 if plan.turn is None else 1
    angles = plan.orientation(times)
    if turned:
        check_angles(path, table[:, 1], angles)
        angles = table[:, 1]
    return [Rows(0, times, angles, table[:, 1 + turned :].reshape(times.size, *plan.start.forces.shape))]


def table_of(path: Path, columns: list[str]) -> Array:
    """(m, k) the numbers below a header of ``columns``; names may be quoted, as CSV quotes them."""
    numbers = array("d")
    with StringIO(text_of(path, "set-points in CSV", most=_MOST_BYTES), newline="") as text:
        rows = csv.reader(text, strict=True)
        try:
            header = next(rows, [])
            if header != columns:
                raise InvalidInput(f"{path}: expected the columns {_shown(columns)}, got {_shown(header)}")
            for row in rows:
                if len(row) != len(columns):
                    raise ValueError(f"line {rows.line_num} has {len(row)}")
                numbers.extend(map(float, row))
        except (csv.Error, ValueError) as error:
            if isinstance(error, InvalidInput):
                raise
            raise InvalidInput(f"{path}: expected rows of {len(columns)} numbers: {error}") from None
    table = np.frombuffer(numbers).reshape(-1, len(columns)) if numbers else np.empty((0, len(columns)))
    if not len(table) or not np.isfinite(table).all():
        raise InvalidInput(f"{path}: expected rows of {len(columns)} finite numbers")
    return table


def _shown(columns: list[str]) -> str:
    """A header as one line of a message."""
    with StringIO() as line:
        csv.writer(line, lineterminator="").writerow(columns)
        return one_line(line.getvalue())[:200]


def check_plan(plan: object) -> None:
    """Raise ``InvalidInput`` for what set-points are not of."""
    if not isinstance(plan, (Transition, RegraspPlan)):
        raise InvalidInput(f"set-points are of a Transition or a RegraspPlan, got {shown(plan)}")


def _steps(plan: Transition | RegraspPlan) -> tuple[Transition, ...]:
    return plan.steps if isinstance(plan, RegraspPlan) else (plan,)


def _columns(plan: Transition | RegraspPlan) -> list[str]:
    if isinstance(plan, RegraspPlan):
        return RegraspTable(plan).columns
    return ["t", *([] if plan.turn is None else ["angle"]), *setpoint_columns(plan.grasp)]

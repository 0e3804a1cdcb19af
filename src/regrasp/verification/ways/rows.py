"""The verdict on set-points of positions, velocities, contacts and forces, row by row, without the shape."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from regrasp.mechanics.checks import Array
from regrasp.mechanics.value import ArrayValue
from regrasp.verification.sampling import verify_setpoints
from regrasp.verification.ways.held import Bools, contacts_of, jumps, lost, touched
from regrasp.verification.ways.verdict import Moving

_ROUNDING = 1e-12  # of the duration
_CLOCK = 1e-9  # of the duration: how far a clock that is a sum may be off
_SAME = 1e-9  # of the size of the grasps: places that are one


class MovedRows(Protocol):
    """Set-points of k fingers at m times, the pauses of the plan's clock included."""

    @property
    def times(self) -> Array: ...  # noqa: D102
    @property
    def steps(self) -> NDArray[np.intp]: ...  # noqa: D102
    @property
    def local(self) -> Array: ...  # noqa: D102
    @property
    def positions(self) -> Array: ...  # noqa: D102
    @property
    def velocities(self) -> Array: ...  # noqa: D102
    @property
    def touching(self) -> NDArray[np.bool_]: ...  # noqa: D102
    @property
    def forces(self) -> Array: ...  # noqa: D102


@dataclass(frozen=True, eq=False)
class MotionRowsVerification(ArrayValue):
    """The verdict on set-points of positions and forces.

    Args:
        violations: each broken condition in words; none for rows that keep everything.
        tip_radius: of the fingers, from where they touch [m].
        to_fingers: the least distance of two tips' surfaces [m]; infinite where there is one finger.
        touching: how many fingers are at contacts, at the least.
        rows: how many there are.
    """

    violations: tuple[str, ...]
    tip_radius: float
    to_fingers: float
    touching: int
    rows: int

    @property
    def ok(self) -> bool:
        """Whether every row holds the object, and fingers neither jump nor let go of a contact."""
        return not self.violations

    def __str__(self) -> str:
        if not self.ok:
            return "\n".join(["set-points not verified:", *(f"  {words}" for words in self.violations)])
        return (
            f"{self.rows} set-points of positions and forces verified: tips of radius {self.tip_radius:.4g} "
            f"keep {self.to_fingers:.4g} from one another, {self.touching} or more touch at every row"
        )


def verify_motion_rows(plan: Any, rows: MovedRows, ways: Moving | None = None) -> MotionRowsVerification:
    """Check rows of set-points against their plan.

    Times rise from 0, and every step is gone through from its start to its end, no faster than the plan.
    Forces at contacts hold the object and are the plan's, and there are none in the air; positions move as
    velocities say; a finger that is said to touch is at a contact of the plan, one radius off it, every
    contact of a step has a finger all through it, and two fingers, in space three, touch at every row. Tips
    are not in one another. What the shape decides is a matter of ``verify_motions``, which judges ways
    between rows, too: with ``ways`` positions must be those of the ways at every row.

    Args:
        plan: the transition or regrasp that they are of.
        rows: as ``files.read_motions`` returns them.
        ways: of the fingers, as ``plan_motions`` or ``files.read_ways`` returns them; not compared with if
            not given.
    """
    steps = getattr(plan, "steps", (plan,))
    broken = list(_unfit(steps, rows))
    if broken:
        return MotionRowsVerification(tuple(broken), np.nan, np.nan, 0, len(rows.times))
    near = _SAME * max(step.grasp.size for step in steps)
    radius = _radius(steps, rows, near)
    on = touched(steps, rows.positions, rows.touching, radius, near)
    during = [_during(rows, s) for s in range(len(steps))]
    violations = [
        *jumps(rows.times, rows.positions, rows.velocities, near),
        *lost(rows.times, steps, during, rows.touching, on, rows.positions.shape[2]),
        *_forces(steps, rows, on),
    ]
    if ways is not None:
        violations += _off_ways(rows, ways, near)
    apart = [
        np.linalg.norm(rows.positions[:, i] - rows.positions[:, j], axis=1).min() - 2 * radius
        for i, j in combinations(range(rows.positions.shape[1]), 2)
    ]
    to_fingers = float(min(apart, default=np.inf))
    if not to_fingers >= -near:
        violations.append(f"two tips are in one another by {-to_fingers:.3g}")
    least = int(rows.touching.sum(axis=1).min())
    return MotionRowsVerification(tuple(violations), radius, to_fingers, least, rows.times.size)


def _unfit(steps: Any, rows: MovedRows) -> Iterator[str]:
    """Shapes and clocks that nothing can be compared with."""
    shape = np.shape(rows.positions)
    for name, wanted in (
        ("times", shape[:1]), ("steps", shape[:1]), ("local", shape[:1]), ("velocities", shape),
        ("touching", shape[:2]), ("forces", (*shape[:2], *np.shape(rows.forces)[-1:])),
    ):  # fmt: skip
        if len(shape) != 3 or np.shape(getattr(rows, name)) != wanted or not all(shape):
            yield f"{name} of rows do not go with positions of shape {shape}"
            return
    times, which = rows.times, rows.steps
    lengths = np.array([step.duration for step in steps])
    begin, slack = np.cumsum(lengths) - lengths, _CLOCK * lengths.sum()
    if not (np.isfinite(times).all() and times[0] == 0 and (np.diff(times) >= 0).all()):
        yield "times of rows must rise from 0"
    elif set(which.tolist()) != set(range(len(steps))) or (np.diff(which) < 0).any():
        yield f"steps of rows must rise from 1 to {len(steps)}, and each have rows"
    else:
        local = rows.local
        ran = np.diff(begin[which] + local)
        last = local[np.flatnonzero(np.diff(which, append=len(steps)))]
        within = (local >= 0) & (local <= lengths[which])
        whole = within.all() and local[0] <= slack and (last >= lengths - slack).all()
        if not (whole and (ran >= -slack).all() and (ran <= np.diff(times) + slack).all()):
            yield "rows must go through every step from its start to its end, no faster than the plan"


def _off_ways(rows: MovedRows, ways: Moving, near: float) -> Iterator[str]:
    """Where rows are not on the ways, or last otherwise."""
    if not abs(rows.times[-1] - ways.duration) <= _ROUNDING * ways.duration:
        yield f"rows last {rows.times[-1]:.9g} s, the ways {ways.duration:.9g} s"
        return
    off = np.linalg.norm(rows.positions - ways.positions(np.minimum(rows.times, ways.duration)), axis=2)
    if not off.max() <= near:  # which no number fails, too
        k, i = np.unravel_index(off.argmax(), off.shape)
        yield f"finger {i + 1} is {off[k, i]:.3g} off its way at {rows.times[k]:.6g} s"


def _radius(steps: Any, rows: MovedRows, near: float) -> float:
    """How far the first tip that touches is off the nearest contact on whose normal it is; else no number."""
    found = []
    for tip in rows.positions[rows.touching][:1]:
        for contact in contacts_of(steps).values():
            off = contact.position - tip
            away = float(off @ contact.normal)
            if away >= -near and np.linalg.norm(off - away * contact.normal) <= near:
                found.append(max(away, 0.0))
    return min(found, default=float("nan"))


def _during(rows: MovedRows, step: int) -> NDArray[np.intp]:
    """Rows of a step, of those at its start the last and of those at its end the first."""
    own = np.flatnonzero(rows.steps == step)
    local = rows.local[own]
    begin, end = np.flatnonzero(local == local[0])[-1], np.flatnonzero(local == local[-1])[0]
    return np.asarray(own[begin : end + 1])


def _forces(steps: Any, rows: MovedRows, on: dict[str, Bools]) -> Iterator[str]:
    """Forces in the air, such as do not hold the object or are not the plan's, or change in pauses."""
    pushes = rows.forces.any(axis=2) & ~np.logical_or.reduce(list(on.values()))
    if pushes.any():
        k, i = np.argwhere(pushes)[0]
        yield f"finger {i + 1} has a force in the air at {rows.times[k]:.6g} s"
    for s, step in enumerate(steps):
        own = np.flatnonzero(rows.steps == s)
        local = rows.local[own]
        forces = np.stack(
            [(rows.forces[own] * on[str(n)][own][..., None]).sum(axis=1) for n in step.grasp.names], axis=1
        )
        moved = np.append(True, np.diff(local) > 0)
        still = np.flatnonzero(~moved)
        if (forces[still] != forces[still - 1]).any():
            yield f"before or after step {s + 1} forces change while the plan's clock stands"
        verdict = verify_setpoints(step, forces[moved], local[moved], step.orientation(local[moved]))
        yield from (f"step {s + 1}: {violation}" for violation in verdict.violations)

"""Set-points of a whole regrasp as a table: orientation, step, and point and force of every finger."""

from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.files.plans.setpoint_rows import (
    Rows,
    check_angles,
    check_quaternions,
    check_spacing,
    check_times,
)
from regrasp.mechanics.checks import Array
from regrasp.mechanics.orientation.quaternion import about, conjugate, product, quaternion
from regrasp.plans.regrasp_plan import RegraspPlan
from regrasp.plans.transition import Transition

_FORCES = ("fx", "fy", "fz", "mn")  # the last one is a soft finger's torque


class _Fingers(NamedTuple):
    """Where the fingers are during a step: (F, d) points, and the number of each one's contact.

    A finger in the air is at its last point, and makes no contact.
    """

    points: Array
    contacts: list[int | None]


class RegraspTable:
    """The columns of a regrasp's set-points, its rows, and the way back from them.

    Before ``step`` stand ``t`` and in the plane ``angle``; in space the unit quaternion ``qw``, ``qx``,
    ``qy``, ``qz`` from the object's frame to its frame at the start, whose sign never jumps.
    """

    def __init__(self, plan: RegraspPlan) -> None:
        self.plan = plan
        self._width = plan.steps[0].start.forces.shape[1]  # numbers per force

    @property
    def columns(self) -> list[str]:
        """Names of all columns."""
        orientation = ["qw", "qx", "qy", "qz"] if self._in_space else ["angle"]
        per_finger = [*"xyz"[: self._dimension], *_FORCES[: self._width]]
        fingers = range(1, len(self.plan.steps[0].grasp) + 1)
        return ["t", *orientation, "step", *(f"F{i}_{what}" for i in fingers for what in per_finger)]

    def rows(self, setpoints: Rows) -> list[list[float]]:
        """Set-points of one step as rows; the step is a whole number."""
        k, count = setpoints.step, setpoints.times.size
        points, contacts = self._fingers[k]
        forces = np.zeros((count, len(contacts), self._width))
        for i, contact in enumerate(contacts):
            if contact is not None:
                forces[:, i] = setpoints.forces[:, contact]
        places = np.broadcast_to(points, (count, *points.shape))
        fingers = np.concatenate([places, forces], axis=-1).reshape(count, -1)
        turned = self._orientations(k, setpoints.angles)
        whole = np.column_stack([self._starts[k] + setpoints.times, turned, fingers]).tolist()
        before = 1 + turned.shape[1]
        return [[*row[:before], k + 1, *row[before:]] for row in whole]

    def read(self, path: Path, table: Array, rate: float | None = None) -> list[Rows]:
        """The set-points of each step from all rows. Raises ``InvalidInput`` for those of another plan."""
        plan, d, first = self.plan, self._dimension, self.columns.index("step")
        steps, result = table[:, first], []
        if (np.diff(steps) < 0).any() or set(steps.tolist()) != set(range(1, len(plan.steps) + 1)):
            raise InvalidInput(f"{path}: steps must rise from 1 to {len(plan.steps)}, and each have rows")
        parts = [table[steps == k + 1] for k in range(len(plan.steps))]
        for here, step, start in zip(parts, plan.steps, self._starts, strict=True):
            check_times(path, here[:, 0], start, start + step.duration)
        local = [here[:, 0] - start for here, start in zip(parts, self._starts, strict=True)]
        durations = [step.duration for step in plan.steps]
        spacing = check_spacing(path, list(zip(local, durations, strict=True)), rate)
        for k, (step, start) in enumerate(zip(plan.steps, self._starts, strict=True)):
            here, (points, contacts) = parts[k], self._fingers[k]
            times = _unrounded(here[:, 0], start, step.duration, spacing)
            angles = self._angles(path, k, here[:, 1:first], step.orientation(times))
            fingers = here[:, first + 1 :].reshape(len(here), len(contacts), d + self._width)
            forces = np.empty((len(here), len(step.grasp), self._width))
            for i, contact in enumerate(contacts):
                if (fingers[:, i, :d] != points[i]).any():
                    place = ", ".join(map(repr, points[i].tolist()))
                    raise InvalidInput(f"{path}: F{i + 1} must be at ({place}) all through step {k + 1}")
                if contact is not None:
                    forces[:, contact] = fingers[:, i, d:]
                elif fingers[:, i, d:].any():
                    raise InvalidInput(f"{path}: F{i + 1} is in the air in step {k + 1} and carries no force")
            result.append(Rows(k, times, angles, forces))
        return result

    @property
    def _in_space(self) -> bool:
        return self.plan.rotations is not None

    @property
    def _dimension(self) -> int:
        return self.plan.steps[0].grasp.dimension

    @cached_property
    def _starts(self) -> list[float]:
        """The time at which each step starts [s]."""
        ends = np.cumsum([step.duration for step in self.plan.steps])
        return [0.0, *ends[:-1].tolist()]

    @cached_property
    def _fingers(self) -> list[_Fingers]:
        points, result = self.plan.steps[0].grasp.positions.copy(), []
        for step, names in zip(self.plan.steps, self.plan.fingers, strict=True):
            contacts = [None if name is None else step.grasp.index(name) for name in names]
            for i, contact in enumerate(contacts):
                if contact is not None:
                    points[i] = step.grasp.positions[contact]
            result.append(_Fingers(points.copy(), contacts))
        return result

    def _orientations(self, k: int, angles: Array) -> Array:
        """(m, 1) angles or (m, 4) quaternions of the object, when it turned by ``angles`` in a step."""
        if not self._in_space:
            return (self.plan.orientations[k] + angles)[:, None]
        return product(self._quaternions[k], _turned(self.plan.steps[k], angles))

    def _angles(self, path: Path, k: int, orientations: Array, planned: Array) -> Array:
        """(m,) turns [rad] in a step from ``orientations``, which must be those of ``planned`` turns."""
        if not self._in_space:
            angles: Array = orientations[:, 0] - self.plan.orientations[k]
            check_angles(path, angles, planned)
            return angles
        check_quaternions(path, orientations, self._orientations(k, planned))
        turn = self.plan.steps[k].turn
        if turn is None or turn.axis is None:
            return planned
        w, *v = product(conjugate(self._quaternions[k]), orientations).T
        found = 2 * np.arctan2(turn.axis @ np.array(v), w)
        off = found - planned
        result: Array = planned + (off - 4 * np.pi * np.round(off / (4 * np.pi)))
        return result

    @cached_property
    def _quaternions(self) -> list[Array]:
        """(4,) at the start of each step, with the sign that follows from the step before."""
        assert self.plan.rotations is not None
        result = [quaternion(self.plan.rotations[0])]
        for step, rotation in zip(self.plan.steps[:-1], self.plan.rotations[1:-1], strict=True):
            last = product(result[-1], _turned(step, step.orientation([step.duration])))[0]
            given = quaternion(rotation)
            result.append(given if given @ last >= 0 else -given)
        return result


def _unrounded(times: Array, start: float, duration: float, spacing: float) -> Array:
    """Times from the start of a step: those of even rows, where they are these but for rounding."""
    even = spacing * np.arange(times.size)
    even[-1] = duration
    same = abs(start + even - times) <= 2 * np.spacing(times)
    result: Array = np.clip(np.where(same, even, times - start), 0.0, duration)
    return result


def _turned(step: Transition, angles: Array) -> Array:
    """(m, 4) of the object turned by ``angles`` [rad] within a step."""
    if step.turn is None or step.turn.axis is None:
        return np.tile([1.0, 0.0, 0.0, 0.0], (angles.size, 1))
    return about(step.turn.axis, angles)

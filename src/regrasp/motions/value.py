"""Motions of the fingers that are free while others hold."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike
from regrasp.mechanics.value import ArrayValue
from regrasp.motions.rounded import RoundedWay
from regrasp.plans.regrasp_plan import RegraspPlan
from regrasp.plans.transition import Transition


@dataclass(frozen=True, eq=False)
class Motion(ArrayValue):
    """One finger's way before a step, in the object's frame; others may move meanwhile.

    step: the step before which it arrives; the number of steps for what follows the last. finger: its number.
    origin, target: contacts between which it goes, the same for one that lifts off, waits or touches down
    only.
    way: of the tip's centre. duration: [s]. start: when it begins, on the clock of ``Motions`` [s].
    to_object, to_tips: how far the tip's surface keeps from the object away from its own contacts, and from
    other tips, exact for the rounded way or less; infinite where there is nothing [m].
    """

    step: int
    finger: int
    origin: str
    target: str
    way: RoundedWay
    duration: float
    start: float
    to_object: float
    to_tips: float

    @property
    def end(self) -> float:
        """When it is over, on the clock of ``Motions`` [s]."""
        return self.start + self.duration


@dataclass(frozen=True, eq=False)
class Motions(ArrayValue):
    """A plan with the ways of its free fingers: the clock stands for a step while fingers move before it.

    plan, motions: in order. tips: (steps + 1, k, d) where the tips' centres are during each step, and at last
    [m]. contacts: (steps + 1, k) whether each finger is at its contact then.
    tip_radius, clearance: as asked for [m]. capsules: (k, d) from each tip's centre to its finger's other
    end, in the object's frame, zero for a disc or a sphere [m].
    """

    plan: Transition | RegraspPlan
    motions: tuple[Motion, ...]
    tips: Array
    contacts: NDArray[np.bool_]
    tip_radius: float
    clearance: float
    capsules: Array

    @property
    def steps(self) -> tuple[Transition, ...]:
        """Those of the plan."""
        return (self.plan,) if isinstance(self.plan, Transition) else self.plan.steps

    @cached_property
    def starts(self) -> Array:
        """(steps + 1,) when each step begins on this clock, and when everything has ended [s]."""
        begun, over = [], 0.0
        for k, length in enumerate([*(step.duration for step in self.steps), 0.0]):
            begun.append(max([over, *(m.end for m in self.motions if m.step == k)]))
            over = begun[-1] + length
        return np.array(begun)

    def pause(self, step: int) -> float:
        """How long the plan's clock stands before a step, or after the last, while fingers move [s]."""
        over = self.starts[step - 1] + self.steps[step - 1].duration if step else 0.0
        return float(self.starts[step] - over)

    @property
    def duration(self) -> float:
        """Of steps and motions together [s]."""
        return float(self.starts[-1])

    def positions(self, t: ArrayLike) -> Array:
        """(m, k, d) the tips' centres in the object's frame at times (m,) in [0, duration] [m]."""
        return self._over_time(t)[0]

    def velocities(self, t: ArrayLike) -> Array:
        """(m, k, d) their velocities in the object's frame [m/s]."""
        return self._over_time(t)[1]

    def touching(self, t: ArrayLike) -> NDArray[np.bool_]:
        """(m, k) whether each finger is at a contact; one that moves is not."""
        return self._over_time(t)[2]

    def plan_time(self, t: ArrayLike) -> Array:
        """(m,) the plan's own time, which stands while fingers move [s]."""
        k, local = self.step_times(t)
        result: Array = np.cumsum([0.0, *(step.duration for step in self.steps)])[k] + local
        return result

    def step_times(self, t: ArrayLike) -> tuple[NDArray[np.intp], Array]:
        """(m,) the step of each time, the pause before it included, from 0; and the time in it (m,) [s].

        After the last step that one, at its end.
        """
        times, k = self._places(t)
        lengths = np.array([step.duration for step in self.steps])
        over = k == lengths.size
        k = np.minimum(k, lengths.size - 1)
        local = np.clip(times - self.starts[k], 0.0, lengths[k])
        return k, np.where(over, lengths[k], local)

    def forces(self, t: ArrayLike) -> Array:
        """(m, k, d) of each finger on the object, in the object's frame, zero in the air [N].

        With soft fingers (m, k, 4), their torques about the normal last.
        """
        k, local = self.step_times(t)
        width = self.steps[0].start.forces.shape[1]
        result = np.zeros((k.size, self.tips.shape[1], width))
        fingers = self.plan.fingers if isinstance(self.plan, RegraspPlan) else [self.steps[0].grasp.names]
        for s, step in enumerate(self.steps):
            here = k == s
            forces = step.forces(local[here])
            for i, name in enumerate(fingers[s]):
                if name is not None:
                    result[here, i] = forces[:, step.grasp.index(name)]
        return result

    def _places(self, t: ArrayLike) -> tuple[Array, NDArray[np.intp]]:
        """Times and the step that each belongs to, the pause before it included."""
        times = np.atleast_1d(np.asarray(t, dtype=float))
        if not ((times >= 0) & (times <= self.duration * (1 + 1e-12))).all():
            raise InvalidInput(f"t must lie in [0, {self.duration:.15g}] s, got {shown(t)}")
        over = np.array([s + step.duration for s, step in zip(self.starts, self.steps, strict=False)])
        return times, np.searchsorted(over, times, side="left")

    def _over_time(self, t: ArrayLike) -> tuple[Array, Array, NDArray[np.bool_]]:
        times, k = self._places(t)
        positions, velocities = self.tips[k], np.zeros((times.size, *self.tips.shape[1:]))
        touching = self.contacts[k]
        for i in range(self.tips.shape[1]):
            own = [m for m in self.motions if m.finger == i]
            for first, motion, last in zip([None, *own], own, [*own[1:], None], strict=False):
                s, a, b = motion.step, motion.start, motion.end
                before, during = (k == s) & (times <= a), (times > a) & (times < b)
                after = (times >= b) & (k <= s)
                if first is None or first.step != s:
                    positions[before, i] = motion.way.points[0]
                    touching[before, i] = s > 0 and self.contacts[s - 1][i]
                x = (times[during] - a) / motion.duration
                positions[during, i], velocities[during, i] = motion.way.over_time(x, motion.duration)
                positions[after, i] = motion.way.points[-1]
                touching[during, i] = False
                touching[after, i] = (last is None or last.step != s) and self.contacts[s][i]
        return positions, velocities, touching

    def __str__(self) -> str:
        lines = [f"{len(self.motions)} motions, {self.duration:.4g} s with the plan's steps"]
        for m in self.motions:
            what = f"from {m.origin} to {m.target}" if m.origin != m.target else f"at {m.origin}"
            lines.append(
                f"before step {m.step + 1}: finger {m.finger + 1} {what}, {m.way.length:.4g} m in "
                f"{m.duration:.4g} s, clear of the object by {m.to_object:.4g} m, "
                f"of tips by {m.to_tips:.4g} m"
            )
        return "\n".join(lines)

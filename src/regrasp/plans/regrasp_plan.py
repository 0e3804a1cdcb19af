"""A whole regrasp: transitions one after the other, and the finger that moves between them."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from regrasp.display import Pictured
from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, numbers_in, read_only
from regrasp.mechanics.orientation.rotations import rotation_matrix
from regrasp.mechanics.value import ArrayValue
from regrasp.plans.document import Documented
from regrasp.plans.regrasp_notes import notes_on
from regrasp.plans.transition import Transition


@dataclass(frozen=True, eq=False)
class FingerMove(ArrayValue):
    """A finger without force that moves before a step.

    step: the step before which it moves. finger: its number, from 0. origin, target: (d,) contact points in
    the object frame, relative to the centre of mass [m]; their names in the plan.
    """

    step: int
    finger: int
    origin: Array
    target: Array
    origin_name: str
    target_name: str


@dataclass(frozen=True, eq=False, repr=False)
class RegraspPlan(ArrayValue, Documented, Pictured):
    """Transitions that carry an object from one grasp to another, of three fingers or of four in space.

    Args:
        steps: a removal, exchanges and rotations, and an addition; each with the contacts in play, at most as
            many as there are fingers.
        orientations: (len(steps) + 1,) the object's angle before the first step, and after each; in space the
            sum of its turns so far, each about its own axis [rad].
        margin: the least angle margin of the holds on the way [rad].
        rotations: (len(steps) + 1, 3, 3) in space, from the object's frame to its frame at the start, before
            the first step and after each; None in the plane.
    """

    steps: tuple[Transition, ...]
    orientations: tuple[float, ...]
    margin: float
    rotations: Array | None = field(default=None, kw_only=True)

    _drawn_by = "regrasp.plots.regrasps.steps:regrasp_png"

    def __post_init__(self) -> None:
        if self.rotations is not None and self.rotations.shape != (len(self.steps) + 1, 3, 3):
            raise InvalidInput(
                f"rotations must have shape ({len(self.steps) + 1}, 3, 3), got {self.rotations.shape}"
            )

    @property
    def duration(self) -> float:
        """Of all steps [s]; the fingers' own moves between contact points are not timed."""
        return sum(step.duration for step in self.steps)

    @property
    def friction_needed(self) -> float:
        """The least coefficient of all contacts under which all forces stay in their cones [-]."""
        return max(step.friction_needed for step in self.steps)

    @property
    def notes(self) -> tuple[str, ...]:
        """Where a finger that holds hardly pushes, or one squeezes far above the load, in words."""
        return tuple(notes_on(self.steps))

    def orientation(self, t: ArrayLike) -> Array:
        """The object's angle [rad] at times in [0, duration] [s], of the shape of t.

        Args:
            t: a time or (m,) times in [0, duration] [s].
        """
        k, local = self._place(t)
        result = np.empty(local.shape)
        for step in range(len(self.steps)):
            here = k == step
            result[here] = self.orientations[step] + self.steps[step].orientation(local[here])
        return result

    def rotation(self, t: ArrayLike) -> Array:
        """(..., 3, 3) in space, from the object's frame to its frame at the start, at times (...) [s].

        Args:
            t: (...) times in [0, duration] [s].

        Raises:
            InvalidInput: In the plane, where ``orientation`` is an angle.
        """
        if self.rotations is None:
            raise InvalidInput("a planar regrasp has an orientation(t), an angle, and no rotation")
        k, local = self._place(t)
        result = np.empty((*local.shape, 3, 3))
        for step, plan in enumerate(self.steps):
            here = k == step
            result[here] = self.rotations[step] @ plan.rotations(local[here])
        return result

    def _place(self, t: ArrayLike) -> tuple[NDArray[np.intp], Array]:
        """The step of each time and the time from its start [s]."""
        times = numbers_in(t, "t must be numbers")
        if not ((times >= 0) & (times <= self.duration * (1 + 1e-12))).all():
            raise InvalidInput(f"t must lie in [0, {self.duration:.15g}] s, got {shown(t)}")
        lengths = np.array([step.duration for step in self.steps])
        ends = np.cumsum(lengths)
        k = np.minimum(np.searchsorted(ends, times, side="right"), len(self.steps) - 1)
        return k, np.clip(times - (ends - lengths)[k], 0, lengths[k])

    @property
    def moves(self) -> tuple[FingerMove, ...]:
        """Every move of a finger without force, in order."""
        return tuple(self._moves_and_fingers()[0])

    @property
    def fingers(self) -> tuple[tuple[str | None, ...], ...]:
        """For each step the contact that each finger makes during it; None for one that is in the air."""
        return tuple(self._moves_and_fingers()[1])

    def _moves_and_fingers(self) -> tuple[list[FingerMove], list[tuple[str | None, ...]]]:
        first = self.steps[0].grasp
        places: list[str | None] = list(first.names)
        where = {name: first[name].position for name in first.names}
        moves, fingers = [], []
        for k, step in enumerate(self.steps):
            grasp = step.grasp
            for name in grasp.names:
                if name in places:
                    continue
                idle = next((i for i, at in enumerate(places) if at not in grasp.names), None)
                if idle is None:
                    raise InvalidInput(f"step {k + 1} has more contacts than there are fingers: {name}")
                origin = str(places[idle])
                moves.append(FingerMove(k, idle, where[origin], grasp[name].position, origin, name))
                places[idle] = name
                where[name] = grasp[name].position
            fingers.append(tuple(at if at in grasp.names else None for at in places))
        return moves, fingers

    def reversed(self) -> "RegraspPlan":
        """The same regrasp run backwards, in space from the orientation where it ended."""
        back = tuple(step.reversed() for step in reversed(self.steps))
        turned = self.rotations
        rotations = None if turned is None else read_only(turned[-1].T @ turned[::-1])
        return RegraspPlan(back, self.orientations[::-1], self.margin, rotations=rotations)

    def __str__(self) -> str:
        lines = [
            f"regrasp in {len(self.steps)} steps and {len(self.moves)} finger moves, {self.duration:g} s, "
            f"holds by {round(float(np.degrees(self.margin)), 2) + 0.0:.2f} deg or more"
        ]
        for k, (step, (a, b)) in enumerate(zip(self.steps, pairwise(self.orientations), strict=True), 1):
            turn = self._turn_in_words(step, a, b)
            held = ", ".join(step.grasp.names)
            lines.append(f"{k:2}. {step.in_words} with {held}{turn}")
        said = dict.fromkeys(str(s.record.withstands) for s in self.steps if s.record.withstands is not None)
        lines += [f"withstands {words}" for words in said]
        return "\n".join([*lines, *(f"note: {note}" for note in self.notes)])

    __repr__ = __str__

    def _turn_in_words(self, step: Transition, before: float, after: float) -> str:
        if step.turn is None:
            return ""
        if step.turn.axis is None:
            return f", turning from {np.degrees(before):.4g} to {np.degrees(after):.4g} deg"
        x, y, z = np.round(step.turn.axis, 9) + 0.0  # rounding reads as 0
        return f", turning by {np.degrees(after - before):.4g} deg about ({x:.3g}, {y:.3g}, {z:.3g})"


def rotation_before(plan: object, k: int) -> Array:
    """(3, 3) from the object's frame before step ``k`` of a plan in space to its frame at the start."""
    turned = plan.rotations if isinstance(plan, RegraspPlan) else None
    return np.eye(3) if turned is None else np.asarray(turned[k])


def accumulated(steps: Sequence[Transition]) -> tuple[tuple[float, ...], Array]:
    """Total turns (K + 1,) [rad] and rotations (K + 1, 3, 3) before and after each step."""
    turned, rotations = [0.0], [np.eye(3)]
    for step in steps:
        turn = step.turn
        if turn is None or turn.axis is None:
            turned.append(turned[-1])
            rotations.append(rotations[-1])
        else:
            turned.append(turned[-1] + turn.angle)
            rotations.append(rotations[-1] @ rotation_matrix(turn.axis, turn.angle))
    return tuple(turned), read_only(np.array(rotations))

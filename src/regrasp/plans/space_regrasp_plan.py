"""A whole regrasp in space: the object's orientation is a rotation."""

from dataclasses import dataclass, field

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, ArrayLike, read_only
from regrasp.mechanics.orientation.rotations import rotation_matrix
from regrasp.plans.regrasp_plan import RegraspPlan
from regrasp.plans.transition import Transition


@dataclass(frozen=True, eq=False, repr=False)
class SpaceRegraspPlan(RegraspPlan):
    """Transitions that carry a solid object from one four-finger grasp to another.

    As ``RegraspPlan``, with at most four contacts in play.

    Args:
        steps: in order, each beginning where the one before ends.
        orientations: (len(steps) + 1,) the sum of its turns so far, each about its own axis [rad].
        margin: the least angle margin of the holds [rad].
        rotations: (len(steps) + 1, 3, 3) from the object's frame to its frame at the start, before the first
            step and after each.
    """

    rotations: Array = field(kw_only=True)

    def __post_init__(self) -> None:
        if self.rotations.shape != (len(self.steps) + 1, 3, 3):
            raise InvalidInput(
                f"rotations must have shape ({len(self.steps) + 1}, 3, 3), got {self.rotations.shape}"
            )

    def rotation(self, t: ArrayLike) -> Array:
        """(..., 3, 3) matrices from the object's frame to its frame at the start, at times (...) [s].

        Args:
            t: (...) times in [0, duration] [s].
        """
        k, local = self._place(t)
        result = np.empty((*local.shape, 3, 3))
        for step in range(len(self.steps)):
            here = k == step
            plan, before = self.steps[step], self.rotations[step]
            result[here] = before @ plan.rotations(local[here])
        return result

    def reversed(self) -> "SpaceRegraspPlan":
        """The same regrasp run backwards, from the orientation where it ended."""
        back = tuple(step.reversed() for step in reversed(self.steps))
        rotations = read_only(self.rotations[-1].T @ self.rotations[::-1])
        return SpaceRegraspPlan(back, self.orientations[::-1], self.margin, rotations=rotations)

    def _turn_in_words(self, step: Transition, before: float, after: float) -> str:
        if step.turn is None or step.turn.axis is None:
            return ""
        x, y, z = np.round(step.turn.axis, 9) + 0.0  # rounding reads as 0
        return f", turning by {np.degrees(after - before):.4g} deg about ({x:.3g}, {y:.3g}, {z:.3g})"


def accumulated(steps: list[Transition]) -> tuple[tuple[float, ...], Array]:
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

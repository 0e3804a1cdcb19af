"""The objectives that words name, one value each: tables elsewhere read them. A new one is a value here."""

from collections.abc import Mapping, Sequence
from math import atan, tan
from types import MappingProxyType
from typing import ClassVar, Literal

import numpy as np

from regrasp.closed_form import choice as closed
from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.margins import Margins, largest_use, least_angle, margins
from regrasp.planning.states.objectives.objective import (
    Bound,
    ConvexObjective,
    LevelObjective,
    Objective,
)
from regrasp.planning.states.objectives.withstood import WithstoodFactor

ObjectiveName = Literal[
    "angle", "force", "effort", "peak", "peak_normal", "friction_use", "sum_normal", "wrench"
]


class _Margin(ConvexObjective):
    """The widest least distance to the cones' boundaries."""

    def of_contacts(self, forces: Array, grasp: Grasp) -> Array:
        return margins(forces, grasp.cones.normals, grasp.frictions).force


class _Effort(ConvexObjective):
    """The least sum of squares."""

    def of_contacts(self, forces: Array, grasp: Grasp) -> Array:
        squares: Array = (forces**2).sum(axis=-1)
        return squares

    def squares(self, grasp: Grasp) -> Array:
        return np.ones(len(grasp))

    def scale(self, unit: float) -> float:
        return unit**2


class _Peak(ConvexObjective):
    """The least largest force."""

    def of_contacts(self, forces: Array, grasp: Grasp) -> Array:
        sizes: Array = np.sqrt((forces**2).sum(axis=-1))
        return sizes


class _Normal(ConvexObjective):
    """The least largest normal force, or the least sum of them."""

    def of_contacts(self, forces: Array, grasp: Grasp) -> Array:
        return grasp.cones.normal(forces)

    def linear(self, grasp: Grasp, unit: float) -> Array | None:
        return grasp.cones.normals if self.bound is Bound.NONE else None


class _Angle(LevelObjective):
    """The widest least angle margin m: friction tan(atan mu - m)."""

    def of_contacts(self, forces: Array, grasp: Grasp) -> Array:
        return margins(forces, grasp.cones.normals, grasp.frictions).angle

    def top(self, frictions: Sequence[float]) -> float:
        return max(atan(mu) for mu in frictions)

    def narrowed(self, friction: float, level: float) -> float | None:
        angle = atan(friction) - level
        return tan(angle) if angle >= 0 else None

    def level(self, reached: Margins) -> float:
        return reached.least_angle

    def level_of(self, forces: Array, normals: Array, frictions: Array) -> float:
        return least_angle(forces, normals, frictions)

    def slopes(self, frictions: Array, narrowed: Array, level: float) -> tuple[Array, Array]:
        fall = 1 + narrowed**2
        return fall / (1 + frictions**2), fall


class _FrictionUse(LevelObjective):
    """The least largest fraction u of the friction available, at the level 1 - u: friction mu u."""

    may_reach_top: ClassVar[bool] = True

    def of_contacts(self, forces: Array, grasp: Grasp) -> Array:
        return margins(forces, grasp.cones.normals, grasp.frictions).friction_use

    def top(self, frictions: Sequence[float]) -> float:
        return 1.0

    def narrowed(self, friction: float, level: float) -> float | None:
        return friction * (1 - level)

    def level(self, reached: Margins) -> float:
        return 1 - reached.largest_friction_use

    def level_of(self, forces: Array, normals: Array, frictions: Array) -> float:
        return 1 - largest_use(forces, normals, frictions)

    def slopes(self, frictions: Array, narrowed: Array, level: float) -> tuple[Array, Array]:
        return np.full(frictions.size, 1 - level), frictions


ANGLE = _Angle(
    "angle", "least angle margin", "angle margin", "least", "rad",
    closed_form=closed.ANGLE, unbounded=True,
)  # fmt: skip
FORCE = _Margin(
    "force", "least force margin", "force margin", "least", "N",
    closed_form=closed.FORCE, unbounded=True, bound=Bound.MARGIN,
)  # fmt: skip
EFFORT = _Effort("effort", "least sum of squares", "$|f|^2$", "sum", "N^2", closed_form=closed.EFFORT)
PEAK = _Peak(
    "peak", "least largest force", "$|f|$", "largest", "N", closed_form=closed.PEAK, bound=Bound.FORCE
)
PEAK_NORMAL = _Normal(
    "peak_normal", "least largest normal force", "normal force", "largest", "N",
    closed_form=closed.PEAK_NORMAL, bound=Bound.NORMAL,
)  # fmt: skip
FRICTION_USE = _FrictionUse(
    "friction_use", "least largest use of friction", "friction use", "largest", "-",
    closed_form=closed.FRICTION_USE, unbounded=True,
)  # fmt: skip
SUM_NORMAL = _Normal(
    "sum_normal", "least sum of normal forces", "normal force", "sum", "N", closed_form=closed.SUM_NORMAL
)
WRENCH = WithstoodFactor(
    "wrench", "widest factor of a disturbance withstood", "factor withstood", "least", "-",
    unbounded=True, bound=Bound.FACTOR,
)  # fmt: skip

OBJECTIVES: Mapping[str, Objective] = MappingProxyType(
    {o.name: o for o in (ANGLE, FORCE, EFFORT, PEAK, PEAK_NORMAL, FRICTION_USE, SUM_NORMAL, WRENCH)}
)
"""The objectives that words name."""
JOINT = "joint force"
"""The word in records for states of a whole sequence that are chosen together."""


def recorded(objective: Objective) -> str:
    """The word for an objective in the record of a plan; one of a user's own is marked as such."""
    known = OBJECTIVES.get(objective.name)
    if objective is known or objective == known or isinstance(objective, WithstoodFactor):
        return objective.name
    return f"own:{objective.name}"


def objective_of(given: "str | Objective") -> Objective:
    """The objective that a word names, or the one given."""
    if isinstance(given, Objective):
        if not isinstance(given, ConvexObjective | LevelObjective):
            raise InvalidInput(
                f"an objective is a ConvexObjective or a LevelObjective, got {type(given).__name__}"
            )
        return given
    found = OBJECTIVES.get(given) if isinstance(given, str) else None
    if found is None:
        raise InvalidInput(f"objective must be one of {', '.join(OBJECTIVES)}; got {shown(given)}")
    return found

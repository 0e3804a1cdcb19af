"""What a state is chosen for: one value per objective, which every table elsewhere reads.

An objective says what each contact adds to it and how the contacts' values make one; its words and unit;
whether larger is better; its closed form for two planar contacts, if it has one. A ``ConvexObjective`` is one
convex program, a ``LevelObjective`` a level that narrowed cones reach (``narrowing``).
A new one is a value in this file; one of a user's own is a ``ForceCost``, or a subclass of these.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from math import atan, tan
from types import MappingProxyType
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike

from regrasp.closed_form import choice as closed
from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.margins import Margins, margins
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.value import ArrayValue

ObjectiveName = Literal["angle", "force", "effort", "peak", "peak_normal", "friction_use", "sum_normal"]

_TOGETHER: Mapping[str, Callable[..., Any]] = {
    "least": np.fmin.reduce,
    "largest": np.fmax.reduce,
    "sum": np.sum,
}


@dataclass(frozen=True, eq=False)
class Objective(ArrayValue, ABC):
    """What a state is chosen for.

    name: its word. words: what is sought. quantity: what it is of one contact. together: how the contacts'
    values make one. unit: of the value, in terms of N and rad. closed_form: its code in
    ``regrasp.closed_form.choice``, or None. unbounded: whether the best value may lie at infinite force, so
    that forces must be limited.
    """

    name: str
    words: str
    quantity: str
    together: Literal["least", "largest", "sum"]
    unit: str
    closed_form: int | None = field(default=None, kw_only=True)
    unbounded: bool = field(default=False, kw_only=True)

    @property
    def maximise(self) -> bool:
        """Whether larger is better: of the least of margins."""
        return self.together == "least"

    @abstractmethod
    def of_contacts(self, forces: Array, grasp: Grasp) -> Array:
        """(..., n) what each contact adds at forces (..., n, w), as the cones measure them [N]."""

    def value(self, state: GraspState) -> float:
        """The objective at a state, in ``unit``; torques of soft fingers count as mu m / torsion [N]."""
        measured = state.grasp.cones.measured(state.forces)
        return float(_TOGETHER[self.together](self.of_contacts(measured, state.grasp)))

    def __hash__(self) -> int:
        return hash(self.name)

    def __str__(self) -> str:
        return self.name


class Bound(Enum):
    """What the one unknown besides the forces bounds in a program, and so what is optimised."""

    NONE = "nothing: the cost is of the forces themselves"
    MARGIN = "every force margin from below"
    FORCE = "every force from above"
    NORMAL = "every normal force from above"


@dataclass(frozen=True, eq=False)
class ConvexObjective(Objective):
    """An objective that is one convex program (``regrasp.planning.states.program``)."""

    bound: Bound = field(default=Bound.NONE, kw_only=True)

    @property
    def follows_unit(self) -> bool:
        """Whether ``linear`` depends on the unit of force: of a cost with squares and a linear part."""
        return False

    def squares(self, grasp: Grasp) -> Array | None:
        """(n,) the a_i of a cost sum a_i |f_i|^2 + c_i . f_i, forces as the cones measure them; or None."""
        return None

    def linear(self, grasp: Grasp, unit: float) -> Array | None:
        """(n, w) its c_i, forces in units of ``unit`` [N]; or None."""
        return None

    def scale(self, unit: float) -> float:
        """What one of the program's value is of the objective's, at forces in units of ``unit`` [N]."""
        return unit

    @property
    def rests(self) -> bool:
        """Whether no forces at all are best where there is no load."""
        return not self.unbounded


@dataclass(frozen=True, eq=False)
class ForceCost(ConvexObjective):
    """The least sum of weights_i |f_i - towards_i|^2 + prices_i . f_i, of a user's own.

    weights: a number or (n,), each at least 0. towards: (n, w) forces to stay near [N], zero if not given.
    prices: (n, w) what a force costs in each direction, object frame. n, w are those of the grasps it is used
    for; forces are as the cones measure them, so that a soft finger's torque counts as mu m / torsion.
    Raises ``InvalidInput`` for costs that are not convex or bounded by nothing.
    """

    weights: Array = field(default_factory=lambda: np.ones(()))
    towards: Array | None = None
    prices: Array | None = None

    def __init__(
        self,
        name: str = "cost",
        weights: ArrayLike = 1.0,
        towards: ArrayLike | None = None,
        prices: ArrayLike | None = None,
    ) -> None:
        given = array(weights, "weights", (None,) if np.ndim(weights) else ())
        if (given < 0).any() or not given.any():
            raise InvalidInput(f"weights must be at least 0, and one of them above it, got {weights!r}")
        if not isinstance(name, str) or name in OBJECTIVES:
            raise InvalidInput(
                f"name must be a word that is not one of {', '.join(OBJECTIVES)}, got {name!r}"
            )
        super().__init__(name, f"least {name}", name, "sum", "-")
        object.__setattr__(self, "weights", given)
        for key, value in (("towards", towards), ("prices", prices)):
            object.__setattr__(self, key, None if value is None else array(value, key, (None, None)))

    def of_contacts(self, forces: Array, grasp: Grasp) -> Array:
        """(..., n) weights_i |f_i - towards_i|^2 + prices_i . f_i."""
        self._check(grasp)
        away = forces if self.towards is None else forces - self.towards
        cost: Array = self.weights * (away**2).sum(axis=-1)
        return cost if self.prices is None else cost + (self.prices * forces).sum(axis=-1)

    def squares(self, grasp: Grasp) -> Array:
        """(n,) the weights, the largest one 1."""
        self._check(grasp)
        return np.broadcast_to(self.weights / self.weights.max(), (len(grasp),))

    def linear(self, grasp: Grasp, unit: float) -> Array | None:
        """(n, w) (prices_i - 2 weights_i towards_i) / (unit times the largest weight)."""
        if self.towards is None and self.prices is None:
            return None
        cost = np.zeros((len(grasp), grasp.width)) if self.prices is None else self.prices
        if self.towards is not None:
            cost = cost - 2 * np.broadcast_to(self.weights, (len(grasp),))[:, None] * self.towards
        return cost / (unit * float(self.weights.max()))

    @property
    def follows_unit(self) -> bool:
        """Whether it has a linear part besides the squares."""
        return self.towards is not None or self.prices is not None

    @property
    def rests(self) -> bool:
        """Whether no forces at all are best where there is no load: with squares alone."""
        return not self.follows_unit

    def scale(self, unit: float) -> float:
        """unit^2 times the largest weight."""
        return unit**2 * float(self.weights.max())

    def _check(self, grasp: Grasp) -> None:
        if self.weights.ndim and self.weights.shape != (len(grasp),):
            raise InvalidInput(f"weights must be one number or {len(grasp)}, got {self.weights.size}")
        for key, value in (("towards", self.towards), ("prices", self.prices)):
            if value is not None and value.shape != (len(grasp), grasp.width):
                raise InvalidInput(
                    f"{key} must have shape ({len(grasp)}, {grasp.width}) for this grasp, got {value.shape}"
                )


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


class LevelObjective(Objective):
    """A level that is reached when cones narrowed to it hold the load.

    may_reach_top: whether forces may well reach the highest level there is, so that it is tried first.
    """

    may_reach_top: ClassVar[bool] = False

    @abstractmethod
    def top(self, frictions: Sequence[float]) -> float:
        """A level that no forces exceed."""

    @abstractmethod
    def narrowed(self, friction: float, level: float) -> float | None:
        """The friction of one cone at a level; None where nothing is left of it."""

    @abstractmethod
    def level(self, reached: Margins) -> float:
        """The level of forces by their margins, over the contacts that carry any; NaN where none does."""

    @abstractmethod
    def slopes(self, frictions: Array, narrowed: Array, level: float) -> tuple[Array, Array]:
        """(n,) how ``narrowed`` rises with the friction, and how it falls with the level."""


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

OBJECTIVES: Mapping[str, Objective] = MappingProxyType(
    {o.name: o for o in (ANGLE, FORCE, EFFORT, PEAK, PEAK_NORMAL, FRICTION_USE, SUM_NORMAL)}
)
"""The objectives that words name."""


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
        raise InvalidInput(f"objective must be one of {', '.join(OBJECTIVES)}; got {given!r}")
    return found

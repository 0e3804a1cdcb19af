"""What an objective is: a value that says what each contact adds to it, and how programs reach its best.

A ``ConvexObjective`` is one convex program, a ``LevelObjective`` a level that narrowed cones reach
(``regrasp.planning.states.narrowing``).
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from enum import Enum
from typing import Any, ClassVar, Literal

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.margins import Margins, margins
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.value import ArrayValue, hashable

_TOGETHER: Mapping[str, Callable[..., Any]] = {
    "least": np.fmin.reduce,
    "largest": np.fmax.reduce,
    "sum": np.sum,
}


@dataclass(frozen=True, eq=False, repr=False)
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

    def _key(self) -> tuple[Hashable, ...]:
        """Fields, and whatever else an objective of a user's own keeps."""
        compared = {f.name for f in fields(self)}
        more = (value for name, value in sorted(vars(self).items()) if name not in compared)
        return (*super()._key(), *(hashable(value) for value in more))

    def __hash__(self) -> int:
        return hash(self.name)

    def __str__(self) -> str:
        return self.name

    def __repr__(self) -> str:
        """Short, as messages show it."""
        return f"{type(self).__name__}({self.name!r})"


class Bound(Enum):
    """What the one unknown besides the forces bounds in a program, and so what is optimised."""

    NONE = "nothing: the cost is of the forces themselves"
    MARGIN = "every force margin from below"
    FORCE = "every force from above"
    NORMAL = "every normal force from above"
    FACTOR = "the factor of a set that is withstood from below"


@dataclass(frozen=True, eq=False, repr=False)
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

    def level_of(self, forces: Array, normals: Array, frictions: Array) -> float:
        """The level of forces (n, d) in cones; the same by itself where margins are more than it asks for."""
        return self.level(margins(forces, normals, frictions))

    @abstractmethod
    def slopes(self, frictions: Array, narrowed: Array, level: float) -> tuple[Array, Array]:
        """(n,) how ``narrowed`` rises with the friction, and how it falls with the level."""

"""What refusals and remedies read of a regrasp problem."""

from collections.abc import Iterable
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from regrasp.mechanics.contact import Contact
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.holds.pairs import Filter, HoldGraph
from regrasp.planning.states.criteria import Criteria


class Asked(Protocol):
    """What is read of a ``RegraspProblem``."""

    @property
    def graph(self) -> HoldGraph:
        """The holds."""

    @property
    def contacts(self) -> tuple[Contact, ...]:
        """The contacts of both ends, then the candidates."""

    @property
    def places(self) -> tuple[tuple[int, ...], tuple[int, ...], int]:
        """The start's and the goal's contacts, and the place of the last orientation."""

    @property
    def allowed(self) -> NDArray[np.bool_] | None:
        """(3, V) which finger may touch which contact, or None."""

    @property
    def is_exact(self) -> bool:
        """Whether all orientations are looked at."""

    @property
    def criteria(self) -> Criteria:
        """Objective and limits."""

    @property
    def load(self) -> Wrench:
        """Before the object turns."""

    @property
    def max_turn(self) -> float:
        """Of one step [rad]."""

    @property
    def least_margin(self) -> float:
        """That every hold must have [rad]."""

    @property
    def min_distance(self) -> float:
        """Between two fingers [m]."""

    @property
    def keep(self) -> Filter | None:
        """A filter of pairs."""

    @property
    def one_finger(self) -> bool:
        """Whether one finger of a hold may carry the load alone."""

    def graph_on(self, contacts: Iterable[Contact]) -> HoldGraph:
        """The holds of other contacts."""

    def allowing(self, force: float) -> "Asked":
        """The same with at least this force [N] where it is limited."""

    def plans(self, extra: int = 0) -> Any:
        """Plans, or ``Infeasible``."""

"""What differs between the plane and space in a regrasp problem: shape, orientations and holds."""

from collections.abc import Iterable, Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.holds.graphs import AnyGraph
from regrasp.planning.holds.stances import Stances
from regrasp.planning.regrasps.steps import Chosen
from regrasp.plans.regrasp_plan import RegraspPlan
from regrasp.plans.timing import TimeScaling

Orientation = Any
"""Of the object: an angle [rad], or in space the direction (3,) in which it sees the load."""


class Setting(Protocol):
    """A shape that fingers touch, how it may turn, and which of its holds hold."""

    @property
    def fingers(self) -> int:
        """How many there are."""

    @property
    def size(self) -> float:
        """Of the shape [m]."""

    @property
    def reach(self) -> float:
        """How far the object turns at most from one hold to the next, all fingers between them [rad]."""

    @property
    def shape(self) -> str:
        """What it is called."""

    @property
    def grasp(self) -> str:
        """What start and goal must be, in words."""

    @property
    def orientations(self) -> Any:
        """(O,) that are tried, the first that at the start."""

    @property
    def last(self) -> int:
        """The place of the orientation in the end."""

    def nearest(self, position: Array) -> Array:
        """The point of the shape nearest to one, both relative to the centre of mass [m]."""

    def sampled(self) -> list[Contact]:
        """Where fingers may touch besides start and goal."""

    def reachable(self, contacts: Sequence[Contact]) -> NDArray[np.bool_]:
        """(fingers, V) which finger may touch which contact, by ``arcs``."""

    def graph_on(self, contacts: Iterable[Contact]) -> AnyGraph:
        """The holds of contacts with their whole friction."""

    def stances(
        self,
        graph: AnyGraph,
        max_turn: float,
        reach: float,
        allowed: NDArray[np.bool_] | None,
        least: float,
    ) -> Stances:
        """Where fingers stand, for the searches; holds of less than a ``least`` margin [rad] are none."""

    def seen(self, orientation: Orientation) -> Wrench:
        """The load, seen from the object."""

    def where(self, orientation: Orientation) -> str:
        """In words, with a preposition."""

    def along(self, orientations: Sequence[Orientation]) -> list[Orientation]:
        """The same, none farther from the one before it than it must be; the last that in the end."""

    def turn(self, before: Orientation, after: Orientation) -> float:
        """How far the object turns [rad]."""

    def between(self, before: Orientation, after: Orientation, share: float) -> Orientation:
        """The orientation a share of the way from one to another."""

    def plan(
        self, states: Sequence[Chosen], orientations: Sequence[Orientation], scaling: TimeScaling
    ) -> RegraspPlan:
        """The steps between states that follow one another."""

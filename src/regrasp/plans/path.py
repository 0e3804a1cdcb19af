"""How forces and load go from one state to another: a straight line, through instants, or around a turn.

A path is geometry between the states at both ends; the clock T(t) of a transition times it. Its parameter u
is T, which falls from 1 to 0, or the time itself where the load is tied to the clock (``timed``).
"""

from abc import ABC, abstractmethod
from typing import ClassVar

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.margins import friction_needed
from regrasp.mechanics.state import GraspState
from regrasp.plans.timing import TimeScaling


class Path(ABC):
    """What lies between two states, ``start`` and ``end``, of one grasp; u has any shape (...)."""

    timed: ClassVar[bool] = False

    @property
    def load_varies(self) -> bool:
        """Whether the load is not the same at every instant."""
        return False

    @abstractmethod
    def check(self, start: GraspState, end: GraspState, scaling: TimeScaling) -> None:
        """Raise ``InvalidInput`` for ends or a clock that are not those of this path."""

    @abstractmethod
    def forces_at(self, start: GraspState, end: GraspState, u: Array) -> Array:
        """Finger forces (..., n, w), object frame [N]."""

    def wrenches_at(self, start: GraspState, end: GraspState, u: Array) -> Array:
        """Finger wrenches (..., n, 3) or (..., n, 6), object frame [N, N m]."""
        return start.grasp.wrenches(self.forces_at(start, end, u))

    @abstractmethod
    def rates_at(self, start: GraspState, end: GraspState, u: Array) -> Array:
        """(..., n, w) the change of the forces by u; of a timed path [N/s]."""

    def load_at(self, start: GraspState, u: Array) -> Array:
        """The load (..., 3) or (..., 6), object frame [N, N m]."""
        return np.broadcast_to(start.load.vector, (*u.shape, start.load.vector.size))

    def orientation_at(self, u: Array) -> Array:
        """The object's angle from the start (...) [rad]."""
        return np.zeros_like(u)

    def rotations_at(self, u: Array) -> Array:
        """(..., 3, 3) from the object's frame to its frame at the start, in space."""
        return np.broadcast_to(np.eye(3), (*u.shape, 3, 3))

    @abstractmethod
    def steepest(self, start: GraspState, end: GraspState) -> Array:
        """(n,) at least the fastest change of each force by u, all over the path."""

    @abstractmethod
    def deciding(self, start: GraspState, end: GraspState) -> Array:
        """(m, n, w) forces of which every force on the path is a combination with weights >= 0."""

    def peaks(self, start: GraspState, end: GraspState) -> Array:
        """(n,) the largest |f_i| of each finger on the path [N]; of soft fingers |(f, mu m / torsion)|."""
        measured = start.grasp.cones.measured(self.deciding(start, end))
        largest: Array = np.sqrt((measured**2).sum(axis=-1)).max(axis=0)
        return largest

    def friction_needed(self, start: GraspState, end: GraspState) -> Array:
        """(n,) the least coefficient of each finger that keeps its forces on the path inside its cone [-].

        It is quasi-convex in the force, so on straight pieces the deciding forces are the worst.
        """
        return needed_by(start.grasp, self.deciding(start, end))

    def reversed(self) -> "Path":
        """The same, run backwards."""
        return self

    def load_in_words(self, start: GraspState, end: GraspState) -> str:
        """Under what load it leads."""
        return repr(start.load)

    def in_words(self, start: GraspState, end: GraspState, by: str, objective: str | None) -> list[str]:
        """What is worth saying of the path itself; by, objective: who planned it and what for."""
        return []


def needed_by(grasp: Grasp, forces: Array) -> Array:
    """(n,) the least coefficient of each finger under which all forces (m, n, w) are inside its cone [-]."""
    needed: Array = friction_needed(forces, grasp.normals, grasp.torsions).max(axis=0)
    return needed

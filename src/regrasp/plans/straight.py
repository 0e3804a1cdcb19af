"""The straight path of Eq. 1-3."""

from dataclasses import dataclass

import numpy as np

from regrasp.closed_form.straight_path import straight_path
from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.value import ArrayValue
from regrasp.plans.path import Path
from regrasp.plans.timing import TimeScaling


@dataclass(frozen=True, eq=False)
class StraightPath(ArrayValue, Path):
    """f = f_end + (f_start - f_end) u under one load. With fixed contacts both ends prove it (fact 1)."""

    def check(self, start: GraspState, end: GraspState, scaling: TimeScaling) -> None:
        """Raise ``InvalidInput`` for ends under different loads.

        Args:
            start: the state at the start, of every contact in play.
            end: the state at the end, of the same contacts.
            scaling: the clock of the transition.
        """
        if start.load is not end.load and start.load != end.load:
            raise InvalidInput("both ends of a straight path must have the same load")

    def forces_at(self, start: GraspState, end: GraspState, u: Array) -> Array:
        """Finger forces (..., n, w), object frame [N].

        Args:
            start: the state at the start, of every contact in play.
            end: the state at the end, of the same contacts.
            u: (...) the clock T, from 1 at the start to 0 at the end [-].
        """
        return straight_path(start.forces, end.forces, u)

    def wrenches_at(self, start: GraspState, end: GraspState, u: Array) -> Array:
        """Finger wrenches (..., n, 3) or (..., n, 6), themselves straight [N, N m].

        Args:
            start: the state at the start, of every contact in play.
            end: the state at the end, of the same contacts.
            u: (...) the clock T, from 1 at the start to 0 at the end [-].
        """
        return straight_path(start.wrenches, end.wrenches, u)

    def rates_at(self, start: GraspState, end: GraspState, u: Array) -> Array:
        """(..., n, w) f_start - f_end all over [N].

        Args:
            start: the state at the start, of every contact in play.
            end: the state at the end, of the same contacts.
            u: (...) the clock T, from 1 at the start to 0 at the end [-].
        """
        change: Array = start.forces - end.forces
        return np.broadcast_to(change, (*u.shape, *change.shape))

    def steepest(self, start: GraspState, end: GraspState) -> Array:
        """(n,) |f_start - f_end|, forces alone [N].

        Args:
            start: the state at the start, of every contact in play.
            end: the state at the end, of the same contacts.
        """
        change = (start.forces - end.forces)[:, : start.grasp.dimension]
        moved: Array = np.linalg.norm(change, axis=1)
        return moved

    def deciding(self, start: GraspState, end: GraspState) -> Array:
        """(2, n, w) both ends.

        Args:
            start: the state at the start, of every contact in play.
            end: the state at the end, of the same contacts.
        """
        return np.stack([start.forces, end.forces])

    def __eq__(self, other: object) -> bool:
        return isinstance(other, StraightPath)

    def __hash__(self) -> int:
        return hash(StraightPath)

    def __repr__(self) -> str:
        return "StraightPath()"


STRAIGHT = StraightPath()

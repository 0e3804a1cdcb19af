"""A path through instants: the answer of a path program."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, array
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.value import ArrayValue
from regrasp.plans.path import Path
from regrasp.plans.timing import TimeScaling


@dataclass(frozen=True, eq=False)
class SampledPath(ArrayValue, Path):
    """Forces and loads at instants, both linear in time between them: for loads that vary, limits that bend.

    Equilibrium and cones at the instants prove every time between. The clock's T(t) is the phase by which the
    least change was weighed; ``start`` and ``end`` are the states at the first and the last instant.

    Args:
        times: (K,) [s], rising from 0.
        forces: (K, n, w) [N].
        loads: (K, 3) or (K, 6) [N, N m].
    """

    timed: ClassVar[bool] = True

    times: Array
    forces: Array
    loads: Array

    def __init__(self, times: ArrayLike, forces: ArrayLike, loads: ArrayLike) -> None:
        t = array(times, "times of a path", (None,))
        if t.size < 2 or t[0] != 0 or not (np.diff(t) > 0).all():
            raise InvalidInput("times of a path through instants must rise from 0, two or more")
        object.__setattr__(self, "times", t)
        object.__setattr__(self, "forces", array(forces, "forces of a path", (t.size, None, None)))
        object.__setattr__(self, "loads", array(loads, "loads of a path", (t.size, None)))

    def check(self, start: GraspState, end: GraspState, scaling: TimeScaling) -> None:
        """Raise ``InvalidInput`` unless shapes and duration are those of the ends and the clock.

        Args:
            start: the state at the start, of every contact in play.
            end: the state at the end, of the same contacts.
            scaling: the clock of the transition.
        """
        shape = start.forces.shape
        if self.forces.shape[1:] != shape or self.loads.shape[1:] != start.load.vector.shape:
            raise InvalidInput(
                f"a path through instants must have forces (K, {shape[0]}, {shape[1]}) and loads of the ends"
            )
        if self.times[-1] != scaling.duration:
            raise InvalidInput(
                f"a path through instants must last the duration {shown(scaling.duration)}, got "
                f"{shown(self.times[-1])}"
            )

    def forces_at(self, start: GraspState, end: GraspState, u: Array) -> Array:
        """Finger forces (..., n, w) at times u, object frame [N].

        Args:
            start: the state at the start, of every contact in play.
            end: the state at the end, of the same contacts.
            u: (...) times [s].
        """
        return self._between(self.forces, u)

    def rates_at(self, start: GraspState, end: GraspState, u: Array) -> Array:
        """Force rates (..., n, w) [N/s]; at an instant that of the stretch after it.

        Args:
            start: the state at the start, of every contact in play.
            end: the state at the end, of the same contacts.
            u: (...) times [s].
        """
        slope: Array = np.diff(self.forces, axis=0) / np.diff(self.times)[:, None, None]
        return slope[self._place(u)[0]]

    def load_at(self, start: GraspState, u: Array) -> Array:
        """The load (..., 3) or (..., 6) at times u, object frame [N, N m].

        Args:
            start: the state at the start, of every contact in play.
            u: (...) times [s].
        """
        return self._between(self.loads, u)

    @property
    def load_varies(self) -> bool:
        """Whether the load is not the same at every instant."""
        return bool(np.ptp(self.loads, axis=0).any())

    def steepest(self, start: GraspState, end: GraspState) -> Array:
        """(n,) the fastest change of each force over the whole path [N/s].

        Args:
            start: the state at the start, of every contact in play.
            end: the state at the end, of the same contacts.
        """
        moved = np.linalg.norm(np.diff(self.forces, axis=0), axis=-1)
        result: Array = (moved / np.diff(self.times)[:, None]).max(axis=0)
        return result

    def deciding(self, start: GraspState, end: GraspState) -> Array:
        """(K, n, w) all instants.

        Args:
            start: the state at the start, of every contact in play.
            end: the state at the end, of the same contacts.
        """
        return self.forces

    def reversed(self) -> "SampledPath":
        """The same, run backwards."""
        return SampledPath(self.times[-1] - self.times[::-1], self.forces[::-1], self.loads[::-1])

    def load_in_words(self, start: GraspState, end: GraspState) -> str:
        """Under what load it leads.

        Args:
            start: the state at the start, of every contact in play.
            end: the state at the end, of the same contacts.
        """
        if not self.load_varies:
            return repr(start.load)
        return f"a load that goes from {start.load!r} to {end.load!r}"

    def in_words(self, start: GraspState, end: GraspState, by: str, objective: str | None) -> list[str]:
        """How many instants, what for and by whom.

        Args:
            start: the state at the start, of every contact in play.
            end: the state at the end, of the same contacts.
            by: who planned the path.
            objective: what it was planned for, or None.
        """
        return [f"path of {self.times.size} instants for {objective} by {by}"]

    def _between(self, values: Array, u: Array) -> Array:
        k, part = self._place(u)
        part = part.reshape(*part.shape, *[1] * (values.ndim - 1))
        result: Array = values[k] * (1 - part) + values[k + 1] * part
        return result

    def _place(self, u: Array) -> tuple[NDArray[np.intp], Array]:
        """The stretch each time lies on and how far along it, from 0 to 1."""
        times = np.minimum(u, self.times[-1])
        k = np.clip(np.searchsorted(self.times, times, side="right") - 1, 0, self.times.size - 2)
        return k, (times - self.times[k]) / (self.times[k + 1] - self.times[k])

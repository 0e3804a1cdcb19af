"""A transition whose forces are linear between instants: the answer of a path program."""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array
from regrasp.plans.course import Course
from regrasp.plans.timing import TimeScaling
from regrasp.plans.transition import Transition


@dataclass(frozen=True, eq=False, repr=False)
class SampledTransition(Transition):
    """A transition along instants, for loads that vary and limits that bend the path.

    Between instants f(t) and w_ext(t) are linear, so that equilibrium and cones at the instants prove every
    time between. ``start`` and ``end`` are the states at the first and last instant, each under its load;
    ``scaling`` is the phase T(t) by which the least change was weighed.
    """

    course: Course = field(kw_only=True)

    def _check(self) -> None:
        course, shape = self.course, self.start.forces.shape
        if course.forces.shape[1:] != shape or course.loads.shape[1:] != self.start.load.vector.shape:
            raise InvalidInput(f"a course must have forces (K, {shape[0]}, {shape[1]}) and loads of the ends")
        if course.times[-1] != self.scaling.duration:
            raise InvalidInput(
                f"a course must last the duration {self.scaling.duration!r}, got {course.times[-1]!r}"
            )

    def forces(self, t: ArrayLike) -> Array:
        """Finger forces (n, d) at a time, (m, n, d) at m times [N]; times in [0, duration] [s]."""
        return self._between(self.course.forces, t)

    def wrenches(self, t: ArrayLike) -> Array:
        """Finger wrenches (n, 3) or (m, n, 3) [N, N m]; (…, 6) in space."""
        return self.grasp.wrenches(self.forces(t))

    def rates(self, t: ArrayLike) -> Array:
        """Force rates f'(t), (n, d) or (m, n, d) [N/s]; at an instant that of the stretch after it."""
        k, _ = self._place(t)
        slope: Array = np.diff(self.course.forces, axis=0) / np.diff(self.course.times)[:, None, None]
        return slope[k]

    @property
    def load_varies(self) -> bool:
        """Whether the load is not the same at every instant."""
        return bool(np.ptp(self.course.loads, axis=0).any())

    @property
    def steepest(self) -> Array:
        """(n,) the fastest change of each force over the whole path, max |f_i'(t)| [N/s]."""
        moved = np.linalg.norm(np.diff(self.course.forces, axis=0), axis=-1)
        result: Array = (moved / np.diff(self.course.times)[:, None]).max(axis=0)
        return result

    def load(self, t: ArrayLike) -> Array:
        """The load (3,) or (m, 3) in the object frame [N, N m]; (…, 6) in space."""
        return self._between(self.course.loads, t)

    def retimed(self, scaling: TimeScaling) -> Transition:
        """Refused: the load is tied to the clock."""
        raise InvalidInput("a path planned through instants keeps its times; plan it with another duration")

    def _deciding_forces(self) -> Array:
        return self.course.forces

    def _load_in_words(self) -> str:
        if not self.load_varies:
            return repr(self.start.load)
        return f"a load that goes from {self.start.load!r} to {self.end.load!r}"

    def _path_in_words(self) -> list[str]:
        record = self.record
        kept = (
            [f"rates below {', '.join(f'{r:.4g}' for r in record.rate_limits)}"] if record.rate_limits else []
        )
        return [
            f"path of {self.course.times.size} instants for {record.path_objective} by {record.path}",
            *kept,
        ]

    def _reversed(self, **changes: Any) -> "SampledTransition":
        return replace(self, course=self.course.reversed(), **changes)

    def _between(self, values: Array, t: ArrayLike) -> Array:
        k, part = self._place(t)
        part = part.reshape(*part.shape, *[1] * (values.ndim - 1))
        result: Array = values[k] * (1 - part) + values[k + 1] * part
        return result

    def _place(self, t: ArrayLike) -> tuple[NDArray[np.intp], Array]:
        """The stretch each time lies on and how far along it, from 0 to 1."""
        self.scaling(t)  # checks the times
        course = self.course.times
        times = np.minimum(np.asarray(t, dtype=float), course[-1])
        k = np.clip(np.searchsorted(course, times, side="right") - 1, 0, course.size - 2)
        return k, (times - course[k]) / (course[k + 1] - course[k])

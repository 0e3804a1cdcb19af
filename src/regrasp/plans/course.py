"""Forces and loads at instants."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, array
from regrasp.mechanics.value import ArrayValue


@dataclass(frozen=True, eq=False)
class Course(ArrayValue):
    """Forces and loads at instants, both linear in time between them.

    times: (K,) [s], rising from 0. forces: (K, n, d) [N]. loads: (K, 3) or (K, 6) [N, N m].
    """

    times: Array
    forces: Array
    loads: Array

    def __init__(self, times: ArrayLike, forces: ArrayLike, loads: ArrayLike) -> None:
        t = array(times, "times of a course", (None,))
        if t.size < 2 or t[0] != 0 or not (np.diff(t) > 0).all():
            raise InvalidInput("times of a course must rise from 0, two or more")
        object.__setattr__(self, "times", t)
        object.__setattr__(self, "forces", array(forces, "forces of a course", (t.size, None, None)))
        object.__setattr__(self, "loads", array(loads, "loads of a course", (t.size, None)))

    def reversed(self) -> "Course":
        """The same, run backwards."""
        return Course(self.times[-1] - self.times[::-1], self.forces[::-1], self.loads[::-1])

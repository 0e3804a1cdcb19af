"""A load that varies in time: an accelerating or a turning hand."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import inf
from typing import Any

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, array, finite, function, number, numbers_in, whole
from regrasp.mechanics.plain import entries
from regrasp.mechanics.value import ArrayValue
from regrasp.mechanics.wrench import Wrench

MOST_INSTANTS = 100_000
"""Of a load or a path."""


@dataclass(frozen=True, eq=False, repr=False)
class LoadSeries(ArrayValue):
    """A load known at instants and linear in time between them.

    Args:
        times: (k,) [s], rising from 0.
        vectors: (k, 3) in the plane, (k, 6) in space: force, then torque about the centre of mass, in the
            object frame [N, N m].

    Raises:
        InvalidInput: For anything else.
    """

    times: Array
    vectors: Array

    def __init__(self, times: ArrayLike, vectors: ArrayLike) -> None:
        t = array(times, "times of a load", (None,))
        if t.size < 2 or t[0] != 0 or not (np.diff(t) > 0).all():
            raise InvalidInput(f"times of a load must rise from 0, two or more; got {shown(times)}")
        w = array(vectors, "vectors of a load", (t.size, None))
        if w.shape[1] not in (3, 6):
            raise InvalidInput(f"a load has 3 (plane) or 6 (space) numbers at each time, got {w.shape[1]}")
        object.__setattr__(self, "times", t)
        object.__setattr__(self, "vectors", w)

    @classmethod
    def sampled(
        cls,
        load: Callable[[float], Wrench],
        duration: float,
        instants: int = 101,
        also: Sequence[float] = (),
    ) -> "LoadSeries":
        """A function of time at ``instants`` equal steps from 0 to ``duration``, and at more times [s].

        Args:
            load: the load at a time [s], object frame [N, N m].
            duration: [s], greater than 0.
            instants: equal steps from 0 to ``duration``, both ends included.
            also: more times [s].
        """
        function(load, "load", "a function of time that returns a Wrench")
        count = whole(instants, "instants", least=2, most=MOST_INSTANTS)
        times = np.linspace(0, number(duration, "duration", above=0), count)
        inside = [t for t in finite(also, "times").ravel().tolist() if 0 < t < duration]
        if inside:
            times = _merged(np.unique(inside), times, 1e-9 * duration / count)
        return cls(times, [_wrench_at(load, t).vector for t in times.tolist()])

    def to_dict(self) -> dict[str, Any]:
        """The series as plain data, which JSON can hold; ``from_dict`` gives back the equal series."""
        return {"times": self.times.tolist(), "vectors": self.vectors.tolist()}

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> "LoadSeries":
        """The series of plain data.

        Args:
            data: what ``to_dict`` returned, or JSON made of it.

        Raises:
            InvalidInput: For other keys and as ``LoadSeries`` does.
        """
        return cls(**entries(data, "a load series", ("times", "vectors")))

    @property
    def duration(self) -> float:
        """[s]."""
        return float(self.times[-1])

    def __call__(self, t: float) -> Wrench:
        """The load at a time in [0, duration] [s]."""
        return Wrench.from_vector(self.at(number(t, "t", least=0)))

    def at(self, t: ArrayLike) -> Array:
        """(..., 3) or (..., 6) at times in [0, duration] [s].

        Args:
            t: (...) times [s].
        """
        times = numbers_in(t, "t must be numbers")
        if not ((times >= 0) & (times <= self.duration)).all():
            raise InvalidInput(f"the load is known from 0 to {self.duration:g} s, asked for t = {shown(t)}")
        result: Array = np.stack([np.interp(times, self.times, c) for c in self.vectors.T], axis=-1)
        return result

    def refined(self, instants: int, *also: float) -> "LoadSeries":
        """The same load known at ``instants`` equal steps, too, and at the times of ``also`` [s].

        Args:
            instants: equal steps, both ends included.
            *also: more times [s].
        """
        whole(instants, "instants", least=2, most=MOST_INSTANTS)
        times: Array = np.unique(finite(also, "times"))
        for more in (self.times, np.linspace(0, self.duration, instants)):
            times = _merged(times, more, 1e-9 * self.duration / instants)
        return LoadSeries(times, self.at(times))

    def __repr__(self) -> str:
        return f"LoadSeries({self.times.size} instants over {self.duration:g} s)"


def _wrench_at(load: Callable[[float], Wrench], t: float) -> Wrench:
    wrench = load(t)
    if not isinstance(wrench, Wrench):
        raise InvalidInput(f"a load function must return a Wrench, at t = {t:g} it returned {shown(wrench)}")
    return wrench


def _merged(times: Array, more: Array, apart: float) -> Array:
    """Both, but for those of ``more`` not ``apart`` from one of ``times``: every stretch has a length."""
    fence = np.concatenate([[-inf], times, [inf]])
    place = np.searchsorted(times, more)
    away = np.minimum(more - fence[place], fence[place + 1] - more)
    return np.union1d(times, more[away > apart])

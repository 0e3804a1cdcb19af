"""Fingers that move at once: each starts as early as it keeps clear of what all others do in time."""

from dataclasses import dataclass, field

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.motions.bounds import keeps, least, segments
from regrasp.motions.geometry.apart import apart
from regrasp.motions.rounded import FASTEST, RoundedWay

_STARTS = 24  # tried between the earliest and the one after everything else
_FINEST = 1 / 1000  # of the clearance: shorter pieces of time, by how far fingers go in them, do not tell


@dataclass(frozen=True)
class Leg:
    """A finger's way from rest to rest. start, duration: [s]."""

    way: RoundedWay
    start: float
    duration: float

    @property
    def end(self) -> float:
        """When it is over [s]."""
        return self.start + self.duration

    @property
    def fastest(self) -> float:
        """A bound on the speed [m/s]."""
        return FASTEST * self.way.length / self.duration


@dataclass
class Timeline:
    """Where a finger is over time: at ``rest`` (d,), then on its legs and at their ends [m]."""

    rest: Array
    capsule: Array
    legs: list[Leg] = field(default_factory=list)

    def at(self, t: Array) -> Array:
        """(m, d) the tip's centre at times (m,) [m]."""
        result = np.tile(self.rest, (t.size, 1))
        for leg in self.legs:
            x = np.clip((t - leg.start) / leg.duration, 0.0, 1.0)
            begun = t > leg.start
            result[begun] = leg.way.over_time(x[begun], leg.duration)[0]
        return result

    @property
    def fastest(self) -> float:
        """A bound on the speed [m/s]."""
        return max((leg.fastest for leg in self.legs), default=0.0)


class Traffic:
    """The timelines of all fingers in a pause, and how far apart they are.

    apart: how far axes keep; clearance: for the fineness of proofs [m].
    """

    def __init__(self, rests: list[Array], capsules: Array, apart: float, clearance: float) -> None:
        self.lines = [Timeline(rest, v) for rest, v in zip(rests, capsules, strict=True)]
        self._apart, self._clearance = apart, clearance

    @property
    def end(self) -> float:
        """When all are at rest [s]."""
        return max((leg.end for line in self.lines for leg in line.legs), default=-np.inf)

    def add(self, finger: int, way: RoundedWay, duration: float, earliest: float, latest: float) -> Leg:
        """The leg with the first start found clear from ``earliest`` on; at ``latest`` it is."""
        line = self.lines[finger]
        for start in np.linspace(earliest, latest, _STARTS + 1)[:-1] if latest > earliest else ():
            line.legs.append(Leg(way, float(start), duration))
            if all(self._keeps(line, other) for other in self.lines if other is not line):
                return line.legs[-1]
            line.legs.pop()
        line.legs.append(Leg(way, max(earliest, latest), duration))
        return line.legs[-1]

    def gap(self, finger: int, leg: Leg) -> float:
        """A bound on how near the finger's axis comes to others' during a leg [m]."""
        line, within = self.lines[finger], self._clearance / 50
        others = [other for other in self.lines if other is not line and other.legs]
        return min((self._least(line, other, leg, within) for other in others), default=np.inf)

    def _keeps(self, one: Timeline, other: Timeline) -> bool:
        """Whether two keep apart from the start of the last leg of ``one`` until both are at rest."""
        if not other.legs:
            return True  # its way was planned around what stands
        start, end = one.legs[-1].start, max(one.legs[-1].end, *(leg.end for leg in other.legs))
        speed = one.fastest + other.fastest
        pieces = segments(np.array([[start], [end]]) * speed)
        return keeps(pieces, self._distance(one, other, speed), self._apart, _FINEST * self._clearance)

    def _least(self, one: Timeline, other: Timeline, leg: Leg, within: float) -> float:
        speed = one.fastest + other.fastest
        pieces = segments(np.array([[leg.start], [leg.end]]) * speed)
        return least(pieces, self._distance(one, other, speed), within)

    def _distance(self, one: Timeline, other: Timeline, speed: float):  # type: ignore[no-untyped-def]
        """How far apart two are at times, given as (m, 1) times ``speed``, so that it changes no faster."""

        def distance(scaled: Array) -> Array:
            t = scaled[:, 0] / speed
            return apart(one.at(t), one.capsule, other.at(t), other.capsule)

        return distance

"""The mean time of a solver over problems that take from microseconds to seconds."""

from collections.abc import Iterable
from math import exp, fsum, log1p

from regrasp.errors import InvalidInput

SHIFT = 1e-5
"""Added to every time before the mean [s]: times far below it count alike, and they are a Python call's own
cost. qpbenchmark's shift of 10 s would make every problem here count alike."""


def shifted_geometric_mean(times: Iterable[float], shift: float = SHIFT) -> float:
    """exp(mean log(t + shift)) - shift, in the unit of the times.

    Raises ``InvalidInput`` for no times, a negative time or a shift that is not positive.
    """
    times = list(times)
    if not times or min(times) < 0 or not shift > 0:
        raise InvalidInput(f"expected times of at least 0 and a positive shift, got {times[:5]} and {shift}")
    return shift * (exp(fsum(log1p(time / shift) for time in times) / len(times)) - 1)

"""The time that is left of a limit, for whatever is asked in turn to solve one program."""

from math import inf
from time import monotonic

_LEAST = 1e-9


class Deadline:
    """A limit that begins now.

    Args:
        seconds: how long it lasts [s]; None for no limit.
    """

    def __init__(self, seconds: float | None) -> None:
        self._end = inf if seconds is None else monotonic() + seconds

    @property
    def left(self) -> float | None:
        """What is left of it [s], or None without a limit; never 0, which some solvers take for no limit."""
        return None if self._end == inf else max(self._end - monotonic(), _LEAST)

    @property
    def is_over(self) -> bool:
        """Whether nothing is left."""
        return monotonic() >= self._end

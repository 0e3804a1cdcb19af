"""What a plan decided by itself."""

from dataclasses import dataclass, replace
from typing import Literal

from regrasp.mechanics.robust.withstood import Withstood


@dataclass(frozen=True)
class Choice:
    """How one end of a plan was chosen.

    end: which one. objective: what for. method: ``closed-form`` or the back end.
    force_limits: one per contact in use [N], those set by ``peak_ratio`` included; infinite for none.
    """

    end: Literal["start", "end"]
    objective: str
    method: str
    force_limits: tuple[float, ...]


@dataclass(frozen=True)
class Record:
    """What a plan decided by itself.

    reserve: fraction of every friction coefficient kept back. choices: the ends that were not given.
    balancing: largest change of a given force to reach exact equilibrium [N].
    path: ``closed-form`` for Eq. 1-3, or what planned the instants: a back end, or ``time-banded``.
    path_objective: what for. rate_limits [N/s], least_normals [N]: one for each contact; empty for none.
    withstands: deviations of the load, and early losses, at every instant; None for none.
    """

    reserve: float
    choices: tuple[Choice, ...] = ()
    balancing: float = 0.0
    path: str = "closed-form"
    path_objective: str | None = None
    rate_limits: tuple[float, ...] = ()
    least_normals: tuple[float, ...] = ()
    withstands: Withstood | None = None

    def reversed(self) -> "Record":
        """That of the same plan run backwards."""
        choices = tuple(replace(c, end="end" if c.end == "start" else "start") for c in self.choices)
        return replace(self, choices=choices)

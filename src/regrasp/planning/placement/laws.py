"""What a placement is judged by: each objective as a gauge of the wrenches that its forces make."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

from regrasp.errors import InvalidInput, shown
from regrasp.planning.states.objectives import OBJECTIVES, Objective, objective_of


class Law(NamedTuple):
    """The p-norm of the sizes of the forces, raised to a power.

    size: ``normal``, n . f, ``force``, |f|, or ``margin``, |f| of forces that keep a distance from the
    edges of their cones. norm: ``sum`` (p = 1), ``squares`` (2) or ``largest``.
    """

    size: str
    norm: str
    power: int = 1

    def codes(self) -> tuple[int, int]:
        """As the compiled search takes them."""
        return ("normal", "force", "margin").index(self.size), ("sum", "squares", "largest").index(self.norm)


LAWS: Mapping[str, Law] = MappingProxyType(
    {
        "sum_normal": Law("normal", "sum"),
        "peak_normal": Law("normal", "largest"),
        "peak": Law("force", "largest"),
        "effort": Law("force", "squares", power=2),
        # levels at which forces below a limit must exist (``levels``)
        "friction_use": Law("force", "largest"),
        "angle": Law("force", "largest"),
        "force": Law("margin", "largest"),
        "answered": Law("force", "largest"),
        "wrench": Law("force", "largest"),
        "wrench_ball": Law("normal", "largest"),
    }
)
LEVELS = ("friction_use", "angle", "force", "answered", "wrench", "wrench_ball")
LARGEST = tuple(word for word in LEVELS if word != "friction_use")
"""Objectives that are best as large as can be; of the others less is better."""

_ALLOWED = {"friction_use": 1e-9, "angle": 1e-9}  # by which ``verify`` lets a value be off
_OF_A_PLACEMENT = {"wrench_ball": "N", "answered": "times the disturbance", "wrench": "times the disturbance"}


def measured_in(word: str) -> str:
    """The unit of a value in words; empty for a share of the friction."""
    known = OBJECTIVES.get(word)
    return _OF_A_PLACEMENT.get(word, "" if known is None or known.unit == "-" else known.unit)


def without_rounding(word: str, value: float) -> float:
    """The value of an objective, 0 where it is no more than ``verify`` lets it be off."""
    return 0.0 if abs(value) <= _ALLOWED.get(word, 0.0) else value


def law_of(objective: str | Objective) -> tuple[str, Law]:
    """The word of an objective and its law. ``InvalidInput`` for one that placements have no bound for."""
    if isinstance(objective, Objective) and objective_of(objective) == OBJECTIVES.get(objective.name):
        objective = objective.name
    if not isinstance(objective, str) or objective not in LAWS:
        raise InvalidInput(f"objective must be one of {', '.join(LAWS)}; got {shown(objective)}")
    return objective, LAWS[objective]

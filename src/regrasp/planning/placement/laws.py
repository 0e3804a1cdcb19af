"""What a placement is judged by: each objective as a gauge of the wrenches that its forces make."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

from regrasp.errors import InvalidInput
from regrasp.planning.states.objectives import Objective, objective_of


class Law(NamedTuple):
    """The p-norm of the sizes of the forces, raised to a power.

    size: ``normal``, n . f, or ``force``, |f|. norm: ``sum`` (p = 1), ``squares`` (2) or ``largest``.
    """

    size: str
    norm: str
    power: int = 1

    def codes(self) -> tuple[int, int]:
        """As the compiled search takes them."""
        return ("normal", "force").index(self.size), ("sum", "squares", "largest").index(self.norm)


LAWS: Mapping[str, Law] = MappingProxyType(
    {
        "sum_normal": Law("normal", "sum"),
        "peak_normal": Law("normal", "largest"),
        "peak": Law("force", "largest"),
        "effort": Law("force", "squares", power=2),
    }
)


def law_of(objective: str | Objective) -> tuple[Objective, Law]:
    """The objective and its law. Raises ``InvalidInput`` for one that placements have no bound for."""
    if isinstance(objective, str) and objective not in LAWS:
        raise InvalidInput(f"objective must be one of {', '.join(LAWS)}; got {objective!r}")
    known = objective_of(objective)
    law = LAWS.get(known.name)
    if law is None or known != objective_of(known.name):
        raise InvalidInput(f"objective must be one of {', '.join(LAWS)}; got {known.name!r}")
    return known, law

"""What a plan says that it withstands besides its load."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.plain import entries
from regrasp.mechanics.robust.stiffness import Stiffness, checked_stiffness
from regrasp.mechanics.value import ArrayValue


@dataclass(frozen=True, eq=False)
class Withstood(ArrayValue):
    """Deviations that every instant of a plan withstands (docs/robustness.md).

    disturbance: of the load, on top of it; None for none. stiffness: of the fingers that answer, one number
    or a row for each contact in play [N/m]. early_loss: whether a finger that leaves or arrives may lose
    contact early.
    """

    disturbance: LoadSet | None
    stiffness: Stiffness = 1.0
    early_loss: bool = False

    def __post_init__(self) -> None:
        if self.disturbance is None and not self.early_loss:
            raise InvalidInput("what is withstood must be a disturbance or an early loss, got neither")

    def to_dict(self) -> dict[str, Any]:
        """As plain data, which JSON can hold."""
        return {
            "disturbance": None if self.disturbance is None else self.disturbance.to_dict(),
            "stiffness": self.stiffness,
            "early_loss": self.early_loss,
        }

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> "Withstood":
        """What ``to_dict`` made, or JSON of it. Raises ``InvalidInput`` for anything else."""
        given = entries(data, "withstands", ("disturbance", "stiffness", "early_loss"))
        loads, early = given["disturbance"], given["early_loss"]
        if not isinstance(early, bool):
            raise InvalidInput(f"early_loss must be True or False, got {shown(early)}")
        disturbance = None if loads is None else LoadSet.from_dict(loads)
        return cls(disturbance, checked_stiffness(given["stiffness"]), early)

    def __str__(self) -> str:
        said = [] if self.disturbance is None else [str(self.disturbance)]
        said += ["the early loss of a finger that leaves or arrives"] if self.early_loss else []
        return " and ".join(said)

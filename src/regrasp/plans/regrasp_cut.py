"""Why no regrasp exists on some contacts: a cut that no hold crosses."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import items, number, whole
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.plain import entries, listed
from regrasp.mechanics.value import ArrayValue


@dataclass(frozen=True, eq=False)
class RegraspCut(ArrayValue):
    """Contacts in two parts: no regrasp of three fingers leads from a start in one to a goal in the other.

    While a finger is in the air two others hold, and every hold shares a contact with the next. Where no pair
    of contacts from both parts holds any load through the centre of mass, no pair of the start holds outside
    its part and none of the goal inside it, the start can never be left for the goal: at no orientation,
    under no such load, with no forces, whatever turns three fingers make. ``verify`` decides it in rationals.

    Not covered: contacts at other points, fingers that slide or roll, loads with a torque about the centre of
    mass.

    Args:
        contacts: planar, relative to the centre of mass [m].
        start: three places among them.
        goal: three places among them.
        reached: places of the part that the start's holds are in.
        least_margin: angle margin of every hold [rad].
        min_distance: of the two fingers of a hold [m].
    """

    contacts: tuple[Contact, ...]
    start: tuple[int, ...]
    goal: tuple[int, ...]
    reached: tuple[int, ...]
    least_margin: float = 0.0
    min_distance: float = 0.0

    def __post_init__(self) -> None:
        contacts = tuple(items(self.contacts, "contacts"))
        if any(not isinstance(c, Contact) or c.dimension != 2 for c in contacts):
            raise InvalidInput(f"contacts of a cut must be planar contacts, got {shown(self.contacts)}")
        object.__setattr__(self, "contacts", contacts)
        for name in ("start", "goal", "reached"):
            places = tuple(
                whole(k, f"each of {name}", least=0, most=max(len(contacts) - 1, 0))
                for k in items(getattr(self, name), name)
            )
            if len(set(places)) != len(places) or (name != "reached" and len(places) != 3):
                raise InvalidInput(f"{name} must be {'' if name == 'reached' else 'three '}different places")
            object.__setattr__(self, name, places)
        number(self.least_margin, "least_margin", least=0)
        number(self.min_distance, "min_distance", least=0)

    def to_dict(self) -> dict[str, Any]:
        """The cut as plain data, which JSON can hold; ``from_dict`` gives back the equal cut."""
        return {
            "contacts": [contact.to_dict() for contact in self.contacts],
            "start": list(self.start),
            "goal": list(self.goal),
            "reached": list(self.reached),
            "least_margin": self.least_margin,
            "min_distance": self.min_distance,
        }

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> "RegraspCut":
        """The cut of plain data.

        Args:
            data: what ``to_dict`` returned, or JSON made of it.

        Raises:
            InvalidInput: For other keys and as ``RegraspCut`` does.
        """
        given = entries(
            data, "a cut", ("contacts", "start", "goal", "reached", "least_margin", "min_distance")
        )
        contacts = [Contact.from_dict(c) for c in listed(given.pop("contacts"), "contacts of a cut")]
        return cls(contacts=tuple(contacts), **given)

    def __str__(self) -> str:
        return (
            f"a cut of {len(self.contacts)} contacts into {len(self.reached)} on the start's side and "
            f"{len(self.contacts) - len(self.reached)} others, which no hold crosses at any orientation"
        )

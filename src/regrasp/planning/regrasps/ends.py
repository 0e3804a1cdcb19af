"""The contacts of the grasps where a regrasp starts and ends."""

from collections.abc import Sequence
from itertools import permutations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.value import numbers
from regrasp.planning.changes.given_ends import with_limit

# Two contacts nearer than this fraction of the object are one.
_SAME = 1e-9
# A contact farther from its outline or mesh than this fraction of its size is not on it.
_OFF = 1e-6


class Ends:
    """Contacts of both grasps among the candidates: those at one place are one.

    contacts: of the start, then of the goal. start, goal: their places.
    """

    def __init__(
        self, start: Grasp, goal: Grasp, max_force: float | None, *, fingers: int, wanted: str
    ) -> None:
        for what, grasp in (("start", start), ("goal", goal)):
            if not isinstance(grasp, Grasp) or len(grasp) != fingers or grasp.dimension != fingers - 1:
                raise InvalidInput(f"{what} must be a Grasp of {wanted}, got {shown(grasp)}")
        self._limit = max_force
        self.contacts: list[Contact] = []
        self.start = tuple(self._place(c, f"start {c.name}") for c in start)
        self.goal = tuple(self._place(c, f"goal {c.name}") for c in goal)

    def _place(self, contact: Contact, name: str) -> int:
        size = max(
            float(abs(contact.position).max()), *(float(abs(c.position).max()) for c in self.contacts), 0.0
        )
        for i, known in enumerate(self.contacts):
            if abs(known.position - contact.position).max() <= _SAME * size:
                return i
        if self._limit is not None:
            contact = with_limit(contact, min(self._limit, contact.max_force or self._limit))
        self.contacts.append(contact.named(name))
        return len(self.contacts) - 1

    def refuse_off(self, contact: Contact, on: Array, size: float, shape: str) -> None:
        """Raise ``InvalidInput`` unless a contact is ``on`` its shape; both relative to the centre."""
        off = float(np.linalg.norm(contact.position - on))
        if off > _OFF * size:
            raise InvalidInput(
                f"{contact.name} at {numbers(contact.position)} is {off:.3g} away from the {shape}, whose "
                f"nearest point is {numbers(on)}, all relative to the centre of mass; make contacts with "
                f"{shape}.contact_at"
            )

    def joined(self, sampled: list[Contact]) -> tuple[Contact, ...]:
        """The contacts of both ends, then the sampled ones that are at other places, named by their order."""
        ends = np.array([c.position for c in self.contacts])
        size = float(abs(ends).max())
        others = [
            c.named(f"c{i}")
            for i, c in enumerate(sampled, 1)
            if abs(ends - c.position).max(axis=1).min() > _SAME * size
        ]
        return (*self.contacts, *others)

    def check(self, allowed: NDArray[np.bool_], arcs: Sequence[Any]) -> None:
        """Raise ``InvalidInput`` unless fingers stand on their arcs and can take the contacts of the goal."""
        for finger, place in enumerate(self.start):
            if not allowed[finger, place]:
                raise InvalidInput(
                    f"{self.contacts[place].name} is not on the arc of finger {finger + 1}, "
                    f"{shown(arcs[finger])}, which touches it at the start"
                )
        for place in self.goal:
            if not allowed[:, place].any():
                raise InvalidInput(f"{self.contacts[place].name} is on no finger's arc: {shown(list(arcs))}")
        if not any(all(allowed[f, v] for f, v in enumerate(way)) for way in permutations(self.goal)):
            raise InvalidInput(
                f"{'three' if len(self.goal) == 3 else 'four'} fingers cannot take the contacts of the goal: "
                + "; ".join(
                    f"{self.contacts[v].name} is on the arc of finger "
                    + " and ".join(str(f + 1) for f in range(len(allowed)) if allowed[f, v])
                    for v in self.goal
                )
            )

"""Contacts that make one grasp: their names, and that no two are one."""

from collections.abc import Iterator, Sequence
from itertools import count

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.contact import Contact

COINCIDENT = 1e-12
"""Contacts nearer than this fraction of the largest coordinate are one point in double precision."""


def named(contacts: tuple[Contact, ...]) -> tuple[Contact, ...]:
    """Unnamed contacts get the name of their place, or the next P<k> that nobody has."""
    taken = {contact.name for contact in contacts}
    result = []
    for place, contact in enumerate(contacts, 1):
        if contact.name is None:
            name = next(name for k in count(place) if (name := f"P{k}") not in taken)
            taken.add(name)
            contact = contact.named(name)
        result.append(contact)
    return tuple(result)


def refuse_equal_names(contacts: tuple[Contact, ...]) -> None:
    """Each name is of one contact."""
    names = [contact.name for contact in contacts]
    for name in names:
        if names.count(name) > 1:
            raise InvalidInput(f"contacts of one grasp must have different names, {shown(name)} came twice")


def refuse_coincident(contacts: tuple[Contact, ...]) -> None:
    """At one point two fingers may push along different normals (an inner corner), not along the same one."""
    for first, second in coincident(contacts):
        a, b = contacts[first], contacts[second]
        if abs(a.normal - b.normal).max() <= COINCIDENT:
            raise InvalidInput(
                f"contacts {shown(a.name)} and {shown(b.name)} coincide at "
                f"{a.position.tolist()}; place them at different points"
            )


def coincident(contacts: Sequence[Contact]) -> Iterator[tuple[int, int]]:
    """Pairs of contacts at one point, up to rounding of the largest coordinate."""
    points = [contact.position.tolist() for contact in contacts]
    near = COINCIDENT * max(abs(x) for p in points for x in p)
    for j, p in enumerate(points):
        for i, q in enumerate(points[:j]):
            if all(abs(a - b) <= near for a, b in zip(p, q, strict=True)):
                yield i, j

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
    if taken == {None}:
        return tuple([contact._under(f"P{place}") for place, contact in enumerate(contacts, 1)])
    result = []
    for place, contact in enumerate(contacts, 1):
        if contact.name is None:
            name = next(name for k in count(place) if (name := f"P{k}") not in taken)
            taken.add(name)
            contact = contact._under(name)
        result.append(contact)
    return tuple(result)


def refuse_equal_names(contacts: tuple[Contact, ...]) -> None:
    """Each name is of one contact."""
    names = [contact.name for contact in contacts]
    if len(set(names)) == len(names):
        return
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
    d = contacts[0].dimension
    points = [contact.plain[:d] for contact in contacts]
    near = COINCIDENT * max([max(map(abs, p)) for p in points])
    for j, p in enumerate(points):
        for i in range(j):
            q = points[i]
            if abs(p[0] - q[0]) <= near and abs(p[1] - q[1]) <= near and abs(p[-1] - q[-1]) <= near:
                yield i, j

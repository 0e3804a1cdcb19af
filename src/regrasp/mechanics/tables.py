"""Contacts as a table for notebooks."""

from collections.abc import Iterable

from regrasp.display import table
from regrasp.mechanics.contact import Contact


def contacts_table(contacts: Iterable[Contact]) -> str:
    """Names, places, normals and limits, a row for each contact."""
    given = tuple(contacts)
    axes = "xyz"[: given[0].position.size]
    head = ["finger", *(f"{a} [m]" for a in axes), *(f"n{a}" for a in axes), "friction", "max force [N]"]
    limits = ["none" if c.max_force is None else c.max_force for c in given]
    rows = [
        [c.name, *c.position.tolist(), *c.normal.tolist(), c.friction, limit]
        for c, limit in zip(given, limits, strict=True)
    ]
    return table(head, rows)

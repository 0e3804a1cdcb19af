"""Every public name with arguments that are right, and what is wrong for each of its parameters.

A parameter is of a kind, by its name; for each kind there are values that it must refuse. The cases are made
from the signatures, so a new parameter without a kind, or a new name without a row, fails the test. A room's
names have their rows in its module; what is wrong for a kind stands in ``wrong``.
"""

from functools import cache
from types import ModuleType

from wrong_calls import (
    changes,
    files,
    mechanics,
    pictures,
    placement,
    plans,
    regrasps,
    shapes,
    states,
    studies,
    surveys,
)
from wrong_calls.row import Row

ROOMS = (mechanics, states, surveys, plans, changes, placement, regrasps, shapes, studies, files, pictures)


@cache
def rows_of(room: ModuleType) -> dict[str, Row]:
    """The rows of a room by name, made when first asked for: some values take seconds."""
    made: dict[str, Row] = room.rows()
    return made


def rows() -> dict[str, Row]:
    """All of them."""
    found = [item for room in ROOMS for item in rows_of(room).items()]
    assert len(dict(found)) == len(found), "a name has two rows"
    return dict(found)

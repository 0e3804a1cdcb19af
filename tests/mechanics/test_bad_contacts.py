"""What contacts, wrenches, grasps and states refuse, to the word."""

import re
from collections.abc import Callable
from math import inf, nan

import numpy as np
import pytest

import regrasp as rg
from paper import GRASP, LOAD, STATE
from refusals import check_error

pytestmark = pytest.mark.contract

P1, P2, P3 = GRASP
TWO, REMOVAL = GRASP.without("P3"), rg.plan_removal(STATE, "P3")
SPACE = rg.Grasp([rg.Contact([np.cos(a), np.sin(a), 0], [-np.cos(a), -np.sin(a), 0], 1) for a in (0, 2, 4)])

Call = Callable[[], object]
CALLS: dict[str, tuple[Call, type[Exception], str | re.Pattern[str]]] = {
    "Contact: words": (
        lambda: rg.Contact("here", [1, 0], 0.3),
        rg.InvalidInput,
        "contact: position must be 2 or 3 numbers, got 'here'",
    ),
    "Wrench: one number": (
        lambda: rg.Wrench(-2),
        rg.InvalidInput,
        "force must be 2 or 3 numbers, got -2",
    ),
    "Contact: one coordinate": (
        lambda: rg.Contact([1], [1, 0], 0.3),
        rg.InvalidInput,
        "contact: position must be 2 or 3 numbers, got 1: [1]",
    ),
    "Contact: NaN": (
        lambda: rg.Contact([nan, 0], [1, 0], 0.3, name="A"),
        rg.InvalidInput,
        "contact 'A': position must be finite, got [nan, 0]",
    ),
    "Contact: mixed dimensions": (
        lambda: rg.Contact([0, 0], [1, 0, 0], 0.3),
        rg.InvalidInput,
        "contact: position and normal must have the same dimension, got 2 and 3",
    ),
    "Contact: zero normal": (
        lambda: rg.Contact([0, 0], [0, 0], 0.3),
        rg.InvalidInput,
        "contact: normal must not be zero; give the direction that points into the object",
    ),
    "Contact: negative friction": (
        lambda: rg.Contact([0, 0], [1, 0], -0.1),
        rg.InvalidInput,
        "contact: friction must be at least 0, got -0.1",
    ),
    "Contact: friction as text": (
        lambda: rg.Contact([0, 0], [1, 0], "0.3"),
        rg.InvalidInput,
        "contact: friction must be a number, got '0.3'",
    ),
    "Contact: moved": (
        lambda: P1.changed(position=[0, 0]),
        rg.InvalidInput,
        "friction, max_force, torsion, limits and name of a contact can be changed, got position; "
        "make another Contact",
    ),
    "Contact: changed in a list": (
        lambda: rg.Grasp(c.changed(friction=0.5, normal=[0, 1]) for c in GRASP),
        rg.InvalidInput,
        "friction, max_force, torsion, limits and name of a contact can be changed, got normal; "
        "make another Contact",
    ),
    "Contact: infinite limit": (
        lambda: rg.Contact([0, 0], [1, 0], 0.3, max_force=inf),
        rg.InvalidInput,
        "contact: max_force must be finite, got inf",
    ),
    "Contact: zero limit": (
        lambda: rg.Contact([0, 0], [1, 0], 0.3, max_force=0),
        rg.InvalidInput,
        "contact: max_force must be greater than 0, got 0",
    ),
    "Contact: name of no text": (
        lambda: rg.Contact([0, 0], [1, 0], 0.3, name=3),
        rg.InvalidInput,
        "a contact's name must be a non-empty string, got 3",
    ),
    "Wrench: infinite": (
        lambda: rg.Wrench([inf, 0]),
        rg.InvalidInput,
        "force must be finite, got [inf, 0]",
    ),
    "Wrench: planar torque of three": (
        lambda: rg.Wrench([1, 0], [1, 2, 3]),
        rg.InvalidInput,
        "torque must be a number, got [1, 2, 3]",
    ),
    "Wrench: torque in space of one": (
        lambda: rg.Wrench([1, 0, 0], 2),
        rg.InvalidInput,
        "torque must have shape (3,), got (): 2",
    ),
    "Wrench: plus a number": (
        lambda: LOAD + 1,
        rg.InvalidInput,
        "a wrench combines with a wrench, got 1",
    ),
    "Grasp: empty": (
        lambda: rg.Grasp([]),
        rg.InvalidInput,
        "a grasp needs at least one contact, got none",
    ),
    "Grasp: no list": (
        lambda: rg.Grasp(3),
        rg.InvalidInput,
        "contacts of a grasp must be a list, got 3",
    ),
    "Grasp: a generator's own mistake": (
        lambda: rg.Grasp(c.named() for c in GRASP),
        TypeError,
        re.compile(r"Contact\.named\(\) missing 1 required positional argument: .*"),
    ),
    "Grasp: of points": (
        lambda: rg.Grasp([[0, 0], [1, 0]]),
        rg.InvalidInput,
        "a grasp is made of Contacts, got [0, 0]",
    ),
    "Grasp: plane and space": (
        lambda: rg.Grasp([P1, SPACE[0]]),
        rg.InvalidInput,
        "contacts of one grasp must have one dimension, got 2 and 3",
    ),
    "Grasp: same name twice": (
        lambda: rg.Grasp([P1, P2.named("P1")]),
        rg.InvalidInput,
        "contacts of one grasp must have different names, 'P1' came twice",
    ),
    "Grasp: coincident": (
        lambda: rg.Grasp([P1, rg.Contact([-4, -4], [1, 1], 0.3, name="Q")]),
        rg.InvalidInput,
        "contacts 'P1' and 'Q' coincide at [-4.0, -4.0]; place them at different points",
    ),
    "Grasp: unknown name": (
        lambda: GRASP["P4"],
        rg.InvalidInput,
        "no contact 'P4' in this grasp; it has P1, P2, P3",
    ),
    "Grasp: index too large": (
        lambda: GRASP[3],
        rg.InvalidInput,
        "no contact 3 in this grasp; it has 3, counted from 0",
    ),
    "Grasp: index of no kind": (
        lambda: GRASP[1.0],
        rg.InvalidInput,
        "a contact is addressed by name or index, got 1.0",
    ),
    "GraspState: forces of two": (
        lambda: rg.GraspState(GRASP, LOAD, [[1, 0], [0, 1]]),
        rg.InvalidInput,
        "forces must have shape (3, 2), got (2, 2): [[1, 0], [0, 1]]",
    ),
    "GraspState: NaN": (
        lambda: rg.GraspState(TWO, LOAD, [[1, 0], [0, nan]]),
        rg.InvalidInput,
        "forces must be finite, got [[1, 0], [0, nan]]",
    ),
    "GraspState: load as a list": (
        lambda: rg.GraspState(TWO, [0, -1], [[1, 0], [0, 1]]),
        rg.InvalidInput,
        "load must be a Wrench, got [0, -1]; write Wrench(force=[...])",
    ),
    "GraspState: load in space": (
        lambda: rg.GraspState(TWO, rg.Wrench([0, 0, -1]), [[1, 0], [0, 1]]),
        rg.InvalidInput,
        "load must have the grasp's dimension 2, got 3",
    ),
}


@pytest.mark.parametrize("name", CALLS)
def test_bad_contact(name: str) -> None:
    check_error(*CALLS[name])

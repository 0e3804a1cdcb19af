"""States of crosses as plain values, and what ``verify`` says of plans between them."""

import regrasp as rg
from foreign import cross, solid_cross

CROSSES = {"plane": cross, "space": solid_cross}
EPS = 2.0**-40


def squeezed(make=cross, frictions=(0.75,) * 4, idle=()):
    """A state of a cross, without the pairs named in ``idle``: A and D, B and C are diagonal pairs."""
    grasp, forces = make(frictions)
    forces[:, 1:] = 0
    for i in idle:
        forces[i] = 0
    return rg.GraspState(grasp, rg.Wrench([0.0] * grasp.dimension), forces)


# A and C, and B and D, face each other: either pair holds the object alone.
WHOLE, UPPER, LOWER = squeezed(), squeezed(idle=(1, 3)), squeezed(idle=(0, 2))
FINGERS = "removal", "B", WHOLE, UPPER

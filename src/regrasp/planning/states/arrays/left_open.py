"""Grasps of a batch that small programs leave open, asked one by one."""

from contextlib import suppress
from math import inf

from regrasp.errors import Infeasible, RegraspError
from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.escape import EscapeTwist
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.arrays.many_grasps import ManyGrasps
from regrasp.planning.states.choosing import choose_forces
from regrasp.planning.states.criteria import Criteria
from regrasp.planning.states.objectives import Objective


def again(
    given: ManyGrasps,
    k: int,
    objective: Objective,
    peak_ratio: float,
    reserve: float,
    forces: Array,
    twists: Array,
) -> None:
    """Writes the forces or the twist of one grasp, if any are found; they are checked by others."""
    rows = (given.positions[k], given.normals[k], given.frictions[k].tolist(), given.limits[k].tolist())
    with suppress(RegraspError):
        grasp = Grasp(
            Contact(r, n, mu, max_force=most if most < inf else None)
            for r, n, mu, most in zip(*rows, strict=True)
        )
        criteria = Criteria(objective, peak_ratio=peak_ratio, reserve=reserve)
        try:
            forces[k] = choose_forces(grasp, Wrench.from_vector(given.loads[k]), criteria).forces
        except Infeasible as refusal:
            if isinstance(refusal.certificate, EscapeTwist):
                twists[k] = refusal.certificate.twist

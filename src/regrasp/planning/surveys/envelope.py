"""How the optimum of a state program moves with everything that shapes it: the envelope theorem.

    V(p) = min 1/2 x'Px + q(p)'x  subject to  A(p) x + s = b(p), s in K     P does not depend on p
    dV/dp = x'dq/dp + z'(dA/dp x - db/dp)                                   z the duals at the optimum x

The data q, A and b are smooth functions of p written down once, in ``state_program``; they are differenced
there, the solution is not, so nothing is solved again and the error is that of the duals.
"""

from dataclasses import dataclass, replace
from math import cos, inf, sin

import numpy as np

from regrasp.errors import SolverFailed
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.objectives import ConvexObjective
from regrasp.planning.states.pressing import pressing
from regrasp.planning.states.program import state_program
from regrasp.programs import Program, Status, solve

Rates = dict[str, Array]
"""By parameter: ``friction``, ``limit`` and ``torsion`` (n,), ``position`` and ``normal`` (n, d - 1) along
and towards the tangents, ``load`` (3,) or (6,). Friction is the cone's: soft fingers' torsions follow it."""

# Cube root of the rounding unit: rounding and curvature of the data cost 1e-10 each.
_STEP = 6e-6


@dataclass(frozen=True)
class Setting:
    """What shapes a program: a grasp and its load; friction and limits in place of the contacts' own.

    frictions: (n,) [-]. limits: (n,) [N], infinite for none.
    """

    grasp: Grasp
    load: Wrench
    frictions: Array
    limits: Array

    def program(self, objective: ConvexObjective, unit: float, weights: Array | None) -> Program:
        """``state_program`` here."""
        frictions, limits = self.frictions.tolist(), self.limits.tolist()
        plain = state_program(self.grasp, self.load, objective, frictions, limits, unit, weights=weights)
        return pressing(plain, self.grasp, np.zeros(len(self.grasp)), unit, unit)  # linear limits

    def moved(self, parameter: str, place: tuple[int, ...], by: float) -> "Setting":
        """The setting with one number changed, at its place in the rates."""
        i = place[0]
        if parameter == "load":
            vector = self.load.vector.copy()
            vector[i] += by
            return replace(self, load=Wrench.from_vector(vector))
        one = by * np.eye(len(self.grasp))[i]
        if parameter == "friction":
            return replace(self, frictions=self.frictions + one)
        if parameter == "limit":
            return replace(self, limits=self.limits + one)
        contact = self.grasp[i]
        if parameter == "torsion":
            return replace(
                self, grasp=self.grasp.replaced(i, contact.changed(torsion=(contact.torsion or 0.0) + by))
            )
        tangent = self.grasp.cones.tangents[i, place[1], : self.grasp.dimension]
        if parameter == "position":
            changed = replace(contact, position=contact.position + by * tangent)
        else:
            changed = replace(contact, normal=cos(by) * contact.normal + sin(by) * tangent)
        return replace(self, grasp=self.grasp.replaced(i, changed))

    def steps(self, unit: float) -> Rates:
        """A small change of every parameter; 0 where it is no parameter here.

        A contact without friction, limit or torsion has none to change.
        """
        grasp, size = self.grasp, self.grasp.size
        across = (len(grasp), grasp.dimension - 1)
        return {
            "friction": np.minimum(_STEP, self.frictions / 2),
            "position": np.full(across, _STEP * size),
            "normal": np.full(across, _STEP),
            "limit": _STEP * np.where(self.limits < inf, self.limits, 0.0),
            "torsion": _STEP * (np.zeros(len(grasp)) if grasp.torsions is None else grasp.torsions),
            "load": _STEP * unit * np.where(grasp.lengths == 1.0, 1.0, size),
        }


def optimum_rates(
    setting: Setting, objective: ConvexObjective, unit: float, weights: Array | None = None
) -> Rates:
    """Derivatives of the least value of ``state_program``.

    The value is that of the program, in units of ``unit`` [N] and with the sign of a minimum; ``weights`` as
    there. The parameters are in units of their own. Raises ``SolverFailed`` without a sound optimum.
    """
    answer = solve(setting.program(objective, unit, weights), "clarabel")
    if answer.status is not Status.SOLVED:  # a grasp at the limit of what it can hold
        raise SolverFailed(f"no duals to differentiate by: {answer}", answer.program, answer)
    x, z = answer.value, answer.duals

    def rate(parameter: str, place: tuple[int, ...], step: float) -> float:
        if step == 0:
            return 0.0
        ahead, behind = (
            setting.moved(parameter, place, by).program(objective, unit, weights) for by in (step, -step)
        )
        moved = z @ ((ahead.A - behind.A) @ x - (ahead.b - behind.b)) + x @ (ahead.q - behind.q)
        return float(moved) / (2 * step)

    found = {}
    for parameter, steps in setting.steps(unit).items():
        found[parameter] = np.array([rate(parameter, at, h) for at, h in np.ndenumerate(steps)]).reshape(
            steps.shape
        )
    return found

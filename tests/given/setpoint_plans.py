"""Plans of every kind, and what is found in rows of their set-points."""

import numpy as np

import regrasp as rg
from regrasp.verification import verify_setpoints

PLANE = rg.Grasp(
    rg.Contact(r, n, 0.3, name=name)
    for name, r, n in (("P1", [-4, -4], [1, 1]), ("P2", [4, -5], [-1, 2]), ("P3", [0, 8], [0, -1]))
)
BALL = rg.Grasp(
    rg.Contact(p, [-x for x in p], 0.7)
    for p in ([1, 0, 0], [-0.5, 0.8, 0.1], [-0.5, -0.8, -0.1], [0, 0.1, 1])
)


def swinging(t) -> rg.Wrench:
    wave = np.sin(2 * np.pi * t)
    return rg.Wrench([-1.5 + 0.5 * wave, -3.5 - wave])


def plans() -> dict[str, rg.Transition]:
    load, weight = rg.Wrench([-1.5, -3.5]), rg.Wrench([0, 0, -1.0])
    two = PLANE.without("P3")
    return {
        "removal": rg.plan_removal(PLANE, "P3", load=load),
        "addition": rg.plan_addition(two, PLANE["P3"], load=load, duration=0.3),
        "load in time": rg.plan_removal(PLANE, "P3", load=swinging, instants=11),
        "rates": rg.plan_removal(PLANE, "P3", load=load, rate_limit=10.0, duration=1.0, instants=11),
        "turn": rg.plan_rotation(two, 0.2, load=load),
        "turn back": rg.plan_rotation(two, -0.2, load=load),
        "turn with torque": rg.plan_rotation(two, 0.1, load=rg.Wrench([-1.5, -3.5], 0.5)),
        "space": rg.plan_removal(BALL, "P4", load=weight),
        "turn in space": rg.plan_rotation(BALL, 1.0, axis=[1, 0, 0.5], load=weight),
    }


PLANS = plans()


def told(plan, t, forces, angles=None) -> tuple[str, ...]:
    angles = plan.orientation(t) if angles is None and plan.turn is not None else angles
    return verify_setpoints(plan, forces, t, angles).violations

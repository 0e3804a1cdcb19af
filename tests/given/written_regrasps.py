"""Turns and regrasps to be written and read."""

from math import radians

import numpy as np

import regrasp as rg

WEIGHT = rg.Wrench([0, -3.0])
ELLIPSE = rg.Outline.ellipse(2, 1)
JAR = rg.Grasp([rg.Contact([-1, 0], [1, 0], 0.8, name="A"), rg.Contact([1, 0.1], [-1, 0], 0.8, name="B")])
ROTATION = rg.plan_rotation(JAR, radians(150), load=WEIGHT, duration=2.0)


def fingers_at(*places: float, prefix: str = "P") -> rg.Grasp:
    """Three contacts at fractions of the boundary of the ellipse."""
    return rg.Grasp(
        ELLIPSE.contact_at(s * ELLIPSE.length, friction=0.5, name=f"{prefix}{i}")
        for i, s in enumerate(places, 1)
    )


def turned_in_a_hold(plan: rg.RegraspPlan) -> rg.RegraspPlan:
    """The same, with a turn there and back in its first hold, and one of all fingers in the end."""
    removal, *others = plan.steps
    (air,) = removal.leaving
    hold = removal.end.without(air)
    there = rg.plan_rotation(hold, radians(15))
    steps = (removal, there, rg.plan_rotation(there.end, radians(-15), end=hold), *others)
    steps += (rg.plan_rotation(others[-1].end, radians(75)),)
    turned = np.cumsum([0.0, *(step.turn.angle if step.turn else 0.0 for step in steps)])
    margin = min(plan.margin, there.end.margins.least_angle)
    return rg.RegraspPlan(steps, tuple(turned.tolist()), margin)


REGRASP = turned_in_a_hold(
    rg.plan_regrasp(
        ELLIPSE,
        fingers_at(0.02, 0.35, 0.7),
        fingers_at(0.2, 0.5, 0.85),
        WEIGHT,
        friction=0.5,
        orientations=1,
    )
)

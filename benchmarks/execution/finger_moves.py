"""Plans that only move fingers: ways through the air depend on places, not on forces."""

import numpy as np

import regrasp as rg
from regrasp.plans.record import Record


def moved(contacts: list[rg.Contact]) -> rg.RegraspPlan:
    """The fingers of the first half of the contacts go to the second, one after the other.

    Ways depend on places only, so no forces are planned: all are zero, and nothing of this plan is verified.
    """
    steps, n = [], len(contacts) // 2
    d = contacts[0].dimension
    for k in range(n + 1):
        grasp = rg.Grasp(contacts[k : k + n])
        state = rg.GraspState(grasp, rg.Wrench(-np.eye(d)[-1]), np.zeros((n, d)))
        leaving = (str(grasp.names[0]),) if k < n else ()
        arriving = (str(grasp.names[-1]),) if k > 0 else ()
        clock, record = rg.TimeScaling.spline(1.0), Record(reserve=0.0)
        steps.append(rg.Transition(state, state, clock, record, leaving=leaving, arriving=arriving))
    return rg.RegraspPlan(tuple(steps), (0.0,) * (n + 2), 0.0)

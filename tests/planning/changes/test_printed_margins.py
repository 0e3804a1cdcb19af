"""The least margin that a plan prints is the least on the whole way."""

import numpy as np
import pytest

import regrasp as rg
from space import nose_cone

pytestmark = pytest.mark.laws

GRIPPY, DOWN = nose_cone(5, 0.5), rg.Wrench([0, 0, -1.0])


def shaken(t):
    return rg.Wrench([0.1 * np.sin(2 * np.pi * t), 0, -1 - 0.1 * np.sin(2 * np.pi * t)])


BALL = rg.Grasp(
    rg.Contact(p, [-x for x in p], 0.7)
    for p in ([1, 0, 0], [-0.5, 0.8, 0.1], [-0.5, -0.8, -0.1], [0, 0.1, 1])
)


@pytest.mark.parametrize(
    "plan",
    [
        rg.plan_removal(GRIPPY, 0, load=DOWN),
        rg.plan_removal(GRIPPY, 0, load=shaken, path_objective="effort", rate_limit=3.0, duration=2.0),
        rg.plan_rotation(BALL, 5.0, axis=[1, -2, 0.5], load=DOWN, objective="force"),
    ],
    ids=["straight", "instants", "turn"],
)
def test_printed_margins_are_those_of_the_whole_way(plan):
    angles = plan.margins(np.linspace(0, plan.duration, 2001)).angle
    for i, name in enumerate(plan.grasp.names):
        line = next(line for line in str(plan).splitlines() if line.startswith(name))
        least = np.degrees(np.nanmin(angles[:, i]))
        assert float(line.split()[-2]) <= least + 0.01

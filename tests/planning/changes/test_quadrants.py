"""Turns through all quadrants, either way, beside the path program under the same turning load."""

from math import pi

import numpy as np
import pytest

import regrasp as rg
from regrasp.mechanics.loads.rotated import turned_load
from regrasp.planning.changes.path_program import PathTask, path_program
from regrasp.programs import solve

pytestmark = pytest.mark.oracle

# Opposite fingers with wide cones hold a weight from every side.
PAIR = rg.Grasp(
    [rg.Contact([-1, 0.05], [1, 0], 0.9, name="A"), rg.Contact([1, -0.05], [-1, 0], 0.9, name="B")]
)
WEIGHT = rg.Wrench([0, -2.0])


def widest_path(start, end, first, turn, instants=25):
    """The least force margin of the best path between two forces while the object turns, and its forces."""
    angles = first + np.linspace(0, turn, instants)
    task = PathTask(
        grasp=PAIR,
        times=np.linspace(0, 1, instants),
        loads=np.array([turned_load(WEIGHT, a).vector for a in angles]),
        start=start,
        end=end,
        active=np.ones((instants, 2), dtype=bool),
        phases=np.linspace(0, 1, instants),
        frictions=PAIR.frictions,
        limits=np.full(2, np.inf),
        rates=np.full(2, np.inf),
        least_normals=np.zeros(2),
        stays=np.ones(2, dtype=bool),
        unit=2.0,
    )
    solution = solve(path_program(task, "force"))
    forces = np.concatenate(
        [[start], task.reference[1:-1] + solution.value[:-1].reshape(-1, 2, 2) * task.unit, [end]]
    )
    return solution.value[-1] * task.unit, angles, forces


@pytest.mark.filterwarnings("ignore:angle is in radians")  # whole turns are meant here
@pytest.mark.parametrize("quarters", [1, 2, 3, 4, 5, -1, -2, -3, -4, -5])
def test_a_rotation_agrees_with_the_path_program_in_every_quadrant(quarters):
    """Between two states of a turn the closed form keeps the margin of the narrower one: no path keeps more.

    The program knows nothing of the closed form: the load is a function of time to it.
    """
    angle = quarters * pi / 2
    plan = rg.plan_rotation(PAIR, angle, load=WEIGHT, duration=1.0)
    assert rg.verify(plan).ok
    knots, forces = plan.turn.angles, plan.turn.forces
    assert knots[-1] == pytest.approx(angle)
    t = np.linspace(0, 1, 4001)
    turned, margins, loads = plan.orientation(t), plan.margins(t).force.min(axis=1), plan.load(t)
    for k in range(len(knots) - 1):
        widest, angles, path = widest_path(forces[k], forces[k + 1], knots[k], knots[k + 1] - knots[k])
        low, high = sorted(knots[k : k + 2])
        piece = (turned >= low - 1e-9) & (turned <= high + 1e-9)
        assert piece.sum() > 20
        ends = [
            rg.GraspState(PAIR, turned_load(WEIGHT, a), f) for a, f in zip(knots[k:], forces[k:], strict=True)
        ]
        narrower = min(state.margins.least_force for state in ends[:2])
        assert widest == pytest.approx(narrower, rel=1e-6)
        assert margins[piece].min() == pytest.approx(narrower, rel=1e-2)  # sampled
        assert margins[piece].min() >= narrower * (1 - 1e-9)
        # Both are paths under the same load.
        seen = np.array([turned_load(WEIGHT, a).vector for a in angles])
        assert path.sum(axis=1) + seen[:, :2] == pytest.approx(np.zeros((len(angles), 2)), abs=1e-7)
        order = np.argsort(turned)
        same = np.column_stack([np.interp(angles, turned[order], loads[order, i]) for i in range(2)])
        assert same == pytest.approx(seen[:, :2], abs=1e-5)

"""One contact under its load, plans down to one, and point contacts beside soft ones."""

import numpy as np
import pytest

import regrasp as rg
from models import OBJECTIVES
from space import random_load, soft_random

pytestmark = pytest.mark.laws

FLOOR = rg.Contact([0, -1], [0, 1], 0.5, name="floor")
SIDE = rg.Contact([0.5, -1], [0, 1], 0.5, name="side")
WEIGHT = rg.Wrench([0, -2.0])


@pytest.mark.parametrize("objective", [*OBJECTIVES, "sum_normal"])
@pytest.mark.parametrize("space", [False, True])
def test_a_ball_on_the_floor(objective: str, space: bool) -> None:
    contact = rg.Contact([0, 0, -1], [0, 0, 1], 0.5) if space else FLOOR
    load = rg.Wrench([0, 0, -2.0]) if space else WEIGHT
    state = rg.choose_state(rg.Grasp([contact]), load, objective)
    assert state.forces == pytest.approx(-load.force[None], abs=1e-12)
    assert state.is_balanced()


@pytest.mark.parametrize("slope", [0.0, 0.3, 0.4999, 0.5001, 0.8])
def test_a_load_along_its_line_is_held_within_friction(slope: float) -> None:
    """Through the contact: f_x = slope at a height of 1 makes a torque of slope."""
    grasp, load = rg.Grasp([FLOOR]), rg.Wrench([slope, -1.0], slope)
    if slope < 0.5:
        assert rg.choose_state(grasp, load).forces == pytest.approx(np.array([[-slope, 1.0]]), abs=1e-9)
    else:
        with pytest.raises(rg.Infeasible) as refusal:
            rg.choose_state(grasp, load)
        assert refusal.value.certificate.is_proof


def test_a_load_beside_it_turns_the_ball() -> None:
    with pytest.raises(rg.Infeasible, match="none resists turning about floor") as refusal:
        rg.choose_state(rg.Grasp([FLOOR]), rg.Wrench([0, -1.0], 0.1))
    assert refusal.value.certificate.is_proof


def test_no_load_needs_no_force() -> None:
    assert not rg.choose_state(rg.Grasp([FLOOR]), rg.Wrench([0, 0]), "effort").forces.any()


def test_plans_down_to_one_and_up_again() -> None:
    two = rg.Grasp([FLOOR, SIDE])
    down = rg.plan_removal(two, "side", load=WEIGHT)
    assert rg.verify(down).ok
    assert down.end.forces == pytest.approx(np.array([[0, 2.0], [0, 0]]), abs=1e-12)
    up = rg.plan_addition(rg.Grasp([FLOOR]), SIDE, load=WEIGHT)
    assert rg.verify(up).ok
    with pytest.raises(rg.Infeasible):
        rg.plan_removal(two, "floor", load=WEIGHT)


@pytest.mark.parametrize("objective", ["angle", "friction_use", "force", "effort"])
def test_point_contacts_beside_soft_ones(objective: str) -> None:
    grasp = rg.Grasp(
        [
            rg.Contact([1, 0, 0], [-1, 0, 0.1], 0.05, torsion=0.5),
            rg.Contact([-1, 0, 0], [1, 0, 0], 0.05),
            rg.Contact([0, 1, 0], [0, -1, 0], 0.2),
        ]
    )
    state = rg.choose_state(grasp, rg.Wrench([0, 0.5, 0]), objective)
    assert state.is_balanced()
    assert state.forces[2] == pytest.approx([0, -0.5, 0, 0], abs=1e-6)


def test_random_grasps_of_soft_and_point_contacts() -> None:
    """An answer or a refusal, never an error of shapes, whichever fingers are left idle."""
    rng, held = np.random.default_rng(7), 0
    for k in range(30):
        grasp, load = soft_random(rng, 4), random_load(rng)
        try:
            state = rg.choose_state(grasp, load, "angle" if k % 2 else "friction_use", max_force=20.0)
        except rg.Infeasible:
            continue
        held += 1
        assert state.is_balanced()
    assert held > 5

"""Moving forces least into equilibrium, beside the pseudo-inverse and the cones written down again."""

import numpy as np
import pytest

import regrasp as rg
from regrasp.mechanics.balance import shifted
from space import random_grasp, random_load

pytestmark = pytest.mark.oracle


def moved(grasp, load, wanted, limits=None):
    """The answer for a grasp, with its own frictions."""
    limits = np.full(len(grasp), np.inf) if limits is None else limits
    return shifted(grasp, load.vector / grasp.lengths, wanted, grasp.frictions, limits)


def by_pseudo_inverse(grasp, load, wanted, used):
    """The same from the definition, for the fingers used."""
    columns = np.repeat(used, grasp.width)
    g, f = grasp.scaled_matrix * columns, wanted.ravel() * columns
    return (f - np.linalg.pinv(g) @ (g @ f + load.vector / grasp.lengths)).reshape(wanted.shape)


@pytest.mark.parametrize("seed", range(20))
def test_the_nearest_forces_in_equilibrium(seed):
    rng = np.random.default_rng(seed)
    grasp, load = random_grasp(rng, int(rng.integers(3, 9)), 0.8), random_load(rng)
    wanted = rng.normal(size=(len(grasp), 3))
    used = np.ones(len(grasp), dtype=bool)
    if len(grasp) > 3:
        wanted[0] *= 1e-10  # idle, and left idle
        used[0] = False
    forces, nearest = moved(grasp, load, wanted), by_pseudo_inverse(grasp, load, wanted, used)
    normal = (nearest * grasp.normals).sum(axis=1)
    across = np.linalg.norm(nearest - normal[:, None] * grasp.normals, axis=1)
    assert (forces is not None) == bool(((normal >= 0) & (across <= grasp.frictions * normal)).all())
    if forces is not None:
        assert forces == pytest.approx(nearest, abs=1e-12)
        assert rg.GraspState(grasp, load, forces).residual < 1e-12


def test_forces_inside_their_cones_and_limits_are_an_answer():
    answers = 0
    for seed in range(40):
        rng = np.random.default_rng(seed)
        grasp, load = random_grasp(rng, 5, 0.9), random_load(rng)
        try:
            best = rg.choose_state(grasp, load, "force").forces
        except rg.Infeasible:
            continue
        noisy = best + 1e-6 * rng.normal(size=best.shape)
        forces = moved(grasp, load, noisy)
        assert forces == pytest.approx(best, abs=1e-4)
        short = np.linalg.norm(forces, axis=1)
        assert moved(grasp, load, noisy, short * (1 + 1e-9)) is not None
        short[2] *= 1 - 1e-9
        assert moved(grasp, load, noisy, short) is None
        answers += 1
    assert answers > 5


def test_contacts_on_a_line_balance_what_they_can():
    """The torque about the line is a direction that no force has."""
    line = rg.Grasp(rg.Contact([x, 0, 0], [np.sign(-x), 0, 0], 0.5) for x in (-1.0, 1.0))
    wanted = np.array([[2.0, 0.1, 0.4], [-2.0, 0.1, 0.5]])
    held, twisted = rg.Wrench([0, 0, -1.0], [0, 0.1, 0]), rg.Wrench([0, 0, -1.0], [0.1, 0, 0])
    forces = moved(line, held, wanted)
    assert rg.GraspState(line, held, forces).residual < 1e-13
    assert forces == pytest.approx(by_pseudo_inverse(line, held, wanted, np.ones(2, dtype=bool)), abs=1e-12)
    assert moved(line, twisted, wanted) is None


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_what_is_not_finite_is_no_answer(bad):
    rng = np.random.default_rng(0)
    grasp, wanted = random_grasp(rng, 4, 0.8), rng.normal(size=(4, 3))
    wanted[1, 2] = bad
    assert moved(grasp, random_load(rng), wanted) is None

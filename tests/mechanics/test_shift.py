"""Moving forces least into equilibrium, beside the pseudo-inverse and the cones written down again."""

import numpy as np
import pytest

import regrasp as rg
from regrasp.closed_form.compiled.shift import shifted_inside
from space import random_grasp, random_load

pytestmark = pytest.mark.oracle

TOLERANCE = 1e-13


def shifted(grasp, load, wanted, limits=None):
    """The compiled answer for a grasp, with its own frictions."""
    limits = np.full(len(grasp), np.inf) if limits is None else limits
    scaled = load.vector / grasp.lengths
    given = wanted, grasp.scaled_matrix, scaled, grasp.cones.normals, grasp.frictions, limits
    return shifted_inside(*given, TOLERANCE)


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
    forces, is_answer = shifted(grasp, load, wanted)
    assert forces == pytest.approx(by_pseudo_inverse(grasp, load, wanted, used), abs=1e-12)
    state = rg.GraspState(grasp, load, forces)
    assert state.residual < 1e-12
    normal = (forces * grasp.normals).sum(axis=1)
    across = np.linalg.norm(forces - normal[:, None] * grasp.normals, axis=1)
    assert is_answer == bool(((normal >= 0) & (across <= grasp.frictions * normal)).all())


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
        forces, is_answer = shifted(grasp, load, noisy)
        assert is_answer
        assert forces == pytest.approx(best, abs=1e-4)
        short = np.linalg.norm(forces, axis=1)
        assert shifted(grasp, load, noisy, short * (1 + 1e-9))[1]
        short[2] *= 1 - 1e-9
        assert not shifted(grasp, load, noisy, short)[1]
        answers += 1
    assert answers > 5


def test_contacts_on_a_line_balance_what_they_can():
    """The torque about the line is a direction that no force has."""
    line = rg.Grasp(rg.Contact([x, 0, 0], [np.sign(-x), 0, 0], 0.5) for x in (-1.0, 1.0))
    wanted = np.array([[2.0, 0.1, 0.4], [-2.0, 0.1, 0.5]])
    held, twisted = rg.Wrench([0, 0, -1.0], [0, 0.1, 0]), rg.Wrench([0, 0, -1.0], [0.1, 0, 0])
    forces, is_answer = shifted(line, held, wanted)
    assert is_answer
    assert rg.GraspState(line, held, forces).residual < 1e-13
    assert forces == pytest.approx(by_pseudo_inverse(line, held, wanted, np.ones(2, dtype=bool)), abs=1e-12)
    assert not shifted(line, twisted, wanted)[1]


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_what_is_not_finite_is_no_answer(bad):
    rng = np.random.default_rng(0)
    grasp, wanted = random_grasp(rng, 4, 0.8), rng.normal(size=(4, 3))
    wanted[1, 2] = bad
    assert not shifted(grasp, random_load(rng), wanted)[1]

"""Soft fingers: torque about the normal inside the limit surface, in states, plans, proofs and files."""

from math import inf

import cvxpy as cp
import numpy as np
import pytest

import regrasp as rg
from regrasp.files import read_plan, write_plan
from space import random_rotation, soft_random

pytestmark = pytest.mark.laws

PAIR = [([-1, 0, 0], [1, 0, 0]), ([1, 0, 0.1], [-1, 0, 0])]
TWIST = rg.Wrench([0, 0, -1.0], [0.05, 0, 0])


def pair(torsion, friction=0.5, **options):
    return rg.Grasp(rg.Contact(p, n, friction, torsion=torsion, **options) for p, n in PAIR)


def effort_by_cvxpy(grasp, load):
    """The least sum of |f|^2 + (mu m / e)^2, from the limit surface as it is defined."""
    f, m = cp.Variable((len(grasp), 3)), cp.Variable(len(grasp))
    total, torque, held, cost = load.force, load.torque, [], 0
    for i, c in enumerate(grasp):
        x, y, z = c.position
        total = total + f[i]
        torque = torque + np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]]) @ f[i] + m[i] * c.normal
        normal = c.normal @ f[i]
        tangent = f[i] - normal * c.normal
        if c.torsion is None:
            held += [m[i] == 0, cp.norm(tangent) <= c.friction * normal]
        else:
            scaled = m[i] * (c.friction / c.torsion)
            held.append(cp.norm(cp.hstack([tangent, scaled])) <= c.friction * normal)
            cost += cp.square(scaled)
    problem = cp.Problem(cp.Minimize(cp.sum_squares(f) + cost), [*held, total == 0, torque == 0])
    problem.solve(solver=cp.CLARABEL)
    return float(problem.value)


def inside_limit_surfaces(grasp, forces):
    """(..., n) the limit surface's left side over f_n^2."""
    normal = (forces[..., :3] * grasp.normals).sum(axis=-1)
    tangential = np.linalg.norm(forces[..., :3] - normal[..., None] * grasp.normals, axis=-1)
    e = np.array([c.torsion or inf for c in grasp])
    assert (normal >= 0).all()
    return (tangential / grasp.frictions) ** 2 + (forces[..., 3] / e) ** 2 - normal**2


def test_two_soft_fingers_hold_a_torque_about_their_line_and_points_do_not():
    with pytest.raises(rg.Infeasible, match="turning about the line") as caught:
        rg.choose_state(pair(None), TWIST, "peak")
    assert caught.value.certificate.is_proof
    grasp = pair(0.2)
    assert grasp.freedom is None
    assert grasp.matrix.shape == (6, 8)
    best = rg.choose_state(grasp, TWIST, "peak")
    assert best.forces.shape == (2, 4)
    assert best.residual < 1e-13
    assert inside_limit_surfaces(grasp, best.forces).max() <= 0
    total = best.forces[:, 3] @ grasp.normals + np.cross(grasp.positions, best.forces[:, :3]).sum(axis=0)
    assert total == pytest.approx(-TWIST.torque, abs=1e-12)


@pytest.mark.parametrize("seed", range(15))
def test_effort_agrees_with_cvxpy(seed):
    rng = np.random.default_rng(seed)
    grasp = soft_random(rng, int(rng.integers(3, 6)))
    load = rg.Wrench(rng.normal(size=3), 0.05 * rng.normal(size=3))
    expected = effort_by_cvxpy(grasp, load)
    if expected == inf:
        with pytest.raises(rg.Infeasible) as caught:
            rg.choose_state(grasp, load)
        assert caught.value.certificate.is_proof
        return
    best = rg.choose_state(grasp, load, "effort")
    assert best.value == pytest.approx(expected, rel=1e-6)
    for objective in ("angle", "force", "peak", "peak_normal", "friction_use"):
        state = rg.choose_state(grasp, load, objective)
        assert state.residual < 1e-12 * max(1, state.magnitudes.max())
        assert inside_limit_surfaces(grasp, state.forces).max() <= 1e-9 * state.magnitudes.max() ** 2
        assert state.margins.least_angle >= 0
        points = grasp.torsions == 0
        assert not state.forces[points, 3].any()


def test_the_limit_surface_is_the_margin():
    grasp = pair(0.2)
    for f_t, m, margin in ((0.0, 0.0, np.arctan(0.5)), (0.0, 0.2, 0.0), (0.5, 0.0, 0.0), (0.3, 0.16, 0.0)):
        state = rg.GraspState(grasp, TWIST, [[1.0, f_t, 0, m], [-1.0, 0, 0, 0]])
        assert state.margins.angle[0] == pytest.approx(margin, abs=1e-12)
        assert state.margins.friction_use[0] == pytest.approx(2 * np.hypot(f_t, 0.5 * m / 0.2), abs=1e-12)


def test_a_vanishing_torsion_is_a_point_contact():
    load = rg.Wrench([0, 0.1, -1.0])
    third = rg.Contact([0, 0.2, 1], [0, 0, -1], 0.7)
    point, soft = pair(None, 0.7).with_contact(third), pair(1e-9, 0.7).with_contact(third)
    for objective in ("effort", "peak", "force"):
        expected = rg.choose_state(point, load, objective).value
        assert rg.choose_state(soft, load, objective).value == pytest.approx(expected, rel=1e-5)


def test_plans_and_files(tmp_path):
    whole = pair(0.2).with_contact(rg.Contact([0, 0, 1], [0, 0, -1], 0.5))
    removal = rg.plan_removal(whole, 2, load=TWIST)
    t = np.linspace(0, 1, 501)
    forces = removal.forces(t)
    assert forces.shape == (501, 3, 4)
    assert inside_limit_surfaces(whole, forces).max() <= 1e-9
    assert abs(removal.wrenches(t).sum(axis=1) + TWIST.vector).max() < 1e-12
    assert rg.verify(removal).ok
    write_plan(removal, tmp_path / "plan.json")
    again = read_plan(tmp_path / "plan.json")
    assert again == removal
    assert rg.verify(again).ok
    turn = rg.plan_rotation(whole, 0.8, axis=[1, 0, 1], load=TWIST)
    assert rg.verify(turn).ok
    assert abs(turn.wrenches(t).sum(axis=1) + turn.load(t)).max() < 1e-12
    assert inside_limit_surfaces(whole, turn.forces(t)).max() <= 1e-9
    alone = rg.plan_removal(
        rg.Grasp([*pair(0.2), rg.Contact([0, 0, 1], [0, 0, -1], 0.5, torsion=0.1)]), 2, load=TWIST
    )
    assert rg.verify(alone).ok


def test_the_last_soft_finger_leaves():
    grasp = rg.Grasp(
        rg.Contact(p, [-x for x in p], 0.8, torsion=e)
        for p, e in (([1, 0, 0], None), ([-0.5, 0.9, 0], None), ([-0.5, -0.9, 0.1], None), ([0, 0, 1], 0.2))
    )
    removal = rg.plan_removal(grasp, 3, load=rg.Wrench([0, 0, -1]))
    assert removal.end.forces.shape == (4, 4)
    assert rg.verify(removal).ok


def test_the_verifier_finds_torques_beyond_the_limit_surface():
    grasp = pair(0.2)
    best = rg.choose_state(grasp, TWIST, "peak")
    assert rg.verify(rg.plan_rotation(grasp, 0.1, axis=[1, 0, 0], load=TWIST)).ok
    narrower = rg.Grasp(c.changed(torsion=0.01) for c in grasp)
    removal = rg.plan_removal(grasp.with_contact(rg.Contact([0, 0, 1], [0, 0, -1], 0.5)), 2, load=TWIST)
    whole = rg.Grasp([*narrower, removal.grasp[2]])
    from dataclasses import replace

    claimed = replace(
        removal,
        start=rg.GraspState(whole, TWIST, removal.start.forces),
        end=rg.GraspState(whole, TWIST, [*best.forces, [0, 0, 0, 0]]),
    )
    assert "outside its friction cone" in "; ".join(rg.verify(claimed).violations)


@pytest.mark.parametrize(("length", "force"), [(1.0, 1.0), (1e-6, 1e6), (1e6, 1e-6)])
def test_frames_and_units(length, force):
    rng = np.random.default_rng(4)
    matrix = random_rotation(rng)
    grasp = soft_random(rng, 4)
    load = rg.Wrench([0.2, 0.1, -1], [0.01, 0, 0.02])
    seen = rg.Grasp(
        rg.Contact(
            length * (matrix @ c.position),
            matrix @ c.normal,
            c.friction,
            torsion=None if c.torsion is None else length * c.torsion,
        )
        for c in grasp
    )
    turned = rg.Wrench(force * (matrix @ load.force), force * length * (matrix @ load.torque))
    best, same = rg.choose_state(grasp, load, "effort"), rg.choose_state(seen, turned, "effort")
    assert same.value == pytest.approx(force**2 * best.value, rel=1e-6)
    scale = np.r_[np.full(3, force), force * length]
    expected = np.hstack([best.forces[:, :3] @ matrix.T, best.forces[:, 3:]])
    assert same.forces / scale == pytest.approx(expected, abs=1e-5)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: rg.Contact([0, 1], [0, -1], 0.5, torsion=0.1), "a contact in the plane has no torsion"),
        (
            lambda: rg.Contact([0, 1, 0], [0, -1, 0], 0.0, torsion=0.1),
            "a contact without friction has no torsion",
        ),
        (lambda: rg.Contact([0, 1, 0], [0, -1, 0], 0.5, torsion=0.0), "torsion must be greater than 0"),
        (lambda: rg.Contact([0, 1, 0], [0, -1, 0], 0.5, torsion=np.nan), "torsion must be finite"),
        (lambda: rg.GraspState(pair(0.2), TWIST, np.zeros((2, 3))), r"forces must have shape \(2, 4\)"),
        (lambda: rg.choose_state(pair(0.2), TWIST, facets=8), "leave them out with soft fingers"),
        (
            lambda: rg.GraspState(
                pair(0.2).with_contact(rg.Contact([0, 0, 1], [0, 0, -1], 0.5)), TWIST, np.ones((3, 4))
            ),
            "point contacts make no torque about their normals",
        ),
    ],
)
def test_bad_input(make, words):
    with pytest.raises(rg.InvalidInput, match=words):
        make()


def test_kinds_of_contact():
    kinds = [
        rg.Contact([0, 0, 1], [0, 0, -1], mu, torsion=e).kind
        for mu, e in ((0, None), (0.5, None), (0.5, 0.1))
    ]
    assert kinds == ["frictionless", "point", "soft"]
    assert "torsion=0.1" in repr(rg.Contact([0, 0, 1], [0, 0, -1], 0.5, torsion=0.1))


def test_pictures_show_forces_without_their_torques():
    import matplotlib.pyplot as plt

    from regrasp import plots

    whole = pair(0.2).with_contact(rg.Contact([0, 0, 1], [0, 0, -1], 0.5))
    removal = rg.plan_removal(whole, 2, load=TWIST)
    first = [line.get_ydata()[0] for line in plots.plot_magnitudes(removal).get_lines()[:3]]
    assert first == pytest.approx(removal.start.magnitudes, rel=1e-12)
    for draw in (plots.plot_state, plots.plot_transition):
        draw(removal.start if draw is plots.plot_state else removal)
    plots.figures(removal)
    assert "Plotly" in plots.html(removal)
    plt.close("all")

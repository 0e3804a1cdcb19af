"""The directions of a load held in space: sampled, proven between samples, against cvxpy and the plane."""

from math import inf

import matplotlib as mpl
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import regrasp as rg
from regrasp.mechanics.orientation.spiral import even_directions
from regrasp.plots import plot_load_sphere
from space import best_by_cvxpy, nose_cone, random_grasp, random_rotation, rotated

pytestmark = pytest.mark.oracle

mpl.use("Agg")
NOSE = nose_cone(3, 0.5)
RING = rg.Grasp(
    rg.Contact([np.cos(a), np.sin(a), 0], [-np.cos(a), -np.sin(a), 0], 0.5) for a in (0, 2.1, 4.2)
)
SAMPLED = rg.held_sphere(NOSE, count=200)


def test_directions_are_even():
    u = even_directions(500)
    assert np.linalg.norm(u, axis=1) == pytest.approx(np.ones(500))
    assert u.mean(axis=0) == pytest.approx(np.zeros(3), abs=0.01)
    assert u.T @ u / 500 == pytest.approx(np.eye(3) / 3, abs=0.01)
    nearest = np.sort(np.arccos(np.clip(u @ u.T, -1, 1)), axis=1)[:, 1]
    spacing = np.sqrt(4 * np.pi / 500)
    assert 0.7 * spacing < nearest.min() < nearest.max() < 1.2 * spacing


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("objective", ["force", "peak", "effort"])
def test_verdicts_and_values_agree_with_cvxpy(seed, objective):
    grasp = random_grasp(np.random.default_rng(seed), 4, 0.5)
    sampled = rg.held_sphere(grasp, 2.0, objective=objective, count=30)
    for u, value in zip(sampled.directions, sampled.values, strict=True):
        load = rg.Wrench(2.0 * u)
        if best_by_cvxpy(grasp, load, "effort") == inf:
            assert np.isnan(value)
        else:
            assert value == pytest.approx(best_by_cvxpy(grasp, load, objective), rel=1e-5, abs=1e-6)


def test_seeds_hold_both_verdicts():
    held = np.concatenate(
        [rg.held_sphere(random_grasp(np.random.default_rng(s), 4, 0.5), count=30).held for s in range(4)]
    )
    assert 0.1 < held.mean() < 0.9


def test_every_refusal_is_proven():
    assert 0 < SAMPLED.share < 0.5
    assert all(twist.is_proof for twist in SAMPLED.twists)
    for u in SAMPLED.directions[~SAMPLED.held]:
        with pytest.raises(rg.Infeasible) as caught:
            SAMPLED.state(u)
        assert caught.value.certificate.is_proof
        assert caught.value.certificate.load.force == pytest.approx(u)


@given(st.integers(0, 2**32 - 1))
def test_what_lies_between_held_directions_is_held(seed):
    rng = np.random.default_rng(seed)
    some = rng.choice(np.flatnonzero(SAMPLED.held), 3)
    direction = rng.uniform(size=3) @ SAMPLED.directions[some]
    state = SAMPLED.state(7.0 * direction)
    assert state.is_balanced()
    assert not hasattr(state, "criteria")  # combined of samples, not chosen
    assert state.load.force == pytest.approx(direction / np.linalg.norm(direction))
    assert SAMPLED.holds(direction)


def test_single_directions_are_decided_exactly():
    rng = np.random.default_rng(3)
    verdicts = [(SAMPLED.holds(u), best_by_cvxpy(NOSE, rg.Wrench(u / np.linalg.norm(u)), "effort") < inf)
                for u in rng.normal(size=(60, 3))]  # fmt: skip
    assert all(ours == theirs for ours, theirs in verdicts)
    assert {ours for ours, _ in verdicts} == {True, False}
    coarse = rg.held_sphere(NOSE, count=20)  # few samples: most is solved for
    assert [coarse.holds(u) for u in np.random.default_rng(3).normal(size=(60, 3))] == [
        a for a, _ in verdicts
    ]


def test_the_plane_embedded_in_space_holds_the_planar_arc():
    places = [([-4, -4], [1, 1]), ([4, -5], [-1, 2]), ([0, 8], [0, -1])]
    planar = rg.Grasp(rg.Contact(p, n, 0.3) for p, n in places).subset([0, 1])
    arc = rg.held_directions(planar)
    space = rg.Grasp(rg.Contact([*c.position, 0], [*c.normal, 0], c.friction) for c in planar)
    sampled = rg.held_sphere(space, count=40)
    lo, hi = arc.arc
    for angle in np.concatenate([np.linspace(lo + 1e-4, hi - 1e-4, 9), [lo - 1e-4, hi + 1e-4, lo - 2.0]]):
        u = [np.cos(angle), np.sin(angle)]
        assert sampled.holds([*u, 0.0]) == arc.contains(u)


def test_frames_and_units_change_nothing():
    turn = random_rotation(np.random.default_rng(5))
    seen = rg.held_sphere(rotated(NOSE, turn, 1e6), 1e-6, count=100)
    for u in np.random.default_rng(6).normal(size=(40, 3)):
        assert seen.holds(turn @ u) == SAMPLED.holds(u)
    small = rg.held_sphere(rotated(NOSE, np.eye(3), 1e-6), 1e6, count=200)
    assert small.values == pytest.approx(1e6 * SAMPLED.values, rel=1e-5, abs=1e-2, nan_ok=True)


def test_limits_make_heavy_loads_fall():
    shares = [rg.held_sphere(RING, weight, count=60, max_force=1.0).share for weight in (0.1, 0.9, 1.4, 5.0)]
    assert shares[0] == 1.0
    assert 1.0 >= shares[1] > shares[2] > shares[3] == 0.0
    heavy = rg.held_sphere(RING, 1.4, count=60, max_force=1.0)
    for u in np.random.default_rng(8).normal(
        size=(30, 3)
    ):  # no convex cone now: combinations may break limits
        load = rg.Wrench(1.4 * u / np.linalg.norm(u))
        held = best_by_cvxpy(RING, load, "peak") <= 1.0
        assert heavy.holds(u) == held
        if held:
            assert heavy.state(u).magnitudes.max() <= 1.0


def test_nothing_held_and_everything_held():
    smooth = rg.Grasp(rg.Contact(c.position, c.normal, 0.0) for c in RING)
    nothing = rg.held_sphere(smooth, count=20)
    assert nothing.share == 0.0
    assert repr(nothing).endswith("0 of 20 sampled directions of a load of 1 N are held")
    assert not nothing.holds([0, 0, 1.0])
    assert nothing.holds([1.0, 0, 0])  # in the plane of the ring, between the samples
    everything = rg.held_sphere(RING, count=20)
    assert everything.share == 1.0
    assert everything.twists == ()


def test_soft_fingers():
    soft = rg.held_sphere(rg.Grasp(c.changed(torsion=0.3) for c in NOSE), count=100)
    assert soft.forces.shape == (100, 3, 4)
    assert (soft.held >= rg.held_sphere(NOSE, count=100).held).all()
    inside = soft.directions[soft.held].mean(axis=0)
    state = soft.state(inside)
    assert state.is_balanced()
    assert not hasattr(state, "criteria")


def test_is_drawn():
    angles = rg.held_sphere(RING, objective="angle", count=12)
    assert angles.label == "least angle margin [deg]"
    assert angles.shown == pytest.approx(np.degrees(angles.values))
    assert angles.values[3] == pytest.approx(rg.choose_state(RING, rg.Wrench(angles.directions[3])).value)
    ax = plot_load_sphere(SAMPLED.directions, SAMPLED.shown, label=SAMPLED.label)
    assert "least force margin [N]" in {other.get_ylabel() for other in ax.figure.axes}
    assert rg.held_sphere(RING, objective="friction_use", count=1).label == "least largest use of friction"


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (
            lambda: rg.held_sphere(rg.Grasp([rg.Contact([0, 1], [0, -1], 0.5)])),
            "in the plane use held_directions",
        ),
        (lambda: rg.held_sphere(NOSE, 0.0), "magnitude must be greater than 0"),
        (lambda: rg.held_sphere(NOSE, count=0), "count must be a whole number of at least 1"),
        (lambda: rg.held_sphere(NOSE, objective="best"), "objective must be one of"),
        (lambda: SAMPLED.holds([0, 0, 0]), "direction must not be zero"),
        (lambda: SAMPLED.holds([0, 1]), r"direction must have shape \(3,\)"),
    ],
)
def test_bad_input_is_named(call, said):
    with pytest.raises(rg.InvalidInput, match=said):
        call()


def test_one_finger_holds_what_points_at_it_alone() -> None:
    one = rg.Grasp([rg.Contact([0.1, 0, 0], [-1, 0, 0], 0.8)])
    sphere = rg.held_sphere(one, count=40)
    assert not np.isfinite(sphere.values).any()
    assert rg.choose_state(one, rg.Wrench([1.0, 0, 0])).value == pytest.approx(np.arctan(0.8))

"""The equilibrium locus of any number of contacts: its ends, membership, random states."""

from math import inf

import cvxpy as cp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import regrasp as rg
from space import nose_cone, random_rotation, rotated

pytestmark = pytest.mark.laws

DOWN = rg.Wrench([0, 0, -1.0])
NOSE = nose_cone(3, 0.5)
PLANAR = rg.Grasp(
    rg.Contact(position, normal, 0.3)
    for position, normal in (([-4, -4], [1, 1]), ([4, -5], [-1, 2]), ([0, 8], [0, -1]))
)
PAPER = rg.Wrench([-1.5, -3.5])
seeds = st.integers(0, 2**32 - 1)


def ends_by_cvxpy(locus, limit):
    """(lo, hi) by cvxpy, from the mathematics; -inf and inf where it says unbounded."""
    grasp, d = locus.grasp, locus.grasp.dimension
    x = cp.Variable(locus.dimension)
    flat = locus.least.ravel() + locus.internal.reshape(locus.dimension, -1).T @ x
    held = []
    for i, c in enumerate(grasp):
        f = flat[d * i : d * i + d]
        along = c.normal @ f
        held += [cp.norm(f - along * c.normal) <= c.friction * along, cp.norm(f) <= min(limit, 1e9)]
    if limit == inf:
        held = held[::2]
    ends = []
    for goal in (cp.Minimize, cp.Maximize):
        for k in range(locus.dimension):
            problem = cp.Problem(goal(x[k]), held)
            problem.solve(solver=cp.CLARABEL)
            assert problem.status in ("optimal", "unbounded")
            ends.append(float(problem.value))
    return np.array(ends).reshape(2, -1)


@pytest.mark.parametrize("limit", [inf, 2.5])
@pytest.mark.parametrize(
    ("grasp", "load"),
    [
        (NOSE, DOWN),
        (nose_cone(5, 0.4), DOWN),
        (PLANAR, PAPER * 0.3),
        (nose_cone(4, 1.1), rg.Wrench([0.1, 0.2, -1.0], [0.02, 0, 0.05])),
    ],
    ids=["three", "five in a plane", "planar", "four"],
)
def test_ends_agree_with_cvxpy(grasp, load, limit):
    locus = rg.SqueezeLocus(grasp, load, None if limit == inf else limit)
    assert np.array(locus.bounds) == pytest.approx(ends_by_cvxpy(locus, limit), rel=1e-5, abs=1e-5)


def test_limits_of_contacts_end_what_the_cones_leave_open():
    sides = [rg.Contact([np.cos(a), np.sin(a), 0], [-np.cos(a), -np.sin(a), 0], 0.5) for a in (0, 2.1, 4.2)]
    open_ = rg.Grasp(sides)
    lo, hi = rg.SqueezeLocus(open_, DOWN).bounds
    assert (hi == inf).all()
    assert (lo > 0).all()
    one = open_.replaced(0, rg.Contact(sides[0].position, sides[0].normal, 0.5, max_force=2.0, name="P1"))
    first, last = rg.SqueezeLocus(one, DOWN).bounds, rg.SqueezeLocus(open_, DOWN, 1e4).bounds
    assert np.isfinite(first[1][:2]).all()
    assert first[1][2] == inf or np.isfinite(first[1][2])
    assert np.isfinite(last).all()
    assert (last[1] > 1e3).all()


@pytest.mark.parametrize(("length", "force"), [(1e-6, 1e6), (1e6, 1e-6), (1.0, 1.0)])
def test_units_and_frames_change_nothing(length, force):
    turn = random_rotation(np.random.default_rng(2))
    locus = rg.SqueezeLocus(NOSE, DOWN, 2.0)
    seen = rg.SqueezeLocus(rotated(NOSE, turn, length), rg.Wrench(force * (turn @ DOWN.force)), 2.0 * force)
    assert np.array(seen.bounds) / force == pytest.approx(np.array(locus.bounds), rel=1e-6, abs=1e-7)
    x = np.array(locus.bounds).mean(axis=0)
    assert seen.forces(force * x) == pytest.approx(
        force * locus.forces(x) @ turn.T, rel=1e-9, abs=1e-9 * force
    )
    mixed = rg.SqueezeLocus(NOSE.subset([2, 0, 1]), DOWN, 2.0)  # P3-P1, P3-P2, P1-P2
    assert np.array(mixed.bounds)[:, [2, 0, 1]] == pytest.approx(np.array(locus.bounds), rel=1e-6, abs=1e-7)


def test_a_point_of_the_locus():
    locus = rg.SqueezeLocus(NOSE, DOWN)
    best = locus.best("force")
    x = locus.squeezes(best)
    assert best.forces == pytest.approx(rg.choose_state(NOSE, DOWN, "force").forces)
    assert locus.contains(x)
    assert locus.contains(best.forces)
    assert locus.contains(best)
    assert locus.state(x).forces == pytest.approx(best.forces)
    assert locus.margins(x).force == pytest.approx(best.margins.force, abs=1e-9)
    assert not locus.contains(1.001 * best.forces)  # out of equilibrium
    lo, hi = locus.bounds
    for k in range(3):
        assert lo[k] < x[k] < hi[k]
        for end, side in ((lo, -1), (hi, 1)):
            out = x.copy()
            out[k] = end[k] + side * 1e-6 * abs(end[k])
            assert not locus.contains(out)
    assert not rg.SqueezeLocus(NOSE, DOWN, best.magnitudes.max() * 0.99).contains(x)


@given(seeds, st.floats(0, 1))
def test_the_locus_is_convex(seed, share):
    locus = rg.SqueezeLocus(NOSE, DOWN)
    a, b = locus.squeezes(locus.sample(2, seed % 1000))
    assert locus.contains(share * a + (1 - share) * b)


@pytest.mark.parametrize("count", [3, 4, 6])
def test_random_states_are_states(count):
    grasp = nose_cone(count, 0.5)
    locus = rg.SqueezeLocus(grasp, DOWN)
    forces = locus.sample(200, seed=4)
    assert forces.shape == (200, count, 3)
    assert all(locus.contains(f) for f in forces)
    peak = rg.choose_state(grasp, DOWN, "peak", reserve=0.0).value
    assert np.linalg.norm(forces, axis=-1).max() <= 3 * peak
    assert np.array_equal(forces, locus.sample(200, seed=4))
    assert not np.array_equal(forces, locus.sample(200, seed=5))


def test_one_squeeze_is_drawn_evenly():
    pair = rg.Grasp([rg.Contact([-1, 0], [1, 0], 0.5), rg.Contact([1, 0], [-1, 0], 0.5)])
    locus = rg.SqueezeLocus(pair, rg.Wrench([0, -1.0]), 4.0)
    lo, hi = locus.bounds
    share = np.sort((locus.squeezes(locus.sample(4000, 1))[:, 0] - lo) / (hi - lo))
    assert abs(share - (np.arange(4000) + 0.5) / 4000).max() < 1.63 / np.sqrt(4000)  # Kolmogorov, 1 %


def test_three_squeezes_are_drawn_evenly():
    limit = 3 * rg.choose_state(NOSE, DOWN, "peak", reserve=0.0).value
    locus = rg.SqueezeLocus(NOSE, DOWN, limit)
    lo, hi = np.array(locus.bounds)
    box = np.random.default_rng(0).uniform(lo, hi, (400_000, 3))
    forces = locus.forces(box)
    known = (locus.margins(box).force.min(axis=-1) >= 0) & (
        np.linalg.norm(forces, axis=-1).max(axis=-1) <= limit
    )
    known = box[known]
    drawn = locus.squeezes(locus.sample(4000, 2))
    assert len(known) > 4000
    for direction in np.vstack([np.eye(3), random_rotation(np.random.default_rng(1))]):
        a, b = np.sort(known @ direction), np.sort(drawn @ direction)
        both = np.concatenate([a, b])
        apart = np.searchsorted(a, both, "right") / len(a) - np.searchsorted(b, both, "right") / len(b)
        assert abs(apart).max() < 1.8 * np.sqrt(1 / len(a) + 1 / len(b))  # Smirnov, 0.3 %


def test_no_volume_is_said():
    with pytest.raises(rg.InvalidInput, match="fill no volume to draw from"):
        rg.SqueezeLocus(NOSE, DOWN).sample(3, peak_ratio=1.0)

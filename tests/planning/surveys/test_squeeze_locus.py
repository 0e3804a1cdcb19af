"""The equilibrium locus of any number of contacts: its coordinates, and what it is where it degenerates."""

from itertools import combinations
from math import inf

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import regrasp as rg
from regrasp.closed_form.triple import centroid_moment, particular_forces, squeezed, triple_frame
from regrasp.planning.surveys.squeeze_basis import pair_squeezes
from space import nose_cone, random_grasp, random_load, random_rotation

pytestmark = pytest.mark.laws

DOWN = rg.Wrench([0, 0, -1.0])
NOSE = nose_cone(3, 0.5)
PLANAR = rg.Grasp(
    rg.Contact(position, normal, 0.3)
    for position, normal in (([-4, -4], [1, 1]), ([4, -5], [-1, 2]), ([0, 8], [0, -1]))
)
PAPER = rg.Wrench([-1.5, -3.5])
SOFT = rg.Grasp(c.changed(torsion=0.1) for c in NOSE)
seeds = st.integers(0, 2**32 - 1)


def spanned(rows, by):
    """Whether rows (k, ...) lie in the space spanned by an orthonormal basis (m, ...)."""
    rows, by = rows.reshape(len(rows), -1), by.reshape(len(by), -1)
    return abs(rows - rows @ by.T @ by).max() < 1e-9


def rank(rows):
    return np.linalg.matrix_rank(rows.reshape(len(rows), -1), tol=1e-7)


@given(seeds, st.integers(3, 8), st.sampled_from([2, 3]))
def test_squeezes_along_pairs_span_the_internal_forces(seed, count, dimension):
    rng = np.random.default_rng(seed)
    grasp = rg.Grasp(rg.Contact(p, -p, 0.5) for p in rng.normal(size=(count, dimension)))
    _, squeezes = pair_squeezes(grasp)
    assert spanned(squeezes, grasp.internal_forces)
    assert (
        rank(squeezes) == len(grasp.internal_forces) == (2 * count - 3 if dimension == 2 else 3 * count - 6)
    )
    locus = rg.SqueezeLocus(grasp, random_load(rng) if dimension == 3 else rg.Wrench(rng.normal(size=2), 0.3))
    assert locus.dimension == len(grasp.internal_forces) == len(locus.coordinates)
    assert all("across" not in name for name in locus.coordinates)
    assert rank(locus.internal) == locus.dimension
    assert abs(grasp.matrix @ locus.internal.reshape(locus.dimension, -1).T).max() < 1e-12


@given(seeds, st.integers(4, 7))
def test_contacts_in_one_plane_have_forces_across_it_that_no_squeeze_makes(seed, count):
    rng = np.random.default_rng(seed)
    flat = np.pad(rng.normal(size=(count, 2)), ((0, 0), (0, 1))) @ random_rotation(rng).T + rng.normal(size=3)
    grasp = rg.Grasp(rg.Contact(p, -p, 0.5) for p in flat)
    _, squeezes = pair_squeezes(grasp)
    assert rank(squeezes) == 2 * count - 3
    locus = rg.SqueezeLocus(grasp, random_load(rng))
    assert locus.dimension == 3 * count - 6 == rank(locus.internal)
    assert locus.coordinates[-(count - 3) :] == tuple(f"across at P{j}" for j in range(4, count + 1))
    for j, forces in enumerate(locus.internal[-(count - 3) :], 3):
        assert np.linalg.norm(forces[j]) == pytest.approx(1.0)
        assert not forces[[k for k in range(3, count) if k != j]].round(9).any()


@pytest.mark.parametrize(
    ("dimension", "count", "free"), [(3, 3, 4), (3, 4, 7), (2, 3, 3), (2, 4, 5), (3, 2, 1)]
)
def test_contacts_on_one_line(dimension, count, free):
    line = np.outer(np.arange(count) + 0.5, np.ones(dimension) / 3)
    grasp = rg.Grasp(rg.Contact(p, -p, 0.5) for p in line)
    locus = rg.SqueezeLocus(grasp, rg.Wrench(np.ones(dimension)))
    assert locus.dimension == free == len(grasp.internal_forces) == rank(locus.internal)
    assert sum("across" not in name for name in locus.coordinates) == count - 1
    x = np.arange(free) - 1.0
    assert locus.squeezes(locus.forces(x)) == pytest.approx(x, abs=1e-12)


def test_contacts_almost_on_a_line_are_refused():
    grasp = rg.Grasp(rg.Contact(p, [0, 0, 1], 0.5) for p in ([0, 0, 0], [1, 0, 0], [2, 1e-11, 0]))
    with pytest.raises(rg.InvalidInput, match="so near to one line or plane that rounding decides"):
        _ = rg.SqueezeLocus(grasp, DOWN).dimension


@given(seeds)
def test_three_squeezes_are_those_of_the_closed_form(seed):
    rng = np.random.default_rng(seed)
    grasp, load = random_grasp(rng, 3), random_load(rng)
    locus = rg.SqueezeLocus(grasp, load)
    assert locus.coordinates == ("P1-P2", "P1-P3", "P2-P3")
    x12, x13, x23 = x = rng.normal(size=3)
    frame = triple_frame(*(tuple(p) for p in grasp.positions.tolist()))
    force, torque = tuple(load.force.tolist()), tuple(load.torque.tolist())
    alone = particular_forces(frame, force, centroid_moment(frame, force, torque))
    closed = np.array(squeezed(frame, alone, (x12, x23, x13)))
    rounding = 1e-13 * np.linalg.cond(grasp.matrix) ** 2
    assert locus.forces(x) == pytest.approx(closed, rel=1e-9, abs=rounding)
    assert locus.squeezes(closed) == pytest.approx(x, abs=10 * rounding)


@given(seeds, st.integers(2, 6))
def test_forces_and_squeezes_undo_each_other(seed, count):
    rng = np.random.default_rng(seed)
    grasp = random_grasp(rng, count)
    load = rg.Wrench.from_vector(-grasp.matrix @ rng.normal(size=3 * count))  # bearable
    locus = rg.SqueezeLocus(grasp, load)
    x = rng.normal(size=(5, locus.dimension))
    forces = locus.forces(x)
    assert forces.shape == (5, count, 3)
    assert locus.squeezes(forces) == pytest.approx(x, abs=1e-7)
    total = np.einsum("ij,mj->mi", grasp.matrix, forces.reshape(5, -1)) + load.vector
    assert abs(total).max() < 1e-11 * (1 + abs(forces).max())
    assert locus.squeezes(locus.least) == pytest.approx(np.zeros(locus.dimension), abs=1e-9)


def test_two_planar_contacts_differ_from_the_locus_by_the_middle_only():
    pair = PLANAR.subset([0, 2])
    load = rg.Wrench.from_vector(-pair.matrix @ np.array([1.0, 1.2, -0.1, -1.0]))
    locus, old = rg.SqueezeLocus(pair, load), rg.EquilibriumLocus(pair, load)
    middle = -load.force @ old.direction / 2
    lo, hi = locus.bounds
    assert (lo[0] + middle, hi[0] + middle) == pytest.approx(old.interval, rel=1e-7)
    assert locus.forces([0.3]) == pytest.approx(old.forces(0.3 + middle))


def test_fingers_without_friction_push_along_their_normals():
    smooth = nose_cone(5, 0.4).replaced(0, rg.Contact([1.0, 0, -0.5], [-0.6, 0, 1], 0.0))
    locus = rg.SqueezeLocus(smooth, DOWN, 5.0)
    forces = locus.sample(100)
    assert abs(np.cross(forces[:, 0], smooth.normals[0])).max() < 1e-12
    assert all(locus.contains(f) for f in forces)


def test_an_empty_locus_says_why():
    locus = rg.SqueezeLocus(nose_cone(3, 0.05), rg.Wrench([0, 0, 1.0]))
    assert locus.is_empty
    assert locus.why.certificate.is_proof
    assert "empty" in repr(locus)
    lo, hi = locus.bounds
    assert (lo == inf).all()
    assert (hi == -inf).all()
    assert not locus.contains([0.0, 0.0, 0.0])
    with pytest.raises(rg.Infeasible, match="the object escapes"):
        locus.sample(3)
    with pytest.raises(rg.InvalidInput, match="not on the locus: no forces of P1, P2, P3"):
        locus.state([0.0, 0.0, 0.0])


def test_two_fingers_in_space():
    pair = rg.Grasp([rg.Contact([-1, 0, 0], [1, 0, 0], 0.5), rg.Contact([1, 0, 0], [-1, 0, 0], 0.5)])
    locus = rg.SqueezeLocus(pair, DOWN)
    assert locus.coordinates == ("P1-P2",)
    assert locus.bounds[0] == pytest.approx([1.0], rel=1e-8)  # each bears half the load on friction 0.5
    assert locus.bounds[1][0] == inf
    turned = rg.SqueezeLocus(pair, rg.Wrench([0, 0, -1.0], [1.0, 0, 0]))
    assert turned.is_empty
    assert not turned.contains([2.0])
    with pytest.raises(rg.Infeasible, match="about the line through P1 and P2"):
        turned.forces([2.0])


def test_loads_of_nothing_need_a_limit():
    locus = rg.SqueezeLocus(NOSE, rg.Wrench([0, 0, 0]))
    assert not locus.is_empty
    with pytest.raises(rg.InvalidInput, match="zero load needs max_force"):
        locus.sample(3)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: rg.SqueezeLocus(NOSE.subset([0]), DOWN), "two contacts or more"),
        (lambda: rg.SqueezeLocus("grasp", DOWN), "needs a Grasp"),
        (lambda: rg.SqueezeLocus(SOFT, DOWN), "is of point contacts, got soft fingers"),
        (lambda: rg.SqueezeLocus(NOSE, PAPER), "the grasp's dimension 3"),
        (lambda: rg.SqueezeLocus(NOSE, DOWN, -1.0), "max_force must be greater than 0"),
        (
            lambda: rg.SqueezeLocus(NOSE, DOWN).forces([1.0, 2.0]),
            r"must have 3 numbers \(P1-P2, P1-P3, P2-P3\)",
        ),
        (lambda: rg.SqueezeLocus(NOSE, DOWN).squeezes([1.0, 2.0, 3.0]), r"shape \(..., 3, 3\)"),
        (lambda: rg.SqueezeLocus(NOSE, DOWN).contains([[1.0, 2.0]]), r"shape \(3, 3\)"),
        (lambda: rg.SqueezeLocus(NOSE, DOWN).state("x"), "squeezes must be numbers"),
        (lambda: rg.SqueezeLocus(NOSE, DOWN).sample(0), "count must be a whole number of at least 1"),
        (lambda: rg.SqueezeLocus(NOSE, DOWN).sample(3, peak_ratio=0.5), "peak_ratio must be at least 1"),
        (lambda: rg.SqueezeLocus(NOSE, DOWN).best("best"), "objective must be one of"),
    ],
)
def test_bad_input_is_named(call, said):
    with pytest.raises(rg.InvalidInput, match=said):
        call()


def test_equal_loci_are_equal():
    assert rg.SqueezeLocus(NOSE, DOWN) == rg.SqueezeLocus(NOSE, DOWN)
    assert rg.SqueezeLocus(NOSE, DOWN) != rg.SqueezeLocus(NOSE, DOWN, 1.0)
    pairs = [f"P{i}-P{j}" for i, j in combinations((1, 2, 3), 2)]
    assert repr(rg.SqueezeLocus(NOSE, DOWN)).endswith(f"squeezes {', '.join(pairs)}")

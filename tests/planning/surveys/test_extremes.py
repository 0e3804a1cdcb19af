"""Largest loads and held centres: textbook answers, independent programs, degenerate directions."""

from itertools import pairwise
from math import cos, hypot, inf, sin

import cvxpy as cp
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

import regrasp as rg
from cones import edges
from invariance import Frame, frames
from paper import GRASP, LOAD
from regrasp.planning.surveys.extremes import load_reach
from space import random_grasp, random_rotation, rotated
from strategies import held_pairs

pytestmark = pytest.mark.oracle


def facing(mu: float = 0.5) -> rg.Grasp:
    return rg.Grasp([rg.Contact([-1, 0], [1, 0], mu), rg.Contact([1, 0], [-1, 0], mu)])


def table(mu: float = 0.5) -> rg.Grasp:
    """Two feet on the ground."""
    return rg.Grasp([rg.Contact([-1, 0], [0, 1], mu), rg.Contact([1, 0], [0, 1], mu)])


def foot(mu: float = 0.5) -> rg.Grasp:
    return rg.Grasp(rg.Contact([x, y, 0], [0, 0, 1], mu) for x in (-0.12, 0.12) for y in (-0.065, 0.065))


def test_yaw_of_a_foot() -> None:
    """Half-sizes X, Y, 100 N down: mu F hypot(X, Y) with round cones, each corner pushing across its lever.

    With pyramids of |f_x|, |f_y| <= mu f_z it would be mu F (X + Y): Caron, Pham and Nakamura, ICRA 2015.
    """
    down = rg.Wrench([0, 0, -100.0])
    for side in (-1, 1):
        found = rg.largest_load(foot(), rg.Wrench([0, 0, 0], [0, 0, side]), down)
        assert found.factor == pytest.approx(0.5 * 100 * hypot(0.12, 0.065), rel=1e-7)
        assert found.factor < 0.5 * 100 * (0.12 + 0.065)
        assert found.bounds[1] == pytest.approx(found.factor, rel=1e-6)
        assert found.escape.is_proof
    tipped = rg.largest_load(foot(), rg.Wrench([0, 0, 0], [1, 0, 0]), down)
    assert tipped.factor == pytest.approx(100 * 0.065, rel=1e-7)


rough = st.sampled_from([0.1, 0.25, 0.5, 1.0, 2.0])
"""HiGHS drops entries below 1e-9 and is right to 1e-7: an oracle for friction that is not tiny."""
hundredths = st.integers(-300, 300).map(lambda k: k / 100)


@given(held_pairs(rough), hundredths, hundredths)
@settings(max_examples=25, deadline=None)
def test_largest_load_against_linear_programs(pair, angle: float, turn: float) -> None:
    direction = rg.Wrench([cos(angle), sin(angle)], turn)
    answer = linprog(
        [0, 0, 0, 0, -1],
        A_eq=np.c_[edges(pair.grasp), direction.vector],
        b_eq=-pair.load.vector,
        bounds=[(0, None)] * 4 + [(None, None)],
    )
    assume(answer.status == 3 or (answer.status == 0 and 1e-6 < -answer.fun < 1e6))
    found = rg.largest_load(pair.grasp, direction, pair.load)
    if answer.status == 3:
        assert found.factor == inf
        assert found.escape is None
        assert found.state.is_balanced(reserve=0.0)
        return
    assert found.factor == pytest.approx(-answer.fun, rel=1e-5)
    lower, upper = found.bounds
    assert lower <= -answer.fun * (1 + 1e-7)
    assert upper >= -answer.fun * (1 - 1e-7)
    assert found.state.is_balanced(reserve=0.0)
    np.testing.assert_allclose(found.state.load.vector, found.load.vector, rtol=1e-9, atol=1e-9)


def test_two_planar_contacts_in_closed_form_against_the_programs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Any contacts, loads and bases; programs may miss what they say, never say more than the formula."""
    rng = np.random.default_rng(7)
    compared = {"bounded": 0, "unbounded": 0, "none": 0}
    for k in range(45):
        grasp = facing(0.4) if k % 9 == 0 else rg.Grasp(
            rg.Contact(rng.normal(size=2), rng.normal(size=2), rng.uniform(0.1, 1.5)) for _ in range(2)
        )  # fmt: skip
        direction, base = (rg.Wrench(rng.normal(size=2), rng.normal()) for _ in range(2))
        answers = []
        for quick in (True, False):
            with monkeypatch.context() as patch:
                if not quick:
                    patch.setattr(f"{load_reach.__name__}.reach_of_two", lambda *given: None)
                try:
                    found = rg.largest_load(grasp, direction, base if k % 2 else None)
                    answers.append((found.factor, found.bounds[1], found.escape is None))
                except rg.Infeasible:
                    answers.append(None)
                try:
                    centres = rg.held_centres(grasp, direction)
                    answers.append((centres.size, centres.is_bounded))
                except rg.Infeasible:
                    answers.append(None)
        load, centres, other_load, other_centres = answers
        assert (load is None) == (other_load is None)
        if load is not None:
            assert load[:2] == pytest.approx(other_load[:2], rel=1e-6, abs=1e-7)
            assert load[2] == other_load[2]
        assert other_centres is None or centres is not None
        if centres is not None and other_centres is not None:
            assert centres[0] >= other_centres[0] * (1 - 1e-6)
            assert centres[1] == other_centres[1]
        kind = "none" if load is None else "unbounded" if load[0] == inf else "bounded"
        compared[kind] += 1
    assert min(compared.values()) >= 2


def test_largest_load_against_cone_programs() -> None:
    rng = np.random.default_rng(4)
    for _ in range(6):
        grasp = random_grasp(rng, 4)
        direction = rg.Wrench(rng.normal(size=3), rng.normal(size=3))
        f, k = cp.Variable((4, 3)), cp.Variable()
        levers = [
            np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]]) @ f[i]
            for i, (x, y, z) in enumerate(grasp.positions)
        ]
        rows = [
            sum(f[i] for i in range(4)) + k * direction.force == 0,
            sum(levers) + k * direction.torque == 0,
        ]
        for i, c in enumerate(grasp):
            across = f[i] - (c.normal @ f[i]) * c.normal
            rows += [cp.norm(across) <= c.friction * (c.normal @ f[i]), cp.norm(f[i]) <= 3]
        problem = cp.Problem(cp.Maximize(k), rows)
        problem.solve(solver=cp.CLARABEL)
        found = rg.largest_load(grasp, direction, max_force=3)
        assert found.factor == pytest.approx(float(problem.value), rel=1e-5, abs=1e-6)
        assert found.bounds[1] >= float(problem.value) - 1e-6


def test_largest_load_of_degenerate_directions() -> None:
    assert rg.largest_load(table(), rg.Wrench([0, -1])).factor == inf
    lifted = rg.largest_load(table(), rg.Wrench([0, 1]))
    assert lifted.bounds == (0.0, pytest.approx(0.0, abs=1e-12))
    assert lifted.escape.is_proof
    assert rg.largest_load(table(), rg.Wrench([1, 0]), rg.Wrench([0, -2])).factor == pytest.approx(1.0)
    with pytest.raises(rg.Infeasible, match="escapes by"):
        rg.largest_load(table(), rg.Wrench([1, 0]), rg.Wrench([0, 2]))
    with pytest.raises(rg.InvalidInput, match="direction must not be zero"):
        rg.largest_load(table(), rg.Wrench([0, 0]))
    with pytest.raises(rg.InvalidInput, match="no largest value"):
        _ = rg.largest_load(table(), rg.Wrench([0, -1])).load


@given(held_pairs(), frames)
@settings(max_examples=12, deadline=None)
def test_largest_load_does_not_depend_on_units(pair, frame: Frame) -> None:
    direction = rg.Wrench([0.3, -1.0], 0.4)
    mine = rg.largest_load(pair.grasp, direction, pair.load, max_force=50.0).factor
    moved = rg.largest_load(
        frame.grasp(pair.grasp, [1, 0]),
        frame.load(direction),
        frame.load(pair.load),
        max_force=50 * frame.force,
    ).factor
    assert moved == pytest.approx(mine, rel=1e-5, abs=1e-6)


def test_centres_over_a_table() -> None:
    """Plane: between the feet. Space: over the rectangle of the feet, whatever the friction."""
    found = rg.held_centres(table(), rg.Wrench([0, -3]))
    np.testing.assert_allclose(np.sort(found.inner[:, 0]), [-1, 1], rtol=1e-8)
    np.testing.assert_allclose(np.sort(found.outer[:, 0]), [-1, 1], rtol=1e-8)
    assert found.contains([0.999, 5.0])  # along the weight nothing changes
    assert found.contains([1.001, 0.0]) is False
    feet = rg.held_centres(foot(), rg.Wrench([0, 0, -100.0]))
    assert feet.size == pytest.approx(0.24 * 0.13, rel=1e-6)
    assert feet.is_bounded
    assert feet.gap < 1e-3
    for centre in ([0.119, 0.064, 0], [-0.119, 0.064, 7.0], [0, 0, 0]):
        assert feet.contains(centre)
    for centre in ([0.121, 0, 0], [0, -0.066, 0]):
        assert feet.contains(centre) is False
    assert all(state.is_balanced(reserve=0.0) for state in feet.states)


def test_centres_in_space_against_cone_programs() -> None:
    """Just inside the inner polygon a load is held, just outside the outer one it is not."""
    rng = np.random.default_rng(0)
    random_grasp(rng, 3, 0.5)
    grasp, weight = random_grasp(rng, 4, 0.5), rg.Wrench([0.2, 0, -1])
    found = rg.held_centres(grasp, weight, max_force=5)
    assert found.gap < 1e-3

    def held(centre: np.ndarray) -> bool:
        f = cp.Variable((4, 3))
        levers = [
            np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]]) @ f[i]
            for i, (x, y, z) in enumerate(grasp.positions)
        ]
        torque = np.cross(centre, weight.force)
        rows = [sum(f[i] for i in range(4)) + weight.force == 0, sum(levers) + torque == 0]
        for i, c in enumerate(grasp):
            across = f[i] - (c.normal @ f[i]) * c.normal
            rows += [cp.norm(across) <= c.friction * (c.normal @ f[i]), cp.norm(f[i]) <= 5]
        problem = cp.Problem(cp.Minimize(0), rows)
        problem.solve(solver=cp.CLARABEL)
        return problem.status == "optimal"

    middle = found.inner.mean(axis=0)
    for corner in found.inner[::6]:
        assert held(middle + 0.999 * (corner - middle))
    for corner in found.outer[::6]:
        assert not held(middle + 1.02 * (corner - middle))
    for a, b in pairwise(found.outer):
        assert not held(middle + 1.01 * ((a + b) / 2 - middle))


def test_centres_without_a_bound_reach_as_far_as_is_sought() -> None:
    found = rg.held_centres(facing(), rg.Wrench([0, -1]), reach=20)
    assert not found.is_bounded
    np.testing.assert_allclose(np.sort(found.inner[:, 0]), [-20, 20], rtol=1e-6)
    limited = rg.held_centres(facing(), rg.Wrench([0, -1]), max_force=2)
    assert limited.is_bounded
    ends = np.sort(limited.inner[:, 0])
    reach = rg.largest_load(facing(), rg.Wrench([0, 0], 1.0), rg.Wrench([0, -1]), max_force=2).factor
    np.testing.assert_allclose(ends, [-reach, reach], rtol=1e-6)


def test_centres_in_another_frame() -> None:
    rng = np.random.default_rng(1)
    spin = random_rotation(rng)
    found = rg.held_centres(rotated(foot(), spin, 1e3), rg.Wrench(spin @ np.array([0, 20.0, -100])))
    mine = rg.held_centres(foot(), rg.Wrench([0, 20.0, -100]))
    assert found.size == pytest.approx(1e6 * mine.size, rel=2e-3)


@pytest.mark.parametrize("unit", [1e-13, 1e-6, 1e9, 1e13])
def test_centres_and_loads_of_any_size(unit: float) -> None:
    """A unit of length scales the region, one of force nothing, a limit its factor."""
    other = rg.Grasp(rg.Contact(unit * c.position, c.normal, c.friction) for c in GRASP)
    region = rg.held_centres(GRASP, LOAD, max_force=10)
    assert rg.held_centres(other, LOAD, max_force=10).size == pytest.approx(unit * region.size, rel=1e-6)
    forced = rg.held_centres(GRASP, unit * LOAD, max_force=10 * unit)
    assert forced.size == pytest.approx(region.size, rel=1e-6)
    factor = rg.largest_load(GRASP, LOAD, max_force=10).factor
    assert rg.largest_load(GRASP, LOAD, max_force=10 * unit).factor == pytest.approx(unit * factor, rel=1e-6)
    aside = rg.Wrench([1, 0], 5)
    based = rg.largest_load(GRASP, aside, LOAD, max_force=1e3)
    far = rg.largest_load(GRASP, aside, unit * LOAD, max_force=1e3 * unit)
    assert far.factor == pytest.approx(unit * based.factor, rel=1e-6)
    assert far.bounds[1] == pytest.approx(far.factor, rel=1e-5)


def test_a_point_under_the_weight_is_decided() -> None:
    one = rg.held_centres(rg.Grasp([rg.Contact([0, -1], [0, 1], 0.5)]), rg.Wrench([0, -1]), max_force=3)
    assert one.gap == 0
    assert one.size < 1e-12


def test_soft_fingers_without_a_load_need_no_friction() -> None:
    soft = rg.Grasp(rg.Contact([x, 0, 0], [-x, 0, 0], 0.4, torsion=0.1) for x in (-1, 1))
    assert float(rg.least_friction(soft, rg.Wrench([0, 0, 0]))) == 0


def test_centres_of_bad_input() -> None:
    with pytest.raises(rg.InvalidInput, match="weight must have a force"):
        rg.held_centres(table(), rg.Wrench([0, 0], 1.0))
    with pytest.raises(rg.Infeasible):
        rg.held_centres(table(), rg.Wrench([0, 1]))


def test_they_say_what_they_found() -> None:
    assert "with friction 0.258199 or more" in str(
        rg.least_friction(facing(), rg.Wrench([0, -1]), max_force=2)
    )
    assert "factors up to 1 of" in str(rg.largest_load(table(), rg.Wrench([1, 0]), rg.Wrench([0, -2])))
    assert "a region of length 2 m, " in str(rg.held_centres(table(), rg.Wrench([0, -3])))

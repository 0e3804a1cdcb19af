"""The paper's example (Section V) against its printed numbers, and its reconstruction."""

import json
from math import sqrt
from pathlib import Path

import numpy as np
import pytest

import regrasp as rg

PAPER = json.loads(Path(__file__).with_name("golden.json").read_text(encoding="utf-8"))["paper_example"]
RECONSTRUCTED = PAPER["reconstruction"]
ROUNDING = PAPER["rounding"]
"""Half a unit of the last printed digit."""

GRASP = rg.Grasp(
    rg.Contact(position, RECONSTRUCTED["normals"][name], RECONSTRUCTED["friction"], name=name)
    for name, position in PAPER["positions"].items()
)
LOAD = rg.Wrench(PAPER["f_ext"])
A = rg.GraspState(GRASP, LOAD, list(PAPER["forces_A"].values()))
B = rg.GraspState(GRASP.without("P3"), LOAD, list(PAPER["forces_B"].values()))
LOCUS = rg.EquilibriumLocus(B.grasp, LOAD)


@pytest.fixture(scope="module")
def removal() -> rg.Transition:
    return rg.plan_removal(A, "P3", end=B)


def test_torques_of_the_first_state_are_those_printed() -> None:
    printed = np.array(list(PAPER["torques_A_printed"].values()))
    np.testing.assert_allclose(A.wrenches[:, 2], printed, rtol=0, atol=PAPER["tolerance"])
    np.testing.assert_array_equal(A.wrenches[:, :2], list(PAPER["forces_A"].values()))
    # The sign convention is r x f: with f x r, as in Section III-A, every torque would be wrong.
    assert (abs(-A.wrenches[:, 2] - printed) > 5).all()
    np.testing.assert_allclose(A.wrenches[:, 2], [3.1452, 2.6144, -5.7592], rtol=0, atol=1e-12)


def test_printed_torques_of_the_second_state_do_not_belong_to_its_printed_forces() -> None:
    np.testing.assert_allclose(B.wrenches[:, 2], [-2.3992, 2.3995], rtol=0, atol=1e-12)
    off = abs(B.wrenches[:, 2] - np.array(list(PAPER["torques_B_printed"].values())))
    assert off.max() == pytest.approx(6.5e-3, abs=1e-12)
    assert off.min() == pytest.approx(6.2e-3, abs=1e-12)
    # No forces that round to those printed make these torques; with two digits swapped, 2.3993, they do.
    reach = ROUNDING * abs(B.grasp.positions).sum(axis=1)
    assert (off > 10 * reach).all()
    assert (abs(abs(B.wrenches[:, 2]) - 2.3993) < reach + ROUNDING).all()


def test_printed_states_are_equilibria_to_their_rounding() -> None:
    for state in (A, B):
        reach = ROUNDING * abs(state.grasp.matrix).sum(axis=1)
        assert (abs(state.imbalance) <= reach).all()
        assert state.residual > 1e-5  # rounded, so never exact


def test_printed_forces_lie_inside_the_reconstructed_cones() -> None:
    assert (A.margins.angle > 0).all()
    assert (B.margins.angle > 0).all()


def test_squeeze_interval_of_the_reconstruction() -> None:
    want = RECONSTRUCTED["squeeze_interval"]
    np.testing.assert_allclose(LOCUS.interval, want, rtol=0, atol=1e-9)
    np.testing.assert_allclose(LOCUS.direction, np.array([8, -1]) / sqrt(65), rtol=1e-15)
    np.testing.assert_allclose(
        LOCUS.segment()[:, :2], RECONSTRUCTED["squeeze_interval_forces_of_P1"], rtol=0, atol=5e-7
    )
    # The two ends are the two edges of the cone at P2: f_2 turns from one to the other.
    n = GRASP["P2"].normal
    f2 = LOCUS.forces(want)[:, 1]
    slope = (n[0] * f2[:, 1] - n[1] * f2[:, 0]) / (f2 @ n)
    np.testing.assert_allclose(slope, [-0.3, 0.3] if slope[0] < 0 else [0.3, -0.3], rtol=1e-9)
    assert (LOCUS.margins(want).angle[:, 0] > 0).all()


def test_the_papers_second_state_is_on_the_locus() -> None:
    x = RECONSTRUCTED["squeeze_of_B"]
    assert LOCUS.interval[0] < x < LOCUS.interval[1]
    assert LOCUS.squeeze(B) == pytest.approx(x, abs=5e-7)
    np.testing.assert_allclose(LOCUS.forces(x), B.forces, rtol=0, atol=ROUNDING)
    assert abs(LOCUS.forces(x + 1e-3) - B.forces).max() > 5 * ROUNDING


@pytest.mark.parametrize("state", [A, B], ids=["S_A", "S_B"])
def test_balancing_changes_no_printed_digit(state: rg.GraspState) -> None:
    balanced = state.balanced()
    change = abs(balanced.forces - state.forces).max()
    assert 0 < change < ROUNDING
    assert balanced.residual < 1e-13 * state.magnitudes.max() * GRASP.size
    # The nearest one: the change is made of grasp-matrix rows only, so it has no internal force.
    moved = balanced.forces - state.forces
    np.testing.assert_allclose(np.tensordot(state.grasp.internal_forces, moved, 2), 0, atol=1e-15)


def test_wrenches_sum_to_zero_at_every_instant(removal: rg.Transition) -> None:
    t = np.linspace(0, removal.duration, 1001)
    total = removal.wrenches(t).sum(axis=1) + LOAD.vector
    assert abs(total).max() < 1e-13 * 6 * 8


def test_the_third_force_keeps_its_direction_and_vanishes(removal: rg.Transition) -> None:
    f3 = removal.forces(np.linspace(0, 1, 1001))[:, 2]
    start = f3[0] / np.hypot(*f3[0])
    np.testing.assert_allclose(f3[:, 0] * start[1] - f3[:, 1] * start[0], 0, atol=1e-15)
    size = f3 @ start
    assert (np.diff(size) <= 0).all()
    assert size[0] == pytest.approx(np.hypot(0.7199, 3.9190), abs=2 * ROUNDING)
    assert (f3[-1] == 0).all()


def test_equations_1_to_3_between_the_papers_own_states(removal: rg.Transition) -> None:
    """T = 1 - 3 s^2 + 2 s^3 is the paper's spline in closed form; w^A and w^B are as printed."""
    t = np.linspace(0, 1, 101)
    T = (1 - 3 * t**2 + 2 * t**3)[:, None]
    w_a = A.wrenches
    w_b = np.vstack([B.wrenches, np.zeros(3)])
    found = removal.wrenches(t)
    for i in (0, 1):
        want = w_b[i] + (w_a[i] - w_b[i]) * T  # (1), (2)
        np.testing.assert_allclose(found[:, i, :2], want[:, :2], rtol=0, atol=ROUNDING)
        np.testing.assert_allclose(found[:, i, 2], want[:, 2], rtol=0, atol=PAPER["tolerance"])
    np.testing.assert_allclose(found[:, 2, :2], w_a[2, :2] * T, rtol=0, atol=ROUNDING)  # (3)
    np.testing.assert_array_equal(removal.forces(t), found[..., :2])
    assert removal.record.balancing < ROUNDING
    assert rg.verify(removal).ok


def test_forces_stay_inside_their_cones_all_the_time(removal: rg.Transition) -> None:
    """Fig. 9b: no angle to the normal exceeds the cone's, and |f_3| alone falls to zero (Fig. 9a)."""
    t = np.linspace(0, 1, 501)[:-1]  # at the end P3 is idle
    assert removal.margins(t).angle.min() > 0
    ends = [A.margins.least_angle, B.margins.least_angle]
    assert removal.margins(t).angle.min() == pytest.approx(min(ends), abs=1e-4)
    assert np.isnan(removal.margins(1.0).angle).tolist() == [False, False, True]

"""The paper's example against its printed numbers, errata included (golden.json says where each is from)."""

import json
from fractions import Fraction

import numpy as np
import pytest

import regrasp as rg
from oracle import locus
from places import TESTS

pytestmark = pytest.mark.golden

GOLDEN = json.loads((TESTS / "golden.json").read_text())
MADE_UP = GOLDEN["reconstruction"]
NAMES = ("P1", "P2", "P3")


@pytest.fixture(scope="module")
def grasp() -> rg.Grasp:
    return rg.Grasp(
        rg.Contact(GOLDEN["positions"][n], MADE_UP["normals"][n], MADE_UP["friction"], name=n) for n in NAMES
    )


@pytest.fixture(scope="module")
def load() -> rg.Wrench:
    return rg.Wrench(GOLDEN["load"])


@pytest.fixture(scope="module")
def start(grasp: rg.Grasp, load: rg.Wrench) -> rg.GraspState:
    return rg.GraspState(grasp, load, [GOLDEN["forces_A"][n] for n in NAMES])


@pytest.fixture(scope="module")
def end(grasp: rg.Grasp, load: rg.Wrench) -> rg.GraspState:
    return rg.GraspState(grasp.without("P3"), load, [GOLDEN["forces_B"][n] for n in NAMES[:2]])


def test_wrenches_of_the_first_state(start: rg.GraspState) -> None:
    printed = [[*GOLDEN["forces_A"][n], GOLDEN["torques_A_printed"][n]] for n in NAMES]
    assert start.wrenches == pytest.approx(np.array(printed), abs=GOLDEN["tolerance"])


def test_torque_is_r_cross_f_not_f_cross_r_as_printed(start: rg.GraspState) -> None:
    r, f = start.grasp.positions, start.forces
    f_cross_r = f[:, 0] * r[:, 1] - f[:, 1] * r[:, 0]
    assert start.wrenches[:, 2] == pytest.approx(-f_cross_r, abs=1e-12)
    printed = [GOLDEN["torques_A_printed"][n] for n in NAMES]
    assert np.abs(f_cross_r - printed).min() > 1


def test_printed_forces_are_rounded_and_say_so(start: rg.GraspState, end: rg.GraspState) -> None:
    assert start.residual == pytest.approx(3.9e-4, abs=1e-4)
    assert end.residual == pytest.approx(3e-4, abs=1e-4)
    assert 0 < abs(start.balanced().forces - start.forces).max() < GOLDEN["tolerance"]


def test_printed_torques_of_the_second_state_disagree_with_its_forces(end: rg.GraspState) -> None:
    computed = dict(zip(NAMES, end.wrenches[:, 2], strict=False))
    assert computed == pytest.approx(GOLDEN["torques_B_of_the_printed_forces"], abs=5e-5)
    assert computed["P1"] - GOLDEN["torques_B_printed"]["P1"] == pytest.approx(-6.2e-3, abs=2e-4)
    assert computed["P2"] - GOLDEN["torques_B_printed"]["P2"] == pytest.approx(6.5e-3, abs=2e-4)
    assert abs(end.wrenches[:, 2].sum()) < GOLDEN["tolerance"]  # computed from the forces they do balance


def test_every_printed_force_is_inside_its_reconstructed_cone(
    start: rg.GraspState, end: rg.GraspState
) -> None:
    assert start.margins.least_angle > 0
    assert end.margins.least_angle > 0


def test_squeeze_interval(grasp: rg.Grasp, load: rg.Wrench) -> None:
    found = rg.EquilibriumLocus(grasp.subset(["P1", "P2"]), load)
    assert found.interval == pytest.approx(MADE_UP["squeeze_interval"], abs=1e-9)
    ends = found.forces(np.array(found.interval))[:, 0]
    assert ends == pytest.approx(np.array(MADE_UP["ends_of_f1"]), abs=5e-7)
    assert found.segment()[:, :2] == pytest.approx(ends, abs=1e-12)


def test_squeeze_interval_in_exact_arithmetic(grasp: rg.Grasp, load: rg.Wrench) -> None:
    """Friction 0.3 as 3/10 exactly: f_1 ends at (151/90, 223/90) and (77/30, 71/30)."""
    contacts = [(GOLDEN["positions"][n], MADE_UP["normals"][n], 0.3) for n in NAMES[:2]]
    exact = locus(*contacts[0], *contacts[1], load.force.tolist(), 0.0)
    assert exact.ends() == pytest.approx(MADE_UP["squeeze_interval"], abs=1e-14)
    ends = [[Fraction(151, 90), Fraction(223, 90)], [Fraction(77, 30), Fraction(71, 30)]]
    assert [[float(x) for x in f] for f in ends] == pytest.approx(np.array(MADE_UP["ends_of_f1"]), abs=5e-7)
    for f1, bound in zip(ends, (exact.lo, exact.hi), strict=True):
        x_per_length = (8 * f1[0] - f1[1]) / 65  # P1 -> P2 is (8, -1)
        assert float(bound.value) == pytest.approx(float(x_per_length), abs=1e-15)


def test_second_state_lies_on_the_locus(grasp: rg.Grasp, load: rg.Wrench, end: rg.GraspState) -> None:
    found = rg.EquilibriumLocus(grasp.without("P3"), load)
    squeeze = found.squeeze(end)
    assert squeeze == pytest.approx(MADE_UP["squeeze_B"], abs=5e-7)
    assert found.interval[0] < squeeze < found.interval[1]
    assert found.forces(squeeze) == pytest.approx(end.forces, abs=GOLDEN["tolerance"])


@pytest.fixture(scope="module")
def removal(start: rg.GraspState, end: rg.GraspState) -> rg.Transition:
    return rg.plan_removal(start, "P3", end=end)


def test_the_papers_transition(removal: rg.Transition, start: rg.GraspState, end: rg.GraspState) -> None:
    t = np.linspace(0, 1, 1001)
    wrenches, forces = removal.wrenches(t), removal.forces(t)
    assert abs(wrenches.sum(axis=1) + removal.load(t)).max() < 1e-12
    third = forces[:, 2]
    assert abs(third[:, 0] * third[0, 1] - third[:, 1] * third[0, 0]).max() < 1e-14
    assert (np.diff(np.linalg.norm(third, axis=1)) <= 0).all()
    assert removal.start.forces == pytest.approx(start.forces, abs=GOLDEN["tolerance"])
    assert removal.end.forces[:2] == pytest.approx(end.forces, abs=GOLDEN["tolerance"])
    assert np.nanmin(removal.margins(t).angle) > 0
    assert rg.verify(removal).ok


def test_our_end_state_is_safer_than_the_papers(removal: rg.Transition, start: rg.GraspState) -> None:
    ours = rg.plan_removal(start, "P3")
    assert ours.end.margins.least_angle > 1.4 * removal.end.margins.least_angle

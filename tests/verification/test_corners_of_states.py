"""Corners of the conditions on one state: what is reported, lengths that differ, torques, exact equality."""

from math import atan, inf, nextafter

import numpy as np
import pytest

import regrasp as rg
from foreign import Plan, Record, course, cross, out_of_balance, places, turn
from regrasp.verification import verify_setpoints

pytestmark = pytest.mark.contract

EPS = 2.0**-40


def good(grasp, forces, load=None) -> set[bool]:
    """The verdicts wherever in a plan the state stands, set-points among them."""
    plans = [plan for _, plan in places(grasp, np.array(forces, dtype=float), load)]
    rows = verify_setpoints(plans[0], np.array([forces] * 3, dtype=float))
    return {*(rg.verify(plan).ok for plan in plans), rows.ok}


def test_slack_in_numbers() -> None:
    """Pushes of 4, across 2: (3/4)^2 - (1/2)^2; without force none, outside the push less than none."""
    grasp, forces = cross((0.75,) * 4, force=4.0)
    state = rg.GraspState(grasp, rg.Wrench([0, 0]), forces)
    assert rg.verify(Plan("rotation", None, state, state)).least_cone_slack == pytest.approx(
        0.3125, rel=1e-15
    )
    rest = rg.GraspState(grasp, rg.Wrench([0, 0]), 0 * forces)
    assert rg.verify(Plan("rotation", None, rest, rest)).least_cone_slack == inf
    pulled = rg.GraspState(grasp, rg.Wrench([0, 0]), -forces)
    assert rg.verify(Plan("rotation", None, pulled, pulled)).least_cone_slack == -inf
    edge, forces = cross((0.25,) * 4, force=4.0)
    outside = rg.GraspState(edge, rg.Wrench([0, 0]), forces)
    found = rg.verify(Plan("rotation", None, outside, outside))
    assert found.least_cone_slack == pytest.approx(0.0625 - 0.25)
    assert "it uses 2 of the friction available" in found.violations[0]
    across = forces.copy()
    across[:, 0] = 0
    assert (
        "it uses inf of"
        in rg.verify(
            Plan("rotation", None, *[rg.GraspState(edge, rg.Wrench([0, 0]), across)] * 2)
        ).violations[0]
    )


def test_slack_and_residual_are_the_worst_of_all_instants() -> None:
    """Settled in floats and decided exactly: one row of each."""
    grasp, forces = cross((0.75,) * 4)
    narrow = forces.copy()
    narrow[:, 1] *= 1.5  # on the edge
    for row, worst in (narrow, 0.0), (forces, 0.3125):
        state = rg.GraspState(grasp, rg.Wrench([0, 0]), forces)
        path = course([0, 0.5, 1], [forces, row, forces], [[0, 0, 0]] * 3)
        verdict = rg.verify(Plan("rotation", None, state, state, course=path))
        assert verdict.ok
        assert verdict.least_cone_slack == pytest.approx(worst, abs=1e-15)
        assert verdict.least_angle == pytest.approx(atan(0.75) - atan(0.75 if worst == 0 else 0.5), abs=1e-15)
        rows = verify_setpoints(Plan("rotation", None, state, state, course=path), path.forces, path.times)
        assert rows.least_cone_slack == pytest.approx(worst, abs=1e-15)
    for off in (EPS / 8, EPS * 0.999):
        bent = forces.copy()
        bent[0, 0] += off
        path = course([0, 0.5, 1], [forces, bent, forces], [[0, 0, 0]] * 3)
        verdict = rg.verify(Plan("rotation", None, state, state, course=path))
        assert verdict.worst_residual == pytest.approx(off / np.hypot(1, 0.5), rel=1e-3, abs=0)


def test_a_residual_of_exactly_the_tolerance() -> None:
    """Beside a load of 2^-20 across, which a finger in the middle holds."""
    grasp, forces = cross()
    forces[:, 1] = 0
    for across in (0, 1):
        held = 2.0**-20 * np.eye(2)[across]
        whole = rg.Grasp([*grasp, rg.Contact([0, 0], held, 0.5, name="E")])
        for off, fine in (EPS, True), (nextafter(EPS, 1), False), (-EPS, True), (nextafter(-EPS, -1), False):
            load = rg.Wrench(off * np.eye(2)[1 - across] - held)
            assert good(whole, [*forces, held], load) == {fine}


def test_torques_are_measured_by_the_farthest_contact() -> None:
    """Two crosses, one four times as large as the other."""
    near, first = cross((0.75,) * 4)
    far, second = cross((0.75,) * 4, length=4.0)
    grasp = rg.Grasp([*near, *(c.named(c.name.lower()) for c in far)])
    forces = np.concatenate([first, second])
    scale = np.hypot(1, 0.5)
    for times, fine in (0.999, True), (1.001, False):
        torque = times * EPS * 4 * np.sqrt(2) * scale
        off = forces + out_of_balance(grasp, [0, 0, torque])
        assert good(grasp, off, rg.Wrench([0, 0])) == {fine}


def test_torques_on_a_contact_at_the_centre_are_measured_by_1() -> None:
    grasp = rg.Grasp([rg.Contact([0, 0], [0, 1], 0.5)])
    for torque, fine in (EPS, True), (nextafter(EPS, 1), False), (-1.1 * EPS, False):
        load = rg.Wrench([0, -1.0], torque)
        assert good(grasp, [[0, 1.0]], load) == {fine}


def test_torques_of_soft_fingers_hold_a_torque() -> None:
    """Both turn the object about x by 1; the load turns it back by 2, or, wrongly, on."""
    grasp = rg.Grasp(rg.Contact([x, 0, 0], [-x, 0, 0], 0.5, torsion=0.5) for x in (-1, 1))
    forces = [[5, 0, 0, 1.0], [-5, 0, 0, -1.0]]
    assert good(grasp, forces, rg.Wrench([0, 0, 0], [-2.0, 0, 0])) == {True}
    assert good(grasp, forces, rg.Wrench([0, 0, 0], [2.0, 0, 0])) == {False}


def test_torques_without_forces_hold_nothing() -> None:
    grasp = rg.Grasp(rg.Contact([x, 0, 0], [-x, 0, 0], 0.5, torsion=0.5) for x in (-1, 1))
    state = rg.GraspState(grasp, rg.Wrench([0, 0, 0]), [[0, 0, 0, 1.0], [0, 0, 0, -1.0]])
    found = rg.verify(Plan("rotation", None, state, state))
    assert "start: not in equilibrium, torques of soft fingers balance no load" in found.violations
    assert "is outside its friction cone: it uses inf" in "; ".join(found.violations)


@pytest.mark.parametrize("size", [2.0**-700, 1.0, 2.0**700])
def test_the_least_angle_in_any_units(size) -> None:
    """Along a normal that points down, so that no component is positive."""
    grasp = rg.Grasp([rg.Contact([0, 1], [0, -1], 0.5)])
    state = rg.GraspState(grasp, rg.Wrench([0, size]), [[0, -size]])
    for plan in (
        Plan("rotation", None, state, state),
        Plan(
            "rotation", None, state, state, course=course([0, 1], [state.forces] * 2, [state.load.vector] * 2)
        ),
    ):
        verdict = rg.verify(plan)
        assert verdict.ok
        if plan.course is None:
            assert verdict.least_angle == pytest.approx(atan(0.5))


def test_a_regrasp_whose_object_rests_between_steps() -> None:
    """No load, no forces at the joint: a hold of nothing, with no margin to claim less than."""
    grasp = rg.Grasp([rg.Contact([-1, 0], [1, 0], 0.5, name="A"), rg.Contact([1, 0], [-1, 0], 0.5, name="B")])
    rest = rg.GraspState(grasp, rg.Wrench([0, 0]), [[0, 0], [0, 0]])
    squeezed = rg.GraspState(grasp, rg.Wrench([0, 0]), [[1, 0], [-1, 0]])
    steps = (Plan("rotation", None, squeezed, rest), Plan("rotation", None, rest, squeezed))
    from types import SimpleNamespace

    plan = SimpleNamespace(steps=steps, orientations=(0.0, 0.0, 0.0), margin=atan(0.5))
    assert rg.verify(plan).violations == ()


def test_friction_below_the_resolution_counts_as_that() -> None:
    """For forces, for the torques of soft fingers and for their limits between two angles."""
    grasp, forces = cross((EPS / 4,) * 4, slope=EPS)
    assert good(grasp, forces) == {True}
    grasp, forces = cross((EPS / 4,) * 4, slope=EPS * (1 + 2.0**-20))
    assert good(grasp, forces) == {False}
    for times, fine in (1, True), (1 + 2.0**-20, False):
        soft = rg.Grasp(rg.Contact([x, 0, 0], [-x, 0, 0], EPS / 4, torsion=0.5) for x in (-1, 1))
        assert good(soft, [[1, 0, 0, 0.5 * times], [-1, 0, 0, 0.5 * times]]) == {fine}


def test_least_normals_of_soft_fingers_look_at_forces_only() -> None:
    grasp = rg.Grasp(rg.Contact([x, 0, 0], [-x, 0, 0], 0.5, torsion=0.5) for x in (-1, 1))
    state = rg.GraspState(grasp, rg.Wrench([0, 0, 0]), [[1, 0, 0, 0.1], [-1, 0, 0, 0.1]])
    for least, fine in (1.0, True), (1.01, False):
        plan = Plan("rotation", None, state, state, record=Record(least_normals=(least,) * 2))
        assert rg.verify(plan).ok == fine
        rows = np.array([state.forces] * 3)
        assert verify_setpoints(plan, rows).ok == fine


def test_turning_loads_that_are_far_smaller_than_the_forces() -> None:
    """A still part of 1e-3 of a load of 1e-12 of the forces is no rounding of the axis."""
    grasp, forces = cross((0.75,) * 4)
    solid = rg.Grasp(rg.Contact([*c.position, 0], [*c.normal, 0], 0.75, name=c.name) for c in grasp)
    forces = np.column_stack([forces, np.zeros(4)])
    for still, fine in (0.0, True), (1e-15, False):
        load = rg.Wrench([0, 1e-12, still])
        state = rg.GraspState(solid, load, forces)
        end = rg.GraspState(solid, rg.Wrench([1e-12 * np.sin(0.5), 1e-12 * np.cos(0.5), still]), forces)
        found = rg.verify(Plan("rotation", None, state, end, turn=turn([0, 0.5], [forces] * 2, [0, 0, 1.0])))
        assert ("no states between angles hold it" not in "; ".join(found.violations)) == fine


@pytest.mark.parametrize("row", [10, 8500])
def test_summaries_are_of_all_blocks_of_rows(row) -> None:
    """A row of more slope than the others, a little out of balance, in the first block and in the second."""
    grasp, forces = cross((0.75,) * 4)
    state = rg.GraspState(grasp, rg.Wrench([0, 0]), forces)
    bent = forces * [1, 1 + EPS / 4]
    bent[0, 0] += EPS / 4
    rows = np.broadcast_to(forces, (9000, 4, 2)).copy()
    rows[row] = bent
    found = verify_setpoints(Plan("rotation", None, state, state), rows)
    assert found.ok
    assert found.worst_residual == pytest.approx(EPS / 4 / np.hypot(1, 0.5), rel=1e-3, abs=0)
    steep = forces * [1, 1.25]
    rows[row] = steep
    found = verify_setpoints(Plan("rotation", None, state, state), rows)
    assert not found.ok
    assert found.least_angle == pytest.approx(atan(0.75) - atan(0.625))
    assert found.least_cone_slack == pytest.approx(0.75**2 - 0.625**2)


def test_an_object_turns_on_one_finger_at_its_centre() -> None:
    grasp, load = rg.Grasp([rg.Contact([0, 0], [0, 1], 1.0)]), rg.Wrench([0, -1.0])
    rows = [-load.rotated(-angle).force[None] for angle in (0.0, 0.5)]
    states = [rg.GraspState(grasp, load.rotated(-a), f) for a, f in zip((0.0, 0.5), rows, strict=True)]
    assert rg.verify(Plan("rotation", None, *states, turn=turn([0, 0.5], rows))).ok

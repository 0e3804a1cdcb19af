"""Every condition on a state, a bit inside its limit and a bit outside, wherever in a plan the state stands.

The grasps balance exactly in binary (``foreign``), so the limits are met to the last bit, and plans are plain
values, so that nothing but ``verify`` looks at them.
"""

from math import inf, nextafter

import numpy as np
import pytest

import regrasp as rg
from foreign import Plan, cross, out_of_balance, places, soft_pair, solid_cross, spoilt
from regrasp.verification import RESOLUTION, verify_setpoints

pytestmark = pytest.mark.contract

EPS = float(RESOLUTION)
CROSSES = {"plane": cross, "space": solid_cross}


def said(plan) -> str:
    verdict = rg.verify(plan)
    assert verdict.ok == (not verdict.violations)
    return "\n".join(verdict.violations)


def rows_said(grasp, forces, load=None) -> str:
    """What is said of these forces as set-points of a plan that has them throughout."""
    load = rg.Wrench([0.0] * grasp.dimension) if load is None else load
    state = rg.GraspState(grasp, load, forces)
    rows = np.array([forces] * 3)
    return "\n".join(verify_setpoints(Plan("rotation", None, state, state), rows).violations)


@pytest.mark.parametrize("make", CROSSES.values(), ids=CROSSES)
@pytest.mark.parametrize("finger", range(4))
def test_a_force_on_the_edge_of_its_cone(make, finger) -> None:
    less = [0.5] * 4
    less[finger] = nextafter(0.5, 0)
    name = "ABCD"[finger]
    for frictions, good in ((0.5,) * 4, True), (less, False):
        grasp, forces = make(frictions)
        for where, plan in places(grasp, forces):
            found = said(plan)
            assert (found == "") == good, where
            assert good or f"force of {name} is outside its friction cone: it uses 1" in found
        assert (rows_said(grasp, forces) == "") == good


@pytest.mark.parametrize("make", CROSSES.values(), ids=CROSSES)
@pytest.mark.parametrize("finger", range(4))
def test_a_force_at_its_limit(make, finger) -> None:
    grasp, forces = make((1.0,) * 4)
    square = float((forces[finger] ** 2).sum())
    at = float(np.sqrt(square))
    while at**2 < square:
        at = nextafter(at, inf)
    below, above = nextafter(at, 0), nextafter(at, inf)
    for limit, good in (below, False), (above, True):
        limits = [None] * 4
        limits[finger] = limit
        grasp, forces = make((1.0,) * 4, limits)
        for where, plan in places(grasp, forces):
            if where == "angle":
                continue  # between two angles forces grow
            assert (said(plan) == "") == good, (where, limit)
        assert (rows_said(grasp, forces) == "") == good


@pytest.mark.parametrize("make", CROSSES.values(), ids=CROSSES)
def test_a_state_spoilt_in_one_place_only(make) -> None:
    """Each state of a plan is looked at: the others are good."""
    grasp, forces = make()
    pulled, pushed, slipped = -forces, 2 * forces, forces.copy()
    pushed[0] = forces[0]
    slipped[:, 1] *= 1 + 1e-15  # balanced, and just outside
    seen = set()
    for where, plan in places(grasp, forces):
        for at in ("start", "end") if where == "ends" else (where,):
            seen.add(at)
            assert "pulls: normal component -" in said(spoilt(plan, at, pulled))
            assert "not in equilibrium" in said(spoilt(plan, at, pushed))
            assert "outside its friction cone" in said(spoilt(plan, at, slipped))
            assert "equilibrium" not in said(spoilt(plan, at, slipped))
    assert seen == {"start", "end", "instant", "angle", "between"}


@pytest.mark.parametrize("make", CROSSES.values(), ids=CROSSES)
@pytest.mark.parametrize("length", [1.0, 2.0**-20, 2.0**20])
@pytest.mark.parametrize("sign", [1, -1])
def test_a_residual_at_its_limit_in_every_direction(make, length, sign) -> None:
    """Forces along the normals alone: the largest is 1, the arm sqrt(2) or 1.6008 lengths."""
    grasp, forces = make((0.5,) * 4, length=length)
    forces[:, 1:] = 0
    forces /= abs(forces).max()
    d = grasp.dimension
    for axis in range(3 * (d - 1)):
        unit = 1.0 if axis < d else grasp.size
        for times, good in (0.999, True), (1.001, False):
            residual = np.zeros(3 * (d - 1))
            residual[axis] = sign * EPS * unit * times
            off = forces + out_of_balance(grasp, residual)
            for where, plan in places(grasp, off):
                assert (said(plan) == "") == good, (axis, where)
            none = rg.Wrench.from_vector(0 * residual)
            assert (rows_said(grasp, off, none) == "") == good


def test_soft_fingers_at_the_edge_of_their_limit_surface() -> None:
    for changes, good in [
        ({}, True),
        ({"friction": nextafter(0.5, 0)}, False),
        ({"torsion": nextafter(0.25, 0)}, False),
        ({"friction": nextafter(0.5, 1), "torsion": nextafter(0.25, 1)}, True),
    ]:
        grasp, load, forces = soft_pair(**changes)
        for where, plan in places(grasp, forces, load):
            assert (said(plan) == "") == good, (changes, where)
        assert (rows_said(grasp, forces, load) == "") == good


def test_torques_of_soft_fingers_count_in_the_balance() -> None:
    grasp, load, forces = soft_pair(friction=1.0, torsion=1.0)
    for change, good in [(0.5 * EPS, True), (8 * EPS, False), (-8 * EPS, False)]:
        other = forces.copy()
        other[0, 3] += change
        for where, plan in places(grasp, other, load):
            assert (said(plan) == "") == good, where
        assert (rows_said(grasp, other, load) == "") == good


def test_limits_of_soft_fingers_count_their_torque() -> None:
    """A push of 3 and a torque that uses the friction of 4 are 5 together."""
    for limit, good in (5.0, True), (nextafter(5, 0), False):
        grasp = rg.Grasp(
            rg.Contact([x, 0, 0], [-x, 0, 0], 2.0, torsion=0.5, max_force=limit, name=name)
            for x, name in ((-1, "A"), (1, "B"))
        )
        forces = [[3, 0, 0, 1.0], [-3, 0, 0, 1.0]]
        for where, plan in places(grasp, forces):
            if where != "angle":
                assert (said(plan) == "") == good, where
        assert (rows_said(grasp, forces) == "") == good


def test_a_point_contact_beside_soft_ones_makes_no_torque() -> None:
    grasp = rg.Grasp(
        [
            rg.Contact([-1, 0, 0], [1, 0, 0], 0.5, torsion=1.0, name="soft"),
            rg.Contact([1, 0, 0], [-1, 0, 0], 0.5, name="point"),
        ]
    )
    good = np.array([[1, 0, 0, 0.0], [-1, 0, 0, 0.0]])
    twisted = np.array([[1, 0, 0, 0.25], [-1, 0, 0, 0.25]])
    state = rg.GraspState(grasp, rg.Wrench([0, 0, 0]), good)
    for where, plan in places(grasp, good):
        assert said(plan) == ""
        if where != "ends":
            plan = spoilt(plan, where, good)
            rows = {"instant": "course", "angle": "turn", "between": "turn"}[where]
            field = "middles" if where == "between" else "forces"
            getattr(getattr(plan, rows), field)[-1 if where == "between" else 1] = twisted
            assert "point: a point contact makes no torque" in said(plan)
    rows = np.array([good, twisted, good])
    found = verify_setpoints(Plan("rotation", None, state, state), rows).violations
    assert found[0].startswith("set-point 1: force of point: a point contact makes no torque")


def test_the_least_slack_and_the_worst_residual_are_reported() -> None:
    grasp, forces = cross((0.75,) * 4)
    for _, plan in places(grasp, forces):
        verdict = rg.verify(plan)
        assert verdict.worst_residual == 0
        assert verdict.least_cone_slack == pytest.approx(0.75**2 - 0.5**2, rel=1e-12)
        assert verdict.least_angle == pytest.approx(np.arctan(0.75) - np.arctan(0.5), rel=1e-12)
        assert f"by {verdict.least_angle:.6g} rad or more" in str(verdict)
    bent = forces.copy()
    bent[0, 0] += EPS / 2
    for where, plan in places(grasp, forces):
        at = "end" if where == "ends" else where
        worst = rg.verify(spoilt(plan, at, bent)).worst_residual
        assert worst == pytest.approx(EPS / 2 / np.hypot(1, 0.5), rel=1e-6, abs=0), where
    rest = rg.verify(Plan("rotation", None, *[rg.GraspState(grasp, rg.Wrench([0, 0]), 0 * forces)] * 2))
    assert rest.ok
    assert rest.least_angle == inf
    assert str(rest).endswith("every force inside its cone")

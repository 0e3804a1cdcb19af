"""Forces 2^30 times the load and more hold anything to their rounding: the load itself must be held, too."""

from math import cos, inf, sin

import numpy as np
import pytest

import regrasp as rg
from foreign import Plan, course, cross, out_of_balance, solid_cross, turn
from regrasp.verification import HELD, verify_setpoints

pytestmark = [pytest.mark.laws, pytest.mark.filterwarnings("error")]
MAKERS = {"plane": cross, "space": solid_cross}


class Squeezed:
    """A cross that squeezes with 2^power, and a weak one beside it that holds whatever load there is."""

    def __init__(self, make, power, unit=1.0) -> None:
        strong, self.hard = make((0.75,) * 4, length=unit)
        weak, self.soft = make((8.0,) * 4, length=unit / 2)
        self.hard, self.soft = self.hard * 2.0**power, self.soft * 4
        self.weak, self.d = weak, weak.dimension
        self.grasp = rg.Grasp([*strong, *(c.named(c.name.lower()) for c in weak)])
        self.axis = None if self.d == 2 else [0, 0, 1.0]

    def load(self, angle=0.0, size=1.0, stretch=1.0):
        """Of ``size`` along -y, seen from an object turned by ``angle``."""
        force = np.zeros(self.d)
        force[:2] = -size * stretch * np.array([sin(angle), cos(angle)])
        return rg.Wrench(force)

    def forces(self, load, residual):
        return np.concatenate([self.hard, self.soft + out_of_balance(self.weak, residual - load.vector)])


def plans(squeezed, residual, size=1.0):
    """A plan for each place: (where, plan), with the residual there and nowhere else."""
    load, none = squeezed.load(size=size), 0 * residual
    good, bad = (squeezed.forces(load, r) for r in (none, residual))
    fine, off = (rg.GraspState(squeezed.grasp, load, f) for f in (good, bad))
    yield "start", Plan("rotation", None, off, fine)
    yield "end", Plan("rotation", None, fine, off)
    path = course([0, 0.5, 1], [good, bad, good], [load.vector] * 3)
    yield "instant 1", Plan("rotation", None, fine, fine, course=path)
    step = 0.5
    seen, between = squeezed.load(step, size), squeezed.load(step / 2, size, 1 / cos(step / 2))
    last, middle = squeezed.forces(seen, residual), squeezed.forces(between, residual)
    turned = turn([0, step], [good, last], squeezed.axis)
    end = rg.GraspState(squeezed.grasp, seen, last)
    yield "angle 0.5 rad", Plan("rotation", None, fine, end, turn=turned)
    last = squeezed.forces(seen, none)
    turned = turn([0, step], [good, last], squeezed.axis, [middle])
    end = rg.GraspState(squeezed.grasp, seen, last)
    yield "between 0 and 0.5 rad", Plan("rotation", None, fine, end, turn=turned)


@pytest.mark.parametrize("make", MAKERS.values(), ids=MAKERS)
@pytest.mark.parametrize("unit", [1.0, 2.0**-20])
def test_the_load_is_held_to_a_thousandth_whatever_the_forces(make, unit) -> None:
    """In every direction, torques over the arm; forces of 2^60 that balance to the last bit."""
    squeezed = Squeezed(make, 60, unit)
    count = 3 * (squeezed.d - 1)
    for axis in range(count):
        for sign in (1, -1):
            for times, good in (0.999, True), (1.001, False):
                size = 1.0 if axis < squeezed.d else squeezed.grasp.size
                residual = sign * times * float(HELD) * size * np.eye(count)[axis]
                for where, plan in plans(squeezed, residual):
                    said = "; ".join(rg.verify(plan).violations)
                    assert (said == "") == good, (axis, where)
                    assert good or said.startswith(
                        f"{where}: the load is not held, G f + w_ext is 0.00097"
                    ), said
    assert not any(rg.verify(plan).ok for _, plan in plans(squeezed, squeezed.load().vector))


@pytest.mark.parametrize("make", MAKERS.values(), ids=MAKERS)
def test_set_points_hold_the_load_to_a_thousandth(make) -> None:
    squeezed = Squeezed(make, 60)
    load = squeezed.load()
    residual = float(HELD) * np.eye(load.vector.size)[1]
    for times, good in (0.999, True), (1.001, False):
        forces = squeezed.forces(load, times * residual)
        state = rg.GraspState(squeezed.grasp, load, forces)
        found = verify_setpoints(Plan("rotation", None, state, state), np.array([forces] * 3))
        assert found.ok == good
        assert good or found.violations[0].startswith("set-point 0: the load is not held")


@pytest.mark.parametrize("make", MAKERS.values(), ids=MAKERS)
@pytest.mark.parametrize("power", [10, 29])
def test_below_2_to_the_30_only_the_forces_count(make, power) -> None:
    squeezed = Squeezed(make, power)
    largest = np.linalg.norm(squeezed.hard[0])
    residual = 2.0**-40 * largest * np.eye(squeezed.load().vector.size)[1]
    for times, good in (0.999, True), (1.001, False):
        for where, plan in plans(squeezed, times * residual):
            said = "; ".join(rg.verify(plan).violations)
            assert (said == "") == good, (where, said)
            assert good or "of the largest force" in said


def test_a_load_that_passes_through_0_is_judged_by_its_largest() -> None:
    """Swinging from 1 to -1 by way of 1e-17, which rounds away beside forces of 4."""
    squeezed = Squeezed(cross, 2)
    loads = [squeezed.load(size=s) for s in (1.0, 1e-17, -1.0)]
    forces = [squeezed.forces(w, 0 * w.vector) for w in loads]
    forces[1] = forces[1] + 1e-16 * np.eye(8)[0][:, None]
    ends = [rg.GraspState(squeezed.grasp, loads[k], forces[k]) for k in (0, -1)]
    plan = Plan("rotation", None, *ends, course=course([0, 0.5, 1], forces, [w.vector for w in loads]))
    assert rg.verify(plan).ok
    alone = rg.GraspState(squeezed.grasp, loads[1], forces[1])
    assert not rg.verify(Plan("rotation", None, alone, alone)).ok


@pytest.mark.parametrize("size", [5e-324, 1e-300, 1e-20])
def test_a_load_that_rounding_loses_is_not_held(size) -> None:
    """Forces of 1 balance themselves; nothing of them holds the load, however small it is."""
    grasp, forces = cross((0.75,) * 4)
    for load in (rg.Wrench([0, size]), rg.Wrench([0, 0], size)):
        state = rg.GraspState(grasp, load, forces)
        for plan in (
            Plan("rotation", None, state, state),
            Plan("rotation", None, state, state, course=course([0, 1], [forces] * 2, [load.vector] * 2)),
        ):
            assert "the load is not held" in rg.verify(plan).violations[0]
            assert not verify_setpoints(plan, np.array([forces] * 2)).ok


def test_sizes_of_loads_are_numbers_at_any_scale() -> None:
    grasp, _ = cross(length=1e-200)
    from regrasp.verification.exact import load_size

    assert load_size(grasp, np.zeros((2, 3))) == 0
    assert load_size(grasp, np.array([[0, 0, 1e200]])) == np.finfo(float).max < inf
    far, _ = cross(length=1e200)
    assert load_size(far, np.array([[0, 0, 1e-200]])) == 5e-324
    assert load_size(far, np.array([[3e-200, -4e-200, 0], [0, 0, 1.0]])) == pytest.approx(
        5e-200, rel=1e-15, abs=0
    )

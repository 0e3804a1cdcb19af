"""Rows that doubles could settle wrongly, names one after the other, time functions, one by one."""

from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from math import inf
from types import SimpleNamespace

import numpy as np
import pytest

import regrasp as rg
from foreign import Plan, Record, Scaling, course, cross, soft_pair, solid_cross
from regrasp.verification import verify_setpoints
from regrasp.verification.exact import check_state, load_size
from regrasp.verification.falling import steepest

pytestmark = pytest.mark.contract

EPS = 2.0**-40
NONE = rg.Wrench([0.0, 0.0])


def said(plan) -> str:
    return "; ".join(rg.verify(plan).violations)


def along(grasp, rows, loads) -> Plan:
    """A plan of instants."""
    rows, loads = np.array(rows, dtype=float), np.array(loads, dtype=float)
    start, end = (rg.GraspState(grasp, rg.Wrench.from_vector(loads[k]), rows[k]) for k in (0, -1))
    return Plan("rotation", None, start, end, course=course(np.linspace(0, 1, len(rows)), rows, loads))


@pytest.mark.parametrize("length", [1.0, 2.0**-20, 2.0**20])
@pytest.mark.parametrize("d", [2, 3])
def test_torques_are_judged_by_the_lever_also_where_coordinates_are_zero(d, length) -> None:
    """Two fingers on the axis x; the second turns its force a little, which is a torque of length e."""
    sides = (-1, 1)
    grasp = rg.Grasp(rg.Contact([x * length, 0, 0][:d], [-x, 0, 0][:d], 0.5) for x in sides)
    for off, good in (0.49 * EPS, True), (0.51 * EPS, False):
        rows = [[[-x, x * e, 0][:d] for x in sides] for e in (0.0, off, 0.0)]
        found = said(along(grasp, rows, [[0.0] * (3 * d - 3)] * 3))
        assert (found == "") == good
        assert good or found.startswith("instant 1: not in equilibrium")
    at_one = rg.Grasp(rg.Contact([0.0] * d, [-x, 0, 0][:d], 0.5) for x in sides)  # no lever at all
    rows = [[[-x, 0, 0][:d] for x in sides]] * 3
    assert said(along(at_one, rows, [[0.0] * (3 * d - 3)] * 3)) == ""
    assert "instant 1" in said(
        along(at_one, [rows[0], 2 * np.array(rows[0]) + 0.1, rows[0]], [[0.0] * (3 * d - 3)] * 3)
    )


@pytest.mark.parametrize("make", [cross, solid_cross])
def test_no_forces_hold_no_load(make) -> None:
    grasp, forces = make()
    for load in np.eye(3 * grasp.dimension - 3) * 1e-300, np.ones((1, 3 * grasp.dimension - 3)):
        for vector in load:
            rows = [forces, 0 * forces, forces]
            zero = 0 * vector
            assert "instant 1: not in equilibrium" in said(along(grasp, rows, [zero, vector, zero]))
    assert said(along(grasp, [forces, 0 * forces, forces], [0 * vector] * 3)) == ""


def test_forces_beside_which_a_load_is_small_hold_it_to_a_thousandth() -> None:
    """Squeezes of 2^32 and a load of 1: rounding alone may be 2^-8, what is asked is 2^-10."""
    grasp, forces = cross((0.75,) * 4, force=2.0**32)
    for off, good in (0.9, True), (1.0, True), (1 + 2.0**-8, False), (1.9, False):
        rows = np.array([forces] * 3)
        rows[:, 0, 1] += 0.5
        rows[:, 2, 1] += 0.5
        rows[1, :, 1] += off * 2.0**-10 / 4
        found = said(along(grasp, rows, [[0, -1.0, 0]] * 3))
        assert (found == "") == good, off
        assert good or "instant 1: the load is not held" in found


def test_the_load_that_is_to_be_held_is_the_largest_of_a_plan() -> None:
    """A residual of 2^-12 at the start, where the load is 2^-20; later it is 1."""
    grasp, forces = cross((0.75,) * 4, force=2.0**32)
    rows, loads = np.array([forces] * 3), np.zeros((3, 3))
    rows[1:, 0, 1] += 0.5
    rows[1:, 2, 1] += 0.5
    loads[0, 1], loads[1:, 1] = 2.0**-12, -1.0
    plan = along(grasp, rows, loads)
    assert said(plan) == ""
    assert verify_setpoints(plan, rows).ok
    loads[1:], rows[1:] = loads[0], rows[0]
    assert "the load is not held" in said(along(grasp, rows, loads))
    for lever in (1.0, 4.0):
        far = rg.Grasp(rg.Contact([x, 0], [-np.sign(x), 0], 0.5) for x in (-lever, 1.0))
        assert load_size(far, np.array([[0.0, 0, 8.0], [1.0, 0, 0]])) == 8 / lever
    for d, torque in ((2, 0.0), (3, 0.0)):
        origin = rg.Grasp(rg.Contact([0.0] * d, [-x, 0, 0][:d], 0.5) for x in (-1, 1))
        assert load_size(origin, np.array([[3.0, 4.0] + [torque] * (3 * d - 5)])) == 5


def test_cones_are_those_of_the_very_numbers() -> None:
    """Forces a bit inside and a bit outside of cones, about normals whose length is 1 but for last bits."""
    rng, seen = np.random.default_rng(0), set()
    for _ in range(150):
        d = int(rng.integers(2, 4))
        n = rng.normal(size=d)
        contact = rg.Contact(np.zeros(d), n, float(rng.uniform(0.1, 2)), name="A")
        n, across = contact.normal, rng.normal(size=d)
        across -= (across @ n) * n
        force = n + contact.friction * across / np.linalg.norm(across)
        force[0] = np.nextafter(force[0], rng.choice([-9, 9]))
        f, m, mu = ([Fraction(x) for x in v] for v in (force.tolist(), n.tolist(), [contact.friction]))
        push, ff, nn = (sum(a * b for a, b in zip(*v, strict=True)) for v in ((f, m), (f, f), (m, m)))
        outside = ff * nn > (1 + mu[0] ** 2) * push**2
        state = rg.GraspState(rg.Grasp([contact]), rg.Wrench([0.0] * d), [force])
        assert ("outside its friction cone" in "; ".join(check_state(state, "A")[2])) == outside
        seen.add(outside)
    assert seen == {True, False}


def test_the_worst_residual_is_that_of_all_rows() -> None:
    """One row that doubles settle, and one so near to the limit that rationals do."""
    grasp, forces = cross()
    for off in 0.99, 0.5:
        rows = np.array([forces] * 3)
        rows[1, 0, 0] += off * EPS
        worst = rg.verify(along(grasp, rows, [[0.0] * 3] * 3)).worst_residual
        assert worst == pytest.approx(off * EPS / np.hypot(1, 0.5), rel=1e-3)
        state = rg.GraspState(grasp, NONE, forces)
        plan = Plan("rotation", None, state, state)
        assert verify_setpoints(plan, rows).worst_residual == pytest.approx(worst, rel=1e-6)


@pytest.mark.parametrize(("row", "slide"), [([1.0, -1.0], -2.0), ([1.0, 1.0], 2.0), ([1.0, 0.5], 2.0)])
@pytest.mark.parametrize("side", [1, -1])
def test_linear_limits_of_rows_at_their_limit(row, slide, side) -> None:
    """Fingers push with 4 and slide with 2: what a row counts may be less than what its terms are."""
    push, mu = 4.0, 0.75
    sizes = np.array([[side * push, 0.0], [-side * push, 0.0]])
    for finger in (0, 1):
        normal = np.array([1.0, 0.0]) * side * (1, -1)[finger]
        tangent = np.array([-normal[1], normal[0]])
        across = [slide, -slide][finger] * side
        force = sizes[finger] + [0, across]
        used = row[0] * (force @ normal) + row[1] * (force @ tangent)
        if used <= 0:
            continue
        for bound, good in (
            (used, True),
            (used * (1 - 2.0**-45), False),
            (used * (1 + 2.0**-45), True),
            (used / 2, False),
        ):
            limits = rg.ForceLimits([row], [bound])
            contacts = [
                rg.Contact(
                    [-side * x, 0], [side * x, 0], mu, limits=limits if k == finger else None, name="AB"[k]
                )
                for k, x in enumerate((1, -1))
            ]
            forces = sizes + np.array([[0, slide], [0, -slide]]) * side
            load = [0.0, 0.0, float(2 * slide)]  # the couple of both
            grasp = rg.Grasp(contacts)
            torque = float(sum(c.position[0] * f[1] for c, f in zip(contacts, forces, strict=True)))
            load[2] = -torque
            found = said(along(grasp, [forces] * 3, [load] * 3))
            assert (found == "") == good, (finger, bound)
            assert good or f"instant 1: force of {'AB'[finger]} breaks its linear limit 0" in found


def test_a_torque_of_a_point_contact_leaves_no_slack() -> None:
    soft = rg.Contact([-1, 0, 0], [1, 0, 0], 0.5, torsion=1.0, name="soft")
    grasp = rg.Grasp([soft, rg.Contact([1, 0, 0], [-1, 0, 0], 0.5, name="point")])
    rows = np.array([[[1, 0, 0, 0.0], [-1, 0, 0, 0.0]]] * 3)
    rows[1, :, 3] = 0.25
    verdict = rg.verify(along(grasp, rows, [[0.0] * 6] * 3))
    assert "point: a point contact makes no torque" in "; ".join(verdict.violations)
    assert verdict.least_cone_slack == -inf


@pytest.mark.parametrize("torsion", [0.25, 4.0])
def test_soft_fingers_in_rows_at_their_limit_surface(torsion) -> None:
    grasp, load, forces = soft_pair(torsion=torsion)
    forces = np.array(forces, dtype=float)
    forces[:, 3] *= torsion / 0.25
    for times, good in (1 - 1e-12, True), (1 + 1e-12, False):
        rows = np.array([forces] * 3)
        rows[1, :, 3] *= times
        assert (said(along(grasp, rows, [load.vector] * 3)) == "") == good


def test_every_finger_that_leaves_is_looked_at_after_one_that_is_unknown() -> None:
    grasp, forces = cross((0.75,) * 4)
    state = rg.GraspState(grasp, NONE, forces)
    plan = Plan("rotation", None, state, state)
    values = {name: getattr(plan, name) for name in (*Plan.__dataclass_fields__, "forces")}
    found = said(SimpleNamespace(**values, leaving=("E", "B"), arriving=()))
    assert "contact 'E' is not one of A, B, C, D" in found
    assert "end: B must carry no force" in found


def test_degrees_of_time_functions_are_whole_numbers() -> None:
    grasp, forces = cross()
    state = rg.GraspState(grasp, NONE, forces)
    for degree, good in (
        (1, True),
        (2, True),
        (0, False),
        (3, False),
        (1.0, False),
        (1.5, False),
        ("1", False),
    ):
        scaling = SimpleNamespace(duration=1.0, control=(1.0, 0.5, 0.0), degree=degree)
        found = said(replace(Plan("rotation", None, state, state), scaling=scaling))
        assert ("time scaling is of degree" not in found) == good, degree


def test_a_duration_too_short_for_numbers_counts_for_small_forces_too() -> None:
    grasp, forces = cross(force=2.0**-40)
    state = rg.GraspState(grasp, NONE, forces)
    for duration, good in (2.3e-308, True), (2.2e-308, False):
        plan = Plan("rotation", None, state, state, scaling=Scaling(duration, (1.0, 0.0)))
        assert (said(plan) == "") == good


def _basis(knots, degree: int, at) -> np.ndarray:
    """(m, n) the B-splines of a degree, by Cox's and de Boor's recursion."""
    values = np.stack([(a <= at) & (at < b) for a, b in pairwise(knots)], axis=1).astype(float)
    for p in range(1, degree + 1):
        n = len(knots) - 1 - p
        parts = np.zeros((len(at), n))
        for i in range(n):
            for k, top in ((i, at - knots[i]), (i + 1, knots[i + p + 1] - at)):
                wide = knots[k + p] - knots[k]
                if wide > 0:
                    parts[:, i] += top / wide * values[:, k]
        values = parts
    return values


def test_how_fast_a_time_function_falls_at_most() -> None:
    """Against differences of the splines on many samples, rising and falling, of every degree."""
    rng, step = np.random.default_rng(3), 1e-7
    for degree in (1, 2, 3, 4):
        for spans in (1, 2, 4):
            control = rng.permutation(np.linspace(0, 1, degree + spans)) ** 2
            knots = np.r_[[0.0] * degree, np.linspace(0, 1, spans + 1), [1.0] * degree]
            at = np.r_[np.linspace(0, 1 - 2 * step, 201), np.linspace(0, 1, spans + 1)[1:] - 2 * step]
            rise = (_basis(knots, degree, at + step) - _basis(knots, degree, at)) @ control
            most = float(abs(rise).max()) / step
            found = steepest(SimpleNamespace(duration=1.0, control=tuple(control.tolist()), degree=degree))
            assert float(found) == pytest.approx(most, rel=2e-4), (degree, spans)


def test_a_time_function_that_names_no_degree_is_cubic_where_it_can_be() -> None:
    for count in range(2, 8):
        control = tuple((np.linspace(1, 0, count) ** 2).tolist())
        named = SimpleNamespace(duration=1.0, control=control, degree=min(3, count - 1))
        assert steepest(SimpleNamespace(duration=1.0, control=control)) == steepest(named)


def test_of_very_large_splines_control_values_are_the_bound() -> None:
    control = np.r_[1.0, np.linspace(1, 0, 4000), 0.0]
    control[2000] = control[2001]
    found = steepest(SimpleNamespace(duration=1.0, control=tuple(control.tolist()), degree=3))
    spans = len(control) - 3
    assert float(found) == pytest.approx(abs(np.diff(control)).max() * spans, rel=1e-9)


def test_what_says_itself_what_it_is_about_takes_nothing_else() -> None:
    cut = rg.RegraspCut(tuple(cross()[0]), (0, 1, 2), (0, 1, 3), (0, 1, 2), 0.0)
    for more in (
        {"load": lambda t: NONE}, {"curvature": 1.0}, {"disturbance": rg.LoadSet.hull([NONE])},
        {"stiffness": 1.0}, {"friction": 0.9}, {"position": [0.0] * 4}, {"surface": 0.0},
        {"early_loss": True},
    ):  # fmt: skip
        with pytest.raises(rg.InvalidInput, match="verify takes nothing else beside it"):
            rg.verify(cut, **more)


def test_set_points_of_no_form_have_no_margins() -> None:
    grasp, forces = cross()
    state = rg.GraspState(grasp, NONE, forces)
    verdict = verify_setpoints(Plan("rotation", None, state, state), forces)
    assert not verdict.ok
    assert (verdict.worst_residual, verdict.least_angle, verdict.least_cone_slack) == (inf, 0, 0)


def test_steps_alone_make_no_regrasp() -> None:
    for more in ({"steps": ()}, {"orientations": (0.0,)}):
        with pytest.raises(rg.InvalidInput, match="verify needs a plan"):
            rg.verify(SimpleNamespace(**more))


def test_a_record_is_judged_choice_by_choice() -> None:
    """The first choice counts fingers wrongly, the second is over its limit: both are named."""
    grasp, forces = cross((0.75,) * 4)
    state = rg.GraspState(grasp, NONE, forces)
    size = float(np.hypot(*forces[0]))
    for factor, good in (1 + 1e-15, True), (1 - 1e-11, False):
        choices = (
            SimpleNamespace(end="start", force_limits=(9.0,)),
            SimpleNamespace(end="end", force_limits=(inf, inf, size * factor, inf)),
        )
        found = said(replace(Plan("rotation", None, state, state), record=Record(choices=choices)))
        assert "start was chosen for 4 fingers in use, but 1 force limits" in found
        assert ("end was chosen with forces of C up to" not in found) == good


@pytest.mark.parametrize(("share", "fine"), [(0.49, False), (0.25, True)])
def test_linear_limits_whose_products_vanish_are_decided_exactly(share, fine) -> None:
    """Each of three terms rounds to zero, their sum is 1.47 or 0.75 times the bound, the least double."""
    least = 5e-324
    limits = ([[least] * 3], [least])
    grasp = rg.Grasp(
        rg.Contact([-x, 0, 0], [x, 0, 0], 2.0, limits=limits if x > 0 else None) for x in (1, -1)
    )
    pushed = share * (grasp.normals[0] + grasp.tangents[0].sum(axis=0))
    forces = np.array([pushed, -pushed])
    load = -np.cross(grasp.positions, forces).sum(axis=0)
    found = said(along(grasp, [forces] * 3, [[0, 0, 0, *load]] * 3))
    assert (found == "") is fine
    assert fine or "breaks its linear limit 0" in found

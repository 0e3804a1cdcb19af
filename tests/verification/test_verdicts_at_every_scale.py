"""Verdicts do not depend on units: powers of two change none, even where squares vanish and overflow."""

from math import inf, nextafter

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import regrasp as rg
from foreign import Plan, course, cross, out_of_balance, places, soft_pair, solid_cross, turn
from regrasp.verification import verify_setpoints
from regrasp.verification.exact import root, rounded

POWERS = st.sampled_from([-1000, -700, -549, -480, -300, -100, 0, 100, 300, 479, 509, 600, 900])
pytestmark = [pytest.mark.laws, pytest.mark.filterwarnings("error")]


def all_verdicts(grasp, forces, load=None) -> list[bool]:
    """At an end, at an instant, at angles, between them, and as set-points."""
    plans = [plan for _, plan in places(grasp, forces, load)]
    rows = verify_setpoints(plans[0], np.array([forces] * 3))
    return [*(rg.verify(plan).ok for plan in plans), rows.ok]


@given(POWERS, POWERS, st.booleans(), st.sampled_from([cross, solid_cross]), st.integers(0, 3))
@settings(max_examples=60)
def test_a_force_outside_its_cone_in_any_units(force, length, good, make, finger) -> None:
    frictions = [0.5] * 4
    if not good:
        frictions[finger] = nextafter(0.5, 0)
    grasp, forces = make(frictions, length=2.0**length, force=2.0**force)
    assert set(all_verdicts(grasp, forces)) == {good}


@given(POWERS, POWERS, st.sampled_from([0.999, 1.001]), st.sampled_from([1, -1]), st.integers(0, 8))
@settings(max_examples=60)
def test_a_residual_at_its_limit_in_any_units(force, length, times, sign, axis) -> None:
    """Nine directions: three of the plane and six of space."""
    make, d, axis = (cross, 2, axis) if axis < 3 else (solid_cross, 3, axis - 3)
    grasp, forces = make()
    forces[:, 1:] = 0
    residual = np.zeros(3 * (d - 1))
    residual[axis] = sign * times * 2.0**-40 * abs(forces).max() * (1.0 if axis < d else grasp.size)
    forces = (forces + out_of_balance(grasp, residual)) * 2.0**force
    grasp, _ = make(length=2.0**length)
    assert set(all_verdicts(grasp, forces)) == {times < 1}


@given(POWERS, st.booleans())
@settings(max_examples=30)
def test_small_forces_beside_large_ones_are_judged_by_themselves(power, good) -> None:
    """Of eight fingers four push 2^power times as hard, in a cross of their own."""
    strong, first = cross((0.75,) * 4)
    weak, second = cross((0.5 if good else nextafter(0.5, 0),) * 4, length=3.0, force=2.0**power)
    grasp = rg.Grasp([*strong, *(c.named(c.name.lower()) for c in weak)])
    assert set(all_verdicts(grasp, np.concatenate([first, second]))) == {good}


@given(st.sampled_from([20, 40, 60, 200, 400, 600, 900]), st.integers(0, 3), st.booleans())
@settings(max_examples=40)
def test_a_force_on_the_edge_of_a_huge_friction(power, finger, good) -> None:
    """Across 2^power times as hard as along the normal; with a bit less friction that is outside."""
    frictions = [2.0**power] * 4
    if not good:
        frictions[finger] = nextafter(2.0**power, 0)
    grasp, forces = cross(frictions, slope=2.0**power)
    assert set(all_verdicts(grasp, forces)) == {good}


@given(st.sampled_from([1, 10, 17, 30, 60, 300]), st.sampled_from([-1, 0, 1, 40, 400]), st.booleans())
@settings(max_examples=40)
def test_rounding_near_the_edge_of_a_large_friction_is_no_proof(mu, size, good) -> None:
    """A push of 1 + 2^-52 against the same across: a bit more, or a bit less, than mu times the push."""
    friction = 2.0**mu
    push = 1 + 2.0**-52
    grasp, forces = cross((friction,) * 4)
    across = nextafter(push * friction, 0 if good else inf)
    forces = np.sign(forces) * np.array([push, across]) * 2.0**size
    assert set(all_verdicts(grasp, forces)) == {good}


@given(POWERS, st.sampled_from([1, 1e5, 2.0**60]), st.booleans())
@settings(max_examples=40)
def test_soft_fingers_in_any_units(power, more, good) -> None:
    """Limit surfaces are met exactly: pushes of 5, across 3 mu, torques of 4 e; mu and e large, too."""
    friction, torsion = 0.5 * more, 0.25 * more
    less = friction if good else nextafter(friction, 0)
    grasp = rg.Grasp(
        rg.Contact([x, 0, 0], [-x, 0, 0], less, torsion=torsion, name=name)
        for x, name in ((-1, "A"), (1, "B"))
    )
    forces = np.array([[5, 3 * friction, 0, 4 * torsion], [-5, 3 * friction, 0, 4 * torsion]]) * 2.0**power
    assume(power > -900 and np.isfinite(forces * 8).all())
    load = rg.Wrench([0, -forces[0, 1] * 2, 0])
    assert set(all_verdicts(grasp, forces, load)) == {good}


@given(st.sampled_from([2.0**10, 2.0**30, 2.0**60]), st.booleans())
def test_torques_of_soft_fingers_are_no_scale_for_the_balance(torsion, good) -> None:
    """Torques of 2^60 about the normals cancel but for 3/2 of what the forces allow: out of balance."""
    grasp = rg.Grasp(
        rg.Contact([x, 0, 0], [-x, 0, 0], 0.5, torsion=torsion, name=name)
        for x, name in ((-1, "A"), (1, "B"))
    )
    grasp = rg.Grasp([*grasp, rg.Contact([0, 0, 0], [0, 1, 0], 0.5, name="C")])  # holds a load of 2^-20
    load = rg.Wrench([0, -(2.0**-20), 0], [(0.5 if good else 1.5) * 2.0**-40, 0, 0])
    forces = [[1, 0, 0, torsion / 4], [-1, 0, 0, torsion / 4], [0, 2.0**-20, 0, 0]]
    assert set(all_verdicts(grasp, forces, load)) == {good}
    grasp = rg.Grasp(c.changed(friction=1e5) for c in grasp)  # mu m / e is 25,000 times the push
    assert set(all_verdicts(grasp, forces, load)) == {good}


@pytest.mark.parametrize("count", [2, 10, 200])
def test_many_fingers_are_summed_within_the_bound(count) -> None:
    """Pairs that push 1 each, and a residual just inside and outside of 2^-40."""
    contacts = [
        rg.Contact([x, k / count], [-x, 0], 0.5, name=f"{x} {k}") for k in range(count) for x in (-1.0, 1.0)
    ]
    grasp = rg.Grasp([*contacts, rg.Contact([0, 0], [1, 0], 0.5)])  # the last holds a load of 2^-20
    forces = np.array([*([-x, 0.0] for _ in range(count) for x in (-1.0, 1.0)), [2.0**-20, 0]])
    for times, good in (1 - 1e-9, True), (1 + 1e-9, False):
        assert set(all_verdicts(grasp, forces, rg.Wrench([-(2.0**-20), times * 2.0**-40]))) == {good}


def test_nothing_is_settled_by_what_vanishes() -> None:
    """Forces of 1e-165, whose squares are 0, outside their cones; loads of 1e-200 that nothing holds."""
    grasp, forces = cross((0.25,) * 4, force=1e-165)
    assert set(all_verdicts(grasp, forces)) == {False}
    grasp, forces = cross()
    assert set(all_verdicts(grasp, 0 * forces, rg.Wrench([0, 0], 1e-200))) == {False}
    assert set(all_verdicts(grasp, 0 * forces, rg.Wrench([1e-200, 0]))) == {False}
    assert set(all_verdicts(grasp, 0 * forces)) == {True}


@pytest.mark.parametrize("size", [1e200, 1e160, 1.7e308, 1e-310, 5e-324])
def test_any_number_gets_a_verdict_in_words(size) -> None:
    for change in ({"force": size}, {"length": size}, {"frictions": (size,) * 4}):
        grasp, forces = cross(**change)
        for _, plan in places(grasp, forces):
            str(rg.verify(plan))
        pulling = -forces
        pulling[0] = forces[0]
        state = rg.GraspState(grasp, rg.Wrench([0, 0]), pulling)
        assert not rg.verify(Plan("rotation", None, state, state)).ok
    pair, load, forces = soft_pair()
    contacts = [rg.Contact(c.position, c.normal, size, torsion=size) for c in pair]
    state = rg.GraspState(rg.Grasp(contacts), load, forces)
    str(rg.verify(Plan("rotation", None, state, state)))


def test_roots_and_doubles_of_any_rational() -> None:
    from fractions import Fraction

    assert root(Fraction(4) ** 600) == 2.0**600
    assert root(Fraction(1, 4**520)) == 2.0**-520
    assert root(Fraction(9, 4) * Fraction(4) ** 700) == 1.5 * 2.0**700
    assert root(Fraction(4) ** 2000) == inf
    assert root(Fraction(0)) == 0
    assert root(Fraction(2)) == pytest.approx(2**0.5, rel=1e-15)
    assert [rounded(s * Fraction(4) ** 600) for s in (1, -1)] == [inf, -inf]
    assert rounded(Fraction(1, 4)) == 0.25


@pytest.mark.parametrize("size", [1e-6, 1e-3, 1.0, 1e6])
@pytest.mark.parametrize("share", [1e-13, 1e-11, 1e-3, 1.0])
@pytest.mark.parametrize("step", [1.0, -1.0, 3.0])
def test_a_torque_that_stays_is_judged_by_the_size_of_the_object(size, share, step) -> None:
    """Two pairs of fingers hold a force and a torque while the object turns; without middles, no state holds
    the torque between the angles, where both weights sum to more than 1."""
    grasp = rg.Grasp(
        rg.Contact([x * size, y * size], [-x, 0], 1e3, name=f"{x} {y}") for x in (-1, 1) for y in (-1, 1)
    )
    torque = share * size  # of a weight of 1
    states = []
    for angle in (0.0, step):
        load = rg.Wrench([0.0, -1.0], torque).rotated(-angle)
        forces = np.array([[10.0 * -np.sign(c.position[0]), 0.0] for c in grasp])
        forces -= load.force / 4
        for f, c in zip(forces, grasp, strict=True):  # a couple against the torque
            f += load.torque[0] / 8 / size**2 * np.array([c.position[1], -c.position[0]])
        states.append(rg.GraspState(grasp, load, forces))
    ends = [state.forces for state in states]
    plan = Plan("rotation", None, *states, turn=turn([0, step], ends))
    verdict = rg.verify(plan)
    assert all(rg.verify(Plan("rotation", None, s, s)).ok for s in states)
    assert verdict.ok == (share < 2.0**-40 / np.sqrt(2))
    assert verdict.ok or verdict.violations == (
        "a part of the load does not turn with the object, and no states between angles hold it",
    )


def test_instants_of_any_number_are_looked_at() -> None:
    """A block of set-points ends at 8192 rows: one bad row before, at and after that is found and named."""
    grasp, forces = cross((0.75,) * 4)
    state = rg.GraspState(grasp, rg.Wrench([0, 0]), forces)
    plan = Plan("rotation", None, state, state)
    for bad in (0, 8191, 8192, 8193, 16384, 20000):
        rows = np.broadcast_to(forces, (20001, 4, 2)).copy()
        rows[bad, 2, 1] *= 2
        found = verify_setpoints(plan, rows).violations
        assert {violation.split(":")[0] for violation in found} == {f"set-point {bad}"}
        times = np.linspace(0, 1, 20001)
        long = Plan("rotation", None, state, state, course=course(times, rows, [[0, 0, 0]] * 20001))
        found = rg.verify(long).violations
        assert any(v.startswith(f"instant {bad}: ") for v in found)


@pytest.mark.parametrize("length", [2.0**-20, 1.0, 2.0**20])
def test_forces_and_torques_of_a_load_are_sizes_of_their_own(length) -> None:
    """A load whose torque, or whose force, is a large number in these units hides nothing."""
    grasp, squeeze = cross((1e3,) * 4, length=length)
    squeeze[:, 1] = 0
    for force, torque in ((0.5, 0.0), (0.0, 0.5 * length), (0.5, 0.5 * length)):
        load = rg.Wrench([0, force], torque)
        forces = squeeze - [0, force / 4]
        couple = np.array([[c.position[1], -c.position[0]] for c in grasp]) / length
        forces = forces + torque / length / 8 * couple
        for off, good in (0.5 * 2.0**-40, True), (4 * 2.0**-40, False):
            assert set(all_verdicts(grasp, forces, rg.Wrench([off, force], torque))) == {good}
            assert set(all_verdicts(grasp, forces, rg.Wrench([0, force], torque + off * length))) == {good}
        assert load.dimension == 2


@pytest.mark.parametrize(("torque", "length"), [(2.0**60, 1.0), (2.0**20, 2.0**-30), (2.0**90, 2.0**30)])
def test_a_torque_that_rounding_loses(torque, length) -> None:
    """A and B twist against one another, so hard that what C adds is lost between them."""
    grasp = rg.Grasp(
        rg.Contact(np.array(place) * length, normal, 0.5, torsion=2 * torque, name=name)
        for name, place, normal in (
            ("A", (-1, -0.5, 0), (1, 0, 0)),
            ("C", (-1, 0.5, 0), (1, 0, 0)),
            ("B", (1, 0, 0), (-1, 0, 0)),
        )
    )
    for twist, good in (2.0**-42, True), (2.0**-36, False):
        forces = [[1, 0, 0, torque], [1, 0, 0, twist * length], [-2, 0, 0, torque]]
        assert set(all_verdicts(grasp, forces)) == {good}


def test_a_torque_whose_product_is_hardly_a_number() -> None:
    """mu m is 5/2 of the least double, and rounds to 2: of the friction 0.55 it uses 0.625, not 0.5."""
    least = 5e-324
    grasp = rg.Grasp(rg.Contact([x, 0, 0], [-x, 0, 0], 0.5, torsion=4 * least) for x in (-1, 1))
    for push, good in (1.1, False), (1.3, True):
        forces = [[push, 0, 0, 5 * least], [-push, 0, 0, 5 * least]]
        assert {rg.verify(plan).ok for _, plan in places(grasp, forces)} == {good}

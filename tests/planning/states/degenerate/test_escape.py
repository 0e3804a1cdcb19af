"""Why a grasp cannot hold: escape twists checked from their definition in the tests' own exact arithmetic."""

import re
from math import hypot, inf

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import regrasp as rg
from oracle import opposition, power
from regrasp.planning.states.escape import escape_twist
from strategies import Pair, held_pairs, held_triples, lattice_pair, random_pair

pytestmark = pytest.mark.laws


def proves(twist: rg.EscapeTwist) -> bool:
    """Forces in the cones, with limits, oppose less than the load drives; without, only beyond 1e9 loads."""
    driven = float(power(twist.twist, twist.load.vector))
    against = [
        opposition(twist.twist, c.position, c.normal, mu)
        for c, mu in zip(twist.grasp, twist.frictions, strict=True)
    ]
    bounded = sum(o * limit for o, limit in zip(against, twist.limits, strict=True) if limit < inf)
    unbounded = max((o for o, limit in zip(against, twist.limits, strict=True) if limit == inf), default=0.0)
    left = driven - bounded * (1 + 1e-14)
    load = hypot(*twist.load.force) + abs(float(twist.load.torque[0])) / twist.grasp.size
    return left > 0 and left > 1e9 * load * unbounded


def refused(grasp: rg.Grasp, load: rg.Wrench, **options: object) -> rg.Infeasible:
    with pytest.raises(rg.Infeasible) as error:
        rg.choose_state(grasp, load, "peak", **options)
    return error.value


def clearly_empty(pair: Pair) -> bool:
    """Empty still when both cones are a thousandth wider: not a matter of rounding."""
    wider = rg.Grasp(
        rg.Contact(r, n, mu * 1.001 + 1e-3)
        for r, n, mu in ((pair.r1, pair.n1, pair.mu1), (pair.r2, pair.n2, pair.mu2))
    )
    return rg.EquilibriumLocus(wider, pair.load).is_empty


@pytest.mark.parametrize("source", [random_pair, lattice_pair])
def test_two_fingers_that_cannot_hold(source) -> None:
    rng = np.random.default_rng(1)
    proven = 0
    while proven < 300:
        pair = source(rng)
        if not clearly_empty(pair):
            continue
        length, force = 10.0 ** rng.integers(-6, 7, 2)
        pair = pair.scaled(float(length), float(force))
        error = refused(pair.grasp, pair.load)
        assert isinstance(error.certificate, rg.EscapeTwist), (pair, str(error))
        assert error.certificate.is_proof
        assert proves(error.certificate), (pair, error.certificate)
        assert str(error.certificate) in str(error)
        proven += 1


def test_three_fingers_that_cannot_hold() -> None:
    """All three push to one side of the load."""
    rng = np.random.default_rng(2)
    for _ in range(60):
        angles = rng.uniform(-0.8, 0.8, 3)
        grasp = rg.Grasp(
            rg.Contact(rng.normal(size=2), [np.sin(a), np.cos(a)], rng.uniform(0.1, 0.5)) for a in angles
        )
        error = refused(grasp, rg.Wrench([rng.normal(), 1.0], rng.normal()))
        assert error.certificate.is_proof
        assert proves(error.certificate)


def test_a_removal_that_drops_the_object_says_how() -> None:
    grasp = rg.Grasp(
        [
            rg.Contact([-4, -4], [1, 1], 0.3, name="P1"),
            rg.Contact([4, -5], [-1, 2], 0.3, name="P2"),
            rg.Contact([0, 8], [0, -1], 0.3, name="P3"),
        ]
    )
    with pytest.raises(rg.Infeasible, match=r"P2, P3 inside their friction cones .* escapes by") as error:
        rg.plan_removal(grasp, "P1", load=rg.Wrench([-1.5, -3.5]))
    assert error.value.certificate.grasp.names == ("P2", "P3")
    assert proves(error.value.certificate)


# -- words ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("reach", "way"), [(1.5, "clockwise"), (-1.5, "counter-clockwise")])
def test_a_table_tips_over_its_edge(reach: float, way: str) -> None:
    """Two supports at x = -1 and 1; the weight beyond one of them turns the table about a point above it."""
    table = rg.Grasp([rg.Contact([-1, 0], [0, 1], 0.3), rg.Contact([1, 0], [0, 1], 0.3)])
    twist = refused(table, rg.Wrench([0, -1], -reach)).certificate
    assert str(twist).startswith(f"turning {way} about (")
    centre = np.array([float(x) for x in re.findall(r"-?\d[\d.e-]*", str(twist))])
    assert centre == pytest.approx(twist.centre, rel=1e-5)
    assert np.sign(centre[0]) == np.sign(reach)
    assert 0 < abs(centre[0]) < abs(reach)  # neither beyond the weight nor on the other side
    v, omega = twist.twist[:2], twist.twist[2]
    assert v + omega * np.array([-centre[1], centre[0]]) == pytest.approx(0, abs=1e-5)  # the centre rests
    assert "e-" not in str(twist)  # a height of 1e-16 is rounding, not news
    supports = twist.velocities[:, 1]
    assert (supports >= 0).all()  # no support is pressed into


def test_an_object_slides_where_nothing_turns_it() -> None:
    twist = refused(
        rg.Grasp([rg.Contact([-1, 0], [0, 1], 0.2), rg.Contact([1, 0], [0, 1], 0.2)]), rg.Wrench([1, -1])
    ).certificate
    lifted = rg.EscapeTwist(twist.grasp, twist.load, [1.0, 0.2, 0.0], twist.frictions, twist.limits)
    assert str(lifted) == "sliding along (0.980581, 0.196116)"
    assert lifted.centre is None
    assert lifted.is_proof  # pulled sideways by as much as its weight, friction 0.2: slides, rising a little
    assert proves(lifted)


# -- force limits and reserve ----------------------------------------------------------------------------


def test_force_limits_that_are_too_low() -> None:
    rng = np.random.default_rng(3)
    proven = 0
    for _ in range(300):
        pair = random_pair(rng)
        if rg.EquilibriumLocus(pair.grasp, pair.load).is_empty or min(pair.mu1, pair.mu2) < 1e-3:
            continue
        if not pair.load.vector.any():
            continue
        least = rg.choose_state(pair.grasp, pair.load, "peak", reserve=0.0).value
        error = refused(pair.grasp, pair.load, max_force=0.98 * least)
        assert error.certificate is not None, pair
        assert error.certificate.limits == pytest.approx((0.98 * least, 0.98 * least))
        assert proves(error.certificate)
        assert "force limits" in str(error)
        assert "the cones alone would hold it with larger forces" in str(error)
        rg.choose_state(pair.grasp, pair.load, "peak", max_force=1.02 * least)
        proven += 1
    assert proven > 40


def test_one_finger_limited_the_other_not() -> None:
    grasp = rg.Grasp(
        [rg.Contact([-1, 0], [1, 0], 0.5, max_force=1.0), rg.Contact([1, 0], [-1, 0], 0.5, name="free")]
    )
    error = refused(grasp, rg.Wrench([0, -2]))
    assert error.certificate.limits == pytest.approx((1.0, inf))
    assert proves(error.certificate)


def test_a_reserve_that_is_too_large() -> None:
    """Weight 1.9 on two fingers of friction 0.5 that push 2 at most: 95 % of the friction is needed."""
    grasp = rg.Grasp([rg.Contact([-1, 0], [1, 0], 0.5), rg.Contact([1, 0], [-1, 0], 0.5)])
    load = rg.Wrench([0, -1.9])
    limit = hypot(2.0, 0.95)
    assert rg.choose_state(grasp, load, "peak", max_force=limit, reserve=0.04).value <= limit
    error = refused(grasp, load, max_force=limit, reserve=0.1)
    assert error.certificate is None
    assert "with 0.1 of the friction kept in reserve" in str(error)


# -- nothing false ---------------------------------------------------------------------------------------


@given(held_pairs())
@settings(max_examples=150)
def test_a_pair_that_holds_has_no_escape(pair: Pair) -> None:
    frictions = [pair.mu1, pair.mu2]
    assert escape_twist(pair.grasp, pair.load, frictions, [inf, inf]) is None
    largest = 4.0 * hypot(1, max(frictions)) * 1.01
    assert escape_twist(pair.grasp, pair.load, frictions, [largest, largest]) is None


@given(held_triples())
@settings(max_examples=60)
def test_a_triple_that_holds_has_no_escape(held: tuple[rg.Grasp, rg.Wrench]) -> None:
    grasp, load = held
    assert escape_twist(grasp, load, grasp.frictions.tolist(), [inf] * 3) is None


@given(held_pairs(), st.tuples(*[st.floats(-1, 1)] * 3).filter(any))
@settings(max_examples=200)
def test_no_motion_is_a_proof_against_a_pair_that_holds(pair: Pair, motion: tuple[float, ...]) -> None:
    twist = rg.EscapeTwist(pair.grasp, pair.load, motion, (pair.mu1, pair.mu2), (inf, inf))
    assert not twist.is_proof


@given(st.integers(0, 10**6))
@settings(max_examples=100)
def test_oppositions_are_upper_bounds_from_the_definition(seed: int) -> None:
    rng = np.random.default_rng(seed)
    pair = random_pair(rng)
    twist = rg.EscapeTwist(pair.grasp, pair.load, rng.normal(size=3), (pair.mu1, pair.mu2), (inf, inf))
    for i, contact in enumerate(pair.grasp):
        exact = opposition(twist.twist, contact.position, contact.normal, contact.friction)
        assert twist.oppositions[i] == pytest.approx(exact, rel=1e-9, abs=1e-12)
        directions = np.linspace(-contact.half_angle, contact.half_angle, 201)
        n = contact.normal
        forces = np.cos(directions)[:, None] * n + np.sin(directions)[:, None] * [-n[1], n[0]]
        sampled = -(forces @ twist.velocities[i]).min()
        assert twist.oppositions[i] >= sampled - 1e-12


def test_a_motion_the_fingers_oppose_is_no_proof() -> None:
    rng = np.random.default_rng(5)
    for _ in range(50):
        pair = random_pair(rng)
        if clearly_empty(pair):
            twist = refused(pair.grasp, pair.load).certificate
            back = rg.EscapeTwist(twist.grasp, twist.load, -twist.twist, twist.frictions, twist.limits)
            assert not back.is_proof
            assert not proves(back)
            assert back.load_power == -twist.load_power < 0


def test_a_motion_that_no_friction_stops_is_said_to_be_one() -> None:
    """Tipping about a foot, however rough it is; sliding needs friction."""
    feet = rg.Grasp(rg.Contact([x, -1], [0, 1], 0.5) for x in (-1, 1))
    for r in (1e-2, 1e-4, 1e-6):
        with pytest.raises(rg.Infeasible, match=r"turning clockwise about \(1, -1\); no friction helps$"):
            rg.choose_state(feet, rg.Wrench([0, -1], -(1 + r)))
    with pytest.raises(rg.Infeasible, match="sliding along") as slides:
        rg.choose_state(feet, rg.Wrench([0.6, -1]))
    assert "no friction" not in str(slides.value)

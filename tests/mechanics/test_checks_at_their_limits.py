"""Checks of balance and escapes at their limits, on both sides."""

from math import hypot, inf, sqrt

import numpy as np
import pytest

import regrasp as rg
from regrasp.mechanics.exact.refining import proven

pytestmark = pytest.mark.contract

FACING = rg.Grasp([rg.Contact([-1, 0], [1, 0], 0.0), rg.Contact([1, 0], [-1, 0], 0.0)])


@pytest.mark.parametrize("pull", [1e-12, 1.0, 1e6])
def test_frictionless_fingers_that_pull_are_let_go(pull: float) -> None:
    """Along the normal of a ray nothing is tangential: the sign alone says that it pulls."""
    state = rg.GraspState(FACING, rg.Wrench([0, 0]), [[-pull, 0], [pull, 0]])
    assert not state.is_balanced()
    assert not state.balanced().forces.any()
    pushed = rg.GraspState(FACING, rg.Wrench([0, 0]), [[pull, 0], [-pull, 0]])
    assert pushed.balanced() is pushed
    held = rg.GraspState(FACING, rg.Wrench([pull, 0]), [[-pull, 0], [0, 0]]).balanced()
    assert held.forces[0, 0] >= 0
    assert held.forces[1, 0] == pytest.approx(-pull)


def test_the_least_force_is_that_of_the_finger_that_opposes_best() -> None:
    """A push of 1 N up against two fingers from above: the sum of their forces must be 1 N, not each."""
    grasp = rg.Grasp([rg.Contact([-1, 0], [0, -1], 0.0), rg.Contact([1, 0], [0, -1], 0.0)])
    twist = rg.EscapeTwist(grasp, rg.Wrench([0, 1]), [0, 1, 0], (0.0, 0.0), (inf, inf))
    assert twist.oppositions == pytest.approx((1, 1))
    assert twist.least_force == pytest.approx(1)
    leaning = rg.EscapeTwist(grasp, rg.Wrench([0, 1]), [0, 1, 0.5], (0.0, 0.0), (inf, inf))
    assert leaning.oppositions == pytest.approx((0.5, 1.5))
    assert leaning.least_force == pytest.approx(1 / 1.5)
    limited = rg.EscapeTwist(grasp, rg.Wrench([0, 1]), [0, 1, 0], (0.0, 0.0), (0.25, inf))
    assert limited.least_force == pytest.approx(0.75)
    for limits, is_proof in (((0.5, 0.5), False), ((0.5, 0.4999999), True), ((0.3, 0.8), False)):
        assert rg.EscapeTwist(grasp, rg.Wrench([0, 1]), [0, 1, 0], (0.0, 0.0), limits).is_proof == is_proof


@pytest.mark.parametrize("short", [1e-10, 1e-8, 1e-6])
def test_a_motion_that_is_nearly_a_proof_becomes_one(short: float) -> None:
    """A table pulled aside by more than its friction: it slides, rising along the edges of both cones."""
    table = rg.Grasp([rg.Contact([-0.3, -1.7], [0, 1], 0.3), rg.Contact([0.9, -1.7], [0, 1], 0.3)])
    load = rg.Wrench([0.31, -1], 1.7 * 0.31)  # along the table
    rough = np.array([1.0, 0.3 - short, 0.0])
    frictions, limits = [0.3, 0.3], [inf, inf]
    assert not rg.EscapeTwist(table, load, rough, (0.3, 0.3), (inf, inf)).is_proof
    twist = proven(table, load, rough, frictions, limits)
    assert twist is not None
    assert twist.oppositions == (0.0, 0.0)
    assert twist.least_force == inf
    assert abs(twist.twist / twist.twist[0] - rough).max() <= 2 * short + 1e-14


def test_a_motion_that_the_fingers_oppose_is_not_made_a_proof() -> None:
    rng = np.random.default_rng(1)
    squeezed = rg.Grasp([rg.Contact([-1, 0], [1, 0], 0.5), rg.Contact([1, 0], [-1, 0], 0.5)])
    for _ in range(100):
        load = rg.Wrench(rng.normal(size=2), rng.normal())
        assert proven(squeezed, load, rng.normal(size=3), [0.5, 0.5], [inf, inf]) is None


def test_a_small_lever_is_no_rounding() -> None:
    """Fingers 1e-9 apart hold a moment of 1e-9 with forces of order one: not rounding."""
    pair = rg.Grasp([rg.Contact([0, 1], [1, 0], 0.5), rg.Contact([1e-9, 1], [-1, 0], 0.5)])
    load = rg.Wrench([0, 0], 1e-9)
    state = rg.choose_state(pair, load, "peak")
    assert state.value == pytest.approx(hypot(1, 2), rel=1e-6)
    assert proven(pair, load, np.array([1.0, 0.0, 1.0]), [0.5, 0.5], [inf, inf]) is None


def test_an_escape_of_still_contacts_is_exact() -> None:
    """Turning about a contact whose coordinates are no short numbers: it stands still to the last bit."""
    rng = np.random.default_rng(3)
    for _ in range(20):
        x, y, reach = rng.normal(), rng.normal(), rng.uniform(0.5, 2)
        grasp = rg.Grasp([rg.Contact([x, y], [0, 1], 0.5), rg.Contact([x - reach, y], [0, 1], 0.5)])
        load = rg.Wrench([0, -1], -(x + 1e-7))
        with pytest.raises(rg.Infeasible, match="turning clockwise") as error:
            rg.choose_state(grasp, load, "effort")
        assert error.value.certificate.least_force > 1e9
        assert error.value.certificate.centre == pytest.approx([x, y], abs=1e-6)


def test_facets_are_kept_for_a_planar_pair() -> None:
    """A square in the place of the circle |f| <= t: (1, 1/2) needs a larger one than the circle."""
    pair = rg.Grasp([rg.Contact([-1, 0], [1, 0], 0.5), rg.Contact([1, 0], [-1, 0], 0.5)])
    load = rg.Wrench([0, -1])
    exact = rg.choose_state(pair, load, "peak")
    assert exact.method == "closed-form"
    square = rg.choose_state(pair, load, "peak", facets=4, max_force=1.5)
    assert square.method == "clarabel"
    with pytest.raises(
        rg.Infeasible
    ):  # sqrt(1.25) = 1.118 is enough for the circle, not for the square in it
        rg.choose_state(pair, load, "peak", facets=4, max_force=1.2)
    assert rg.choose_state(pair, load, "peak", max_force=1.2).value == pytest.approx(sqrt(1.25))

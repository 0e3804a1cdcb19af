"""Angle margin, distance to the cone and friction use are what they say, in the plane and in space."""

from math import atan, atan2, cos, hypot, inf, pi, sin, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import regrasp as rg
from regrasp.mechanics.margins import largest_use, least_angle, margins
from strategies import POWERS

pytestmark = pytest.mark.laws

COMPONENTS = st.floats(-5, 5).map(lambda x: round(x, 3) + 0.0)
FRICTIONS = st.one_of(st.just(0.0), st.floats(0.01, 3).map(lambda x: round(x, 3)))


@st.composite
def contacts(draw, dimensions=(2, 3)) -> tuple[np.ndarray, np.ndarray, float]:
    """(force, unit normal, friction), the force neither zero nor rounding."""
    d = draw(st.sampled_from(dimensions))
    vector = st.lists(COMPONENTS, min_size=d, max_size=d).map(np.array)
    f = draw(vector.filter(lambda v: np.linalg.norm(v) > 1e-2))
    n = draw(vector.filter(lambda v: np.linalg.norm(v) > 1e-1))
    return f, n / np.linalg.norm(n), draw(FRICTIONS)


def one(f: np.ndarray, n: np.ndarray, mu: float) -> tuple[float, float, float]:
    """(angle, force, friction_use) of one force."""
    m = margins(np.array([f]), np.array([n]), np.array([mu]))
    return float(m.angle[0]), float(m.force[0]), float(m.friction_use[0])


def distance_to_cone_boundary(f: np.ndarray, n: np.ndarray, mu: float, samples: int = 20_001) -> float:
    """Distance to the nearest of many points of the boundary, negative outside; for d = 3 in f's half-plane.

    The cone is round about n, so the nearest boundary point lies in the plane of f and n.
    """
    along = float(f @ n)
    across = float(np.linalg.norm(f - along * n))
    edge = np.array([1, mu]) / hypot(1, mu)
    reach = 1.001 * float(np.linalg.norm(f))
    points = np.linspace(0, reach, samples)[:, None] * edge
    mirrored = points * [1, -1]
    all_points = np.concatenate([points, mirrored])
    nearest = float(np.hypot(*(all_points - [along, across]).T).min())
    return nearest if along >= 0 and across <= mu * along else -nearest


# -- worked by hand ---------------------------------------------------------------------------------------

BY_HAND = [
    # f, n, mu, angle, force, friction_use
    ([3, 0], [1, 0], 0.75, atan(0.75), 3 * 0.6, 0.0),  # along the normal
    ([4, 3], [1, 0], 0.75, 0.0, 0.0, 1.0),  # on the edge
    ([4, -3], [1, 0], 0.75, 0.0, 0.0, 1.0),  # on the other
    ([4, 1], [1, 0], 0.75, atan(0.75) - atan(0.25), (0.75 * 4 - 1) * 0.8, 1 / 3),
    ([1, 1], [1, 0], 0.75, atan(0.75) - pi / 4, -0.25 * 0.8, 4 / 3),  # outside
    ([0, 2], [1, 0], 0.75, atan(0.75) - pi / 2, -2 * 0.8, inf),  # along the surface
    ([-1, 0], [1, 0], 0.75, atan(0.75) - pi, -1.0, inf),  # pulls: the apex is nearest
    ([-4, 3], [1, 0], 0.75, atan(0.75) - (pi - atan(0.75)), -5.0, inf),  # the apex just so
    ([0, -2], [0, -1], 0.0, 0.0, 0.0, np.nan),  # frictionless, pushed along its normal
    ([1, -2], [0, -1], 0.0, -atan(0.5), -1.0, inf),  # frictionless, pushed askew
    ([0, 2], [0, -1], 0.0, -pi, -2.0, inf),  # frictionless, pulled
    ([0, 0, 5], [0, 0, 1], 1.0, pi / 4, 5 / sqrt(2), 0.0),  # in space
    ([3, 4, 10], [0, 0, 1], 1.0, pi / 4 - atan(0.5), 5 / sqrt(2), 0.5),
    ([3, -4, 5], [0, 0, 1], 1.0, 0.0, 0.0, 1.0),
    ([0, 0, -5], [0, 0, 1], 1.0, pi / 4 - pi, -5.0, inf),
]


@pytest.mark.parametrize("case", BY_HAND, ids=[f"{c[0]} in {c[1]}, {c[2]}" for c in BY_HAND])
def test_by_hand(case: tuple) -> None:
    f, n, mu, *want = case
    assert one(np.array(f, float), np.array(n, float), mu) == pytest.approx(want, abs=1e-15, nan_ok=True)


def test_a_state_has_the_margins_of_its_contacts() -> None:
    grasp = rg.Grasp([rg.Contact([0, 0], [2, 0], 0.75), rg.Contact([1, 0], [0, -3], 0.5)])
    state = rg.GraspState(grasp, rg.Wrench([0, 0]), [[4, 1], [1, -4]])
    assert state.margins.angle == pytest.approx(
        [atan(0.75) - atan(0.25), atan(0.5) - atan(0.25)], rel=1e-14, abs=0
    )
    assert state.margins.force == pytest.approx([1.6, 1 / sqrt(1.25)], rel=1e-14, abs=0)
    assert state.margins.friction_use == pytest.approx([1 / 3, 0.5], rel=1e-14, abs=0)
    assert state.margins.least_angle == pytest.approx(atan(0.5) - atan(0.25), rel=1e-14, abs=0)
    assert state.margins.least_force == pytest.approx(1 / sqrt(1.25), rel=1e-14, abs=0)
    assert state.margins.largest_friction_use == pytest.approx(0.5, rel=1e-14, abs=0)


# -- contacts without force -------------------------------------------------------------------------------


def state_of(*forces: list[float]) -> rg.GraspState:
    grasp = rg.Grasp(rg.Contact([i, 0], [1, 0], 0.75) for i in range(len(forces)))
    return rg.GraspState(grasp, rg.Wrench([0, 0]), forces)


def test_a_contact_without_force_is_left_out() -> None:
    found = state_of([4, 1], [0, 0], [4, -2]).margins
    np.testing.assert_array_equal(np.isnan(found.angle), [False, True, False])
    np.testing.assert_array_equal(np.isnan(found.friction_use), [False, True, False])
    assert found.force[1] == 0
    assert found.least_angle == pytest.approx(atan(0.75) - atan(0.5))
    assert found.least_force == pytest.approx((3 - 2) * 0.8)  # not the idle contact's 0
    assert found.largest_friction_use == pytest.approx(2 / 3)


def test_rounding_is_no_force_and_a_small_force_is_one() -> None:
    """A force below 2^-40 of the largest is idle, though here it points out of its cone."""
    found = state_of([4, 1], [-(2.0**-39), 0]).margins  # below 2^-40 |(4, 1)| = 2^-40 * 4.12
    assert np.isnan([found.angle[1], found.friction_use[1]]).all()
    assert found.force[1] == 0
    assert found.least_angle > 0
    assert found.largest_friction_use == pytest.approx(1 / 3)
    found = state_of([4, 1], [-(2.0**-37), 0]).margins
    assert found.least_angle == pytest.approx(atan(0.75) - pi)


def test_no_force_at_all_has_no_margin() -> None:
    found = state_of([0, 0], [0, 0]).margins
    assert np.isnan([found.least_angle, found.least_force, found.largest_friction_use]).all()
    np.testing.assert_array_equal(found.force, 0)


def test_frictionless_contacts_in_use_count() -> None:
    grasp = rg.Grasp([rg.Contact([0, 0], [1, 0], 0.0), rg.Contact([1, 0], [1, 0], 0.75)])
    found = rg.GraspState(grasp, rg.Wrench([0, 0]), [[2, 0], [4, 1]]).margins
    assert found.least_angle == 0
    assert found.least_force == 0
    assert found.largest_friction_use == pytest.approx(1 / 3)  # undefined for the frictionless one


def test_margins_at_many_instants() -> None:
    forces = np.array([[[4, 1], [0, 0]], [[4, 3], [1, 0]], [[1, 0], [2, 1]]], float)
    normals, frictions = np.array([[1.0, 0], [1, 0]]), np.array([0.75, 0.75])
    many = margins(forces, normals, frictions)
    assert many.angle.shape == many.force.shape == many.friction_use.shape == (3, 2)
    for i, f in enumerate(forces):
        each = margins(f, normals, frictions)
        for field in ("angle", "force", "friction_use"):
            np.testing.assert_array_equal(getattr(many, field)[i], getattr(each, field))
    assert many.least_angle == pytest.approx(0, abs=1e-15)  # over instants and contacts


# -- laws -------------------------------------------------------------------------------------------------


@given(contacts())
def test_angle_by_half_chords(contact: tuple) -> None:
    """Kahan's angle between unit vectors, 2 atan(|a - b| / |a + b|), and friction use as its tangent."""
    f, n, mu = contact
    unit = f / np.linalg.norm(f)
    between = 2 * atan2(float(np.linalg.norm(unit - n)), float(np.linalg.norm(unit + n)))
    angle, _, use = one(f, n, mu)
    assert angle == pytest.approx(atan(mu) - between, abs=1e-13)
    if mu > 0 and between < pi / 2 - 1e-3:
        assert use == pytest.approx(np.tan(between) / mu, rel=1e-9, abs=1e-12)
    if between > pi / 2 + 1e-9:
        assert use == inf


@given(contacts())
@settings(max_examples=60)
def test_force_margin_is_the_distance_to_the_boundary(contact: tuple) -> None:
    f, n, mu = contact
    found, brute = one(f, n, mu)[1], distance_to_cone_boundary(f, n, mu)
    # Samples 5e-5 |f| apart: the nearest is farther than the boundary by at most their half.
    step = float(np.linalg.norm(f)) * 1.001 / 20_000
    assert abs(brute) - step <= abs(found) <= abs(brute) + 1e-12
    assert found * brute >= -(step**2)


@given(contacts(dimensions=(3,)))
@settings(max_examples=30)
def test_force_margin_in_space_against_the_whole_cone(contact: tuple) -> None:
    """Rays all around the cone, the nearest point of each in closed form."""
    f, n, mu = contact
    first = np.cross(n, [1, 0, 0] if abs(n[0]) < 0.7 else [0, 1, 0])
    first /= np.linalg.norm(first)
    turn = np.linspace(0, 2 * pi, 4001)[:, None]
    rays = (n + mu * (np.cos(turn) * first + np.sin(turn) * np.cross(n, first))) / hypot(1, mu)
    nearest = np.maximum(rays @ f, 0)[:, None] * rays
    brute = float(np.linalg.norm(nearest - f, axis=1).min())
    found, size = one(f, n, mu)[1], float(np.linalg.norm(f))
    # A ray turned by delta from the nearest one is farther by at most this, in squares.
    assert found**2 - 1e-12 * size**2 <= brute**2 <= found**2 + (size * pi / 4000) ** 2


@given(contacts())
def test_signs_agree(contact: tuple) -> None:
    """Inside, on or outside is one fact, whichever margin tells it."""
    f, n, mu = contact
    angle, force, use = one(f, n, mu)
    if mu == 0 or abs(angle) < 1e-12:
        return
    assert (angle > 0) == (force > 0) == (use < 1)


@given(contacts(), POWERS)
def test_force_unit(contact: tuple, unit: float) -> None:
    f, n, mu = contact
    angle, force, use = one(f, n, mu)
    scaled = one(unit * f, n, mu)
    assert scaled[0] == pytest.approx(angle, abs=1e-14)
    assert scaled[1] == pytest.approx(unit * force, rel=1e-9, abs=1e-13 * unit)
    if mu > 0:  # without friction it is undefined or infinite, by rounding
        assert scaled[2] == pytest.approx(use, rel=1e-9, abs=1e-13)


@given(contacts(dimensions=(2,)), st.floats(-pi, pi))
def test_rotation_in_the_plane(contact: tuple, angle: float) -> None:
    f, n, mu = contact
    turn = np.array([[cos(angle), -sin(angle)], [sin(angle), cos(angle)]])
    compare_turned(f, n, mu, turn)


@given(contacts(dimensions=(3,)), st.lists(st.floats(-1, 1), min_size=4, max_size=4))
def test_rotation_in_space(contact: tuple, quaternion: list[float]) -> None:
    q = np.array(quaternion)
    if np.linalg.norm(q) < 0.1:
        q = np.array([1.0, 2.0, -3.0, 0.5])
    w, x, y, z = q / np.linalg.norm(q)
    turn = np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])  # fmt: skip
    compare_turned(*contact, turn)


def compare_turned(f: np.ndarray, n: np.ndarray, mu: float, turn: np.ndarray) -> None:
    angle, force, use = one(f, n, mu)
    found = one(turn @ f, turn @ n, mu)
    assert found[0] == pytest.approx(angle, abs=1e-13)
    assert found[1] == pytest.approx(force, abs=1e-13 * 10)
    if mu > 0 and abs(f @ n) > 1e-6:  # along the surface the use is as near to infinite as rounding lets it
        assert found[2] == pytest.approx(use, rel=1e-8, abs=1e-12)


@given(contacts(dimensions=(2,)))
def test_the_plane_is_a_section_of_space(contact: tuple) -> None:
    f, n, mu = contact
    in_space = one(np.array([*f, 0]), np.array([*n, 0]), mu)
    assert in_space == pytest.approx(one(f, n, mu), rel=1e-12, abs=1e-14, nan_ok=True)


@pytest.mark.parametrize("size", [0.25, 1.0, 10.0, 1e-6])
def test_friction_use_without_friction_does_not_hang_on_rounding(size: float) -> None:
    """A force along the normal, to rounding, uses nothing of nothing; any other force is infinitely much."""
    normal = np.array([2.0, 3.0]) / hypot(2, 3)
    along, off = size * np.array([0.5, 0.75]), size * np.array([0.5, 0.76])
    unit = normal[None]
    assert np.isnan(margins(along[None], unit, np.zeros(1)).friction_use).all()
    assert np.isinf(margins(off[None], unit, np.zeros(1)).friction_use).all()


def test_values_hand_out_arrays_that_cannot_be_written() -> None:
    grasp = rg.Grasp([rg.Contact([-1, 0], [1, 0], 0.5), rg.Contact([1, 0], [-1, 0], 0.5)])
    state = rg.GraspState(grasp, rg.Wrench([0, -1]), [[2, 0.5], [-2, 0.5]])
    kept = [state.forces, state.wrenches, state.imbalance, state.load.vector, state.load.force]
    kept += [state.margins.angle, state.margins.force, state.margins.friction_use]
    kept += [grasp.matrix, grasp.positions, grasp.internal_forces, grasp[0].normal]
    for array in kept:
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0


@pytest.mark.parametrize("width", [2, 3, 4])
def test_the_least_margin_and_largest_use_alone_are_those_of_all(width):
    rng = np.random.default_rng(width)
    for k in range(200):
        n = int(rng.integers(1, 20))  # few contacts and many are worked out differently
        normals = rng.normal(size=(n, width))
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        forces = (normals * rng.uniform(-0.2, 2, (n, 1)) + 0.3 * rng.normal(size=(n, width))) * (k % 7 > 0)
        forces *= (rng.random((n, 1)) < 0.8) * 10.0 ** rng.integers(-9, 9)
        forces[k % n] = normals[k % n] * (k % 3)
        frictions = rng.uniform(0, 1, n) * (rng.random(n) < 0.7)
        of_all = margins(forces, normals, frictions)
        expected = of_all.least_angle, of_all.largest_friction_use
        found = least_angle(forces, normals, frictions), largest_use(forces, normals, frictions)
        assert found == pytest.approx(expected, rel=1e-12, abs=1e-14, nan_ok=True)

"""The sets of Section III: wrench planes and cones, iso-torque lines, segments."""

from math import hypot, inf, nan

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import regrasp as rg
from cones import in_cone, wrench
from regrasp.mechanics.wrench_space import IsoTorqueLine, WrenchCone, WrenchLoop, WrenchPlane, iso_torque_line
from strategies import coordinates, directions, frictions, points

pytestmark = pytest.mark.laws

PAPER = rg.Grasp(
    [
        rg.Contact([-4, -4], [1, 1], 0.3, name="P1"),
        rg.Contact([4, -5], [-1, 2], 0.3, name="P2"),
        rg.Contact([0, 8], [0, -1], 0.3, name="P3"),
    ]
)
LOAD = rg.Wrench([-1.5, -3.5])
STATE = rg.GraspState(PAPER, LOAD, [[3.7897, 3.0034], [-3.0096, 4.4156], [0.7199, -3.9190]]).balanced()
SPACE = rg.Contact([1, 0, 0], [-1, 0, 0], 0.5)
contacts = st.builds(rg.Contact, points, directions, frictions)
shares = st.floats(-0.99, 0.99)


@given(contacts, points, coordinates)
def test_a_wrench_plane_holds_the_wrenches_of_forces_and_no_others(
    contact: rg.Contact, force: tuple[float, float], off: float
) -> None:
    plane = WrenchPlane(contact)
    w = plane.wrench(force)
    np.testing.assert_array_equal(w, wrench(contact, np.array(force)))
    size = hypot(*force) * (1 + hypot(*contact.position))
    assert plane.normal @ w == pytest.approx(0, abs=1e-15 * size)
    assert plane.normal @ (w + np.array([0, 0, off])) == pytest.approx(off, abs=1e-15 * (size + abs(off)))


def test_wrenches_of_many_forces_at_once() -> None:
    plane = WrenchPlane(PAPER["P2"])
    forces = np.arange(12.0).reshape(2, 3, 2)
    assert plane.wrench(forces).shape == (2, 3, 3)
    np.testing.assert_array_equal(plane.wrench(forces)[1, 2], wrench(PAPER["P2"], forces[1, 2]))


@given(contacts, shares, st.floats(0.01, 100), st.sampled_from([1, -1]))
def test_a_wrench_cone_holds_the_forces_of_the_friction_cone(
    contact: rg.Contact, share: float, size: float, sign: int
) -> None:
    cone = WrenchCone(contact, np.array([1.0, -2.0, 3.0]), sign)
    inside, beyond = (wrench(contact, in_cone(contact, s, size)) for s in (share, 1.01 * np.sign(share or 1)))
    assert cone.contains(cone.apex + sign * inside)
    assert cone.contains(cone.apex)
    assert not cone.contains(cone.apex - sign * inside)
    if contact.friction > 1e-6:
        assert not cone.contains(cone.apex + sign * beyond)
    off_plane = np.array([0, 0, 0.01 * size * (1 + hypot(*contact.position))])
    assert not cone.contains(cone.apex + sign * inside + off_plane)
    # The inverse is the same set turned about its apex, and turned twice it is the set again.
    assert cone.inverse().contains(cone.apex - sign * inside)
    assert not cone.inverse().contains(cone.apex + sign * inside)
    assert cone.inverse().inverse() == cone
    assert cone.moved([7, 8, 9]).contains(np.array([7, 8, 9]) + sign * inside)


@given(contacts, st.sampled_from([1, -1]))
def test_edges_lie_on_the_boundary(contact: rg.Contact, sign: int) -> None:
    cone = WrenchCone(contact, sign=sign)
    edges = cone.edges
    np.testing.assert_allclose(np.hypot(*edges[:, :2].T), 1, rtol=1e-15)
    normal, tangent = contact.normal, np.array([-contact.normal[1], contact.normal[0]])
    for edge, side in zip(edges, (-1, 1), strict=True):
        assert cone.contains(edge)
        f = sign * edge[:2]
        assert f @ tangent == pytest.approx(side * contact.friction * (f @ normal), abs=1e-15)
        beyond = edge[:2] + 1e-3 * sign * side * tangent
        assert not cone.contains(wrench(contact, beyond))
        assert edge[2] == pytest.approx(wrench(contact, edge[:2])[2], abs=1e-15)


def test_cones_compare_by_value_and_start_at_the_origin() -> None:
    contact = PAPER["P1"]
    assert WrenchCone(contact) == WrenchCone(contact, [0, 0, 0], 1)
    assert WrenchCone(contact) != WrenchCone(contact).inverse()
    np.testing.assert_array_equal(WrenchCone(contact).apex, 0)


def test_iso_torque_line_by_hand() -> None:
    """r = (3, 4), f = (0, 5): tau = 15 = 5 d; the line lies 3 to the left of r."""
    line = iso_torque_line(rg.Contact([3, 4], [0, 1], 1.0), [0, 5])
    assert line.torque == 15
    assert line.distance == 3
    np.testing.assert_allclose(line.direction, [0.6, 0.8], rtol=1e-15)
    np.testing.assert_allclose(line.force, [-2.4, 1.8], rtol=1e-15)
    # |f_x| <= f_y along (-2.4, 1.8) + s (0.6, 0.8): in from s = 3/7 on, and never out again.
    np.testing.assert_allclose(line.friction_segment[0], np.array([-15, 15]) / 7, rtol=1e-14)
    assert np.isinf(line.friction_segment[1]).all()


@given(contacts, points, st.floats(-10, 10))
def test_one_torque_along_a_line(contact: rg.Contact, force: tuple[float, float], along: float) -> None:
    r = contact.position
    if hypot(*r) < 1e-3:
        return
    line = iso_torque_line(contact, force)
    assert line.torque == pytest.approx(wrench(contact, np.array(force))[2], abs=1e-15)
    assert line.torque == pytest.approx(hypot(*r) * line.distance, rel=1e-14, abs=0)
    for f in (np.array(force) + along * line.direction, line.force + along * line.direction):
        assert wrench(contact, f)[2] == pytest.approx(line.torque, abs=1e-13 * (1 + hypot(*r)) * 20)
    # d is the distance of the line from the contact, and f's own head lies on the line.
    assert abs(line.distance) == pytest.approx(hypot(*line.force), rel=1e-14, abs=0)
    assert line.force @ line.direction == pytest.approx(0, abs=1e-14 * (1 + abs(line.distance)))


def test_torque_grows_with_the_distance() -> None:
    contact = rg.Contact([3, 4], [0, 1], 1.0)
    distances = [IsoTorqueLine(contact, tau).distance for tau in (-10, 0, 5, 10)]
    assert distances == pytest.approx([-2, 0, 1, 2])


@given(contacts, shares, st.floats(0.1, 5))
def test_the_friction_segment_ends_on_the_cone(contact: rg.Contact, share: float, size: float) -> None:
    if hypot(*contact.position) < 1e-3:
        return
    f, n, mu = in_cone(contact, share, size), contact.normal, contact.friction
    line = iso_torque_line(contact, f)
    segment = line.friction_segment
    if segment is None:  # the line runs along an edge of the cone, to rounding
        edges = [in_cone(contact, s) / hypot(1, mu) for s in (-1, 1)]
        assert min(abs(line.direction[0] * e[1] - line.direction[1] * e[0]) for e in edges) < 1e-9
        return
    ends = [end for end in segment if np.isfinite(end).all()]
    for end in ends:
        normal, tangential = float(end @ n), abs(float(n[0] * end[1] - n[1] * end[0]))
        size_of_end = hypot(*end) + hypot(*f)
        assert tangential == pytest.approx(mu * normal, abs=1e-9 * size_of_end)
        assert normal >= -1e-9 * size_of_end
        assert wrench(contact, end)[2] == pytest.approx(line.torque, abs=1e-9 * size_of_end * 10)
    # f lies between the ends, and the cone is convex: beyond a finite end the line has left it.
    s = [float(end @ line.direction) if np.isfinite(end).all() else side * inf
         for end, side in zip(segment, (-1, 1), strict=True)]  # fmt: skip
    own = float(f @ line.direction)
    assert s[0] - 1e-9 * (1 + abs(s[0])) <= own <= s[1] + 1e-9 * (1 + abs(s[1]))
    for end, side in zip(s, (-1, 1), strict=True):
        if abs(end) < 100 and mu > 1e-3:
            out = line.force + (end + side * 0.1 * (1 + abs(end))) * line.direction
            assert abs(n[0] * out[1] - n[1] * out[0]) > mu * (out @ n) - 1e-9


def test_a_line_that_misses_the_cone_has_no_segment() -> None:
    contact = rg.Contact(
        [1, 0], [1, 0], 0.5
    )  # lines are horizontal: no force (s, tau) with s > 2 |tau| is out
    assert IsoTorqueLine(contact, 1.0).friction_segment is not None
    sideways = rg.Contact([1, 0], [0, 1], 0.5)  # f_y >= 2 |f_x|: a negative torque would need to pull
    assert IsoTorqueLine(sideways, -1.0).friction_segment is None
    np.testing.assert_allclose(IsoTorqueLine(sideways, 2.0).friction_segment, [[-1, 2], [1, 2]], rtol=1e-15)


PAIR_IN_SPACE = rg.Grasp([SPACE, rg.Contact([-1, 0, 0], [1, 0, 0], 0.5)])
BAD = [
    (lambda: WrenchPlane(SPACE), "wrench planes are defined for planar contacts; this one is in space"),
    (lambda: WrenchCone(SPACE), "wrench planes are defined for planar contacts; this one is in space"),
    (lambda: WrenchCone(PAPER["P1"], sign=2), "sign must be 1 or -1, got 2"),
    (lambda: WrenchCone(PAPER["P1"], [0, 0]), "apex must have shape (3,), got (2,): [0, 0]"),
    (lambda: IsoTorqueLine(PAPER["P1"], nan), "torque must be finite, got nan"),
    (
        lambda: IsoTorqueLine(rg.Contact([0, 0], [1, 0], 0.5), 1.0),
        "a contact at the centre of mass makes no torque and has no iso-torque lines",
    ),
    (lambda: iso_torque_line(PAPER["P1"], [1, 2, 3]), "force must have shape (2,), got (3,): [1, 2, 3]"),
    (
        lambda: WrenchLoop(STATE, ("P1", "P2")),
        "order must name each of P1, P2, P3 once, got ('P1', 'P2')",
    ),
    (
        lambda: WrenchLoop(rg.GraspState(PAIR_IN_SPACE, rg.Wrench([0, 0, 0]), np.zeros((2, 3)))),
        "the wrench loop is drawn for planar grasps; this one is in space",
    ),
    (
        lambda: rg.EquilibriumLocus.given(PAPER, LOAD, "P1", [1, nan]),
        "force must be finite, got [1, nan]",
    ),
    (
        lambda: rg.EquilibriumLocus.given(PAPER, LOAD, "P9", [1, 1]),
        "no contact 'P9' in this grasp; it has P1, P2, P3",
    ),
]


@pytest.mark.parametrize(("call", "message"), BAD, ids=[message for _, message in BAD])
def test_bad_input_is_refused(call, message: str) -> None:
    with pytest.raises(rg.InvalidInput) as refused:
        call()
    assert str(refused.value) == message

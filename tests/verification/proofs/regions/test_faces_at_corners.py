"""What doubles show of states at corners, to a tenth of their doubt, and what rationals are asked."""

from functools import partial
from itertools import product
from math import atan, cos, inf, sin
from types import SimpleNamespace

import numpy as np
import pytest

import regrasp as rg
from regrasp.verification.placed.faces.corners import Corners

pytestmark = pytest.mark.oracle

near = partial(pytest.approx, abs=0)
BIT, UP = 2.0**-46, np.array([0, 0, 1.0])
SQUARE = np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]) / 8


def at(
    forces, load, *, places=((1.0, 0, 0), (-1, 0, 0)), patches=None, moments=None, mu=0.5, **changes
) -> Corners:
    """States (c, s, k, 3) of fingers that push up, at points if no polygons are given."""
    places = np.array(places, dtype=float)
    k = len(places)
    given = {
        "grasp": rg.Grasp(rg.Contact(p, UP, mu) for p in places),
        "patches": [p[None] for p in places] if patches is None else patches,
        "loads": np.array([np.zeros(6), load]), "moments": np.array([np.ones(k), moments or np.zeros(k)]),
        "forces": np.array([np.ones(np.shape(forces)), forces]), "max_force": 100.0,
        "tilts": np.zeros((2, k, 3)), "focus": np.zeros((2, k)),
    }  # fmt: skip
    return Corners(SimpleNamespace(**given | changes), 1)


def two(one, other, load=(0, 0, -2, 0, 0, 0), **changes) -> Corners:
    return at([[[one, other]]], load, **changes)


@pytest.mark.parametrize("scale", [1.0, 1e-200, 1e200])
@pytest.mark.parametrize("mu", [0.0, 0.5, 30.0])
def test_cones_are_clear_by_more_than_rounding(mu, scale) -> None:
    for part, good in (0.9, False), (1.1, True), (-1e3, False), (1e3, True):
        room = part * BIT * (1 + mu)  # of the size: mu cos - sin
        edge = atan(mu) - room * cos(atan(mu))
        for turn in (1, 0, 0), (-0.6, 0.8, 0):
            f = scale * (sin(edge) * np.array(turn) + cos(edge) * UP)
            assert two(f, scale * UP, mu=mu).in_cones()[0, 0, 0] == (good and mu > 0)
    assert not two(-scale * UP, scale * UP, mu=mu).in_cones()[0, 0, 0]
    assert not two(scale * np.array([-0.01, -0.01, -1]), -scale * UP, mu=mu).in_cones().any()
    for part, good in (0.9e-140, False), (1.1e-140, mu > 0), (0.0, False):
        assert two(part * UP, UP, mu=mu).in_cones()[0, 0, 0] == good


@pytest.mark.parametrize("scale", [1.0, 1e-200, 1e200])
def test_forces_are_below_their_limit_by_more_than_rounding(scale) -> None:
    for part, good in (0.9, False), (1.1, True), (-1e15, False), (inf, True):
        told = two(
            UP * scale, [0, 0.28 * scale, 0.96 * scale], max_force=scale * (1 + part * BIT)
        ).below_limit()
        assert (told == good).all()
    told = two(UP * scale, 2 * UP * scale, max_force=1.5 * scale).below_limit()
    assert told.tolist() == [[[True, False]]]


@pytest.mark.parametrize("scale", [1.0, 2.0**-600, 2.0**600])
def test_states_are_balanced_by_more_than_rounding(scale) -> None:
    """2^-40 of the largest force, 2, is 128 of 2^-46; 3 of forces, 3 of the load, 1 of its torque count."""
    load = scale * np.array([0, 0, -3, 0, 1, 0])
    for axis, sign in product(range(3), (1, -1)):
        for part, good in (120.5, True), (121.5, False):
            f = 2 * UP + sign * part * BIT * np.eye(3)[axis]
            residuals, told = two(scale * f, scale * UP, load).balanced()
            assert told.item() == good, (axis, sign)
            assert residuals.item() == near(part * BIT / 2, rel=1e-3)


@pytest.mark.parametrize("moment", [0.0, 8.0])
@pytest.mark.parametrize("torque", [0.0, 6.0, -6.0])
def test_torques_count_by_the_longest_lever_and_moments_both_ways(moment, torque) -> None:
    places = ((2.0, 0, 0), (-1, 0, 0))
    patches = [np.array([[2.0, 0, 0]] * 3), np.array([[-1.0, 0, 0]])]
    for sign, way in (0, -1), (1, 1):
        turn = -(torque + way * moment) / 3  # by forces along y
        size = float(np.hypot(1, turn))
        terms = 2 * size + 2 + (np.hypot(1, torque) + moment) / 2
        for part, good in (64 * size - terms - 0.1, True), (64 * size - terms + 0.1, False):
            for axis in 1, 2:
                forces = np.tile(UP, (3, 2, 2, 1))
                forces[2, sign] += [[0, turn, 0], [0, -turn, 0]]
                forces[2, sign, 0] += part * BIT * np.eye(3)[axis]
                load = (0, 0, -2, 0, 1, torque)
                state = at(forces, load, places=places, patches=patches, moments=[moment, 5.0])
                assert state.balanced()[1][2, sign] == good
                assert state.balanced()[0][2, sign] == near(part * BIT / size, rel=0.1)


def test_loads_are_held_however_large_forces_are() -> None:
    """To a thousandth of a load of 2^-33, 8 of 2^-46, less 2 of the forces; without one to 64 - 2."""
    out = np.array([1.0, 0, 0])
    for load, most in (2.0**-33, 6), (0.0, 62):
        half = load / 2 * UP
        for part, good in (most - 0.1, True), (most + 0.1, False):
            state = two((part * BIT - 1) * out + half, out + half, (0, 0, -load, 0, 0, 0))
            assert state.balanced()[1].item() == good
            more = two(8 * ((part * BIT - 1) * out + half), 8 * (out + half), (0, 0, -8 * load, 0, 0, 0))
            assert more.balanced()[1].item() == good


def test_a_lever_of_nothing_is_one() -> None:
    none = [np.zeros((1, 3))] * 2
    state = two(UP, UP, (0, 0, -2, 0, 0, 1.0), patches=none)
    assert state.balanced()[0].item() == 1.0
    assert state.wrong()[1][0].startswith("corner 1: not in equilibrium")
    assert two(0 * UP, 0 * UP, np.zeros(6), patches=none).wrong() == (0.0, [])


def test_rationals_are_asked_what_doubles_do_not_show() -> None:
    """The first state that is wrong is named; residuals are the largest of either."""
    places = ((1.0, 0, 0), (-1, 0, 0))
    patches = [np.array([[1.125, 0, 0], [0.875, 0, 0], [1.125, 0, 0]]), np.array([[-1.0, 0, 0]])]
    up = np.array([[1, x] for x in patches[0][:, 0]]) * 2 / (1 + patches[0][:, :1])  # torques about y balance
    forces = np.zeros((3, 2, 2, 3))
    forces[..., 2] = up[:, None]

    def told(moment=0.0, off=(), load=(0, 0, -2, 0, 0, 0), **changes):
        given = forces.copy()
        for where, by in off:
            given[where] += by
        return at(given, load, places=places, patches=patches, moments=[moment, 9.0], **changes).wrong()

    assert told()[1] == []
    assert 0 <= told()[0] < 1e-15
    wide = (((2, 1, 0), [0.51 * up[2, 0], 0, 0]), ((2, 1, 1), [-0.51 * up[2, 0], 0, 0]))
    found = told(off=wide)[1]  # the same for both, and too much for one
    assert found[0].startswith("corner 3: force of P1 is outside its friction cone")
    edge = (((1, 0, 0), [0.5 * up[1, 1], 0, 0]), ((1, 0, 1), [-0.5 * up[1, 1], 0, 0]))
    assert told(off=edge)[1] == []  # which rationals say
    for part, good in (0.999, True), (1.001, False):
        by = part * 2.0**-39  # 2^-40 of the load
        residual, broken = told(off=[((1, 1, 1), [0, by, 0])])
        assert residual == near(part * 2.0**-40, rel=1e-3)
        assert (broken == []) == good
    some = [((1, 1, 1), [0, 0.9 * 2.0**-40, 0])]  # which doubles show
    edge = [((0, 0, 0), [0.5 * up[0, 0], 0, 0]), ((0, 0, 1), [-0.5 * up[0, 0], 0, 0])]  # and these do not
    for off in some, edge + some, [((1, 1, 1), [0, 1.9 * 2.0**-40, 0]), *edge]:
        part = 0.95 if len(off) == 3 and off[0] not in edge else 0.9 / up[1].max()
        assert told(off=off) == (near(part * 2.0**-40, rel=1e-3), [])
    for sign, way in (0, -1), (1, 1):  # 1e-9 both ways: held by turning, each by its own
        turn = -way * 1e-9 / (1 + patches[0][:, 0])
        forces[:, sign, 0, 1], forces[:, sign, 1, 1] = turn, -turn
    assert told(moment=1e-9)[1] == []
    for moment in 0.0, -1e-9, 2e-9, 9.0:
        residual, broken = told(moment=moment)
        assert len(broken) == 1
        assert broken[0].startswith("corner 1: not in equilibrium")
    assert told(moment=1e-9, off=[((2, 1, 0), [0, 1e-15, 0])])[1] == []
    for limit, words in (
        (float(up.max()) * (1 + 1e-12), []),
        (1.5, []),
        (1.05, ["corner 1: a force of 1.05882352941 is above 1.05"]),
    ):
        assert told(moment=1e-9, max_force=limit)[1] == words


def test_rationals_judge_torques_about_normals_in_any_direction() -> None:
    """So near to the edges of cones that doubles show nothing."""
    patches = [np.array([[1.0, 0, 0]] * 3), np.array([[-1.0, 0, 0]])]
    for n in UP, np.array([0, 0.6, 0.8]):
        for moment, good in (0.5, True), (0.5 + 1e-9, False), (-0.5, False):
            forces = np.zeros((3, 2, 2, 3))
            for sign, way in (0, -1), (1, 1):
                side = np.cross(n, [1.0, 0, 0])
                turn = -way * 0.25 * (1 - 2.0**-47) * side
                forces[:, sign] = 0.5 * n + turn, 0.5 * n - turn
            state = at(forces, [*-n, 0, 0, 0], patches=patches, moments=[moment, 0.0])
            state.grasp = rg.Grasp(rg.Contact(p, n, 0.5) for p in ((1.0, 0, 0), (-1, 0, 0)))
            state.along = (state.scaled * state.grasp.normals).sum(axis=-1)
            assert not state.in_cones().any()
            assert (state.wrong()[1] == []) == good, (n, moment)


def lacking(forces, *, tilt=(0, 0, 0), focus=0.0, off=(0, 0, 0), other=UP, scale=1.0) -> float:
    """What mixtures of forces (4, 3) of a finger in SQUARE lack, whose place is ``off`` its middle."""
    whole = np.zeros((4, 2, 2, 3))
    whole[:, :, 0], whole[:, :, 1] = np.array(forces)[:, None], other
    places = (off, (-1.0, 0, 0))
    patches = [SQUARE, np.array([[-1.0, 0, 0]])]
    tilts = np.zeros((2, 2, 3))
    tilts[1, 0] = tilt
    given = {"tilts": tilts, "focus": np.array([[0, 0], [focus, 0]])}
    return at(scale * whole, np.zeros(6), places=places, patches=patches, **given).lacks(0)


RADIUS, WIDE = 2**0.5 / 8, 2**0.5 / 4


@pytest.mark.parametrize("scale", [1.0, 2.0**-600, 2.0**600])
def test_what_mixtures_lack_is_bounded_from_above(scale) -> None:
    """Rounding is that of all terms, also of those that cancel, and of what a tilt has along the normal."""
    for tilt, focus in (
        ((0, 0, 0), 0.0), ((0.5, 0, 0), 0.0), ((0, 0, 7.0), 0.0), ((0.5, 0.25, 0), 2.0), ((0.5, 0, 0), -2.0),
    ):  # fmt: skip
        forces = UP + np.array([tilt[0], tilt[1], 0]) + focus * SQUARE
        size = np.linalg.norm(forces, axis=1)
        terms = size * (1 + np.linalg.norm(tilt) + abs(focus) * RADIUS)
        expected = (BIT * terms).max() * RADIUS * scale
        assert lacking(forces, tilt=tilt, focus=focus, scale=scale) == near(expected, rel=1e-9)
    aside = 2.0**-7  # of every force, and so many ulps more
    forces = np.tile(np.add(UP, (aside, 0, 0)), (4, 1))
    size = float(np.hypot(1, aside))
    expected = (1 + BIT * size) * (aside + BIT * size) / (1 - BIT * size) * RADIUS * (1 + BIT) * scale
    assert lacking(forces, scale=scale) == near(expected, rel=8 * 2.0**-53)
    forces[1:] = UP
    forces[0] = [aside, 0, 2.0**-20]  # steep, so that the width counts
    size = float(np.hypot(*forces[0, ::2]))
    assert lacking(forces, scale=scale) == near((aside + BIT * size) * WIDE * (1 + BIT) * scale, rel=1e-15)


def test_a_tilt_is_along_the_face() -> None:
    """All of it turned, and what a tilt has along the normal left out."""
    turn = np.array([[0.6, -0.8, 0], [0.48, 0.36, -0.8], [0.64, 0.48, 0.6]])
    forces = np.tile([0.5 + 2.0**-7, 0, 1.0], (4, 1))
    patches = [SQUARE @ turn.T, np.array([[-1.0, 0, 0]])]
    for along in 0.0, 3.0, -3.0:
        tilts = np.zeros((2, 2, 3))
        tilts[1, 0] = turn @ [0.5, 0, along]
        whole = np.zeros((4, 2, 2, 3))
        whole[:, :, 0], whole[:, :, 1] = (forces @ turn.T)[:, None], turn @ UP
        state = at(whole, np.zeros(6), places=((0, 0, 0), (-1, 0, 0)), patches=patches, tilts=tilts)
        state.grasp = rg.Grasp(rg.Contact(c.position, turn @ UP, 0.5) for c in state.grasp)
        state.along = (state.scaled * state.grasp.normals).sum(axis=-1)
        assert state.lacks(0) == near(2.0**-7 * RADIUS, rel=1e-9)


def test_small_forces_and_none() -> None:
    assert lacking(np.zeros((4, 3))) == 0.0
    assert lacking(np.tile(1e-150 * UP, (4, 1))) == near(1e-140 * WIDE, rel=1e-12)
    assert lacking(np.array([UP, UP, UP, 0 * UP])) == near(BIT * RADIUS, rel=1e-9)
    assert lacking([UP, UP, UP, [1.0, 0, 0]]) == near(WIDE, rel=1e-9)


def test_focus_is_no_more_than_its_forces_are_even() -> None:
    for focus, good in (32 / WIDE * (1 - 1e-9), True), (32 / WIDE * (1 + 1e-9), False):
        for sign in 1, -1:
            assert (lacking(UP + sign * focus * SQUARE, focus=sign * focus) < inf) == good


def test_a_point_lacks_nothing() -> None:
    assert two(UP, UP).lacks(0) == two([1.0, 0, 0], UP).lacks(0) == two(0 * UP, UP).lacks(0) == 0.0

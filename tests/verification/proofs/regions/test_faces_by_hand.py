"""Regions on the bottom of a cube, made by hand: torques, places and forces at their limits."""

from itertools import product
from math import atan, inf, nan
from types import SimpleNamespace

import numpy as np
import pytest

import regrasp as rg
from regrasp.verification.exact import RESOLUTION
from regrasp.verification.placed.faces.regions import verify_face_regions

pytestmark = pytest.mark.oracle

CUBE, REACH, UP = rg.Mesh.box(2, 2, 2), 3**0.5, np.array([0, 0, 1.0])
REST = np.array([[0.5, 0.6, -1], [-0.6, 0.5, -1], [0.1, -0.7, -1]])
SQUARE = np.array([[-0.1, -0.1, -1], [0.1, -0.1, -1], [0.1, 0.1, -1], [-0.1, 0.1, -1]])
LOAD = np.array([[0.0, 0, -8, 0, 0, 0]])


def made(patch=SQUARE, place=(0, 0, -1), push=lambda corner, sign: UP, moment=1e-9, friction=2.0, **changes):
    """Finger A anywhere in a polygon pushes as ``push`` says, three others hold the rest of the load."""
    patch, place = np.array(patch, dtype=float), np.array(place, dtype=float)
    grasp = rg.Grasp(rg.Contact(p, UP, friction, name=n) for p, n in zip([place, *REST], "ABCD", strict=True))
    matrix = np.vstack([np.tile(np.eye(3), 3), np.hstack([_cross(p) for p in REST])])
    forces = np.zeros((1, len(patch), 2, 4, 3))
    for c, (s, sign) in product(range(len(patch)), enumerate((-1.0, 1.0))):
        f = np.asarray(push(patch[c], sign), dtype=float)
        whole = LOAD[0] + np.r_[f, np.cross(patch[c], f)] + np.r_[0, 0, 0, sign * moment * UP]
        forces[0, c, s] = [f, *(np.linalg.pinv(matrix) @ -whole).reshape(3, 3)]
    given = {
        "shape": CUBE, "grasp": grasp, "patches": (patch, *(p[None] for p in REST)), "radius": 0.0,
        "radii": np.zeros(4), "max_force": 100.0, "loads": LOAD, "moments": np.array([[moment, 0, 0, 0]]),
        "tilts": np.zeros((1, 4, 3)), "focus": np.zeros((1, 4)), "forces": forces,
    }  # fmt: skip
    return SimpleNamespace(**given | changes)


def _cross(p):
    return np.array([[0, -p[2], p[1]], [p[2], 0, -p[0]], [-p[1], p[0], 0]])


def said(regions) -> str:
    return "; ".join(verify_face_regions(regions).violations)


def test_what_is_right_and_its_margins() -> None:
    verdict = verify_face_regions(made())
    assert verdict.ok
    assert 0 < verdict.worst_residual < float(RESOLUTION)
    forces = made().forces[0]
    across = np.hypot(forces[..., 0], forces[..., 1])
    assert verdict.least_cone_slack == pytest.approx((4 - (across / forces[..., 2]) ** 2).min(), rel=1e-9)
    assert verdict.least_angle == pytest.approx((atan(2) - np.arctan2(across, forces[..., 2])).min())
    idle = verify_face_regions(made(push=lambda corner, sign: 0 * UP, friction=3.0))
    assert idle.ok
    assert idle.least_angle > 0  # of the fingers that push
    for size, counts in (0.9995e-8, False), (1.0005e-8, True):  # 1e-12 of max_force is none
        regions = made(max_force=1e4, push=lambda c, s, size=size: size / 5**0.5 * np.array([2 - 1e-9, 0, 1]))
        assert (verify_face_regions(regions).least_angle < 1e-8) == counts


@pytest.mark.parametrize("tilt", [[0, 0, 0], [0.2, -0.1, 0], [0.2, -0.1, 5.0]])
@pytest.mark.parametrize("focus", [0.0, 0.7])
@pytest.mark.parametrize(("only", "other"), [(1.0, 0.01), (-1.0, 0.01), (1.0, 0.02)])
def test_the_torque_that_mixtures_lack_at_its_limit(tilt, focus, only, other) -> None:
    """N is 2 at one corner, 1 at the others; 0.01 aside there: slope 0.005 times 2 times 0.1 sqrt 2.

    Aside where N is 1 it is 0.01 times the width where that is less than the slope's 0.02 times the radius.
    """
    first = SQUARE[0]
    tilts, place = np.zeros((1, 4, 3)), np.array([0, 0, -1.0])
    tilts[0, 0] = tilt
    across = np.array([*tilt[:2], 0])

    def push(aside_at, off):
        def f(corner, sign):
            at, here = (corner == first).all(), (corner == SQUARE[aside_at]).all() and sign == only
            n = 2.0 if at else 1.0
            return n * (UP + across + focus * (corner - off)) + (
                other * np.array([0.6, 0.8, 0]) if here else 0
            )

        return f

    far = np.array([0.05, 0.05, -1.0])  # the corner (-0.1, -0.1) is 0.15 sqrt 2 from it
    width = 0.2 * 2**0.5
    for where, at, lacks in (
        (0, place, other * width / 2),
        (1, place, other * width),
        (0, far, other * 0.15 * 2**0.5),
        (1, far, other * width),
    ):
        for factor, good in (1 + 1e-8, True), (1 - 1e-6, False):
            regions = made(
                place=at,
                push=push(where, at),
                moment=lacks * factor,
                tilts=tilts,
                focus=np.full((1, 4), focus),
            )
            found = said(regions)
            assert (found == "") == good, (where, factor, found)
            assert good or found.startswith("load 1: mixtures of the forces of A may lack a torque")


def test_a_finger_that_does_not_push_has_no_slope() -> None:
    """Aside without a normal force, at friction: the width counts; without any force nothing is lacked."""
    for n in (0.0, 1e-3):
        regions = made(push=lambda c, s, n=n: n * UP, moment=1e-9)
        assert said(regions) == ""


def test_cones_and_limits_at_corners() -> None:
    for less, good in (1e-15, True), (0.0, True), (-(2.0**-52), False), (-1e-9, False):
        regions = made(
            push=lambda c, s, less=less: [2 * (1 - less), 0, 1],
            tilts=np.full((1, 4, 3), [2.0, 0, 0]),
            moment=1e-6,
        )
        found = said(regions)
        assert ("friction cone" not in found) == good, (less, found)
    good = made(push=lambda c, s: 4 * UP)
    for limit, words in (
        (4.0, ""), (4 - 2.0**-51, "load 1, corner 1: a force of 4 is above 4"), (inf, ""),
        (-4.0, "above"), (nan, "above"), (1e300, ""),
    ):  # fmt: skip
        good.max_force = limit
        assert words in said(good)
        assert (said(good) == "") == (words == ""), limit


@pytest.mark.parametrize("scale", [1.0, 1e-6, 1e6])
def test_equilibrium_at_its_limit(scale) -> None:
    """Of the largest force, or of the load where that is larger; torques of the farthest corner's lever."""
    for finger, axis, sign in product(range(4), range(3), (0, 1)):
        for part, good in (0.9, True), (1.1, False):
            regions = made()
            size = max(np.linalg.norm(regions.forces[0, 2, sign], axis=-1).max(), 8.0)
            regions.forces[0, 2, sign, finger, axis] += part * float(RESOLUTION) * size * 0.999
            regions.forces, regions.loads = regions.forces * scale, LOAD * scale
            regions.max_force, regions.moments = regions.max_force * scale, regions.moments * scale
            found = said(regions)
            assert ("not in equilibrium" not in found) == good, (finger, axis, found)
    for part, signs, good in (0.6, [0], True), (0.8, [0], False), (0.6, [0, 1], True), (0.8, [1], False):
        regions = made()  # of both components together, and of each direction of the torque by itself
        regions.forces[0, 2, signs, 0, :2] += part * float(RESOLUTION) * 8.0 * (0.999 if good else 1.001)
        assert ("not in equilibrium" not in said(regions)) == good
    lever = np.linalg.norm([*REST, SQUARE[0]], axis=1).max()
    arm = np.linalg.norm(np.cross(REST[0] - REST[1], UP))
    for part, good in (0.95, True), (1.05, False):  # of two fingers, as much the other way: a torque alone
        regions = made()
        size = 8.0 * part * float(RESOLUTION) * lever / arm
        regions.forces[0, 1, 0, 1] += size * UP
        regions.forces[0, 1, 0, 2] -= size * UP
        assert (said(regions) == "") == good
    none = made(loads=0 * LOAD, moment=0.0)
    none.forces[:] = 0
    assert said(none) == ""
    none.moments[0, 0] = 1e-9  # which no force holds
    assert said(none).startswith("load 1, corner 1: not in equilibrium")
    large = 1e3 * LOAD
    assert "w_ext is 1 of the largest force" in said(made(loads=large, forces=0 * made().forces))


def test_forces_are_within_the_limits_of_contacts() -> None:
    regions = made()
    for most, good in (100.0, True), (np.nextafter(100.0, 0), False):
        regions.grasp = rg.Grasp(c.changed(max_force=most) for c in made().grasp)
        assert said(regions) == (
            "" if good else "; ".join(f"forces may be 100, above the max_force of {n}" for n in "ABCD")
        )


def test_radii_are_no_wider_than_polygons() -> None:
    for factor, good in (1 + 0.9e-9, True), (1 + 1.1e-9, False):
        found = said(made(radii=np.array([0.1 * factor, 0, 0, 0])))
        assert (found == "") == good
        assert good or "polygon of A is narrower than its radius" in found
        assert (said(made(radii=np.full(4, 0.0), radius=0.0)) == "") is True
        regions = made(radii=np.array([0.1, 0, 0, 0]))
        regions.radius = 1e-300
        assert "radius of all" in said(regions)
    assert "radius of all" in said(made(radius=-1e-300))
    assert "radius of all" in said(made(radius=nan))


def test_fingers_of_no_polygon_are_at_their_places() -> None:
    good = made()
    for off, fine in (0.9e-9, True), (1.1e-9, False):
        moved = made(patches=(SQUARE, good.patches[1] + [off * REACH, 0, 0], *good.patches[2:]))
        assert ("B has no polygon" not in said(moved)) == fine
    assert "B has no polygon" in said(made(radii=np.array([0, 1e-300, 0, 0])))
    assert "polygon of A is not on faces" in said(made(shape=rg.Mesh.box(2, 2, 2.1)))
    upside = rg.Grasp(rg.Contact(c.position, -c.normal, 2.0, name=c.name) for c in good.grasp)
    assert "polygon of A is not on faces" in said(made(grasp=upside))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"patches": made().patches[:3]}, "each contact needs a polygon"),
        ({"patches": (SQUARE[:, :2], *made().patches[1:])}, "each contact needs a polygon"),
        ({"patches": (SQUARE[0], *made().patches[1:])}, "each contact needs a polygon"),
        ({"patches": (SQUARE[:0], *made().patches[1:])}, "each contact needs a polygon"),
        ({"loads": LOAD[:0]}, "there is no load"),
        ({"loads": np.add(LOAD, nan)}, "loads and polygons must be finite"),
        ({"patches": (SQUARE + inf, *made().patches[1:])}, "loads and polygons must be finite"),
        ({"patches": (SQUARE, *(p + nan for p in made().patches[1:]))}, "loads and polygons must be finite"),
        ({"patches": (SQUARE * [1, 1, 1.01], *made().patches[1:])}, "A is not around its place"),
        ({"radius": 1e-300}, "the radius of all is above that of one of them"),
        ({"loads": LOAD[:, :5]}, "there is no load"),
        ({"loads": LOAD[0]}, "there is no load"),
        ({"forces": made().forces[:, :3]}, "are missing"),
        ({"forces": made().forces[:, :, :1]}, "are missing"),
        ({"forces": made().forces[..., :2]}, "are missing"),
        ({"forces": np.concatenate([made().forces] * 2)}, "are missing"),
        ({"forces": made().forces + inf}, "are missing"),
        ({"moments": np.zeros((1, 3))}, "are missing"),
        ({"moments": np.full((1, 4), nan)}, "are missing"),
        ({"tilts": np.zeros((1, 4, 2))}, "are missing"),
        ({"focus": np.zeros((2, 4))}, "are missing"),
        ({"radii": np.zeros(3)}, "are missing"),
    ],
)
def test_regions_of_no_form(changes, words) -> None:
    assert said(made()) == ""
    verdict = verify_face_regions(made(**changes))
    assert words in "; ".join(verdict.violations)
    assert (verdict.worst_residual, verdict.least_angle, verdict.least_cone_slack) == (inf, -inf, -inf)


def test_every_load_counts() -> None:
    good = made()
    double = {"loads": np.repeat(LOAD, 2, axis=0), "forces": np.repeat(good.forces, 2, axis=0)}
    for name in ("moments", "tilts", "focus"):
        double[name] = np.repeat(getattr(good, name), 2, axis=0)
    assert said(made(**double)) == ""
    for load in 0, 1:
        regions = made(**double | {"forces": np.array(double["forces"])})
        regions.forces[load, 3, 1, 1, 0] += 8 * 0.25 * float(RESOLUTION)
        verdict = verify_face_regions(regions)
        assert verdict.ok
        assert verdict.worst_residual > 0.2 * float(RESOLUTION)
        regions = made(**double | {"forces": np.array(double["forces"])})
        regions.forces[load] *= 1 + 1e-9
        assert said(regions).startswith(
            f"load {load + 1}, corner 1: not in equilibrium, G f + w_ext is 1e-09 of"
        )


def test_places_alone_have_one_state_a_load() -> None:
    whole = made()
    forces = np.zeros((1, 1, 1, 4, 3))
    forces[0, 0, 0] = whole.forces[0].mean(axis=(0, 1))  # of corners about the place, in both directions
    points = tuple(c.position[None] for c in whole.grasp)
    assert said(made(patches=points, forces=forces)) == ""
    assert "are missing" in said(made(patches=points, forces=forces[:, :, :0]))
    for axis, sign in product(range(3), (-1, 1)):
        for part, good in (0.9, True), (1.1, False):
            moved = list(points)
            moved[2] = points[2] + sign * part * 1e-9 * REACH * np.eye(3)[axis]
            assert ("C has no polygon" not in said(made(patches=tuple(moved), forces=forces))) == good


def test_margins_of_forces_that_lean_and_of_triangles() -> None:
    lean = np.array([0.6, -0.3, 0])
    triangle = SQUARE[[0, 1, 2]] + [-0.02, 0.02, 0]
    regions = made(
        triangle, push=lambda c, s: 0.5 * (UP + lean), friction=3.0, tilts=np.full((1, 4, 3), lean)
    )
    verdict = verify_face_regions(regions)
    assert verdict.violations == ()
    across = np.hypot(regions.forces[..., 0], regions.forces[..., 1])
    slope = (across / regions.forces[..., 2]).max()
    assert slope > 0.6
    assert verdict.least_cone_slack == pytest.approx(9 - slope**2, rel=1e-12)
    broken = made()
    broken.forces[0, 1, 1, 2, 0] = nan
    verdict = verify_face_regions(broken)
    assert verdict.violations == ("forces at corners are missing, or what they prove",)


def test_large_forces_hold_the_load_all_the_same() -> None:
    """Two fingers squeeze by 1e13 and push up by 1 each, where 8 are asked: 6e-13 of the forces."""
    regions = made(friction=1e14, moment=0.0, max_force=1e15)
    along = 1e13 * (REST[0] - REST[1]) / np.linalg.norm(REST[0] - REST[1])
    regions.forces[:] = [[0, 0, 0], UP - along, UP + along, [0, 0, 0]]
    assert said(regions).startswith("load 1, corner 1: the load is not held, G f + w_ext is 0.75 of it")

"""Normals of meshes, contacts on them, samples."""

import pickle
from math import cos, pi, sin

import numpy as np
import pytest

import regrasp as rg
from refusals import refused
from regrasp.mesh import parts
from solids import angle

pytestmark = pytest.mark.oracle

BOX = rg.Mesh.box(2, 3, 4)
CONE = rg.Mesh.revolved([(0, 0), (1, 0), (0, 2)])


def test_flat_normals_are_off_by_half_a_turn_at_most() -> None:
    round_one = rg.Mesh.cylinder(2, 3)
    flat = rg.Mesh(round_one.vertices, round_one.faces)
    points = flat.sample(300)
    off = angle(round_one.normals(points), flat.normals(points))
    assert 0.9 * 360 / 128 < off.max() <= 360 / 128 + 1e-9


def test_smooth_normals_of_a_sphere() -> None:
    ball = rg.Mesh.sphere(3)
    rng = np.random.default_rng(0)
    points = ball.nearest(3 * (v := rng.normal(size=(3000, 3))) / np.linalg.norm(v, axis=1)[:, None])
    assert angle(ball.normals(points), -points / np.linalg.norm(points, axis=1)[:, None]).max() < 0.3


def test_smooth_normals_of_a_box_are_its_faces() -> None:
    soft = rg.Mesh(BOX.vertices, BOX.faces, smooth=True)
    points = BOX.sample(60)
    np.testing.assert_allclose(soft.normals(points), BOX.normals(points), atol=1e-15)


def test_smooth_normals_do_not_depend_on_how_flat_faces_are_divided() -> None:
    prism = rg.Mesh.cylinder(1, 1, segments=12)  # turns by 30 degrees
    corners = prism.vertices[prism.faces]
    middles = corners.mean(axis=1)
    finer = np.concatenate([np.stack([corners[:, k], corners[:, (k + 1) % 3], middles], 1) for k in range(3)])
    count = 3 * len(finer)
    split = rg.Mesh(finer.reshape(-1, 3), np.arange(count).reshape(-1, 3), smooth=True)
    assert len(split.faces) == 3 * len(prism.faces)
    shared = prism.vertices[:24] * [1, 1, 0.999]  # on the edges of the side
    np.testing.assert_allclose(split.normals(shared), prism.normals(shared), atol=1e-12)


def test_a_steeper_crease_smooths_what_a_lower_one_parts() -> None:
    hexagon = rg.Mesh.cylinder(1, 1, segments=6)  # its sides turn by 60 degrees
    soft = rg.Mesh(hexagon.vertices, hexagon.faces, smooth=True, crease=np.radians(61))
    at = [cos(0.3), sin(0.3), 0]
    assert angle(hexagon.normals(at), -np.array([cos(pi / 6), sin(pi / 6), 0])) < 1e-9
    foot = soft.nearest(at)
    assert angle(soft.normals(at), -foot / np.linalg.norm(foot)) < 1e-9


# -- contacts refused -------------------------------------------------------------------------------------


def test_edges_and_corners_are_refused() -> None:
    assert refused(BOX.contact_at, [1, 1.5, 0.3], friction=0.3) == (
        "point (1, 1.5, 0.3) is at an edge or corner, where 2 faces meet at up to 90 degrees "
        "and no normal is defined; move it into a face"
    )
    assert "where 6 faces meet at up to 90 degrees" in refused(BOX.contact_at, [1, 1.5, 2], friction=0.3)
    assert BOX.contact_at([1, 1.5 - 1e-6, 0], friction=0.3).normal.tolist() == [-1, 0, 0]


def test_an_edge_within_a_flat_face_is_none() -> None:
    for x in np.linspace(-0.9, 0.9, 7):
        contact = BOX.contact_at([x, 1.5 * x, 2], friction=0.3)  # along the diagonal
        np.testing.assert_allclose(contact.normal, [0, 0, -1], atol=1e-15)


def test_an_edge_of_a_faceted_curve_is_refused_with_advice() -> None:
    soft = rg.Mesh.cylinder(1, 2)
    faceted = rg.Mesh(soft.vertices, soft.faces)
    assert refused(faceted.contact_at, [1, 0, 0.1], friction=0.3) == (
        "point (1, 0, 0.1) is at an edge or corner, where 2 faces meet at up to 5.62 degrees "
        "and no normal is defined; move it into a face; for a curved surface give the mesh smooth=True"
    )
    np.testing.assert_allclose(soft.contact_at([1, 0, 0.1], friction=0.3).normal, [-1, 0, 0], atol=1e-12)
    finer = rg.Mesh.cylinder(1, 2, segments=90)  # turns by 4 degrees
    assert rg.Mesh(finer.vertices, finer.faces).contact_at([1, 0, 0.1], friction=0.3).normal[0] < -0.99


def test_the_tip_of_a_cone_is_refused() -> None:
    for mesh in (CONE, rg.Mesh(CONE.vertices, CONE.faces)):
        assert "(0, 0, 2) is at an edge or corner, where 64 faces meet" in refused(
            mesh.contact_at, [0, 0, 2], friction=0.3
        )
    tip = np.linalg.norm(CONE.sample(100, clearance=0.3) - [0, 0, 2], axis=1)
    assert tip.min() >= 0.3


def test_a_point_far_away_is_refused() -> None:
    assert refused(BOX.contact_at, [1000, 0, 0], friction=0.3) == (
        "point (1000, 0, 0) is 999 away from the surface of an object of size (2, 3, 4); "
        "is it in the mesh's coordinates and unit? nearest() answers for any"
    )
    np.testing.assert_array_equal(BOX.nearest([1000, 0, 0]), [1, 0, 0])


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda: BOX.contact_at([1, 0], friction=0.3), "point must have shape (3,), got (2,): [1, 0]"),
        (lambda: BOX.nearest([1, 0]), "points must be finite, of shape (..., 3); got shape (2,): [1, 0]"),
        (lambda: BOX.normals("here"), "points must be numbers of shape (..., 3), got 'here'"),
        (lambda: BOX.sample(0), "count must be a whole number of at least 1, got 0"),
        (lambda: BOX.sample(3, seed=0.5), "seed must be a whole number of at least 0, got 0.5"),
        (lambda: BOX.sample(3, clearance=-1), "clearance must be at least 0, got -1"),
        (lambda: rg.Mesh.box(1, 0, 1), "b must be greater than 0, got 0"),
        (lambda: rg.Mesh.cylinder(1, -1), "height must be greater than 0, got -1"),
        (lambda: rg.Mesh.cylinder(1, 1, segments=2), "segments must be a whole number of at least 3, got 2"),
        (lambda: rg.Mesh.sphere(1, divisions=1), "divisions must be a whole number of at least 2, got 1"),
        (lambda: rg.Mesh.extruded([[0, 0]], 1), "outline must be an Outline, got [[0, 0]]"),
        (
            lambda: rg.Mesh.revolved([(1, 0), (1, 1), (0, 1)]),
            "profile must begin and end on the axis, with radius 0, and have radii above 0 in between; "
            "got radii [1. 1. 0.]",
        ),
        (
            lambda: rg.Mesh.revolved([(0, 0), (2, 2), (2, 0), (1, 2), (0, 2)]),
            "profile crosses or touches itself near (1.33333, 1.33333); it must be a simple closed curve",
        ),
        (
            lambda: rg.Mesh(BOX.vertices, BOX.faces, crease=30),
            "crease must be less than pi / 2, got 30; it is in radians",
        ),
    ],
)
def test_arguments_refused(call, says: str) -> None:
    assert refused(call) == says


# -- samples ----------------------------------------------------------------------------------------------


def to_edges(points: np.ndarray, half: np.ndarray) -> np.ndarray:
    """Distance of points on a box to its nearest edge: the second smallest of those to its faces."""
    return np.sort(half - abs(points), axis=1)[:, 1]


@pytest.mark.parametrize("count", [1, 2, 7, 60, 400])
def test_samples_are_even_and_keep_clear(count: int) -> None:
    points = BOX.sample(count)
    assert points.shape == (count, 3)
    half = BOX.size / 2
    np.testing.assert_allclose(abs(half - abs(points)).min(axis=1), 0, atol=1e-12)
    spacing = np.sqrt(BOX.area / count)
    assert to_edges(points, half).min() >= spacing / 16
    if count >= 60:
        assert to_edges(points, half).min() >= spacing / 4
        away = np.linalg.norm(points[:, None] - points, axis=2) + 9 * np.eye(count)
        assert away.min() > 0.35 * spacing
        places = BOX.faces[np.random.default_rng(0).integers(0, 12, 4000)]
        shares = np.random.default_rng(1).dirichlet([1, 1, 1], 4000)
        everywhere = np.einsum("kc,kcx->kx", shares, BOX.vertices[places])
        holes = np.linalg.norm(everywhere[:, None] - points, axis=2).min(axis=1)
        assert holes.max() < 1.25 * spacing


def test_a_clearance_is_kept_or_refused() -> None:
    for clearance in (0, 0.2, 0.9):
        assert to_edges(BOX.sample(50, clearance=clearance), BOX.size / 2).min() >= clearance
    assert refused(BOX.sample, 50, clearance=1.6).startswith(
        "the surface has no room for 50 points 1.6 or more from its sharp edges: 0 of "
    )
    assert "the farthest about 1.5" in refused(BOX.sample, 50, clearance=1.6)


def test_both_sides_and_the_rim_of_a_thin_plate_are_sampled() -> None:
    plate = rg.Mesh.box(1, 1, 1e-3)
    z = plate.sample(50)[:, 2]
    assert 20 <= (z > 0).sum() <= 30
    assert abs(abs(z) - 5e-4).max() < 1e-12
    narrow = plate.sample(50, clearance=0)
    rim = abs(narrow[:, 2]) < 4.99e-4
    assert 4 <= rim.sum() <= 16
    assert len(np.unique(plate.normals(narrow).round(9), axis=0)) == 6


def test_samples_are_repeatable() -> None:
    ball = rg.Mesh.sphere(1)
    np.testing.assert_array_equal(ball.sample(20), ball.sample(20, seed=0))
    assert (ball.sample(20) != ball.sample(20, seed=1)).any()


def test_contacts_are_those_at_the_samples() -> None:
    cam = parts.cam()
    found = cam.contacts(25, friction=0.4, max_force=3.0, seed=2)
    for contact, point in zip(found, cam.sample(25, seed=2), strict=True):
        same = cam.contact_at(point, friction=0.4, max_force=3.0)
        np.testing.assert_allclose(contact.position, same.position, atol=1e-15)
        np.testing.assert_allclose(contact.normal, same.normal, atol=1e-9)
        assert (contact.friction, contact.max_force, contact.name) == (0.4, 3.0, None)


def test_contacts_of_a_mesh_hold_its_weight() -> None:
    box = rg.Mesh(BOX.vertices + np.array([7, 8, 9]), BOX.faces)
    sides = [(8, 8, 9.5), (6, 8.3, 9), (7, 9.5, 8.8), (7.2, 6.5, 9)]
    grasp = rg.Grasp(box.contact_at(point, friction=0.5) for point in sides)
    state = rg.choose_state(grasp, rg.Wrench([0, 0, -2.0]), "effort")
    assert state.residual < 1e-6
    assert min(state.margins.angle) > 0


# -- values -----------------------------------------------------------------------------------------------


def test_a_mesh_is_a_value() -> None:
    again = rg.Mesh(BOX.vertices.tolist(), BOX.faces.tolist())
    assert again == BOX
    assert hash(again) == hash(BOX)
    assert pickle.loads(pickle.dumps(BOX)) == BOX
    assert rg.Mesh(BOX.vertices, BOX.faces, smooth=True) != BOX
    assert rg.Mesh(BOX.vertices, BOX.faces, crease=0.2) != BOX
    for values in (BOX.vertices, BOX.faces, BOX.centre_of_mass, BOX.size):
        with pytest.raises(ValueError, match="read-only"):
            values[0] = 0
    vertices = np.array(BOX.vertices)
    kept = rg.Mesh(vertices, BOX.faces)
    vertices[:] = 0
    assert kept == BOX


def test_a_mesh_says_its_size() -> None:
    assert repr(BOX) == "Mesh(12 faces, size (2, 3, 4), volume 24)"
    assert repr(rg.Mesh.sphere(1)) == "Mesh(1280 faces, smooth, size (2, 2, 2), volume 4.15268)"

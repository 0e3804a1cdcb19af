"""Meshes against closed forms, trimesh and their own laws."""

import pickle
from math import cos, pi, sin

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

import regrasp as rg
from regrasp.mesh import parts
from regrasp.outline import parts as outlines
from solids import Motion, angle, bumpy, is_inside, motions, seeds

pytestmark = pytest.mark.oracle

BOX = rg.Mesh.box(2, 3, 4)
CONE = rg.Mesh.revolved([(0, 0), (1, 0), (0, 2)])
few = settings(max_examples=25, deadline=None)


def measures(mesh: rg.Mesh) -> list[float]:
    return [mesh.volume, mesh.area, *mesh.centre_of_mass, *mesh.size]


# -- closed forms -----------------------------------------------------------------------------------------


def test_a_box() -> None:
    assert measures(BOX) == pytest.approx([24, 52, 0, 0, 0, 2, 3, 4], abs=1e-15)
    contact = BOX.contact_at([1.1, 0.5, -0.5], friction=0.3, max_force=7, torsion=0.1, name="A")
    np.testing.assert_allclose(contact.position, [1, 0.5, -0.5], atol=1e-15)
    assert contact == rg.Contact(contact.position, [-1, 0, 0], 0.3, max_force=7, torsion=0.1, name="A")


def test_contacts_are_relative_to_the_centre_of_mass() -> None:
    away = rg.Mesh(BOX.vertices + np.array([5, 0, 0]), BOX.faces)
    np.testing.assert_allclose(away.centre_of_mass, [5, 0, 0], atol=1e-14)
    contact = away.contact_at([6, 0, 0], friction=0.3)
    np.testing.assert_allclose(contact.position, [1, 0, 0], atol=1e-14)
    np.testing.assert_allclose(away.surface()[0], BOX.vertices, atol=1e-14)


@pytest.mark.parametrize("segments", [3, 8, 64, 1000])
def test_a_cylinder_is_the_prism_it_says(segments: int) -> None:
    prism = rg.Mesh.cylinder(2, 3, segments=segments)
    turn = 2 * pi / segments
    base, side = segments * 2 * sin(turn), segments * 4 * sin(turn / 2)
    assert prism.volume == pytest.approx(3 * base, rel=1e-12)
    assert prism.area == pytest.approx(2 * base + 3 * side, rel=1e-12)
    np.testing.assert_allclose(prism.centre_of_mass, 0, atol=1e-14)


def test_a_sphere_in_the_limit() -> None:
    errors = [1 - rg.Mesh.sphere(2, divisions=n).volume / (4 / 3 * pi * 8) for n in (4, 8, 16)]
    assert errors[1] < 0.009
    np.testing.assert_allclose(errors[:-1], np.array(errors[1:]) * 4, rtol=0.1)  # second order


def test_a_cone() -> None:
    full = CONE.volume
    assert full == pytest.approx(64 * sin(2 * pi / 64) / 2 * 2 / 3, rel=1e-12)
    np.testing.assert_allclose(CONE.centre_of_mass, [0, 0, 0.5], atol=1e-14)


@pytest.mark.parametrize("name", [*outlines.PARTS])
def test_a_plate_is_its_outline(name: str) -> None:
    outline = outlines.PARTS[name]()
    plate = rg.Mesh.extruded(outline, 0.01)
    polygon = rg.Outline(outline.polygon(), outline.hole_polygons())
    assert plate.volume == pytest.approx(0.01 * polygon.area, rel=1e-12)
    around = polygon.length + sum(hole.length for hole in polygon.holes)
    assert plate.area == pytest.approx(2 * polygon.area + 0.01 * around, rel=1e-12)
    np.testing.assert_allclose(plate.centre_of_mass, [*outline.centre_of_mass, 0.005], atol=1e-5)
    centre = outline.centre_of_mass + polygon.centre_of_mass
    np.testing.assert_allclose(plate.centre_of_mass, [*centre, 0.005], atol=1e-14)
    assert plate.smooth == (name == "cam")


def test_a_plate_has_the_contacts_of_its_outline() -> None:
    outline = outlines.bracket()
    plate = rg.Mesh.extruded(outline, 0.01)
    for s in outline.sample(20):
        flat = outline.contact_at(s, friction=0.4)
        solid = plate.contact_at([*(flat.position + outline.centre_of_mass), 0.0049], friction=0.4)
        np.testing.assert_allclose(solid.position, [*flat.position, -1e-4], atol=1e-15)
        np.testing.assert_allclose(solid.normal, [*flat.normal, 0], atol=1e-12)


@pytest.mark.parametrize("name", parts.PARTS)
def test_parts_are_sound_and_trimesh_agrees(name: str) -> None:
    part = parts.PARTS[name]()
    theirs = trimesh.Trimesh(part.vertices, part.faces, process=False)
    assert theirs.is_watertight
    assert theirs.is_winding_consistent
    assert part.volume == pytest.approx(theirs.volume, rel=1e-9)
    assert part.area == pytest.approx(theirs.area, rel=1e-9)
    np.testing.assert_allclose(part.centre_of_mass, theirs.center_mass, atol=1e-9)
    assert theirs.euler_number == {"bracket": -2, "bottle": 2}.get(name, 0)  # 2 - 2 holes


def test_the_bracket_is_two_plates_less_two_bores() -> None:
    width, leg, height, web, hole = 0.04, 0.06, 0.05, 0.006, 0.012
    bore = 32 * sin(2 * pi / 32) / 2 * (hole / 2) ** 2
    expected = width * web * (leg + height - web) - 2 * bore * web
    assert parts.bracket(width, leg, height, web, hole).volume == pytest.approx(expected, rel=1e-12)


# -- laws -------------------------------------------------------------------------------------------------


@given(seeds, motions(), st.booleans())
@few
def test_a_moved_mesh_has_moved_contacts(seed: int, motion: Motion, smooth: bool) -> None:
    mesh = bumpy(seed, smooth=smooth)
    moved = motion.mesh(mesh)
    assert moved.volume == pytest.approx(motion.scale**3 * mesh.volume, rel=1e-9)
    assert moved.area == pytest.approx(motion.scale**2 * mesh.area, rel=1e-9)
    near = 1e-11 * motion.scale
    np.testing.assert_allclose(moved.centre_of_mass, motion.points(mesh.centre_of_mass), atol=near)
    np.testing.assert_allclose(moved.sample(30), motion.points(mesh.sample(30)), atol=near)
    pairs = zip(mesh.contacts(30, friction=0.3), moved.contacts(30, friction=0.3), strict=True)
    for before, after in pairs:
        np.testing.assert_allclose(
            after.position, motion.scale * motion.directions(before.position), atol=near
        )
        np.testing.assert_allclose(after.normal, motion.directions(before.normal), atol=1e-9)


@given(seeds)
@few
def test_trimesh_agrees(seed: int) -> None:
    mesh = bumpy(seed)
    theirs = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    assert mesh.volume == pytest.approx(theirs.volume, rel=1e-9)
    np.testing.assert_allclose(mesh.centre_of_mass, theirs.center_mass, atol=1e-9)
    points = np.random.default_rng(seed).normal(size=(50, 3)) + mesh.centre_of_mass
    _, distances, _ = trimesh.proximity.closest_point_naive(theirs, points)
    ours = mesh.nearest(points)
    np.testing.assert_allclose(np.linalg.norm(ours - points, axis=1), distances, atol=1e-9)
    np.testing.assert_allclose(mesh.nearest(ours), ours, atol=1e-12)


@given(seeds)
@few
def test_normals_of_a_closed_surface_cancel(seed: int) -> None:
    mesh = bumpy(seed)
    corners = mesh.vertices[mesh.faces]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    middles = corners.mean(axis=1)
    normals = mesh.normals(middles)
    np.testing.assert_allclose(areas @ normals, 0, atol=1e-13)
    assert -(areas * (normals * middles).sum(axis=1)).sum() / 6 == pytest.approx(mesh.volume)


@given(seeds, st.booleans())
@few
def test_normals_point_into_the_object(seed: int, smooth: bool) -> None:
    mesh = bumpy(seed, smooth=smooth)
    for contact in mesh.contacts(30, friction=0.3):
        step = 1e-6 * contact.normal
        point = contact.position + mesh.centre_of_mass
        assert is_inside(mesh, point + step)
        assert not is_inside(mesh, point - step)


@given(seeds)
@few
def test_winding_is_mended(seed: int) -> None:
    mesh = bumpy(seed)
    turned = np.random.default_rng(seed).random(len(mesh.faces)) < 0.5
    uneven = np.where(turned[:, None], mesh.faces[:, [0, 2, 1]], mesh.faces)
    assert rg.Mesh(mesh.vertices, uneven) == mesh
    assert rg.Mesh(mesh.vertices, mesh.faces[:, ::-1]).volume == pytest.approx(mesh.volume)


@given(seeds, st.booleans())
@few
def test_a_soup_of_triangles_in_any_order_is_the_same_body(seed: int, smooth: bool) -> None:
    mesh = bumpy(seed, smooth=smooth)
    order = np.random.default_rng(seed).permutation(len(mesh.faces))
    corners = mesh.vertices[mesh.faces[order]]
    corners[::2] = np.roll(corners[::2], 1, axis=1)
    soup = rg.Mesh(corners.reshape(-1, 3), np.arange(3 * len(order)).reshape(-1, 3), smooth=smooth)
    assert len(soup.vertices) == len(mesh.vertices)
    np.testing.assert_allclose(measures(soup), measures(mesh), atol=1e-12)
    for point in mesh.sample(10):
        ours, theirs = (m.contact_at(point, friction=0.3) for m in (mesh, soup))
        np.testing.assert_allclose(ours.position, theirs.position, atol=1e-12)
        np.testing.assert_allclose(ours.normal, theirs.normal, atol=1e-9)


def test_what_is_unused_is_left_out() -> None:
    vertices = np.vstack([[[9, 9, 9]], BOX.vertices, [[7, 7, 7]], BOX.vertices[:1]])
    faces = np.vstack([BOX.faces + 1, [[1, 10, 2]]])  # the last has two corners in one place
    assert rg.Mesh(vertices, faces) == BOX


# -- normals ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("segments", [16, 64])
def test_smooth_normals_of_a_cylinder_are_its_own(segments: int) -> None:
    cylinder = rg.Mesh.cylinder(2, 3, segments=segments)
    points = cylinder.sample(200)
    normals = cylinder.normals(points)
    side = abs(points[:, 2]) < 1.4999
    assert 100 < side.sum() < 190
    radial = points[side] * [1, 1, 0]
    np.testing.assert_allclose(normals[side], -radial / np.linalg.norm(radial, axis=1)[:, None], atol=1e-12)
    np.testing.assert_allclose(normals[~side], [[0, 0, -np.sign(z)] for z in points[~side, 2]], atol=1e-12)


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


def refusal(call, *args, **kwargs) -> str:
    with pytest.raises(rg.InvalidInput) as caught:
        call(*args, **kwargs)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_edges_and_corners_are_refused() -> None:
    assert refusal(BOX.contact_at, [1, 1.5, 0.3], friction=0.3) == (
        "point (1, 1.5, 0.3) is at an edge or corner, where 2 faces meet at up to 90 degrees "
        "and no normal is defined; move it into a face"
    )
    assert "where 6 faces meet at up to 90 degrees" in refusal(BOX.contact_at, [1, 1.5, 2], friction=0.3)
    assert BOX.contact_at([1, 1.5 - 1e-6, 0], friction=0.3).normal.tolist() == [-1, 0, 0]


def test_an_edge_within_a_flat_face_is_none() -> None:
    for x in np.linspace(-0.9, 0.9, 7):
        contact = BOX.contact_at([x, 1.5 * x, 2], friction=0.3)  # along the diagonal
        np.testing.assert_allclose(contact.normal, [0, 0, -1], atol=1e-15)


def test_an_edge_of_a_faceted_curve_is_refused_with_advice() -> None:
    soft = rg.Mesh.cylinder(1, 2)
    faceted = rg.Mesh(soft.vertices, soft.faces)
    assert refusal(faceted.contact_at, [1, 0, 0.1], friction=0.3) == (
        "point (1, 0, 0.1) is at an edge or corner, where 2 faces meet at up to 5.62 degrees "
        "and no normal is defined; move it into a face; for a curved surface give the mesh smooth=True"
    )
    np.testing.assert_allclose(soft.contact_at([1, 0, 0.1], friction=0.3).normal, [-1, 0, 0], atol=1e-12)
    finer = rg.Mesh.cylinder(1, 2, segments=90)  # turns by 4 degrees
    assert rg.Mesh(finer.vertices, finer.faces).contact_at([1, 0, 0.1], friction=0.3).normal[0] < -0.99


def test_the_tip_of_a_cone_is_refused() -> None:
    for mesh in (CONE, rg.Mesh(CONE.vertices, CONE.faces)):
        assert "(0, 0, 2) is at an edge or corner, where 64 faces meet" in refusal(
            mesh.contact_at, [0, 0, 2], friction=0.3
        )
    tip = np.linalg.norm(CONE.sample(100, clearance=0.3) - [0, 0, 2], axis=1)
    assert tip.min() >= 0.3


def test_a_point_far_away_is_refused() -> None:
    assert refusal(BOX.contact_at, [1000, 0, 0], friction=0.3) == (
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
    assert refusal(call) == says


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
    assert refusal(BOX.sample, 50, clearance=1.6).startswith(
        "the surface has no room for 50 points 1.6 or more from its sharp edges: 0 of "
    )
    assert "the farthest about 1.5" in refusal(BOX.sample, 50, clearance=1.6)


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

"""Meshes against closed forms, trimesh and their own laws."""

from math import pi, sin

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

import regrasp as rg
from regrasp.mesh import parts
from regrasp.outline import parts as outlines
from solids import Motion, bumpy, is_inside, motions, seeds

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

"""Which wall a finger touches, units that are not what they seem, and moments of inertia."""

import warnings
from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import regrasp as rg
from regrasp.mesh import parts
from regrasp.outline import parts as outlines
from solids import bumpy, is_inside, motions, seeds

pytestmark = pytest.mark.oracle

RADIUS, WALL = 0.04, 0.004
MUG = rg.Mesh.revolved(
    [(0, 0), (RADIUS, 0), (RADIUS, 0.1), (RADIUS - WALL, 0.1), (RADIUS - WALL, WALL), (0, WALL)]
)


def tip(depth: float, angle: float = 0.05) -> np.ndarray:
    """A point in the mug's wall, this deep from outside."""
    return np.array([(RADIUS - depth) * np.cos(angle), (RADIUS - depth) * np.sin(angle), 0.05])


def outward(contact: rg.Contact, point: np.ndarray) -> bool:
    return float(contact.normal[:2] @ point[:2]) < 0


@pytest.mark.parametrize("depth", [0.0014, 0.0019, 0.0021, 0.0026])
def test_a_wall_as_near_as_another_is_warned_of(depth: float) -> None:
    with pytest.warns(
        UserWarning, match=r"from one that faces the other way; say which with along= or outside=True"
    ) as w:
        contact = MUG.contact_at(tip(depth), friction=0.5)
    assert w[0].filename == __file__
    assert outward(contact, tip(depth)) == (depth < WALL / 2)


@pytest.mark.parametrize("depth", [0.0, 1e-4, 0.0012, 0.0028, 0.0039, WALL])
def test_a_wall_much_nearer_is_not(depth: float) -> None:
    assert outward(MUG.contact_at(tip(depth), friction=0.5), tip(depth)) == (depth < WALL / 2)


@given(st.floats(0, WALL), st.floats(0, 6.2))
@settings(max_examples=30, deadline=None)
def test_the_side_asked_for(depth: float, angle: float) -> None:
    point = tip(depth, angle + 0.01)
    radial = point * [1, 1, 0]
    for contact, out in (
        (MUG.contact_at(point, friction=0.5, outside=True), True),
        (MUG.contact_at(point, friction=0.5, along=-radial), True),
        (MUG.contact_at(point, friction=0.5, along=radial), False),
    ):
        assert outward(contact, point) == out
        place = contact.position + MUG.centre_of_mass
        assert np.hypot(*place[:2]) == pytest.approx(RADIUS if out else RADIUS - WALL, abs=1e-4)


@settings(max_examples=15, deadline=None)
@given(seeds)
def test_a_line_enters_where_inside_begins(seed: int) -> None:
    mesh, rng = bumpy(seed), np.random.default_rng(seed)
    point, along = mesh.sample(1, seed=seed)[0], rng.normal(size=3)
    try:
        contact = mesh.contact_at(point, friction=0.5, along=along)
    except rg.InvalidInput as error:
        says = str(error)
    else:
        says = ""
    if says:
        assert any(words in says for words in ("does not enter", "edge or corner", "away from"))
        return
    place, step = contact.position + mesh.centre_of_mass, 1e-6 * along / np.linalg.norm(along)
    assert is_inside(mesh, place + step)
    assert not is_inside(mesh, place - step)
    assert contact.normal @ along > 0


def test_wrong_sides() -> None:
    for options, says in (
        ({"along": (0, 0, 0)}, "along must be a direction"),
        ({"along": (0, 0, 1), "outside": True}, "give one of along and outside"),
        ({"along": "up"}, "along must be numbers"),
    ):
        with pytest.raises(rg.InvalidInput, match=says):
            MUG.contact_at(tip(0.001), friction=0.5, **options)
    with pytest.raises(rg.InvalidInput, match="does not enter the object"):
        MUG.contact_at([0.5, 0, 0.05], friction=0.5, along=(0, 1, 0))


# -- units --------------------------------------------------------------------------------------------------


def test_a_part_in_millimetres_taken_for_metres(tmp_path) -> None:
    rg.Mesh.box(140, 60, 30).save_stl(tmp_path / "part.stl")
    with pytest.warns(UserWarning, match="the largest side is 140, .* give scale=1e-3") as warned:
        mesh = rg.Mesh.from_file(tmp_path / "part.stl")
    assert warned[0].filename == __file__
    for scale in (1, 1e-3):  # who says it is not told
        rg.Mesh.from_file(tmp_path / "part.stl", scale=scale)
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        mesh.contact_at([0.05, 0.02, 1.1], friction=0.5)
    says = [str(each.message) for each in warned]
    assert (
        "the contact is 13.9 away from the point (0.05, 0.02, 1.1), on an object of size (140, 60, 30); "
        "if they are in different units, read the mesh with scale=" in says
    )


def test_a_point_near_the_surface_is_no_cause(tmp_path) -> None:
    rg.Mesh.box(0.14, 0.06, 0.03).save_stl(tmp_path / "part.stl")
    rg.Mesh.from_file(tmp_path / "part.stl").contact_at([0.02, 0.01, 0.018], friction=0.5)


# -- inertia ------------------------------------------------------------------------------------------------


def test_inertia_of_simple_bodies() -> None:
    a, b, c = 0.3, 0.2, 0.1
    box = rg.Mesh(rg.Mesh.box(a, b, c).vertices + np.array([5, -3, 2]), rg.Mesh.box(a, b, c).faces)
    about = box.volume / 12 * np.diag([b**2 + c**2, a**2 + c**2, a**2 + b**2])
    np.testing.assert_allclose(box.inertia, about, rtol=1e-9, atol=1e-12)
    assert rg.Outline([[9, 9], [12, 9], [12, 11], [9, 11]]).inertia == pytest.approx(6 * (9 + 4) / 12)
    assert rg.Outline.ellipse(2, 1, centre=(7, 7)).inertia == pytest.approx(2 * pi * 5 / 4)
    ring = rg.Outline.ellipse(2, 2, holes=[rg.Outline.ellipse(1, 1)])
    assert ring.inertia == pytest.approx(pi / 2 * (16 - 1))
    with pytest.raises(ValueError, match="read-only"):
        box.inertia[0, 0] = 1


@pytest.mark.parametrize("name", outlines.PARTS)
def test_inertia_of_an_outline_by_sampling(name: str) -> None:
    import shapely

    part = outlines.PARTS[name]()
    region = shapely.Polygon(part.polygon(1e-6), part.hole_polygons(1e-6))
    low, high = np.array(region.bounds).reshape(2, 2)
    n = 600
    x, y = ((np.arange(n) + 0.5) / n * (b - a) + a for a, b in zip(low, high, strict=True))
    inside = shapely.contains_xy(region, *(grid.ravel() for grid in np.meshgrid(x, y)))
    square = (np.stack(np.meshgrid(x, y)) ** 2).sum(axis=0).ravel()
    assert part.inertia == pytest.approx(square[inside].sum() * np.prod(high - low) / n**2, rel=5e-3)


@settings(max_examples=25, deadline=None)
@given(seeds, motions())
def test_inertia_turns_with_the_body(seed: int, motion) -> None:
    mesh = bumpy(seed)
    moved = motion.mesh(mesh).inertia
    expected = motion.scale**5 * motion.rotation @ mesh.inertia @ motion.rotation.T
    np.testing.assert_allclose(moved, expected, atol=1e-9 * abs(expected).max())


@pytest.mark.parametrize("name", parts.PARTS)
def test_inertia_as_trimesh_has_it(name: str) -> None:
    import trimesh

    mesh = parts.PARTS[name]()
    theirs = trimesh.Trimesh(mesh.vertices - mesh.centre_of_mass, mesh.faces, process=False).moment_inertia
    np.testing.assert_allclose(mesh.inertia, theirs, atol=1e-9 * abs(theirs).max())

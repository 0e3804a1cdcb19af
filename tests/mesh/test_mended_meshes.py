"""Bodies with slivers, holes, parts and cavities: mended where asked or sure, refused with the cause."""

import sys
import warnings
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import regrasp as rg
from mesh_files import BOX, facets, obj, text
from refusals import refused
from regrasp.mesh import parts
from regrasp.mesh.reading.cavities import windings
from solids import bumpy

pytestmark = pytest.mark.contract


def slivered(mesh: rg.Mesh, rng: np.random.Generator, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Sides of faces divided on one side only; collinear faces close the gaps, one or several on a side."""
    vertices, faces = list(mesh.vertices), [tuple(face) for face in mesh.faces]
    for f in rng.permutation(len(faces))[:count]:
        a, b, c = faces[f]
        ends = [a]
        for share in np.sort(rng.uniform(0.1, 0.9, rng.integers(1, 4))):
            vertices.append((1 - share) * vertices[a] + share * vertices[b])
            ends.append(len(vertices) - 1)
        ends.append(b)
        faces[f] = (ends[0], ends[1], c)
        faces += [(p, q, c) for p, q in pairwise(ends[1:])]
        faces += [(a, ends[k + 1], ends[k]) for k in range(1, len(ends) - 1)]  # without area
    return np.array(vertices), np.array(faces)


@pytest.mark.parametrize("seed", range(12))
def test_slivers_that_close_t_joints(tmp_path: Path, seed: int) -> None:
    rng = np.random.default_rng(seed)
    mesh = bumpy(seed) if seed % 2 else parts.bracket()
    vertices, faces = slivered(mesh, rng, 15)
    found = rg.Mesh.from_file(text(tmp_path, obj(vertices, faces), "part.obj"))
    assert found.volume == pytest.approx(mesh.volume, rel=1e-5)
    assert found.area == pytest.approx(mesh.area, rel=1e-5)
    assert "faces without area" in found.notes[0]
    # no face is left whose direction is rounding
    corners = found.vertices[found.faces]
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    heights = (
        np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / sides
    )
    assert heights.min() > 1e-6 * found.size.max()


def two(apart: float) -> tuple[np.ndarray, np.ndarray]:
    """Cubes of sides 2 and 1 with centres this far apart along x."""
    large, small = rg.Mesh.box(2, 2, 2), rg.Mesh.box(1, 1, 1)
    return np.vstack([small.vertices + np.array([apart, 0, 0]), large.vertices]), np.vstack(
        [small.faces, large.faces + 8]
    )


@pytest.mark.parametrize("apart", [1.2, 5.0, 0.1])
def test_the_largest_of_several_bodies(tmp_path: Path, apart: float) -> None:
    path = text(tmp_path, obj(*two(apart)), "part.obj")
    assert 'bodies="largest" takes the largest, bodies="fuse" unites them' in refused(rg.Mesh.from_file, path)
    found = rg.Mesh.from_file(path, bodies="largest")
    assert found.volume == pytest.approx(8)
    assert found.notes == ("kept: the largest of 2 surfaces, volume 8; left out: 1",)


@pytest.mark.parametrize(("apart", "volume"), [(1.2, 8.7), (0.1, 8.0), (1.5, 9.0), (1.0, 8.5)])
def test_bodies_fused(tmp_path: Path, apart: float, volume: float) -> None:
    pytest.importorskip("manifold3d")
    path = text(tmp_path, obj(*two(apart)), "part.obj")
    found = rg.Mesh.from_file(path, bodies="fuse")
    assert found.volume == pytest.approx(volume, rel=1e-6)
    assert found.notes == (f"fused: 2 surfaces, volume 9 in all, into one of {volume:g}",)


def test_bodies_apart_cannot_be_fused_into_one(tmp_path: Path) -> None:
    pytest.importorskip("manifold3d")
    assert "there are 2 closed surfaces" in refused(
        rg.Mesh.from_file, text(tmp_path, obj(*two(5.0)), "a.obj"), bodies="fuse"
    )


def test_fusing_without_the_extra(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "manifold3d", None)
    with pytest.raises(
        ImportError, match=r"^fusing bodies needs manifold3d: pip install 'regrasp\[meshes\]'$"
    ):
        rg.Mesh.from_file(text(tmp_path, obj(*two(1.2)), "part.obj"), bodies="fuse")


@pytest.mark.parametrize("seed", range(8))
def test_small_holes_are_closed_where_asked(tmp_path: Path, seed: int) -> None:
    rng = np.random.default_rng(seed)
    mesh = rg.Mesh.sphere(1.0, divisions=6)
    gone = [0, *rng.permutation(len(mesh.faces))[: rng.integers(1, 6)]]
    ring = np.flatnonzero((mesh.faces == mesh.faces[5, 0]).any(axis=1))  # all around a vertex
    path = text(tmp_path, obj(mesh.vertices, np.delete(mesh.faces, [*gone, *ring], axis=0)), "part.obj")
    assert "close_holes=0.05 closes holes up to a twentieth" in refused(rg.Mesh.from_file, path)
    assert "not watertight" in refused(rg.Mesh.from_file, path, close_holes=0.01)
    found = rg.Mesh.from_file(path, close_holes=0.5)
    assert found.volume == pytest.approx(mesh.volume, rel=5e-3)
    assert found.notes[0].startswith("closed: ")


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"bodies": "all"}, "bodies must be one of one, largest, fuse; got 'all'"),
        ({"bodies": None}, "bodies must be one of one, largest, fuse; got None"),
        ({"close_holes": -1}, "close_holes must be at least 0, got -1"),
        ({"close_holes": "yes"}, "close_holes must be a number, got 'yes'"),
    ],
)
def test_wrong_options(tmp_path: Path, options: dict, says: str) -> None:
    assert (
        refused(rg.Mesh.from_file, text(tmp_path, obj(BOX.vertices, BOX.faces), "a.obj"), **options) == says
    )


def test_what_was_read_is_equal_whatever_was_mended(tmp_path: Path) -> None:
    whole = rg.Mesh.from_file(text(tmp_path, obj(BOX.vertices, BOX.faces), "a.obj"))
    assert whole.notes == ()
    assert whole == BOX


@pytest.mark.parametrize("bodies", ["largest", "fuse"])
@pytest.mark.parametrize(("inner", "hollow"), [("cavity", True), ("solid", False), ("apart", False)])
def test_cavities_are_filled_with_a_warning(tmp_path, bodies: str, inner: str, hollow: bool) -> None:
    ball = rg.Mesh.sphere(1.0, divisions=3)
    small, faces = 0.5 * ball.vertices + 0.1, ball.faces
    text = facets(ball.vertices, faces)
    text += facets(small + 9 * (inner == "apart"), faces[:, ::-1] if inner == "cavity" else faces)
    path = tmp_path / "a.stl"
    path.write_text(f"solid a\n{text}endsolid a\n")
    if inner == "apart" and bodies == "fuse":
        with pytest.raises(rg.InvalidInput, match="2 closed surfaces"):
            rg.Mesh.from_file(path, bodies=bodies)
        return
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        mesh = rg.Mesh.from_file(path, bodies=bodies)
    assert mesh.volume == pytest.approx(ball.volume)
    assert [bool("filled: 1 cavity of volume" in str(w.message)) for w in caught] == [True] * hollow
    assert any("filled: 1 cavity" in note for note in mesh.notes) == hollow


def test_windings_are_whole_numbers() -> None:
    ball = rg.Mesh.sphere(1.0, divisions=3)
    points = np.random.default_rng(3).uniform(-1.5, 1.5, (40, 3))
    away = abs(np.linalg.norm(points, axis=1) - 0.97) > 0.05
    found = windings(points, ball.vertices[ball.faces])
    inside = np.linalg.norm(points, axis=1) < 0.97
    assert found[away] == pytest.approx(inside[away].astype(float), abs=1e-12)

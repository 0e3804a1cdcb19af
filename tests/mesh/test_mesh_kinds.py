"""Mesh files of every kind of fault: read where the body is clear, refused with the cause where it is not."""

import struct
import subprocess
import sys
import warnings
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import regrasp as rg
from regrasp.mesh import parts
from regrasp.mesh.reading.cavities import windings
from regrasp.mesh.reading.files import stl
from solids import bumpy, seeds

pytestmark = pytest.mark.contract

BOX = rg.Mesh.box(1, 2, 3)
SHEET = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"


def text(folder: Path, content: str | bytes, name: str) -> Path:
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def obj(vertices, faces, head: str = "") -> str:
    lines = [head, *(f"v {x!r} {y!r} {z!r}" for x, y, z in np.asarray(vertices, dtype=float).tolist())]
    return "\n".join([*lines, *("f " + " ".join(map(str, face)) for face in np.asarray(faces) + 1)]) + "\n"


def ascii_stl(mesh: rg.Mesh, title: str) -> str:
    facets = (
        "facet normal 0 0 0\nouter loop\n"
        + "".join(f"vertex {x} {y} {z}\n" for x, y, z in corners)
        + "endloop\nendfacet\n"
        for corners in mesh.vertices[mesh.faces]
    )
    return f"solid {title}\n" + "".join(facets) + f"endsolid {title}\n"


def ply(mesh: rg.Mesh, comment: str) -> str:
    head = f"ply\nformat ascii 1.0\ncomment {comment}\nelement vertex {len(mesh.vertices)}\n"
    head += "property float x\nproperty float y\nproperty float z\n"
    head += f"element face {len(mesh.faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    rows = [" ".join(map(str, row)) for row in mesh.vertices]
    return head + "\n".join([*rows, *(f"3 {a} {b} {c}" for a, b, c in mesh.faces)]) + "\n"


def refusal(call, *args, **options) -> str:
    with pytest.raises(rg.InvalidInput) as caught:
        call(*args, **options)
    assert "\n" not in str(caught.value)
    return str(caught.value)


# -- encodings, without the package that trimesh guesses them by ---------------------------------------------


def test_any_encoding_without_the_optional_decoder(tmp_path: Path) -> None:
    """In a process in which charset_normalizer and chardet cannot be imported."""
    word = "Größe in mm, naïve façade"
    for encoding in ("latin-1", "cp1252", "utf-8", "utf-8-sig", "utf-16"):
        text(tmp_path, obj(BOX.vertices, BOX.faces, f"# {word}").encode(encoding), f"{encoding}.obj")
        text(tmp_path, ascii_stl(BOX, word).encode(encoding), f"{encoding}.stl")
    for encoding in ("latin-1", "utf-8"):
        text(tmp_path, ply(BOX, word).encode(encoding), f"{encoding}.ply")
    text(tmp_path, word.encode("latin-1").ljust(80) + stl(BOX.vertices, BOX.faces)[80:], "binary.stl")
    code = (
        "import sys, pathlib\n"
        "class Blocked:\n"
        "    def find_spec(self, name, path=None, target=None):\n"
        "        if name.split('.')[0] in ('charset_normalizer', 'chardet'):\n"
        "            raise ModuleNotFoundError(f'No module named {name!r}', name=name)\n"
        "sys.meta_path.insert(0, Blocked())\n"
        "import regrasp as rg\n"
        "for path in sorted(pathlib.Path(sys.argv[1]).iterdir()):\n"
        "    print(path.name, round(rg.Mesh.from_file(path).volume, 9))\n"
    )
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", code, str(tmp_path)], capture_output=True, text=True
    )
    assert done.stderr == ""
    assert done.stdout.splitlines() == [f"{path.name} 6.0" for path in sorted(tmp_path.iterdir())]
    assert len(done.stdout.splitlines()) == 13


@settings(max_examples=20, deadline=None)
@given(seeds)
def test_relative_indices(tmp_path_factory, seed: int) -> None:
    """Vertices and faces in turns, faces by numbers from the first vertex or from the last so far."""
    rng = np.random.default_rng(seed)
    mesh, count = bumpy(seed), 0
    lines = []
    for face in mesh.faces:
        lines += [f"v {x} {y} {z}" for x, y, z in mesh.vertices[face]]
        count += 3
        places = [i + 1 if rng.integers(2) else i - count for i in range(count - 3, count)]
        lines.append(
            "f " + " ".join(f"{place}//{place}" if rng.integers(2) else f"{place}" for place in places)
        )
    found = rg.Mesh.from_file(text(tmp_path_factory.mktemp("obj"), "\n".join(lines), "part.obj"))
    assert found.volume == pytest.approx(mesh.volume, rel=1e-5)


def test_an_index_before_the_first_vertex_is_refused(tmp_path: Path) -> None:
    path = text(tmp_path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 -4\n", "part.obj")
    assert "a face names a vertex before the first, 'f -1 -2 -4'; there are 3 so far" in refusal(
        rg.Mesh.from_file, path
    )
    path = text(tmp_path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 x\n", "part.obj")
    assert "a face must be f with numbers of vertices" in refusal(rg.Mesh.from_file, path)


# -- counts and textures ------------------------------------------------------------------------------------


@given(st.integers(0, 2**32 - 1).filter(lambda count: count != 12))
def test_a_wrong_count_of_an_stl(tmp_path_factory, count: int) -> None:
    data = stl(BOX.vertices, BOX.faces)
    path = text(tmp_path_factory.mktemp("stl"), data[:80] + struct.pack("<I", count) + data[84:], "part.stl")
    assert f"its header says {count} faces, its bytes hold 12" in refusal(rg.Mesh.from_file, path)


@pytest.mark.parametrize("element", ["vertex", "face"])
@pytest.mark.parametrize("count", [10**9, 10**30])
def test_a_ply_that_claims_more_than_it_has(tmp_path: Path, element: str, count: int) -> None:
    here = {"vertex": f"element vertex {len(BOX.vertices)}\n", "face": f"element face {len(BOX.faces)}\n"}[
        element
    ]
    path = text(tmp_path, ply(BOX, "").replace(here, f"element {element} {count}\n"), "part.ply")
    says = refusal(rg.Mesh.from_file, path)
    assert "its header says" in says or "more than 1100000; simplify the mesh" in says


def test_a_texture_that_is_missing_does_not_matter(tmp_path: Path, capfd) -> None:
    assert rg.Mesh.from_file(
        text(tmp_path, ply(BOX, "TextureFile gone.png"), "part.ply")
    ).volume == pytest.approx(6)
    head = "mtllib gone.mtl\nusemtl gone"
    assert rg.Mesh.from_file(
        text(tmp_path, obj(BOX.vertices, BOX.faces, head), "part.obj")
    ).volume == pytest.approx(6)
    assert capfd.readouterr() == ("", "")


# -- slivers ------------------------------------------------------------------------------------------------


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


# -- several bodies, holes ----------------------------------------------------------------------------------


def two(apart: float) -> tuple[np.ndarray, np.ndarray]:
    """Cubes of sides 2 and 1 with centres this far apart along x."""
    large, small = rg.Mesh.box(2, 2, 2), rg.Mesh.box(1, 1, 1)
    return np.vstack([small.vertices + np.array([apart, 0, 0]), large.vertices]), np.vstack(
        [small.faces, large.faces + 8]
    )


@pytest.mark.parametrize("apart", [1.2, 5.0, 0.1])
def test_the_largest_of_several_bodies(tmp_path: Path, apart: float) -> None:
    path = text(tmp_path, obj(*two(apart)), "part.obj")
    assert 'bodies="largest" takes the largest, bodies="fuse" unites them' in refusal(rg.Mesh.from_file, path)
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
    assert "there are 2 closed surfaces" in refusal(
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
    assert "close_holes=0.05 closes holes up to a twentieth" in refusal(rg.Mesh.from_file, path)
    assert "not watertight" in refusal(rg.Mesh.from_file, path, close_holes=0.01)
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
        refusal(rg.Mesh.from_file, text(tmp_path, obj(BOX.vertices, BOX.faces), "a.obj"), **options) == says
    )


def test_what_was_read_is_equal_whatever_was_mended(tmp_path: Path) -> None:
    whole = rg.Mesh.from_file(text(tmp_path, obj(BOX.vertices, BOX.faces), "a.obj"))
    assert whole.notes == ()
    assert whole == BOX


# -- files without end --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("a.obj", SHEET + "f 1 2 3\n" * 1_200_000, "there are 1200000 faces, more than 1100000"),
        ("a.obj", "v 0 0 0\n" * 3_100_000, "there are 3100000 vertices and faces, more than 3000000"),
        ("a.obj", SHEET + "".join(f"usemtl {i}\nf 1 2 3\n" for i in range(20_000)), "more than two"),
        ("a.obj", "v 1e400 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "vertex 0 is (inf, 0, 0)"),
        ("a.obj", "v 1e200 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "the mesh must be between 1e-60 and 1e+60"),
        ("a.obj", SHEET + f"f 1 2 {10**30}\n", "a face names a vertex that is not there"),
        (
            "a.ply",
            "ply\nformat ascii 1.0\nelement vertex 3\n",
            "its header does not begin with ply or has no",
        ),
        (
            "a.stl",
            b"x" * 80 + struct.pack("<I", 2_000_000) + bytes(100),
            "says 2000000 faces, its bytes hold 2",
        ),
        ("a.stl", "solid\nfacet\nvertex a b c\nendsolid", "the file cannot be read as STL"),
    ],
    ids=range(9),
)
def test_meshes_without_end(tmp_path: Path, name: str, content: str | bytes, says: str) -> None:
    assert says in refusal(rg.Mesh.from_file, text(tmp_path, content, name))


def test_a_crowd_of_vertices_is_refused(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    soup = np.zeros(30_000, dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("unused", "<u2")])
    soup["corners"] = 1e-7 * rng.random((30_000, 3, 3))
    soup["corners"][0] = np.eye(3)
    path = text(tmp_path, b"x" * 80 + struct.pack("<I", 30_000) + soup.tobytes(), "part.stl")
    assert "of the vertices many are within" in refusal(rg.Mesh.from_file, path)


def facets(vertices: Any, faces: Any) -> str:
    """The facets of an ASCII STL."""
    lines = []
    for face in faces:
        corners = "".join(f"   vertex {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in vertices[face])
        lines.append(f" facet normal 0 0 0\n  outer loop\n{corners}  endloop\n endfacet\n")
    return "".join(lines)


@pytest.mark.parametrize("line_break", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize(
    ("first", "last"), [("solid a\n", ""), ("", "endsolid a\n"), ("", ""), ("solid\n", "endsolid\n")]
)
def test_text_without_its_first_or_last_line_is_read_and_said(tmp_path, first, last, line_break) -> None:
    box = rg.Mesh.box(1, 2, 3)
    path = tmp_path / "a.stl"
    path.write_bytes((first + facets(box.vertices, box.faces) + last).replace("\n", line_break).encode())
    read = rg.Mesh.from_file(path)
    assert read.volume == pytest.approx(6)
    assert bool(read.notes) == (not first or not last)
    assert all("mended" in note for note in read.notes)


@pytest.mark.parametrize(
    ("cut", "holds"), [(" endfacet\n", True), ("  endloop\n endfacet\n", True), ("1.5\n  endloop\n", False)]
)
def test_text_that_ends_within_a_facet(tmp_path, cut: str, holds: bool) -> None:
    box = rg.Mesh.box(1, 2, 3)
    text = facets(box.vertices, box.faces)
    path = tmp_path / "a.stl"
    path.write_text("solid a\n" + text[: text.rindex(cut)])
    if holds:
        assert rg.Mesh.from_file(path).volume == pytest.approx(6)
        return
    with pytest.raises(rg.InvalidInput, match="not watertight: 3 open edges"):
        rg.Mesh.from_file(path)
    closed = rg.Mesh.from_file(path, close_holes=2)
    assert closed.volume == pytest.approx(6)
    assert any("which is left out" in note for note in closed.notes)


@pytest.mark.parametrize(
    ("face", "words"),
    [
        ("f 0 1 2", "names a vertex that is not there, 'f 0 1 2': they are counted from 1 to 8"),
        ("f 1 2 9", "names a vertex that is not there"),
        ("f 1 2 99999999999999999999999", "names a vertex that is not there"),
        ("f -9 1 2", "names a vertex before the first"),
        ("f -1 0 2", "names a vertex that is not there"),
        ("f 1.0 2.0 3.0", "must be f with numbers of vertices"),
        ("f a b c", "must be f with numbers of vertices"),
    ],
)
def test_faces_of_other_vertices_are_refused(tmp_path, face: str, words: str) -> None:
    box = rg.Mesh.box(1, 2, 3)
    rows = ["v {:g} {:g} {:g}".format(*tuple(v)) for v in box.vertices] + [
        f"f {a} {b} {c}" for a, b, c in box.faces + 1
    ]
    path = tmp_path / "a.obj"
    path.write_text("\n".join([*rows, face]))
    with pytest.raises(rg.InvalidInput) as caught:
        rg.Mesh.from_file(path)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)
    path.write_text("\r".join(rows))
    assert rg.Mesh.from_file(path).volume == pytest.approx(6)
    path.write_text("\n".join(rows).replace(".", ","))
    with pytest.raises(rg.InvalidInput, match="with decimal commas"):
        rg.Mesh.from_file(path)


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

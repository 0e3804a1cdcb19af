"""Mesh files of every kind of fault: read where the text is clear, refused with the cause where it is not."""

import struct
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import regrasp as rg
from mesh_files import BOX, facets, obj, text
from refusals import refused
from regrasp.mesh.reading.files import stl
from solids import bumpy, seeds

pytestmark = pytest.mark.contract

SHEET = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"


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
    assert "a face names a vertex before the first, 'f -1 -2 -4'; there are 3 so far" in refused(
        rg.Mesh.from_file, path
    )
    path = text(tmp_path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 x\n", "part.obj")
    assert "a face must be f with numbers of vertices" in refused(rg.Mesh.from_file, path)


@given(st.integers(0, 2**32 - 1).filter(lambda count: count != 12))
def test_a_wrong_count_of_an_stl(tmp_path_factory, count: int) -> None:
    data = stl(BOX.vertices, BOX.faces)
    path = text(tmp_path_factory.mktemp("stl"), data[:80] + struct.pack("<I", count) + data[84:], "part.stl")
    assert f"its header says {count} faces, its bytes hold 12" in refused(rg.Mesh.from_file, path)


@pytest.mark.parametrize("element", ["vertex", "face"])
@pytest.mark.parametrize("count", [10**9, 10**30])
def test_a_ply_that_claims_more_than_it_has(tmp_path: Path, element: str, count: int) -> None:
    here = {"vertex": f"element vertex {len(BOX.vertices)}\n", "face": f"element face {len(BOX.faces)}\n"}[
        element
    ]
    path = text(tmp_path, ply(BOX, "").replace(here, f"element {element} {count}\n"), "part.ply")
    says = refused(rg.Mesh.from_file, path)
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
    assert says in refused(rg.Mesh.from_file, text(tmp_path, content, name))


def test_a_crowd_of_vertices_is_refused(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    soup = np.zeros(30_000, dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("unused", "<u2")])
    soup["corners"] = 1e-7 * rng.random((30_000, 3, 3))
    soup["corners"][0] = np.eye(3)
    path = text(tmp_path, b"x" * 80 + struct.pack("<I", 30_000) + soup.tobytes(), "part.stl")
    assert "of the vertices many are within" in refused(rg.Mesh.from_file, path)


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

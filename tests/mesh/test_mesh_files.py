"""Meshes written by the test come back from STL, OBJ and PLY; what is no solid is refused and says where."""

import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
import trimesh

import regrasp as rg
from places import ROOT
from refusals import refused
from regrasp.mesh import parts
from solids import bumpy, is_inside

pytestmark = pytest.mark.contract

BOX = rg.Mesh.box(2, 3, 4)
BRACKET = ROOT / "examples" / "bracket.stl"


def written(folder: Path, mesh: rg.Mesh, kind: str) -> Path:
    """By trimesh: ``stl_ascii`` and ``ply_ascii`` too."""
    name, _, form = kind.partition("_")
    path = folder / f"part.{name}"
    theirs = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    options = {"encoding": "ascii"} if kind == "ply_ascii" else {}
    theirs.export(path, file_type=kind if name == "stl" else name, **options)
    assert form == "" or b"vertex" in path.read_bytes()[:400]
    return path


def text(folder: Path, content: str, name: str = "part.obj") -> Path:
    (folder / name).write_text(content)
    return folder / name


def obj(mesh: rg.Mesh, first: int = 1) -> str:
    lines = [f"v {x} {y} {z}" for x, y, z in mesh.vertices]
    return "\n".join([*lines, *(f"f {a} {b} {c}" for a, b, c in mesh.faces + first)]) + "\n"


# -- what comes back --------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["stl", "stl_ascii", "obj", "ply", "ply_ascii"])
@pytest.mark.parametrize("name", ["bumpy", *parts.PARTS])
def test_a_body_comes_back(tmp_path: Path, kind: str, name: str) -> None:
    mesh = bumpy(3) if name == "bumpy" else parts.PARTS[name]()
    found = rg.Mesh.from_file(written(tmp_path, mesh, kind), smooth=mesh.smooth)
    assert (len(found.vertices), len(found.faces)) == (len(mesh.vertices), len(mesh.faces))
    near = 1e-5 * mesh.size.max()
    assert found.volume == pytest.approx(mesh.volume, rel=1e-4)
    np.testing.assert_allclose(found.centre_of_mass, mesh.centre_of_mass, atol=near)
    np.testing.assert_allclose(found.size, mesh.size, atol=near)
    points = mesh.sample(10)
    np.testing.assert_allclose(found.nearest(points), points, atol=near)
    np.testing.assert_allclose(found.normals(points), mesh.normals(points), atol=1e-2)


def test_scale_and_smoothness(tmp_path: Path) -> None:
    path = written(tmp_path, rg.Mesh.box(60, 40, 20), "stl")
    found = rg.Mesh.from_file(str(path), scale=1e-3, smooth=True, crease=0.3)
    np.testing.assert_allclose(found.size, [0.06, 0.04, 0.02])
    assert (found.smooth, found.crease) == (True, 0.3)
    assert repr(rg.Mesh.from_file(path, scale=1)) == "Mesh(12 faces, size (60, 40, 20), volume 48000)"


def test_groups_of_one_body_are_one(tmp_path: Path) -> None:
    lines = obj(BOX).splitlines()
    parted = [*lines[:8], "g one", "usemtl red", *lines[8:13], "g two", "usemtl blue", *lines[13:]]
    found = rg.Mesh.from_file(text(tmp_path, "\n".join(parted)))
    assert (len(found.vertices), len(found.faces)) == (8, 12)
    assert found.volume == pytest.approx(24)


def test_quadrilaterals_of_a_file_are_divided(tmp_path: Path) -> None:
    sides = ["f 1 2 4 3", "f 5 7 8 6", "f 1 5 6 2", "f 3 4 8 7", "f 1 3 7 5", "f 2 6 8 4"]
    path = text(tmp_path, "\n".join(obj(BOX).splitlines()[:8] + sides))
    assert rg.Mesh.from_file(path).volume == pytest.approx(24)


def test_corners_up_to_single_precision_are_one(tmp_path: Path) -> None:
    corners = BOX.vertices[BOX.faces].reshape(-1, 3)
    shaken = corners + 1e-7 * np.random.default_rng(0).uniform(-1, 1, corners.shape)
    lines = [f"v {x} {y} {z}" for x, y, z in shaken]
    lines += [f"f {i + 1} {i + 2} {i + 3}" for i in range(0, len(lines), 3)]
    found = rg.Mesh.from_file(text(tmp_path, "\n".join(lines)))
    assert len(found.vertices) == 8
    assert found.volume == pytest.approx(24, rel=1e-6)


@pytest.mark.parametrize("shift", [0.0, 10.0])
def test_what_we_write_others_read(tmp_path: Path, shift: float) -> None:
    mesh = rg.Mesh(parts.nut().vertices + shift, parts.nut().faces)
    mesh.save_stl(tmp_path / "nut.stl")
    theirs = trimesh.load_mesh(tmp_path / "nut.stl")
    assert theirs.is_watertight
    assert theirs.volume == pytest.approx(mesh.volume, rel=1e-2 if shift else 1e-6)
    raw = trimesh.load_mesh(tmp_path / "nut.stl", process=False)
    np.testing.assert_allclose(raw.triangles, mesh.vertices[mesh.faces], rtol=1e-7, atol=1e-9)


def test_the_shipped_bracket_is_what_the_code_makes() -> None:
    assert BRACKET.stat().st_size < 60_000
    shipped, made = rg.Mesh.from_file(BRACKET), parts.bracket()
    assert len(shipped.faces) == len(made.faces)
    assert shipped.volume == pytest.approx(made.volume, rel=1e-6)
    np.testing.assert_allclose(shipped.centre_of_mass, made.centre_of_mass, atol=1e-8)
    np.testing.assert_allclose(made.nearest(shipped.vertices), shipped.vertices, atol=1e-8)
    points = np.sort(made.vertices.round(6), axis=0)
    np.testing.assert_allclose(np.sort(shipped.vertices.round(6), axis=0), points, atol=2e-6)


# -- real parts, where a package that ships them is installed -----------------------------------------------


def package_files(package: str, pattern: str) -> list[Path]:
    """Data files of a package, found without importing it."""
    found = find_spec(package)
    if found is None or not found.submodule_search_locations:
        pytest.skip(f"{package} is not installed")
    return sorted(Path(found.submodule_search_locations[0]).glob(pattern))


def check_sound(mesh: rg.Mesh) -> None:
    theirs = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    assert mesh.volume == pytest.approx(theirs.volume, rel=1e-6)
    near = 1e-6 * mesh.size.max()
    np.testing.assert_allclose(mesh.centre_of_mass, theirs.center_mass, atol=near)
    for contact, point in zip(mesh.contacts(20, friction=0.5), mesh.sample(20), strict=True):
        np.testing.assert_allclose(mesh.contact_at(point, friction=0.5).position, contact.position, atol=near)
        step = near * contact.normal
        assert is_inside(mesh, point + step)
        assert not is_inside(mesh, point - step)


def test_a_real_nut() -> None:
    (path,) = package_files("pyvista", "examples/nut.ply")
    nut = rg.Mesh.from_file(path)
    check_sound(nut)
    assert sorted(nut.size) == pytest.approx([28.93, 46.04, 46.04], abs=0.01)


def test_a_drawing_of_an_ant_is_no_body() -> None:
    (path,) = package_files("pyvista", "examples/ant.ply")
    with pytest.raises(
        rg.InvalidInput, match=r"ant\.ply: there are 15 closed surfaces, apart from one another"
    ):
        rg.Mesh.from_file(path)


def test_real_tools_are_read_or_say_why_not() -> None:
    paths = package_files("metaworld", "assets/**/*.stl")
    read, refused = [], []
    for path in paths:
        try:
            read.append(rg.Mesh.from_file(path))
        except rg.InvalidInput as error:
            refused.append(str(error).removeprefix(f"{path}: "))
    assert len(read) > 80
    for mesh in read[::8]:
        check_sound(mesh)
    plainly = ("the mesh is not watertight", "there are ", "64 edges of more than two faces")
    assert [message for message in refused if not message.startswith(plainly)] == []


# -- what is refused --------------------------------------------------------------------------------------


V, F = BOX.vertices, BOX.faces
SHEET = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]])
# Seven corners of a strip with a half turn, each edge of two faces: the projective plane has one side.
ONE_SIDED = [
    (0, 1, 4), (0, 1, 5), (0, 2, 3), (0, 2, 5), (0, 3, 4),
    (1, 2, 3), (1, 2, 4), (1, 3, 5), (2, 4, 5), (3, 4, 5),
]  # fmt: skip


@pytest.mark.parametrize(
    ("vertices", "faces", "says"),
    [
        (V[:, :2], F, "vertices must have shape (any, 3), got (8, 2)"),
        ("box", F, "vertices must be numbers of shape (any, 3)"),
        (np.where(V == 1, np.nan, V), F, "vertices must be finite, vertex 4 is (nan, -1.5, -2) (4 are not)"),
        (V, [], "the mesh is empty: it has no faces"),
        (V, F.astype(float), "faces must be whole numbers of shape (any, 3), got float64 of shape (12, 3)"),
        (V, [[0, 1, 3, 2]], "faces must be triangles, shape (any, 3); got (1, 4): divide them first"),
        (V, [[0, 1, 3, 2], [1, 2, 3]], "faces must be triangles, three vertex numbers in each row"),
        (V, F + 1, "face 2 names vertex 8; there are 8, numbered from 0"),
        (V, F - 1, "face 0 names vertex -1; there are 8, numbered from 0"),
        (V, [[0, 0, 1]], "the mesh is empty: every face has two corners in one place"),
        (V, F[1:], "the mesh is not watertight: 3 open edges around 1 hole, one from (-1, -1.5, 2) to "
            "(-1, -1.5, -2); close it, since an open surface has no volume"),
        (V, F[[0, 2, 4, 5, 6, 8, 9, 10]], "the mesh is not watertight: 12 open edges around "),
        (V, [*F, *F[:1]], "3 edges of more than two faces, one from (-1, -1.5, -2) to (-1, -1.5, 2); "
            "bodies that touch there, or faces given twice?"),
        (np.vstack([V, V + 9]), np.vstack([F, F + 8]),
            "there are 2 closed surfaces, apart from one another: two pass through (-1, -1.5, -2) and "
            "(8, 7.5, 7); a mesh is one object without cavities: keep one, or unite them"),
        (np.vstack([V, V / 2]), np.vstack([F, F[:, ::-1] + 8]), "there are 2 closed surfaces"),
        (SHEET, [[0, 1, 2], [0, 2, 1]], "the mesh encloses no volume: 0, with an area of 1"),
        (V * [1, 1, 0], F, "1 edge of more than two faces, one from (1, 1.5, 0) to (-1, -1.5, 0)"),
        (np.random.default_rng(0).normal(size=(6, 3)), ONE_SIDED,
            "the surface has one side only, like a Möbius strip: it bounds no object"),
        (np.vstack([V, [[-1, -1.5, 0]]]), [*F[1:], [0, 1, 8], [1, 3, 8], [3, 0, 8]],
            "faces must have an area; 1 of 14 have none, face 11 is (-1, -1.5, -2), (-1, -1.5, 2), "
            "(-1, -1.5, 0); mend the mesh where it was made"),
    ],
)  # fmt: skip
def test_meshes_refused(vertices, faces, says: str) -> None:
    assert refused(rg.Mesh, vertices, faces).startswith(says)


def test_a_thin_sheet_is_a_body_and_a_flat_one_is_not() -> None:
    assert rg.Mesh.box(1, 1, 1e-6).volume == pytest.approx(1e-6)
    assert "the mesh encloses no volume" in refused(rg.Mesh, SHEET.repeat(1, 0), [[0, 1, 2], [2, 1, 0]])


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("part.step", "", "the kind of file must be one of .stl, .obj, .ply; got '.step'"),
        ("part", "", "the kind of file must be one of .stl, .obj, .ply; got 'none'"),
        ("part.stl", "", "the file is empty"),
        ("part.obj", "# nothing\n", "the file "),
        ("part.obj", "v 0 0 0\nv 1 0 0\n", "the file "),
        ("part.obj", "v 0 0 zero\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "the file cannot be read as OBJ: "),
        ("part.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
            "property float z\nend_header\n0 0 0\n", "the file has no faces: a mesh is made of triangles"),
        ("part.ply", "no such thing", "the file cannot be read as PLY: "),
        ("part.stl", "no such thing", "the file has no faces: a mesh is made of triangles"),
        ("part.stl", "solid part\nendsolid part\n", "the file "),
        ("part.obj", "v 0 0 0\nv 1 0 0\nv 0 1 nan\nf 1 2 3\n",
            "vertices must be finite, vertex 2 is (0, 1, nan)"),
        ("part.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
            "the mesh is not watertight: 3 open edges around 1 hole"),
        ("part.obj", "o one\n" + obj(BOX) + "o two\n" + obj(rg.Mesh(BOX.vertices + 9, BOX.faces), 9),
            "there are 2 closed surfaces"),
    ],
)  # fmt: skip
def test_files_refused(tmp_path: Path, name: str, content: str, says: str) -> None:
    path = text(tmp_path, content, name)
    assert refused(rg.Mesh.from_file, path).startswith(f"{path}: {says}")


def test_no_file_and_no_scale(tmp_path: Path) -> None:
    for path in (tmp_path / "none.stl", tmp_path):
        assert refused(rg.Mesh.from_file, path) == f"{path}: expected a file with a mesh, found none"
    with pytest.raises(rg.InvalidInput, match=r"^scale must be greater than 0, got 0$"):
        rg.Mesh.from_file(tmp_path / "none.stl", scale=0)


@pytest.mark.parametrize("kind", ["stl", "obj", "ply"])
def test_without_the_extra(tmp_path: Path, monkeypatch, kind: str) -> None:
    path = written(tmp_path, BOX, kind)
    for module in [name for name in sys.modules if name.split(".")[0] == "trimesh"]:
        monkeypatch.setitem(sys.modules, module, None)
    message = rf"^reading {kind.upper()} needs trimesh: pip install 'regrasp\[meshes\]'$"
    with pytest.raises(ImportError, match=message):
        rg.Mesh.from_file(path)


def test_what_another_library_logs_is_not_printed(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "damaged.stl"
    path.write_text(
        "solid x\nfacet normal 0 0 oops\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
    )
    with pytest.raises(rg.InvalidInput):
        rg.Mesh.from_file(path)
    assert capfd.readouterr() == ("", "")

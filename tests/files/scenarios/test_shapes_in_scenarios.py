"""Every option of drawings and meshes stands in scenarios, does there what it "
"does in Python, and needs a file."""

import inspect
import struct
from pathlib import Path
from typing import get_args

import numpy as np
import pytest

import regrasp as rg
from regrasp.files.scenarios.object_entry import ObjectEntry
from regrasp.files.scenarios.regrasp import OutlineEntry
from regrasp.outline.drawing import UNITS
from scenarios import regrasp

pytestmark = pytest.mark.contract

DRAWING = """<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="60mm" viewBox="0 0 120 60">
<g id="cut"><ellipse cx="60" cy="30" rx="60" ry="30"/></g>
<g id="other"><rect x="50" y="20" width="10" height="10"/></g>
</svg>"""


def outline_of(folder: Path, **keys: object) -> rg.Outline:
    return OutlineEntry.model_validate({"file": "a.svg", **keys}, context={"folder": folder}).value


def object_of(folder: Path, **keys: object) -> rg.Mesh:
    return ObjectEntry.model_validate({"mesh": "a.stl", **keys}, context={"folder": folder}).value


def two_balls(path: Path) -> None:
    ball = rg.Mesh.sphere(1.0, divisions=3)
    parts = [ball.vertices[ball.faces], 0.5 * ball.vertices[ball.faces] + [1.2, 0, 0]]
    rows = [struct.pack("<12fH", 0, 0, 0, *corners.ravel(), 0) for part in parts for corners in part]
    path.write_bytes(b" " * 80 + struct.pack("<I", len(rows)) + b"".join(rows))


def test_drawings(tmp_path: Path) -> None:
    path = tmp_path / "a.svg"
    path.write_text(DRAWING)
    for keys in (
        {},
        {"layers": ["cut"]},
        {"unit": "m"},
        {"unit": "cm", "layers": ["cut"]},
        {"tolerance": 2.0},
    ):
        assert outline_of(tmp_path, **keys) == rg.Outline.from_file(path, **keys)
    whole, cut = outline_of(tmp_path, unit="m"), outline_of(tmp_path, unit="m", layers=["cut"])
    assert cut.area == pytest.approx(np.pi * 0.06 * 0.03, rel=1e-3)
    assert cut.area - whole.area == pytest.approx(1e-4, rel=1e-3)


def test_meshes(tmp_path: Path) -> None:
    path = tmp_path / "a.stl"
    two_balls(path)
    for keys in (
        {"bodies": "largest"},
        {"bodies": "fuse"},
        {"bodies": "largest", "smooth": True, "scale": 2.0},
    ):
        assert object_of(tmp_path, **keys) == rg.Mesh.from_file(path, **keys)
    rounded = object_of(tmp_path, bodies="largest", smooth=True, crease_degrees=60.0, close_holes=0.1)
    assert rounded.crease == pytest.approx(np.radians(60))
    with pytest.raises(ValueError, match='bodies="largest" takes the largest'):
        object_of(tmp_path)


def test_every_option_of_files_is_a_key() -> None:
    for reader, entry, named in (
        (rg.Outline.from_file, OutlineEntry, {}),
        (rg.Mesh.from_file, ObjectEntry, {"crease": "crease_degrees"}),
    ):
        options = [p.name for p in inspect.signature(reader).parameters.values() if p.kind is p.KEYWORD_ONLY]
        assert {named.get(option, option) for option in options} <= entry.model_fields.keys()
    assert set(get_args(get_args(OutlineEntry.model_fields["unit"].annotation)[0])) == set(UNITS)


@pytest.mark.parametrize(
    ("key", "value"), [("scale", 2.0), ("unit", "m"), ("layers", ["a"]), ("tolerance", 0.1)]
)
def test_options_of_drawings_need_one(key: str, value: object) -> None:
    with pytest.raises(ValueError, match=f"{key} goes with file, found part"):
        OutlineEntry.model_validate({"part": "gear", key: value})


@pytest.mark.parametrize(
    ("key", "value"),
    [("scale", 2.0), ("smooth", True), ("crease_degrees", 10.0), ("bodies", "fuse"), ("close_holes", 0.1)],
)
def test_options_of_meshes_need_one(key: str, value: object) -> None:
    with pytest.raises(ValueError, match=f"{key} goes with mesh, found part"):
        ObjectEntry.model_validate({"part": "bracket", key: value})


def test_what_reading_has_mended_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    two_balls(tmp_path / "a.stl")
    grips = "".join(
        f'[[contacts]]\nname = "F{k}"\nposition = {[round(float(x), 6) for x in r]}\nfriction = 0.8\n'
        for k, r in enumerate(0.97 * np.array([[1, 1, 1], [-1, -1, 1], [-1, 1, -1], [1, -1, -1]]) / 3**0.5)
    )
    ends = 'objective = "effort"\nwhole_objective = "effort"'
    task = f'[task]\nkind = "removal"\ncontact = "F3"\n{ends}\nrate = 20.0\n'
    solid = '[object]\nmesh = "a.stl"\nbodies = "largest"\nsmooth = true\n[load]\nforce = [0.0, 0.0, -1.0]\n'
    (tmp_path / "s.toml").write_text(f"{solid}{grips}{task}")
    status, out, err = regrasp(capsys, "plan", tmp_path / "s.toml", "-o", tmp_path / "out", "--no-figures")
    assert (status, err) == (0, "")
    assert "kept: the largest of 2 surfaces" in out

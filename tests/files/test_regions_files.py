"""Files of contact regions: read back equal, a touched one refused, and a false one that is signed, too."""

import json
import re
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import regrasp as rg
from refusals import refusal
from regrasp.files import read_regions, write_regions
from scenarios import regrasp
from values import WEIGHT_IN_PLANE, on_faces

pytestmark = pytest.mark.contract

SQUARE = rg.Outline([[0, 0], [4, 0], [4, 3], [0, 3]])
ELLIPSE = rg.Outline.ellipse(2, 1)


def around(shape: rg.Outline, *places: float) -> rg.ContactRegions:
    return rg.contact_regions(
        shape, rg.Grasp(shape.contact_at(s * shape.length, friction=0.6) for s in places), WEIGHT_IN_PLANE
    )


MADE = {
    "polygon": lambda: around(SQUARE, 0.1, 0.2),
    "curve": lambda: around(ELLIPSE, 0.7, 0.8),
    "faces": on_faces,
}


def signed(data: dict[str, Any]) -> dict[str, Any]:
    """Data with a digest that fits."""
    given = {k: v for k, v in data.items() if k not in ("format", "version", "digest")}
    return data | {"digest": sha256(repr(given).encode()).hexdigest()}


@pytest.mark.parametrize("kind", MADE)
def test_regions_come_back_equal_and_verify(
    kind: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "regions.json"
    regions = MADE[kind]()
    write_regions(regions, file)
    again = read_regions(file)
    assert again == regions
    assert again.digest == regions.digest
    assert rg.verify(again).ok
    status, out, err = regrasp(capsys, "verify", str(file))
    assert (status, err) == (0, "")
    assert str(regions) in out
    data = json.loads(file.read_text(encoding="utf-8"))
    assert signed(data) == data


def numbers_in(data: Any) -> list[tuple[list[Any] | dict[str, Any], Any]]:
    """Where in plain data a number stands."""
    pairs = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    found = []
    for key, value in pairs:
        found += [(data, key)] if isinstance(value, (int, float)) else numbers_in(value)
    return found


@pytest.mark.parametrize("kind", MADE)
def test_no_number_can_be_touched(kind: str) -> None:
    regions = MADE[kind]()
    data = regions.to_dict()
    places = numbers_in(data)
    assert len(places) > 50
    rng, again, refused = np.random.default_rng(6), list[Any](), 0
    for number in rng.choice(len(places), min(60, len(places)), replace=False):
        table, key = places[number]
        kept = table[key]
        table[key] = kept * (1 + 1e-15) + 1e-300 if isinstance(kept, float) else kept + 1
        said = refusal(lambda: again.append(type(regions).from_dict(data)))
        refused += said is not None
        table[key] = kept
    assert all(each == regions for each in again)  # normals of any length are the same
    assert refused > 40


def test_signed_lies_are_read_and_do_not_verify(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "regions.json"
    flat, solid = MADE["polygon"]().to_dict(), on_faces().to_dict()
    for form, data, change, words in (
        ("regrasp regions", flat, {"half_width": 2 * flat["half_width"]}, "less than the half width"),
        ("regrasp regions", flat, {"max_force": 0.5 * flat["max_force"]}, "above"),
        ("regrasp regions", flat, {"corners": flat["corners"][1:]}, "missing"),
        ("regrasp face regions", solid, {"radius": 2 * max(solid["radii"])}, "above that of one"),
        ("regrasp face regions", solid, {"radii": [2 * r for r in solid["radii"]]}, "polygon"),
    ):
        file.write_text(json.dumps(signed({"format": form, "version": 1} | data | change)))
        assert words in str(rg.verify(read_regions(file)))
        status, _, err = regrasp(capsys, "verify", str(file))
        assert status == 1
        assert words in err


def test_what_is_no_file_of_regions_is_refused_in_one_line(tmp_path: Path) -> None:
    file = tmp_path / "regions.json"
    data = {"format": "regrasp regions", "version": 1} | MADE["polygon"]().to_dict()
    for change, words in (
        ({"version": True}, "version 1"),
        ({"version": 2}, "version 1"),
        ({"format": "regrasp plan"}, "not regions of format"),
        ({"format": ["regrasp regions"]}, "not regions of format"),
        ({"more": 1}, "unknown key 'more'"),
        ({"arcs": [[0, 1]]}, "arcs"),
        ({"corners": 3}, "corners must be a list"),
        ({"half_width": -1.0}, "half_width"),
        ({"shape": {"vertices": [[0, 0], [1, 1]]}}, "three"),
        ({"grasp": on_faces().grasp.to_dict()}, "in the plane"),
        ({"digest": "none"}, "digest"),
    ):
        file.write_text(json.dumps(data | change))
        said = refusal(lambda: read_regions(file))
        assert said is not None
        assert re.match(rf"{re.escape(str(file))}: .*{words}", str(said)), said
        assert "\n" not in str(said)
    solid = {"format": "regrasp face regions", "version": 1} | on_faces().to_dict()
    for change, words in (
        ({"shape": data["shape"]}, "a mesh"),
        ({"forces": [[0.0]]}, "forces"),
        ({"patches": [[0.0, 0.0, 0.0]]}, "patches"),
    ):
        file.write_text(json.dumps(solid | change))
        assert words in str(refusal(lambda: read_regions(file)))
    assert "write_regions writes a ContactRegions or a FaceRegions" in str(
        refusal(lambda: write_regions(3, file))  # type: ignore[arg-type]
    )

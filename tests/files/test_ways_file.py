"""Ways of fingers and their shape in a file: read back bit-equal, refused where they are no ways."""

import json
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import regrasp as rg
from executed_plans import bracket, lifted, removal
from regrasp.files import read_motions, read_ways, write_motions, write_ways
from regrasp.motions import Motions, plan_motions
from regrasp.verification import verify_motion_rows, verify_motions

pytestmark = pytest.mark.contract

ELLIPSE = rg.Outline.ellipse(0.04, 0.02, holes=[[[0, 0], [0.004, 0], [0, 0.004]]])


@cache
def planar() -> tuple[Motions, rg.Outline]:
    plan = rg.plan_regrasp(
        ELLIPSE,
        *(
            rg.Grasp(ELLIPSE.contact_at(p * ELLIPSE.length, friction=0.5) for p in places)
            for places in ((0.02, 0.35, 0.7), (0.2, 0.5, 0.85))
        ),
        rg.Wrench([0, -3.0]),
        friction=0.5,
    )
    return plan_motions(plan, ELLIPSE, tip_radius=0.003, clearance=0.002), ELLIPSE


@cache
def spatial() -> tuple[Motions, rg.Mesh]:
    solid = bracket()[0]
    return plan_motions(lifted(), solid, tip_radius=0.002, clearance=0.001, capsules=[0, 0, 0.05]), solid


@pytest.mark.parametrize("made", [planar, spatial])
def test_ways_read_back_bit_equal_and_are_judged(made: Callable[[], Any], tmp_path: Path) -> None:
    motions, shape = made()
    file = tmp_path / "motions.json"
    write_ways(motions, shape, file)
    read = read_ways(file, motions.plan)
    assert read.motions == motions
    assert read.shape == shape
    assert verify_motions(*read) == verify_motions(motions, shape)
    assert verify_motions(*read).ok
    write_ways(*read, tmp_path / "again.json")
    assert (tmp_path / "again.json").read_bytes() == file.read_bytes()


def test_rows_are_compared_with_their_ways(tmp_path: Path) -> None:
    motions, _ = planar()
    write_motions(motions, tmp_path / "motions.csv", rate=200.0)
    rows = read_motions(tmp_path / "motions.csv", motions.plan)
    assert verify_motion_rows(motions.plan, rows, motions).ok
    aside = rows._replace(positions=rows.positions + np.array([1e-6, 0]))
    assert "off its way at" in str(verify_motion_rows(motions.plan, aside, motions))
    longer = rows._replace(times=rows.times * 1.01)
    assert "the ways" in str(verify_motion_rows(motions.plan, longer, motions))


def through(data: dict[str, Any]) -> None:
    """A way across the object."""
    for motion in data["motions"]:
        motion["points"], motion["cuts"] = [motion["points"][0], motion["points"][-1]], []


def other_shape(data: dict[str, Any]) -> None:
    data["shape"] = {"outline": rg.Outline.ellipse(0.044, 0.022).to_dict()}


@pytest.mark.parametrize(
    ("change", "said"), [(through, "is in the object by"), (other_shape, "is in the object by")]
)
def test_ways_that_do_not_keep_clear_are_seen(change: Any, said: str, tmp_path: Path) -> None:
    motions, shape = planar()
    file = tmp_path / "motions.json"
    write_ways(motions, shape, file)
    data = json.loads(file.read_text())
    change(data)
    file.write_text(json.dumps(data))
    verdict = verify_motions(*read_ways(file, motions.plan))
    assert said in str(verdict)


def put(*keys: Any, value: Any) -> Callable[[dict[str, Any]], None]:
    def change(data: Any) -> None:
        for key in keys[:-1]:
            data = data[key]
        data[keys[-1]] = value

    return change


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (put("format", value="regrasp plan"), 'expected ways of fingers with "format"'),
        (put("version", value=2), "version: expected 1, got 2"),
        (put("motions", 0, "step", value=99), r"motions\[0\]: the plan has \d steps and 3 fingers"),
        (put("motions", 0, "finger", value=3), r"motions\[0\]: the plan has \d steps and 3 fingers"),
        (put("motions", 0, "origin", value="X"), "the plan has no contact 'X'"),
        (put("motions", 0, "duration", value=0.0), "duration: expected a number greater than 0"),
        (put("motions", 0, "start", value=float("nan")), "start: expected a finite number"),
        (put("motions", 0, "points", value=[[0.0, 0.0], [0.0, 0.0]]), "no two in a row alike"),
        (put("motions", 0, "cuts", value=[0.1]), "cuts"),
        (put("tips", value=[[[0.0, 0.0]]]), "tips must have shape"),
        (put("contacts", 0, value=[True]), "contacts: expected"),
        (put("capsules", 0, value=[1e9, 0.0]), "capsules: at most"),
        (put("shape", value={}), "shape must have either outline or mesh"),
        (put("shape", "outline", "ellipse", value=[1.0, -1.0]), "must be greater than 0"),
    ],
)
def test_what_is_no_ways_is_refused(change: Any, said: str, tmp_path: Path) -> None:
    motions, shape = planar()
    file = tmp_path / "motions.json"
    write_ways(motions, shape, file)
    data = json.loads(file.read_text())
    change(data)
    file.write_text(json.dumps(data))
    with pytest.raises(rg.InvalidInput, match=said) as raised:
        read_ways(file, motions.plan)
    assert str(raised.value).startswith(f"{file}: ")


def test_ways_of_another_plan_and_what_is_none_are_refused(tmp_path: Path) -> None:
    motions, shape = planar()
    write_ways(motions, shape, tmp_path / "motions.json")
    with pytest.raises(rg.InvalidInput, match="tips must have shape"):
        read_ways(tmp_path / "motions.json", removal())
    with pytest.raises(rg.InvalidInput, match="write_ways needs motions, got 3"):
        write_ways(3, shape, tmp_path / "x.json")  # type: ignore[arg-type]
    with pytest.raises(rg.InvalidInput, match="shape must be an Outline or a Mesh, got 3"):
        write_ways(motions, 3, tmp_path / "x.json")  # type: ignore[arg-type]

"""Files of chosen grasps: as large as searches may be, in lines, and nothing that would not be read."""

from dataclasses import replace
from math import nan
from pathlib import Path

import pytest

import regrasp as rg
from regrasp.files import read_plan, write_plan

pytestmark = pytest.mark.oracle

BOX = rg.Outline([(-2, -1), (2, -1), (2, 1), (-2, 1)])
CHOSEN = rg.choose_grasp(BOX, 2, rg.Wrench([0.1, -1]), friction=0.5)


def test_a_number_takes_no_line_of_its_own(tmp_path: Path) -> None:
    """200,000 boxes took 78 MB with each number on its own line, and were not read."""
    write_plan(CHOSEN, tmp_path / "plan.json")
    text = (tmp_path / "plan.json").read_text()
    assert len(text.splitlines()) < 60
    assert text.startswith('{\n "format": "regrasp plan",\n "version": 1,\n "kind": "grasp",\n')
    read = read_plan(tmp_path / "plan.json")
    assert read.to_dict() == CHOSEN.to_dict()
    assert rg.verify(read).ok


def test_what_would_not_be_read_is_not_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "plan.json"
    write_plan(CHOSEN, file)
    size = file.stat().st_size
    for most, fits in ((size, True), (size - 2, False)):  # the last line ends with a break
        monkeypatch.setattr("regrasp.files.plans.plan_file.MOST_BYTES", most)
        file.unlink(missing_ok=True)
        if fits:
            write_plan(CHOSEN, file)
            continue
        with pytest.raises(
            rg.InvalidInput, match=r"plan.json: with a proof of \d+ boxes .* fewer most_boxes"
        ):
            write_plan(CHOSEN, file)
        assert list(tmp_path.iterdir()) == []


def test_numbers_are_finite(tmp_path: Path) -> None:
    with pytest.raises(rg.InvalidInput, match=r"^[^\n]*value: expected finite numbers$"):
        write_plan(replace(CHOSEN, value=nan), tmp_path / "plan.json")
    assert list(tmp_path.iterdir()) == []

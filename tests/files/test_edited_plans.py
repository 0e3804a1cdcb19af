"""Saved plans with random edits: nothing false verifies, nothing true does not, nothing else is raised."""

import sys
from dataclasses import replace
from math import inf
from pathlib import Path
from random import Random

import pytest

from places import ROOT

pytestmark = pytest.mark.oracle

sys.path.append(str(ROOT / "benchmarks" / "files"))
KINDS = (
    "removal", "removal, linear limits", "turn of soft fingers", "grasp, peak", "grasp, effort",
    "set-points, removal",
)  # fmt: skip


def some(folder: Path):
    """A few kinds of plans, those that are made in no time."""
    import hostile_cases as given

    for name in KINDS:
        if name in given.PLANS:
            yield given.of_plan(name, given.PLANS[name](), folder)
        elif name in given.CHOSEN:
            yield given.of_choice(name, given.CHOSEN[name](), folder)
        else:
            yield given.of_setpoints(name, given.PLANS["removal"](), folder)
    yield given.regions(folder)
    yield given.of_state("state in space", given.STATES["state in space"]())
    import hostile_ways as ways

    yield ways.of_cut("cut", ways.contacts_cut(min_distance=5.0), folder)
    yield ways.of_cut("cut, outline", ways.outline_cut(max_force=4.0, min_normal=0.5), folder)
    yield ways.of_motions("motions", ways.motions(), folder)


def test_no_edit_of_a_plan_lies_or_breaks_anything(tmp_path: Path) -> None:
    from hostile_files import tried

    for case in some(tmp_path):
        found = tried(case, 60, Random(f"a {case.name}"), inf)
        assert found["bad"] == [], case.name
        assert found["edits"] == 60
        assert found.get("refused", 0) + found.get("not verified", 0) > 10
        assert found.get("verified", 0) > 2, case.name


def test_a_verifier_that_says_yes_to_everything_is_found_out(tmp_path: Path) -> None:
    from hostile_files import tried

    for case in some(tmp_path):
        found = tried(replace(case, told=lambda data: ""), 60, Random(f"b {case.name}"), inf)
        assert found.get("lies", 0) > 3, case.name


def test_a_verifier_that_says_no_or_breaks_is_found_out(tmp_path: Path) -> None:
    from hostile_files import tried

    case = next(some(tmp_path))
    said = iter([""] + ["never"] * 99)
    found = tried(replace(case, told=lambda data: next(said)), 60, Random(1), inf)
    assert found["false alarms"] > 3
    said = iter([""])
    found = tried(replace(case, told=lambda data: next(said)), 9, Random(1), inf)
    assert found["tracebacks"] == 9
    assert found["bad"][0]["said"].startswith("StopIteration")


def test_cuts_that_no_numbers_can_save() -> None:
    import regrasp as rg
    from hostile_ways import outline_cut

    free, limited = outline_cut(), outline_cut(max_force=4.0, min_normal=0.5)
    for cut in (free, limited):
        for name in ("force", "turned"):
            assert "within a turn of" in rg.verify(replace(cut, **{name: [1e308, 1.0]})).asked
        vertices = cut.vertices.copy()
        vertices[1] = vertices[0]
        assert rg.verify(replace(cut, vertices=vertices)).violations == (
            "a side of the outline has no length",
        )
        vertices = cut.vertices.copy()
        vertices[-1] = vertices[0]
        assert rg.verify(replace(cut, vertices=vertices)).violations == (
            "a side of the outline has no length",
        )
        for factor, fine in ((1 + 1e-13, True), (1 - 1e-13, True), (1 + 1e-11, False), (1 - 1e-11, False)):
            found = str(rg.verify(replace(cut, turned=factor * cut.turned)))
            assert ("the loads at the ends of the turn are of different sizes" in found) == (
                cut is limited and not fine
            )

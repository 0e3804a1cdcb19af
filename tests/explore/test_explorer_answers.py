"""What the explorer says is what regrasp says; what it copies says the same again."""

import contextlib
import io
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import regrasp as rg
from regrasp.errors import InvalidInput
from regrasp.explore.answer import answer
from regrasp.explore.copies import as_python, as_scenario
from regrasp.explore.question import Question
from regrasp.explore.start import of_shape, start_of
from regrasp.files import parse_scenario, plan_scenario
from regrasp.outline.parts import PARTS

pytestmark = pytest.mark.contract

EXAMPLES = Path(__file__).parents[2] / "examples"


def test_forces_margins_and_locus_are_the_planners() -> None:
    asked = start_of().question
    found = answer(asked)
    plan = rg.plan_removal(asked.grasp, "P3", load=asked.wrench)
    np.testing.assert_allclose(
        found["plan"]["forces"], plan.forces(np.array(found["plan"]["times"])), rtol=1e-6
    )
    low, high = rg.EquilibriumLocus(asked.grasp.without("P3"), asked.wrench).interval
    assert found["locus"]["interval"] == pytest.approx([low, high], rel=1e-6)
    assert found["holds"]
    assert found["plan"]["margins"][-1][2] is None, "the finger that left has no angle"


@pytest.mark.parametrize("share", [-1.0, 0.0, 0.3, 1.0, 2.0])
def test_a_squeeze_is_kept_on_the_locus(share: float) -> None:
    asked = start_of().question
    low, high = answer(asked)["locus"]["interval"]
    found = answer(replace(asked, squeeze=low + share * (high - low)))
    assert found["holds"]
    assert found["locus"]["chosen"] == pytest.approx(low + np.clip(share, 0, 1) * (high - low), rel=1e-5)


def test_where_nothing_holds_the_escape_is_a_proof() -> None:
    asked = replace(start_of().question, leaves="P1")
    found = answer(asked)
    assert not found["holds"]
    assert found["escape"]["proof"]
    assert found["escape"]["names"] == ["P2", "P3"]
    assert len(found["state"]["forces"]) == 3, "what holds before is shown"


@pytest.mark.parametrize("part", [*PARTS, None])
def test_every_beginning_holds_and_stays_where_it_was_put(part: str | None) -> None:
    start = start_of(part)
    found = answer(start.question, start.shape)
    assert found["holds"], found["says"]
    again = answer(Question.of(start.question.to_dict() | {"contacts": found["contacts"]}), start.shape)
    for key in ("contacts", "says"):
        assert again[key] == found[key]


def test_everybody_stays() -> None:
    found = answer(replace(start_of().question, leaves=None, objective="effort"))
    assert found["holds"]
    assert "plan" not in found
    assert found["says"].startswith("Held: the least angle margin is")


@pytest.mark.parametrize("part", ["solid-bracket", "solid-nut"])
def test_solids_are_held_and_copied(part: str) -> None:
    start = start_of(part)
    found = answer(start.question, start.shape)
    assert found["holds"], found["says"]
    names: dict[str, object] = {}
    with contextlib.redirect_stdout(io.StringIO()):
        exec(as_python(start.question, start.shape), names)
    plan = plan_scenario(parse_scenario(as_scenario(start.question, start.shape)))
    for made in (names["plan"], plan):
        np.testing.assert_allclose(
            made.forces([0, 1.0]), np.array(found["plan"]["forces"])[[0, -1]], rtol=1e-5, atol=1e-6
        )


def test_where_a_solid_escapes_the_screw_is_drawn() -> None:
    start = start_of("solid-bracket")
    slippery = tuple(c | {"friction": 0.01} for c in start.question.contacts)
    found = answer(replace(start.question, contacts=slippery), start.shape)
    assert not found["holds"]
    assert np.array(found["escape"]["velocities"]).shape[1] == 3
    assert len(found["escape"]["axis"][1]) == 3


@pytest.mark.parametrize("leaves", ["P3", None])
@pytest.mark.parametrize("part", ["cam", None])
def test_copies_say_the_same(part: str | None, leaves: str | None) -> None:
    start = start_of(part)
    contacts = [c | {"name": f'{c["name"]} "é\\'} for c in start.question.contacts]
    asked = replace(start.question, contacts=tuple(contacts), leaves=leaves and f'{leaves} "é\\')
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        exec(as_python(asked, start.shape), {})
    assert ("verified" if leaves else "P1") in said.getvalue()
    plan = plan_scenario(parse_scenario(as_scenario(asked, start.shape)))
    assert plan.contact == 'P3 "é\\'
    if leaves:
        shown = answer(asked, start.shape)["plan"]["forces"]
        np.testing.assert_allclose(
            plan.forces([0, 0.5, 1.0]), np.array(shown)[[0, 20, 40]], rtol=1e-5, atol=1e-6
        )


def test_a_chosen_squeeze_is_copied() -> None:
    asked = replace(start_of().question, squeeze=1.9)
    names: dict[str, object] = {}
    with contextlib.redirect_stdout(io.StringIO()):
        exec(as_python(asked), names)
    end = names["plan"].end  # type: ignore[attr-defined]
    np.testing.assert_allclose(end.forces, answer(asked)["plan"]["forces"][-1], rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize(
    "name",
    [
        "paper",
        "addition",
        "exchange",
        "rotation",
        "regrasp",
        "space-removal",
        "space-regrasp",
        "space-rotation",
    ],
)
def test_scenarios_open(name: str) -> None:
    start = start_of(str(EXAMPLES / f"{name}.toml"))
    assert answer(start.question, start.shape)["contacts"]


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ("bracket.step", "expected a scenario"),
        ("solid-gear", "expected a scenario"),
        ("none.toml", "none.toml"),
    ],
)
def test_other_beginnings_are_refused(given: str, words: str) -> None:
    with pytest.raises(InvalidInput, match=words):
        start_of(str(EXAMPLES / given))


def test_an_outline_on_which_nothing_holds_is_opened_all_the_same() -> None:
    sliver = rg.Outline([[0, 0], [100, 0], [100, 1e-3], [0, 1e-3]])
    assert of_shape(sliver).question.leaves == "P3"

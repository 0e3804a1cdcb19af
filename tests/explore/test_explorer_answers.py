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
from regrasp.explore.start import of_outline, start_of
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
    found = answer(start.question, start.outline)
    assert found["holds"], found["says"]
    again = answer(Question.of(start.question.to_dict() | {"contacts": found["contacts"]}), start.outline)
    for key in ("contacts", "says"):
        assert again[key] == found[key]


def test_everybody_stays() -> None:
    found = answer(replace(start_of().question, leaves=None, objective="effort"))
    assert found["holds"]
    assert "plan" not in found
    assert found["says"].startswith("Held: the least angle margin is")


@pytest.mark.parametrize("leaves", ["P3", None])
@pytest.mark.parametrize("part", ["cam", None])
def test_copies_say_the_same(part: str | None, leaves: str | None) -> None:
    start = start_of(part)
    contacts = [c | {"name": f'{c["name"]} "é\\'} for c in start.question.contacts]
    asked = replace(start.question, contacts=tuple(contacts), leaves=leaves and f'{leaves} "é\\')
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        exec(as_python(asked, start.outline), {})
    assert ("verified" if leaves else "P1") in said.getvalue()
    plan = plan_scenario(parse_scenario(as_scenario(asked, start.outline)))
    assert plan.contact == 'P3 "é\\'
    if leaves:
        shown = answer(asked, start.outline)["plan"]["forces"]
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


@pytest.mark.parametrize("name", ["paper", "addition", "exchange", "rotation", "regrasp"])
def test_planar_scenarios_open(name: str) -> None:
    assert answer(*_asked(str(EXAMPLES / f"{name}.toml")))["contacts"]


def _asked(given: str) -> tuple[Question, rg.Outline | None]:
    start = start_of(given)
    return start.question, start.outline


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ("space-removal.toml", "the explorer works in the plane"),
        ("space-regrasp.toml", "the explorer works in the plane"),
        ("bracket.stl", "expected a scenario"),
        ("none.toml", "none.toml"),
    ],
)
def test_other_beginnings_are_refused(given: str, words: str) -> None:
    with pytest.raises(InvalidInput, match=words):
        start_of(str(EXAMPLES / given))


def test_an_outline_on_which_nothing_holds_is_opened_all_the_same() -> None:
    sliver = rg.Outline([[0, 0], [100, 0], [100, 1e-3], [0, 1e-3]])
    assert of_outline(sliver).question.leaves == "P3"

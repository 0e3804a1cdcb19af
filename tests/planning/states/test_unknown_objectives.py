"""An objective that nobody knows is computed as what it is, or refused by name; it never becomes another."""

import ast
import inspect
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pytest

import regrasp as rg
from paper import GRASP, LOAD
from regrasp.explore.question import Question
from regrasp.files import read_plan, write_plan
from regrasp.planning.states.objectives import ConvexObjective, Objective
from regrasp.planning.states.objectives.known import OBJECTIVES
from regrasp.plots import html
from scenarios import edited
from scenarios import regrasp as command
from wrong_calls import ROOMS, rows, rows_of
from wrong_calls.row import Row

pytestmark = pytest.mark.contract

OWN = rg.ForceCost("careful")


class Stranger(ConvexObjective):
    """A program that no table of the package has heard of: the least sum of squares, twice."""

    def of_contacts(self, forces: Any, grasp: rg.Grasp) -> Any:
        return 2 * (forces**2).sum(axis=-1)

    def squares(self, grasp: rg.Grasp) -> Any:
        return np.full(len(grasp), 2.0)

    def scale(self, unit: float) -> float:
        return unit**2


STRANGER = Stranger("strange", "least double sum of squares", "$2|f|^2$", "sum", "N^2")
WORDS = ("objective", "whole_objective", "start_objective", "path_objective")
ANEW: dict[str, dict[str, Any]] = {
    "plan_removal": {"start": GRASP, "load": LOAD},
    "plan_addition": {"start": GRASP.without("P3"), "load": LOAD},
    "plan_hold": {"start": GRASP, "load": LOAD},
    "plan_exchange": {"start": GRASP, "load": LOAD},
}
"""With grasps in place of states, so that nothing is given that an objective would have chosen."""


def asking(rows: dict[str, Row]) -> Iterator[tuple[str, str]]:
    """Every public call that takes an objective, with each of its parameters that does."""
    for name, row in rows.items():
        if name.partition(".")[0] not in ("SampledPath", "StraightPath", "TurningPath", "Record", "Choice"):
            for word in WORDS:
                if word in inspect.signature(row.call).parameters:
                    yield name, word


def called(row: Row, **more: Any) -> Any:
    given = row.right | ANEW.get(row.call.__name__, {}) | more
    positional = [
        given.pop(name)
        for name, parameter in inspect.signature(row.call).parameters.items()
        if parameter.kind is inspect.Parameter.POSITIONAL_ONLY and name in given
    ]
    return row.call(*positional, **given)


@pytest.mark.parametrize("room", ROOMS, ids=lambda room: room.__name__.rpartition(".")[2])
def test_every_call_answers_for_what_it_was_asked(room: ModuleType) -> None:
    found = rows_of(room)
    for name, word in asking(found):
        for wrong in ("angel", "", "ANGLE", 1, object()):
            with pytest.raises(rg.InvalidInput, match=word.rpartition("_")[2]):
                called(found[name], **{word: wrong})
        for own in (OWN, STRANGER):
            said = answer(found[name], {word: own})
            assert any(part in said for part in (own.name, type(own).__name__, "objective must be")), said
            plt.close("all")


def answer(row: Row, asked: dict[str, Any]) -> str:
    """What the call's result is for, or why it is refused."""
    try:
        return told(called(row, **asked))
    except rg.InvalidInput as error:
        return str(error)


def told(found: Any) -> str:
    """The objectives that a result says it is for."""
    if isinstance(found, rg.Transition):
        return " ".join(choice.objective for choice in found.record.choices)
    if isinstance(found, rg.RegraspPlan):
        return " ".join(told(part) for part in found.steps)
    if isinstance(found, plt.Axes):
        drawn = {o.quantity: o.name for o in (OWN, STRANGER)}
        return drawn.get(found.get_ylabel().partition(" [")[0], found.get_ylabel())
    criteria = getattr(found, "criteria", found)
    said = getattr(criteria, "objective", None)
    return said.name if isinstance(said, Objective) else str(said)


def test_there_are_many_such_calls() -> None:
    assert len({name for name, _ in asking(rows())}) >= 18


def test_what_it_is_chosen_for_decides() -> None:
    """The least sum of squares, twice, has the forces of the effort: not those of the angle."""
    pair = GRASP.without("P3")
    effort, strange = (rg.choose_state(pair, LOAD, objective) for objective in ("effort", STRANGER))
    angle = rg.choose_state(pair, LOAD)
    assert np.allclose(strange.forces, effort.forces, atol=1e-5)
    assert strange.value == pytest.approx(2 * effort.value, rel=1e-6)
    assert not np.allclose(strange.forces, angle.forces, atol=0.1)


def test_plans_keep_whose_objective_it_was(tmp_path: Path) -> None:
    plan = rg.plan_removal(GRASP, "P3", load=LOAD, objective=STRANGER)
    write_plan(plan, tmp_path / "plan.json")
    assert [c.objective for c in read_plan(tmp_path / "plan.json").record.choices] == ["own:strange", "force"]
    assert rg.verify(plan).ok
    assert "strange" in str(plan)
    assert "<html" in html(plan)


def test_words_from_outside_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scenario = tmp_path / "wrong.toml"
    scenario.write_text(edited(('objective = "angle"', 'objective = "angel"')), encoding="utf-8")
    status, _, said = command(capsys, "plan", scenario, "-o", tmp_path / "plan.json")
    assert status == 2
    assert "objective" in said
    asked = {"contacts": [c.to_dict() for c in GRASP], "load": LOAD.vector.tolist(), "objective": "angel"}
    with pytest.raises(rg.InvalidInput, match="objective must be one of"):
        Question.of(asked)
    told_of = {"format": "regrasp plan", "version": 1}
    with pytest.raises(rg.InvalidInput):
        read_plan(_written(tmp_path / "plan.json", told_of))


def _written(path: Path, data: dict[str, Any]) -> Path:
    path.write_text(str(data).replace("'", '"'), encoding="utf-8")
    return path


# -- no source asks which objective it is by its word -----------------------------------------------------

OTHER_LISTS = {
    "planning/changes/path_program.py": "objectives of paths through instants, a list of their own",
    "planning/changes/path_search.py": "the same",
    "planning/changes/joining.py": "the same",
    "planning/placement/chosen.py": "goals of placements, laws of their own (placement/laws.py)",
    "verification/placed/chosen_grasps.py": "the same, written again",
    "verification/placed/claims/contacts.py": "the same",
    "verification/placed/claims/levels.py": "the same",
    "plots/over_time/magnitudes.py": "margins to draw, angle or force, and no other is taken",
    "bench/families/states.py": "the programs of a test set, each written as it is",
}
"""Modules whose words are not those of the objectives of states."""


def words_compared(source: str) -> Iterator[str]:
    """Comparisons with the word of an objective, which are branches that a new one falls through."""
    if not any(f'"{word}"' in source.replace("'", '"') for word in OBJECTIVES):
        return
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Compare) and "objective" in ast.unparse(node):
            inside = [c.value for c in ast.walk(node) if isinstance(c, ast.Constant)]
            if any(isinstance(value, str) and value in OBJECTIVES for value in inside):
                yield ast.unparse(node)


def test_no_source_compares_the_word_of_an_objective() -> None:
    root = Path(rg.__file__).parent
    found = {
        str(path.relative_to(root)): words
        for path in root.rglob("*.py")
        if (words := list(words_compared(path.read_text(encoding="utf-8"))))
    }
    assert {name: words for name, words in found.items() if name not in OTHER_LISTS} == {}
    assert OTHER_LISTS.keys() == found.keys()


def test_a_comparison_is_seen() -> None:
    assert list(words_compared("if objective == 'angle': pass")) == ["objective == 'angle'"]
    assert list(words_compared("x = a.objective in ('effort', 'peak')")) == [
        "a.objective in ('effort', 'peak')"
    ]
    assert list(words_compared("x = objective is ANGLE or key == 'force'")) == []

"""A cost of a user's own through the verbs: it is what states are chosen for, or refused in one line."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import regrasp as rg
from paper import GRASP, LOAD
from refusals import refused
from regrasp.files import read_plan, write_plan
from regrasp.plots import html
from written_regrasps import ELLIPSE, WEIGHT, fingers_at

pytestmark = pytest.mark.contract

TWO = GRASP.without("P3")
NEW = rg.Contact([-5, -3], [1, 1], 0.3, name="Q")
ENDS = (ELLIPSE, fingers_at(0.02, 0.35, 0.7), fingers_at(0.2, 0.5, 0.85), WEIGHT)
COSTS: dict[str, Callable[[int], rg.ForceCost]] = {
    "weights": lambda n: rg.ForceCost("mine", weights=[4.0, 1.0, 2.0][:n]),
    "near forces": lambda n: rg.ForceCost("mine", towards=[[3.0, 2.0], [-3.0, 4.0], [1.0, -4.0]][:n]),
    "prices": lambda n: rg.ForceCost("mine", prices=[[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]][:n]),
}
PLANNED: dict[str, tuple[int, Callable[[rg.ForceCost], Any]]] = {
    "removal": (2, lambda cost: rg.plan_removal(GRASP, "P3", load=LOAD, objective=cost)),
    "removal, whole": (3, lambda cost: rg.plan_removal(GRASP, "P3", load=LOAD, whole_objective=cost)),
    "addition": (2, lambda cost: rg.plan_addition(TWO, GRASP["P3"], load=LOAD, objective=cost)),
    "exchange": (2, lambda cost: rg.plan_exchange(TWO, "P1", NEW, load=LOAD, objective=cost)),
    "hold": (3, lambda cost: rg.plan_hold(GRASP, load=LOAD, objective=cost)),
    "rotation": (2, lambda cost: rg.plan_rotation(TWO, 0.2, load=LOAD, objective=cost)),
    "rate limit": (2, lambda cost: rg.plan_removal(GRASP, "P3", load=LOAD, objective=cost, rate_limit=20.0)),
    "regrasp": (2, lambda cost: rg.plan_regrasp(*ENDS, friction=0.5, orientations=1, objective=cost)),
    "joint": (
        2,
        lambda cost: rg.plan_regrasp(*ENDS, friction=0.5, orientations=1, objective=cost, states="joint"),
    ),
}


@pytest.mark.parametrize("cost", COSTS)
@pytest.mark.parametrize("verb", PLANNED)
def test_verbs_plan_for_it_and_files_keep_its_word(verb: str, cost: str, tmp_path: Path) -> None:
    """Sized for the fingers that hold where it is asked; for others it is refused by name."""
    fingers, plan_for = PLANNED[verb]
    plan = plan_for(COSTS[cost](fingers))
    assert rg.verify(plan).ok
    write_plan(plan, tmp_path / "plan.json")
    read = read_plan(tmp_path / "plan.json")
    assert read == plan
    assert rg.verify(read).ok
    steps = getattr(plan, "steps", [plan])
    words = {c.objective for step in steps for c in step.record.choices}
    assert ("joint force" if verb == "joint" else "own:mine") in words
    assert "<html" in html(plan)
    said = refused(plan_for, COSTS[cost](5 - fingers))
    assert "of 'mine' must" in said
    assert "which it is asked for" in said


LINES: dict[str, tuple[Callable[[rg.ForceCost], Any], str]] = {
    "path": (
        lambda cost: rg.plan_removal(GRASP, "P3", load=LOAD, path_objective=cost),
        "path_objective must be one of change, effort, force, peak; got ForceCost('mine')",
    ),
    "places": (
        lambda cost: rg.choose_grasp(ELLIPSE, 2, WEIGHT, friction=0.5, objective=cost),
        "got ForceCost('mine')",
    ),
    "map": (lambda cost: rg.placement_map(ELLIPSE, WEIGHT, friction=0.5, objective=cost), "('mine')"),
    "batch": (
        lambda cost: rg.choose_states([[1, 0], [-1, 0]], [[-1, 0], [1, 0]], 0.5, [0, -1.0], objective=cost),
        "objective 'mine' has no batch; ask choose_state",
    ),
    "squeezes": (
        lambda cost: rg.best_squeezes([-1, 0], [1, 0], 0.5, [1, 0], [-1, 0], 0.5, [0, -1], objective=cost),
        "objective 'mine' has no closed form, so it has no batch",
    ),
    "locus": (lambda cost: rg.EquilibriumLocus(TWO, LOAD).best(cost), "use choose_state"),
}


@pytest.mark.parametrize("call", LINES)
def test_where_only_words_are_known_it_is_refused_in_a_line(call: str) -> None:
    ask, words = LINES[call]
    assert words in refused(ask, COSTS["weights"](2))


@pytest.mark.parametrize("cost", COSTS)
def test_rates_and_copies_are_of_the_same_cost(cost: str) -> None:
    mine = COSTS[cost](2)
    state = rg.choose_state(TWO, LOAD, mine)
    assert state.value == pytest.approx(mine.value(state))
    assert rg.sensitivity(TWO, LOAD, mine).friction.shape == (2,)
    assert rg.choose_state(TWO, LOAD, COSTS[cost](2)) == state


def test_words_of_every_kind_are_written_and_read(tmp_path: Path) -> None:
    """The factor of a set that is withstood, too, which has no closed form."""
    loads = rg.LoadSet.ball(0 * LOAD, force=0.01, torque=0.01)
    plan = rg.plan_removal(
        GRASP, "P3", load=LOAD, whole_objective="wrench", disturbance=loads, max_force=12.0
    )
    write_plan(plan, tmp_path / "plan.json")
    assert read_plan(tmp_path / "plan.json") == plan
    assert [c.objective for c in plan.record.choices] == ["angle", "wrench"]

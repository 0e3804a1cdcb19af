"""Options that verbs share: one set, one default, one description, wherever they appear."""

import inspect

import pytest

import regrasp as rg
from paper import GRASP, LOAD, STATE
from regrasp.files.scenarios.tasks import Change, Removal, Rotation, Task
from regrasp.planning.states.options import (
    ChangeOptions,
    LimitOptions,
    PlanOptions,
    StateOptions,
    described,
)

pytestmark = pytest.mark.contract

VERBS = [
    (rg.choose_state, StateOptions),
    (rg.EquilibriumLocus.best, LimitOptions),
    (rg.sensitivity, LimitOptions),
    (rg.pyramid_losses, LimitOptions),
    (rg.held_sphere, LimitOptions),
    (rg.plan_removal, ChangeOptions),
    (rg.plan_addition, ChangeOptions),
    (rg.plan_exchange, ChangeOptions),
    (rg.plan_rotation, PlanOptions),
]


@pytest.mark.parametrize(("verb", "options"), VERBS, ids=lambda x: getattr(x, "__name__", ""))
def test_signatures_and_docstrings_name_every_option(verb: object, options: type) -> None:
    parameters = inspect.signature(verb).parameters
    for name, (_, option) in described(options).items():
        assert parameters[name].kind is inspect.Parameter.KEYWORD_ONLY
        assert parameters[name].default == option.default
        assert f"{name}: {option.words}" in " ".join(str(verb.__doc__).split())
    assert not any(p.kind is inspect.Parameter.VAR_KEYWORD for p in parameters.values())


def test_what_is_no_option_is_refused_as_by_any_function() -> None:
    with pytest.raises(TypeError, match=r"choose_state\(\) got an unexpected keyword argument 'maxforce'"):
        rg.choose_state(GRASP, LOAD, maxforce=3.0)


@pytest.mark.parametrize(("task", "options"), [(Task, PlanOptions), (Change, ChangeOptions)])
def test_scenario_keys_take_default_and_words_from_the_options(task: type, options: type) -> None:
    for name, (_, option) in described(options).items():
        if name not in ("scaling", "disturbance"):  # a word with its control values; a table beside the load
            assert task.model_fields[name].default == option.default
            assert task.model_fields[name].description == option.words
    assert issubclass(Removal, Change)
    assert issubclass(Rotation, Task)


def test_criteria_stand_for_objective_and_limits() -> None:
    asked = rg.Criteria("effort", max_force=6.0, reserve=0.1)
    state = rg.choose_state(GRASP, LOAD, asked)
    assert state.criteria is asked
    assert (
        state.forces.tolist()
        == rg.choose_state(GRASP, LOAD, "effort", max_force=6.0, reserve=0.1).forces.tolist()
    )
    with pytest.raises(rg.InvalidInput, match="the Criteria given hold every limit; leave out max_force"):
        rg.choose_state(GRASP, LOAD, asked, max_force=6.0)
    removal = rg.plan_removal(GRASP, "P3", load=LOAD, objective=asked)
    assert removal.record.reserve == 0.1
    assert [c.objective for c in removal.record.choices] == ["effort", "force"]
    assert [c.max_force for c in removal.grasp] == [6.0] * 3
    other = rg.Criteria("peak", max_force=6.0)
    removal = rg.plan_removal(GRASP, "P3", load=LOAD, objective=asked, whole_objective=other)
    assert [c.objective for c in removal.record.choices] == ["effort", "peak"]


def test_criteria_of_a_regrasp() -> None:
    outline = rg.Outline.ellipse(2, 1)

    def grasp(*places: float) -> rg.Grasp:
        return rg.Grasp(outline.contact_at(s * outline.length, friction=0.6) for s in places)

    task = (outline, grasp(0.05, 0.3, 0.7), grasp(0.2, 0.5, 0.85), rg.Wrench([0, -3.0]))
    asked = rg.Criteria("effort", max_force=9.0)
    plan = rg.plan_regrasp(*task, friction=0.6, objective=asked, candidates=24, orientations=8)
    same = rg.plan_regrasp(
        *task, friction=0.6, objective="effort", max_force=9.0, candidates=24, orientations=8
    )
    assert plan == same
    with pytest.raises(rg.InvalidInput, match="leave out max_force"):
        rg.plan_regrasp(*task, friction=0.6, objective=asked, max_force=9.0)


# -- limits stay from state to plan ---------------------------------------------------------------------


@pytest.mark.parametrize("limit", [6.0, 8.0])
def test_a_limit_stays_from_state_to_plan(limit: float) -> None:
    state = rg.choose_state(GRASP, LOAD, "force", max_force=limit)
    for plan in (
        rg.plan_removal(state, "P3", objective="force"),
        rg.plan_exchange(state, "P3", rg.Contact([0.5, 8], [0, -1], 0.3, name="P4"), objective="force"),
    ):
        assert [c.max_force for c in plan.grasp] == [limit] * len(plan.grasp)
        assert plan.peak <= limit
    easy = rg.choose_state(GRASP, LOAD, "effort", max_force=limit)
    turned = rg.plan_rotation(easy, 0.3, objective="effort")
    assert [c.max_force for c in turned.grasp] == [limit] * 3
    free = rg.plan_removal(state, "P3", objective="force", max_force=None)
    assert [c.max_force for c in free.grasp] == [None] * 3
    higher = rg.plan_removal(state, "P3", objective="force", max_force=2 * limit)
    assert [c.max_force for c in higher.grasp] == [2 * limit] * 3
    assert [c.max_force for c in rg.plan_removal(STATE, "P3").grasp] == [None] * 3


# -- angles in degrees by name --------------------------------------------------------------------------


def test_degrees_by_name_and_a_warning_beyond_a_whole_turn() -> None:
    by_degrees = rg.plan_rotation(GRASP, degrees=90, load=LOAD)
    assert by_degrees == rg.plan_rotation(GRASP, 0.5 * 3.141592653589793, load=LOAD)
    with pytest.warns(UserWarning, match="so 90 is 14.32 whole turns; write degrees=90 if"):
        rg.plan_rotation(GRASP, 90, load=LOAD)
    assert rg.plan_rotation(GRASP, degrees=400, load=LOAD).turn.angle == pytest.approx(6.98131700797)
    assert rg.plan_rotation(GRASP, 2 * 3.141592653589793, load=LOAD)  # a whole turn is no surprise
    for wrong in ({}, {"angle": 1.0, "degrees": 3.0}):
        with pytest.raises(rg.InvalidInput, match=r"give the turn as angle \[rad\] or as degrees="):
            rg.plan_rotation(GRASP, load=LOAD, **wrong)
    with pytest.raises(rg.InvalidInput, match="there is nothing to turn"):
        rg.plan_rotation(GRASP, degrees=0, load=LOAD)


def test_criteria_show_what_was_given():
    assert repr(rg.Criteria()) == "Criteria('angle')"
    assert repr(rg.Criteria("effort", max_force=3.0, stiffness=[1, 2])) == (
        "Criteria('effort', max_force=3.0, stiffness=(1.0, 2.0))"
    )

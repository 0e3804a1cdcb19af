"""From a scenario to its plan."""

from collections.abc import Callable
from math import radians
from typing import Any, Literal, TypeVar, overload

from regrasp.errors import InvalidInput, shown
from regrasp.files.scenarios.grasp import GraspScenario
from regrasp.files.scenarios.regrasp import RegraspScenario, RegraspTask
from regrasp.files.scenarios.scenario import AnyScenario, PlannedScenario, Scenario
from regrasp.files.scenarios.space_grasp import SpaceGraspScenario
from regrasp.files.scenarios.space_regrasp import SpaceRegraspScenario, SpaceRegraspTask
from regrasp.files.scenarios.tasks import Change, Exchange, Hold, OneFinger, Rotation
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.wrench import Wrench
from regrasp.mesh.mesh import Mesh
from regrasp.outline.outline import Outline
from regrasp.planning.changes.finger_change import plan_addition, plan_exchange, plan_removal
from regrasp.planning.changes.hold import plan_hold
from regrasp.planning.changes.rotation import plan_rotation
from regrasp.planning.holds.sequences import MAX_TURN
from regrasp.planning.placement.chosen import ChosenGrasp
from regrasp.planning.regrasps.verbs import plan_regrasp
from regrasp.planning.states.options import ChangeOptions, LimitOptions, PlanOptions, described
from regrasp.plans.loads import LoadSeries
from regrasp.plans.regrasp_plan import RegraspPlan
from regrasp.plans.transition import Transition

Planned = TypeVar("Planned")

# Keys of a task that the planner takes under the same name.
_CLOCK = ("duration", "scaling", "rate_limit")  # which the task works out together
_SET = ("disturbance", "stiffness")  # which stands beside the load, and by contacts
_STATE_OPTIONS = ("objective", *(name for name in described(PlanOptions) if name not in (*_CLOCK, *_SET)))
_CHANGE_OPTIONS = (
    "objective",
    *(name for name in described(ChangeOptions) if name not in (*_CLOCK, *_SET)),
)
_REGRASP_OPTIONS = (
    "orientations",
    "candidates",
    "objective",
    "states",
    "min_distance",
    "min_normal",
    "stiffness",
    "early_loss",
    *described(LimitOptions),
    "step_duration",
)
_SPACE_REGRASP_OPTIONS = (*_REGRASP_OPTIONS, "goal_rotation", "facets", "seed")


@overload
def plan_scenario(scenario: GraspScenario | SpaceGraspScenario) -> ChosenGrasp: ...
@overload
def plan_scenario(scenario: PlannedScenario) -> Transition | RegraspPlan: ...
def plan_scenario(scenario: AnyScenario) -> Transition | RegraspPlan | ChosenGrasp:
    """What a scenario asks for: a plan, or a grasp where one is to be chosen.

    Args:
        scenario: what ``read_scenario`` or ``parse_scenario`` returned.

    Raises:
        Infeasible: As the planner does.
        InvalidInput: As the planner does.
    """
    if isinstance(scenario, RegraspScenario | SpaceRegraspScenario):
        return regrasp_by(scenario, plan_regrasp)
    if isinstance(scenario, GraspScenario | SpaceGraspScenario):
        return scenario.chosen()
    if not isinstance(scenario, Scenario):
        raise InvalidInput(f"a scenario comes from read_scenario or parse_scenario, got {shown(scenario)}")
    task, load = scenario.task, scenario.external
    if isinstance(task, Rotation):
        return _rotation(scenario, task)
    own = "whole_objective" if isinstance(task, OneFinger) else "start_objective"
    keys = (*_CHANGE_OPTIONS, own)
    if isinstance(task, Hold):
        keys = tuple(key for key in keys if key != "early_loss")  # no finger leaves
    options = _taken(task, keys) | _withstood(scenario, task)
    rate_limit = _per_finger(scenario, task, task.rate_limit)
    options["load"], options["rate_limit"] = load, rate_limit
    options["scaling"] = task.time_scaling
    if isinstance(load, LoadSeries):
        options["scaling"] = task.scaling_lasting(load.duration)
    elif rate_limit is not None and task.duration is None:
        straight = options | {"rate_limit": None, "path_objective": None}
        options["scaling"] = _planned(scenario, task, **straight).fastest(rate_limit).scaling
    return _planned(scenario, task, **options, **_idle_times(task))


def _per_finger(
    scenario: Scenario, task: Change | Hold, values: float | list[float] | None
) -> float | list[float] | None:
    """Values in the order of the plan's fingers, in which the one that arrives is the last."""
    if isinstance(task, Hold) or not isinstance(values, list) or not task.arriving:
        return values
    arriving = scenario.grasp.index(task.arriving[0])
    return [*values[:arriving], *values[arriving + 1 :], values[arriving]]


def _withstood(scenario: Scenario, task: Change | Hold | Rotation) -> dict[str, Any]:
    """The set of deviations and the stiffness of the plan's fingers."""
    springs = task.stiffness
    if isinstance(task, Change):
        springs = _per_finger(scenario, task, springs)
    return {"disturbance": scenario.disturbance, "stiffness": springs}


def _idle_times(task: Change | Hold) -> dict[str, float | None]:
    """When fingers are idle, by the verbs' own words."""
    if isinstance(task, Hold):
        return {}
    if isinstance(task, Exchange):
        return {"idle_from": task.idle_from, "idle_until": task.idle_until}
    assert isinstance(task, OneFinger)
    return {"idle_from" if task.leaving else "idle_until": task.idle_time}


def regrasp_by(scenario: RegraspScenario | SpaceRegraspScenario, verb: Callable[..., Planned]) -> Planned:
    """What a verb that takes what ``plan_regrasp`` takes makes of a scenario."""
    task = scenario.task
    if isinstance(scenario, RegraspScenario):
        assert isinstance(task, RegraspTask)
        shape: Outline | Mesh = scenario.outline.value
        options: dict[str, Any] = {
            "goal_orientation": radians(task.goal_degrees),
            "arcs": None if task.arcs is None else [arc or None for arc in task.arcs],
            "max_turn": MAX_TURN if task.max_turn_degrees is None else radians(task.max_turn_degrees),
            "one_finger": task.one_finger,
            **_taken(task, _REGRASP_OPTIONS),
        }
    else:
        assert isinstance(task, SpaceRegraspTask)
        shape = scenario.object.value
        options = {"max_turn": radians(task.max_turn_degrees), **_taken(task, _SPACE_REGRASP_OPTIONS)}
    load, around = Wrench(scenario.load.force), scenario.load.disturbance
    return verb(
        shape,
        scenario.start_grasp,
        scenario.goal_grasp,
        load,
        friction=scenario.friction,
        least_margin=radians(task.least_margin_degrees),
        weights=None if task.weights is None else task.weights.value,
        disturbance=None if around is None else around.around(load),
        limits=None if task.limits is None else task.limits.value([]),
        **options,
    )


def _rotation(scenario: Scenario, task: Rotation) -> Transition:
    whole = scenario.grasp
    return plan_rotation(
        _given(scenario, whole, "force") or whole,
        degrees=task.degrees,
        axis=task.unit_axis,
        load=scenario.wrench("start"),
        end=_given(scenario, whole, "end_force"),
        scaling=task.time_scaling,
        **_taken(task, _STATE_OPTIONS),
        **_withstood(scenario, task),
    )


def _taken(task: Any, keys: tuple[str, ...]) -> dict[str, Any]:
    return {key: getattr(task, key) for key in keys}


def _planned(scenario: Scenario, task: Change | Hold, **options: Any) -> Transition:
    whole = scenario.grasp
    if isinstance(task, Hold):
        start, end = _given(scenario, whole, "force"), _given(scenario, whole, "end_force")
        return plan_hold(start or whole, options.pop("load"), end=end, **options)
    if not task.arriving:
        rest = whole.without(task.contact)
        start, end = _given(scenario, whole, "force"), _given(scenario, rest, "end_force")
        return plan_removal(start or whole, task.contact, end=end, **options)
    (name,) = task.arriving
    arriving, before = whole[name], whole.without(name)
    known = _given(scenario, before, "force") or before
    if isinstance(task, Exchange):
        after = before.without(task.contact).with_contact(arriving)
        end = _given(scenario, after, "end_force")
        return plan_exchange(known, task.contact, arriving, end=end, **options)
    end = _given(scenario, before.with_contact(arriving), "end_force")
    return plan_addition(known, arriving, end=end, **options)


def _given(scenario: Scenario, grasp: Grasp, key: Literal["force", "end_force"]) -> GraspState | None:
    """The state of ``grasp`` whose forces stand in the scenario, if they do: all of them, or none."""
    forces = {entry.name: getattr(entry, key) for entry in scenario.contacts}
    rows = [forces[name] for name in grasp.names]
    if None in rows:
        return None
    load = scenario.wrench("start" if key == "force" else "end")
    # beside soft fingers a point contact has a fourth number, too: no torque
    return GraspState(grasp, load, [(*row, 0.0)[: grasp.width] for row in rows])

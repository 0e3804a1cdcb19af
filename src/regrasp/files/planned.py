"""From a scenario to its plan."""

from typing import Any, Literal

from regrasp.files.scenario import Removal, Scenario
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.state import GraspState
from regrasp.planning.change import plan_addition, plan_removal
from regrasp.planning.loads import LoadSeries
from regrasp.planning.transition import Transition

# Keys of a task that the planner takes under the same name.
_OPTIONS = (
    "objective",
    "whole_objective",
    "method",
    "max_force",
    "peak_ratio",
    "reserve",
    "balance_tolerance",
    "min_normal",
    "path_objective",
    "instants",
    "facets",
)


def plan_scenario(scenario: Scenario) -> Transition:
    """The transition a scenario asks for. Raises ``Infeasible`` and ``InvalidInput`` as the planner does."""
    task = scenario.task
    options: dict[str, Any] = {key: getattr(task, key) for key in _OPTIONS}
    load = scenario.external
    options["load"], options["rate_limit"] = load, task.rate_limit
    options["scaling"] = task.time_scaling
    if isinstance(load, LoadSeries):
        options["scaling"] = task.scaling_lasting(load.duration)
    elif task.rate_limit is not None and task.duration is None:
        straight = options | {"rate_limit": None, "path_objective": None, "idle_time": None}
        options["scaling"] = _planned(scenario, **straight).fastest(task.rate_limit).scaling
    return _planned(scenario, **options, idle_time=task.idle_time)


def _planned(scenario: Scenario, *, idle_time: float | None = None, **options: Any) -> Transition:
    task, whole = scenario.task, scenario.grasp
    rest = whole.without(task.contact)
    if isinstance(task, Removal):
        start, end = _given(scenario, whole, "force"), _given(scenario, rest, "end_force")
        return plan_removal(start or whole, task.contact, end=end, idle_from=idle_time, **options)
    arriving = whole[task.contact]
    after = rest.with_contact(arriving)
    start, end = _given(scenario, rest, "force"), _given(scenario, after, "end_force")
    return plan_addition(start or rest, arriving, end=end, idle_until=idle_time, **options)


def _given(scenario: Scenario, grasp: Grasp, key: Literal["force", "end_force"]) -> GraspState | None:
    """The state of ``grasp`` whose forces stand in the scenario, if they do: all of them, or none."""
    forces = {entry.name: getattr(entry, key) for entry in scenario.contacts}
    rows = [forces[name] for name in grasp.names]
    load = scenario.wrench("start" if key == "force" else "end")
    return None if None in rows else GraspState(grasp, load, rows)

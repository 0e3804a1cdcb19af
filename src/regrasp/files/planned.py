"""From a scenario to its plan."""

from typing import Literal

from regrasp.files.scenario import Removal, Scenario
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.wrench import Wrench
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
    task, whole = scenario.task, scenario.grasp
    rest = whole.without(task.contact)
    options = {key: getattr(task, key) for key in _OPTIONS}
    load = scenario.external
    options["load"], options["scaling"] = load, task.time_scaling
    fastest = task.rate_limit if task.duration is None and isinstance(load, Wrench) else None
    if isinstance(load, LoadSeries):
        options["scaling"] = task.scaling_lasting(load.duration)
    if fastest is None:
        options["rate_limit"] = task.rate_limit
    if isinstance(task, Removal):
        start, end = _given(scenario, whole, "force"), _given(scenario, rest, "end_force")
        plan = plan_removal(start or whole, task.contact, end=end, idle_from=task.idle_time, **options)
    else:
        arriving = whole[task.contact]
        after = rest.with_contact(arriving)
        start, end = _given(scenario, rest, "force"), _given(scenario, after, "end_force")
        plan = plan_addition(start or rest, arriving, end=end, idle_until=task.idle_time, **options)
    return plan if fastest is None else plan.fastest(fastest)


def _given(scenario: Scenario, grasp: Grasp, key: Literal["force", "end_force"]) -> GraspState | None:
    """The state of ``grasp`` whose forces stand in the scenario, if they do: all of them, or none."""
    forces = {entry.name: getattr(entry, key) for entry in scenario.contacts}
    rows = [forces[name] for name in grasp.names]
    load = scenario.wrench("start" if key == "force" else "end")
    return None if None in rows else GraspState(grasp, load, rows)

"""From a scenario to its plan."""

from typing import Literal

from regrasp.files.scenario import Removal, Scenario
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.state import GraspState
from regrasp.planning.change import plan_addition, plan_removal
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
)


def plan_scenario(scenario: Scenario) -> Transition:
    """The transition a scenario asks for. Raises ``Infeasible`` and ``InvalidInput`` as the planner does."""
    task, whole = scenario.task, scenario.grasp
    rest = whole.without(task.contact)
    options = {key: getattr(task, key) for key in _OPTIONS}
    options |= {"load": scenario.wrench, "scaling": task.time_scaling}
    if isinstance(task, Removal):
        start, end = _given(scenario, whole, "force"), _given(scenario, rest, "end_force")
        plan = plan_removal(start or whole, task.contact, end=end, **options)
    else:
        arriving = whole[task.contact]
        after = rest.with_contact(arriving)
        start, end = _given(scenario, rest, "force"), _given(scenario, after, "end_force")
        plan = plan_addition(start or rest, arriving, end=end, **options)
    return plan if task.rate_limit is None else plan.fastest(task.rate_limit)


def _given(scenario: Scenario, grasp: Grasp, key: Literal["force", "end_force"]) -> GraspState | None:
    """The state of ``grasp`` whose forces stand in the scenario, if they do: all of them, or none."""
    forces = {entry.name: getattr(entry, key) for entry in scenario.contacts}
    rows = [forces[name] for name in grasp.names]
    return None if None in rows else GraspState(grasp, scenario.wrench, rows)

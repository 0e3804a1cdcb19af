"""From a scenario to its plan with the ways of its free fingers."""

from functools import partial

from regrasp.errors import InvalidInput
from regrasp.files.scenarios.planned import plan_scenario, regrasp_by
from regrasp.files.scenarios.regrasp import RegraspScenario
from regrasp.files.scenarios.scenario import AnyScenario, Scenario
from regrasp.files.scenarios.space_regrasp import SpaceRegraspScenario
from regrasp.motions.value import Motions


def plan_scenario_motions(scenario: AnyScenario) -> Motions:
    """What a scenario asks for, with the ways of its free fingers; ``plan`` of it is the plan.

    A regrasp is the best one that has ways.

    Args:
        scenario: what ``read_scenario`` or ``parse_scenario`` returned, with a table ``[motions]``.

    Raises:
        Infeasible: As ``plan_scenario`` does, and where a finger is shut in.
        InvalidInput: As ``plan_scenario`` does, and without ``[motions]`` or the object's shape.
    """
    from regrasp.motions.plan import plan_motions
    from regrasp.motions.regrasps import plan_regrasp_motions

    motions = getattr(scenario, "motions", None)
    if motions is None:
        raise InvalidInput("motions: ways of fingers need a table [motions] with tip_radius and clearance")
    if isinstance(scenario, RegraspScenario | SpaceRegraspScenario):
        return regrasp_by(scenario, partial(plan_regrasp_motions, **motions.options))
    assert isinstance(scenario, Scenario)
    if scenario.object is None:
        raise InvalidInput("motions: ways go around a shape: give an [object], or an [outline] and a regrasp")
    plan = plan_scenario(scenario)
    return plan_motions(plan, scenario.object.value, **motions.options)

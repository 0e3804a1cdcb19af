"""Scenarios in, plans and set-points out. Imports pydantic, so it is imported when it is used."""

from typing import TYPE_CHECKING

from regrasp.later import later

if TYPE_CHECKING:
    from regrasp.files.plans.bag import write_mcap
    from regrasp.files.plans.cut_file import read_cut, write_cut
    from regrasp.files.plans.motion_rows import MotionRows, read_motions
    from regrasp.files.plans.motions_table import write_motions
    from regrasp.files.plans.plan_file import read_plan, write_plan
    from regrasp.files.plans.regions_file import read_regions, write_regions
    from regrasp.files.plans.setpoints import write_setpoints
    from regrasp.files.plans.ways_file import Ways, read_ways, write_ways
    from regrasp.files.scenarios.grasp import GraspScenario
    from regrasp.files.scenarios.moving import plan_scenario_motions
    from regrasp.files.scenarios.planned import plan_scenario
    from regrasp.files.scenarios.regrasp import RegraspScenario
    from regrasp.files.scenarios.scenario import (
        AnyScenario,
        Scenario,
        parse_scenario,
        read_scenario,
        scenario_schema,
    )
    from regrasp.files.scenarios.space_grasp import SpaceGraspScenario
    from regrasp.files.scenarios.space_regrasp import SpaceRegraspScenario

__all__ = [
    "AnyScenario",
    "GraspScenario",
    "MotionRows",
    "RegraspScenario",
    "Scenario",
    "SpaceGraspScenario",
    "SpaceRegraspScenario",
    "Ways",
    "parse_scenario",
    "plan_scenario",
    "plan_scenario_motions",
    "read_cut",
    "read_motions",
    "read_plan",
    "read_regions",
    "read_scenario",
    "read_ways",
    "scenario_schema",
    "write_cut",
    "write_mcap",
    "write_motions",
    "write_plan",
    "write_regions",
    "write_setpoints",
    "write_ways",
]

_WHERE = {
    "AnyScenario": "scenarios.scenario",
    "GraspScenario": "scenarios.grasp",
    "MotionRows": "plans.motion_rows",
    "RegraspScenario": "scenarios.regrasp",
    "Scenario": "scenarios.scenario",
    "SpaceGraspScenario": "scenarios.space_grasp",
    "SpaceRegraspScenario": "scenarios.space_regrasp",
    "Ways": "plans.ways_file",
    "parse_scenario": "scenarios.scenario",
    "plan_scenario": "scenarios.planned",
    "plan_scenario_motions": "scenarios.moving",
    "read_cut": "plans.cut_file",
    "read_motions": "plans.motion_rows",
    "read_plan": "plans.plan_file",
    "read_regions": "plans.regions_file",
    "read_scenario": "scenarios.scenario",
    "read_ways": "plans.ways_file",
    "scenario_schema": "scenarios.scenario",
    "write_cut": "plans.cut_file",
    "write_mcap": "plans.bag",
    "write_motions": "plans.motions_table",
    "write_plan": "plans.plan_file",
    "write_regions": "plans.regions_file",
    "write_setpoints": "plans.setpoints",
    "write_ways": "plans.ways_file",
}

__getattr__, __dir__ = later(__name__, _WHERE)

"""Scenarios in, plans and set-points out. Imports pydantic, so it is imported when it is used."""

from regrasp.files.plans.bag import write_mcap
from regrasp.files.plans.cut_file import read_cut, write_cut
from regrasp.files.plans.motion_rows import MotionRows, read_motions
from regrasp.files.plans.motions_table import write_motions
from regrasp.files.plans.plan_file import read_plan, write_plan
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
from regrasp.files.scenarios.space_regrasp import SpaceRegraspScenario

__all__ = [
    "AnyScenario",
    "GraspScenario",
    "MotionRows",
    "RegraspScenario",
    "Scenario",
    "SpaceRegraspScenario",
    "Ways",
    "parse_scenario",
    "plan_scenario",
    "plan_scenario_motions",
    "read_cut",
    "read_motions",
    "read_plan",
    "read_scenario",
    "read_ways",
    "scenario_schema",
    "write_cut",
    "write_mcap",
    "write_motions",
    "write_plan",
    "write_setpoints",
    "write_ways",
]

"""Scenarios in, plans and set-points out. Imports pydantic, so it is imported when it is used."""

from regrasp.files.plan_file import read_plan, write_plan
from regrasp.files.planned import plan_scenario
from regrasp.files.regrasp_scenario import RegraspScenario
from regrasp.files.scenario import AnyScenario, Scenario, parse_scenario, read_scenario, scenario_schema
from regrasp.files.setpoints import write_setpoints
from regrasp.files.space_regrasp_scenario import SpaceRegraspScenario

__all__ = [
    "AnyScenario",
    "RegraspScenario",
    "Scenario",
    "SpaceRegraspScenario",
    "parse_scenario",
    "plan_scenario",
    "read_plan",
    "read_scenario",
    "scenario_schema",
    "write_plan",
    "write_setpoints",
]

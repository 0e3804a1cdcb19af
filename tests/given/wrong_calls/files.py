"""Scenarios, plans, set-points and ways on disk."""

import os

import regrasp.files as files
from regrasp.files.scenarios.templates import template
from values import VALUES, removal
from wrong_calls.row import Row

MOVING = """
friction = 0.5
[load]
force = [0.0, -3.0]
[outline]
vertices = [[-1, -1], [1, -1], [1, 1], [-1, 1]]
[start]
positions = [[-1, 0], [1, 0.1], [0, 1]]
[goal]
positions = [[-1, 0.2], [1, 0.1], [0, 1]]
[task]
kind = "regrasp"
candidates = 8
orientations = 1
[motions]
tip_radius = 0.05
clearance = 0.02
"""


def rows() -> dict[str, Row]:
    scenario = files.parse_scenario(template("removal"))
    moving = files.parse_scenario(MOVING)
    return {
        "read_scenario": Row(files.read_scenario, {}, {"path": "path"}),
        "parse_scenario": Row(
            files.parse_scenario, {"text": template("removal")}, {"text": "text", "file": "path"}
        ),
        "plan_scenario": Row(files.plan_scenario, {"scenario": scenario}),
        "plan_scenario_motions": Row(files.plan_scenario_motions, {"scenario": moving}),
        "write_motions": Row(
            files.write_motions,
            {"motions": files.plan_scenario_motions(moving), "path": os.devnull, "rate": 10.0},
            {"motions": "value"},
        ),
        "read_cut": Row(files.read_cut, {}, {"path": "path"}),
        "write_cut": Row(
            files.write_cut, {"cut": VALUES["RegraspCut"](), "path": os.devnull}, {"cut": "value"}
        ),
        "read_regions": Row(files.read_regions, {}, {"path": "path"}),
        "write_regions": Row(
            files.write_regions,
            {"regions": VALUES["ContactRegions"](), "path": os.devnull},
            {"regions": "value"},
        ),
        "read_plan": Row(files.read_plan, {}, {"path": "path"}),
        "read_motions": Row(files.read_motions, {"path": "none.csv", "plan": removal()}),
        "read_ways": Row(files.read_ways, {"path": "none.json", "plan": removal()}),
        "write_ways": Row(
            files.write_ways,
            {
                "motions": files.plan_scenario_motions(moving),
                "shape": moving.outline.value,
                "path": os.devnull,
            },
            {"motions": "value", "shape": "value"},
        ),
        "write_plan": Row(files.write_plan, {"plan": removal(), "path": os.devnull}),
        "write_mcap": Row(
            files.write_mcap,
            {"plan": removal(), "path": "none.mcap"},
            {"start": "number", "metres_per_newton": "positive"},
        ),
        "write_setpoints": Row(files.write_setpoints, {"plan": removal(), "path": os.devnull}),
    }

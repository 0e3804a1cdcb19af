"""Whole regrasps, their graphs, and the ways of fingers."""

import regrasp as rg
from values import (
    SQUARE_OUTLINE,
    WEIGHT,
    WEIGHT_IN_PLANE,
    ellipse,
    four_on_box,
    mesh,
    on_outline,
    problem,
    three_on_ellipse,
)
from wrong_calls.row import Row


def rows() -> dict[str, Row]:
    outline, box = ellipse(), mesh()
    first, last = three_on_ellipse(0.02, 0.35, 0.7), three_on_ellipse(0.2, 0.5, 0.85)
    asked = {"start": first, "goal": last, "load": rg.Wrench([0, -3]), "friction": 0.5}
    small = {"candidates": 4, "orientations": 1}
    or_none = {"facets": "some or all", "max_turn": "some small angle"}
    solid = {"start": four_on_box(), "goal": four_on_box(), "load": WEIGHT, "friction": 0.8}
    return {
        "regrasps_on_outline": Row(
            rg.regrasps_on_outline,
            {
                "outline": SQUARE_OUTLINE,
                "start": on_outline(0.5).start,
                "goal": on_outline(0.5).goal,
                "load": WEIGHT_IN_PLANE,
                "friction": 0.5,
            },
            {"outline": "value", "turns": "table", "forbidden": "numbers"},
        ),
        "OutlineRegrasps.plan": Row(on_outline(0.5).plan, {}),
        "OutlineCut.from_dict": Row(
            rg.OutlineCut.from_dict, {"data": on_outline(0.01).certificate.to_dict()}
        ),
        "plan_motions": Row(
            rg.plan_motions,
            {"plan": problem().plans()[0], "shape": outline, "tip_radius": 0.01, "clearance": 0.01},
            {
                "shape": "value",
                "tip_radius": "positive",
                "clearance": "positive",
                "speed": "positive",
                "acceleration": "positive",
                "capsules": "bars",
            },
        ),
        "RegraspProblem": Row(rg.RegraspProblem, {"outline": outline, **asked, **small}, or_none),
        "RegraspProblem that turns": Row(
            rg.RegraspProblem, {"outline": outline, **asked, "candidates": 4}, or_none
        ),
        "RegraspProblem.sequences": Row(problem().sequences, {}),
        "RegraspProblem.plans": Row(problem().plans, {}),
        "RegraspProblem.allowing": Row(problem().allowing, {"force": 9.0}, {"force": "positive"}),
        "RegraspProblem in space": Row(rg.RegraspProblem, {"outline": box, **solid, **small}, or_none),
        "RegraspProblem.asking": Row(problem().asking, {"min_normal": 0.1}, {"min_normal": "not negative"}),
        "plan_regrasp": Row(
            rg.plan_regrasp,
            {"outline": outline, **asked, **small, "motions": True, "tip_radius": 0.01, "clearance": 0.01},
            {
                "start": "end",
                "goal": "end",
                "motions": "flag",
                "tip_radius": "positive",
                "clearance": "positive",
                "speed": "positive",
                "acceleration": "positive",
                "capsules": "bars",
                "attempts": "count",
            },
            free=("options",),
        ),
        "plan_regrasps": Row(rg.plan_regrasps, {"outline": outline, **asked, **small}, free=("options",)),
        "HoldGraph": Row(
            rg.HoldGraph,
            {"contacts": problem().contacts, "load": rg.Wrench([0, -3.0]), "angles": [0.0, 1.0]},
            {
                "contacts": "contacts",
                "angles": "angles",
                "most_bytes": "count",
                "min_normal": "not negative",
            },
        ),
        "bottleneck": Row(
            rg.bottleneck,
            {"graph": problem().graph, "start": (0, 1, 2), "goal": (3, 4, 5)},
            {"start": "places", "goal": "places", "goal_orientation": "count"},
        ),
        "RegraspWeights": Row(
            rg.RegraspWeights,
            {},
            dict.fromkeys(("moves", "turning", "time", "effort"), "not negative"),
        ),
    }

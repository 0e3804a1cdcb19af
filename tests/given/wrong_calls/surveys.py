"""Measures of grasps, what they hold and what they withstand."""

import regrasp as rg
from paper import GRASP, LOAD, STATE
from values import PAIR, space_grasp
from wrong_calls.row import Row


def rows() -> dict[str, Row]:
    r, n = [[-1.0, 0.0], [-1.0, 0.1]], [[1.0, 0.0], [1.0, 0.0]]
    sphere = rg.held_sphere(space_grasp(), count=12)
    choosing = {"grasp": PAIR, "load": LOAD}
    return {
        "held_directions": Row(rg.held_directions, {"grasp": PAIR}),
        "HeldDirections.contains": Row(
            rg.held_directions(PAIR).contains, {"direction": [0.0, -1.0]}, {"direction": "planar vector"}
        ),
        "held_sphere": Row(rg.held_sphere, {"grasp": space_grasp(), "count": 12}),
        "HeldSphere.state": Row(sphere.state, {"direction": [0, 0, -1]}, {"direction": "space vector"}),
        "HeldSphere.holds": Row(sphere.holds, {"direction": [0, 0, -1]}, {"direction": "space vector"}),
        "closure": Row(rg.closure, {"grasp": GRASP}),
        "wrench_ball": Row(
            rg.wrench_ball,
            {"grasp": GRASP, "limit": 1.0},
            {"limit": "limits", "norm": "word", "length": "positive", "gap": "gap"},
        ),
        "quality": Row(
            rg.quality,
            {"grasp": GRASP},
            {
                "limit": "limits",
                "length": "positive",
                "loads": "value",
                "jacobians": "jacobians",
                "gap": "gap",
            },
        ),
        "Quality.__getitem__": Row(rg.quality(GRASP).__getitem__, {"name": "isotropy"}, {"name": "key"}),
        "least_friction": Row(rg.least_friction, choosing, {"contacts": "contact names"}),
        "largest_load": Row(
            rg.largest_load, {"grasp": PAIR, "direction": LOAD}, {"direction": "value", "base": "value"}
        ),
        "held_centres": Row(
            rg.held_centres,
            {"grasp": PAIR, "weight": rg.Wrench(LOAD.force), "max_force": 20.0},
            {"weight": "value", "gap": "positive", "reach": "positive"},
        ),
        "least_stiffness": Row(
            rg.least_stiffness,
            {"state_or_plan": STATE},
            {"state_or_plan": "value", "load_at": "planar vector", "surface": "curvatures"},
        ),
        "margin_curve": Row(
            rg.margin_curve,
            choosing | {"count": 3},
            {"x": "word", "at": "rising limits", "surface": "number"},
        ),
        "MarginCurve.least": Row(
            rg.margin_curve(PAIR, LOAD, count=3).least, {"value": 0.1}, {"value": "number"}
        ),
        "tolerances": Row(
            rg.tolerances,
            {"state_or_plan": STATE.balanced()},
            {"state_or_plan": "value", "surface": "curvatures"},
        ),
        "wrench_balls": Row(
            rg.wrench_balls,
            {"positions": r, "normals": n, "frictions": 0.5},
            {
                "positions": "finger rows",
                "normals": "finger rows",
                "frictions": "fingers' numbers",
                "limit": "positive",
                "norm": "word",
                "length": "batch lengths",
            },
        ),
        "batch_tolerances": Row(
            rg.batch_tolerances,
            {"positions": r, "normals": n, "frictions": 0.5, "forces": n},
            {
                "positions": "finger rows",
                "normals": "finger rows",
                "frictions": "fingers' numbers",
                "forces": "finger rows",
                "stiffness": "batch springs",
            },
        ),
    }

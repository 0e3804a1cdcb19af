"""Every public name with arguments that are right, and what is wrong for each of its parameters.

A parameter is of a kind, by its name; for each kind there are values that it must refuse. The cases are made
from the signatures, so a new parameter without a kind, or a new name without a row, fails the test.
"""

import inspect
import os
import tempfile
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from math import inf, nan
from typing import Any, NamedTuple

import numpy as np

import regrasp as rg
from paper import GRASP, LOAD, STATE
from values import (
    PAIR,
    SQUARE,
    SQUARE_OUTLINE,
    VALUES,
    WEIGHT,
    WEIGHT_IN_PLANE,
    bent,
    ellipse,
    four_on_box,
    mesh,
    on_outline,
    placed,
    problem,
    regrasp,
    removal,
    rotation,
    space_grasp,
    three_on_ellipse,
)

HUGE = 10**400
OBJECT = object()
ANYTHING = ("x", "", b"x", OBJECT, {}, {1, 2}, 1j, len, type, Ellipsis)
"""Nothing in regrasp takes these, but a word, a name or a path takes text."""

NOT_A_NUMBER = (
    *ANYTHING,
    "1.0",
    nan,
    inf,
    -inf,
    HUGE,
    -HUGE,
    [1, 2],
    [],
    np.zeros(2),
    np.array("x"),
    True,
    None,
)
NOT_POSITIVE = (*NOT_A_NUMBER, 0, -1.0, -1e-300)
NOT_A_VALUE = (*ANYTHING, None, 3, nan, HUGE, [], [1, 2], np.zeros(3), True)
NOT_NUMBERS = (
    *ANYTHING, None, nan, HUGE, [nan, 1], [inf, 0], [HUGE, 1], ["a", "b"], [None, 1], [[1], [1, 2]], [1j, 0],
    np.array(["x", "y"]), [OBJECT, 1], "12",
)  # fmt: skip
NOT_A_VECTOR = (*NOT_NUMBERS, 5, [], [1], [1, 2, 3, 4], [[1, 2]], np.zeros((2, 2)), np.zeros((1, 2, 3)))
NOT_A_COUNT = (*ANYTHING, "3", None, nan, inf, HUGE, -1, 1.5, 3.0, True, [], [3], np.zeros(2))

KINDS: dict[str, Sequence[Any]] = {
    "number": NOT_A_NUMBER,
    "positive": NOT_POSITIVE,
    "not negative": (*NOT_A_NUMBER, -1.0),
    "fraction": (*NOT_A_NUMBER, -0.1, 1.0, 7),
    "ratio": (*NOT_A_NUMBER, 0.5, -3),
    "small angle": (*NOT_POSITIVE, 4.0),
    "some small angle": tuple(wrong for wrong in (*NOT_POSITIVE, 4.0) if wrong is not None),
    "vector": NOT_A_VECTOR,
    "planar vector": (*NOT_A_VECTOR, [1, 2, 3]),
    "space vector": (*NOT_A_VECTOR, [1, 2]),
    "normal": (*NOT_A_VECTOR, [0, 0]),
    "numbers": NOT_NUMBERS,
    "table": (*NOT_NUMBERS, 5, [], [1, 2], np.zeros((2, 2, 2))),
    "some places": (*NOT_NUMBERS, 5, [1, 2, 3, 4], np.zeros((2, 2))),
    "times": (*NOT_NUMBERS, -1.0, 1e9, [0.0, 1e9]),
    "limits": (*NOT_NUMBERS, 0, -1, [1, 2], [0, 0, 0], [[1, 1, 1]]),
    "count": NOT_A_COUNT,
    "angles": (*NOT_NUMBERS, 5, [], np.zeros((2, 2))),
    "some or all": tuple(wrong for wrong in NOT_A_COUNT if wrong is not None),
    "seed": [value for value in NOT_A_COUNT if value is not HUGE],
    "value": NOT_A_VALUE,
    "end": tuple(wrong for wrong in NOT_A_VALUE if wrong is not None),
    "word": (*ANYTHING, None, 3, nan, HUGE, True, [], ["angle"], "Angle", b"angle"),
    "name": ("", " ", b"x", OBJECT, {}, 1j, 3, nan, HUGE, True, [], ["a"]),
    "contact of": (*ANYTHING, None, 1.0, nan, HUGE, -HUGE, 99, -99, [], True, "Q"),
    "contacts": (*NOT_A_VALUE, [1], "ab", [OBJECT]),
    "flag": (*ANYTHING, None, 3, nan, HUGE, [], 0, "True"),
    "function": (*ANYTHING[:6], 3, nan, HUGE, [], True),
    "path": (None, 3, nan, HUGE, OBJECT, [], {}, b"\0", "", "\0", "\ud800", True),
    "choices": (*NOT_A_VALUE, "each"),
    "data": (*NOT_A_VALUE, {"x": 1}, {1: 2}),
    "function name": (*ANYTHING[:6], None, 3, nan, HUGE, [], True, "nothing", "nothing:here", "math:pi"),
    "grid": (
        *NOT_A_VALUE,
        {"a": []},
        {"a": 3},
        {"a": [nan]},
        {"a": [1, 1]},
        {"b": [1]},
        {1: [2]},
        [{}],
        [{"a": 1}, 2],
    ),
    "workers": (*ANYTHING, nan, HUGE, -1, 1.5, True, []),
    "client": (*ANYTHING[3:], 3, nan, HUGE, [], True),
    "time limit": (*ANYTHING, nan, inf, HUGE, -1, 0, True, []),
    "shared": (*ANYTHING[:4], *ANYTHING[5:], 3, nan, [], {1: 2}, {"a": 2}, {"c": 2}),
    "listener": (*ANYTHING[:6], None, 3, nan, []),
}

NAMES: dict[str, str] = {
    "friction": "not negative", "max_force": "positive", "torsion": "positive", "name": "name",
    "peak_ratio": "ratio", "reserve": "fraction", "objective": "word", "whole_objective": "word",
    "path_objective": "word", "method": "word", "facets": "count", "duration": "positive", "rate": "positive",
    "scaling": "value", "grasp": "value", "load": "value", "state": "value", "start": "value", "end": "value",
    "goal": "value", "outline": "value", "mesh": "value", "plan": "value", "graph": "value",
    "scenario": "value",
    "balance_tolerance": "not negative", "min_normal": "least normals", "idle_from": "not negative",
    "idle_until": "not negative", "instants": "count", "rate_limit": "limits", "count": "count",
    "seed": "seed",
    "clearance": "not negative", "orientations": "some or all", "candidates": "some or all",
    "goal_orientation": "number",
    "goal_rotation": "table", "states": "word", "max_turn": "small angle", "least_margin": "not negative",
    "min_distance": "not negative", "keep": "function", "arcs": "choices", "one_finger": "flag",
    "weights": "value", "step_duration": "positive", "extra": "count", "scale": "positive",
    "tolerance": "positive", "smooth": "flag", "path": "path", "data": "data", "t": "times",
    "axis": "space vector", "along": "space vector", "degrees": "number", "arriving": "contacts",
    "outside": "flag", "layers": "layers", "unit": "word", "bodies": "word", "close_holes": "not negative",
    "disturbance": "value", "stiffness": "stiffnesses", "tip_radius": "not negative", "early_loss": "flag",
    "start_objective": "word", "also": "numbers",
    "angle": "number", "magnitude": "positive", "degree": "count", "segments": "count", "divisions": "count",
    "crease": "positive", "contact": "contact of", "squeeze": "numbers", "direction": "vector",
    "limits": "contact limits",
}  # fmt: skip
"""Of parameters that are of one kind wherever they appear."""


class Row(NamedTuple):
    """A call that is right; kinds of parameters that their names do not tell; parameters of no kind."""

    call: Callable[..., Any]
    right: dict[str, Any]
    kinds: dict[str, str] = {}  # noqa: RUF012 - never changed
    free: tuple[str, ...] = ()


@cache
def _study() -> str:
    """The folder of a study that is done."""
    folder = tempfile.mkdtemp()
    rg.sweep("study_cases:product", {"a": [1, 2]}, out=folder, workers=0, progress=False)
    return folder


def rows() -> dict[str, Row]:
    """All rows by name, made when asked for: some values take a moment."""
    r, n = [[-1.0, 0.0], [-1.0, 0.1]], [[1.0, 0.0], [1.0, 0.0]]
    batch = {
        "r1": r, "n1": n, "mu1": 0.5, "r2": [1.0, 0.0], "n2": [-1.0, 0.0], "mu2": 0.5, "force": [0.0, -1.0],
        "torque": 0.0,
    }  # fmt: skip
    of_batch = {
        "r1": "rows", "n1": "rows", "r2": "rows", "n2": "rows", "force": "rows", "mu1": "entries",
        "mu2": "entries", "torque": "batch torque",
    }  # fmt: skip
    contact = {"position": [1.0, 2.0], "normal": [0.0, 1.0], "friction": 0.5}
    planar = {"position": "vector", "normal": "normal"}
    first, last = three_on_ellipse(0.02, 0.35, 0.7), three_on_ellipse(0.2, 0.5, 0.85)
    asked = {"start": first, "goal": last, "load": rg.Wrench([0, -3]), "friction": 0.5}
    small = {"candidates": 4, "orientations": 1}
    or_none = {"facets": "some or all", "max_turn": "some small angle"}
    solid = {"start": four_on_box(), "goal": four_on_box(), "load": WEIGHT, "friction": 0.8}
    locus, squeezes = rg.EquilibriumLocus(PAIR, LOAD), rg.SqueezeLocus(GRASP, LOAD)
    middle = float(np.mean(locus.interval))
    scaling, series = rg.TimeScaling.spline(1.0), rg.LoadSeries([0, 1], [[0, 0, 0], [1, 1, 1]])
    sphere = rg.held_sphere(space_grasp(), count=12)
    outline, box = ellipse(), mesh()
    choosing = {"grasp": PAIR, "load": LOAD}
    loads = rg.LoadSet.ball(LOAD, force=1.0, torque=0.1)
    transition, turn, whole = removal(), rotation(), regrasp()
    result = {
        "Contact": Row(rg.Contact, contact, planar),
        "Contact.named": Row(rg.Contact([0, 0], [1, 0], 1).named, {"name": "a"}),
        "ForceLimits": Row(
            rg.ForceLimits,
            {"rows": [[1, 0], [0, 1]], "bounds": [1, 2]},
            {"rows": "table", "bounds": "bounds"},
        ),
        "ForceLimits.scaled": Row(
            rg.ForceLimits([[1, 0]], [1]).scaled, {"factor": 2.0}, {"factor": "positive"}
        ),
        "ForceLimits.from_dict": Row(
            rg.ForceLimits.from_dict, {"data": rg.ForceLimits([[1, 0]], [1]).to_dict()}
        ),
        "torque_limits": Row(
            rg.torque_limits,
            {"jacobian": [[1, 0], [0, 1]], "torques": [1, 2]},
            {"jacobian": "table", "torques": "torques", "normal": "some normal"},
        ),
        "Contact.from_dict": Row(rg.Contact.from_dict, {"data": GRASP["P1"].to_dict()}),
        "Wrench": Row(rg.Wrench, {"force": [1.0, 2.0]}, {"force": "vector", "torque": "number"}),
        "Wrench in space": Row(
            rg.Wrench,
            {"force": [1.0, 2.0, 3.0], "torque": [1.0, 2.0, 3.0]},
            {"force": "vector", "torque": "space vector"},
        ),
        "Wrench.from_vector": Row(
            rg.Wrench.from_vector, {"vector": [1.0, 2.0, 3.0]}, {"vector": "vector of 3 or 6"}
        ),
        "Wrench.rotated": Row(LOAD.rotated, {"rotation": 0.3}, {"rotation": "number"}),
        "Wrench.rotated in space": Row(WEIGHT.rotated, {"rotation": np.eye(3)}, {"rotation": "table"}),
        "Wrench.__add__": Row(LOAD.__add__, {"other": LOAD}, {"other": "value"}),
        "Wrench.__sub__": Row(LOAD.__sub__, {"other": LOAD}, {"other": "value"}),
        "Wrench.__mul__": Row(LOAD.__mul__, {"factor": 2.0}, {"factor": "number"}),
        "Wrench.__truediv__": Row(LOAD.__truediv__, {"divisor": 2.0}, {"divisor": "divisor"}),
        "Wrench.from_dict": Row(rg.Wrench.from_dict, {"data": LOAD.to_dict()}),
        "Grasp": Row(rg.Grasp, {"contacts": list(GRASP)}, {"contacts": "contacts"}),
        "Grasp.index": Row(GRASP.index, {"contact": "P1"}),
        "Grasp.__getitem__": Row(GRASP.__getitem__, {"contact": "P1"}),
        "Grasp.subset": Row(GRASP.subset, {"contacts": ["P1"]}, {"contacts": "contact names"}),
        "Grasp.without": Row(GRASP.without, {"contact": "P1"}),
        "Grasp.with_contact": Row(
            GRASP.with_contact, {"contact": rg.Contact([9, 9], [1, 0], 1)}, {"contact": "value"}
        ),
        "Grasp.replaced": Row(GRASP.replaced, {"contact": "P1", "by": GRASP["P1"]}, {"by": "value"}),
        "Grasp.wrenches": Row(GRASP.wrenches, {"forces": STATE.forces}, {"forces": "table"}),
        "Grasp.from_dict": Row(rg.Grasp.from_dict, {"data": GRASP.to_dict()}),
        "GraspState": Row(
            rg.GraspState, {"grasp": GRASP, "load": LOAD, "forces": STATE.forces}, {"forces": "table"}
        ),
        "GraspState.force": Row(STATE.force, {"contact": "P1"}),
        "GraspState.without": Row(STATE.without, {"contact": "P1"}),
        "GraspState.is_balanced": Row(STATE.is_balanced, {}),
        "GraspState.balanced": Row(STATE.balanced, {}),
        "GraspState.from_dict": Row(rg.GraspState.from_dict, {"data": STATE.to_dict()}),
        "EscapeTwist": Row(
            rg.EscapeTwist,
            {"grasp": PAIR, "load": LOAD, "twist": [0, 0, 1], "frictions": (0.3, 0.3), "limits": (inf, inf)},
            {
                "twist": "space vector",
                "frictions": "numbers of grasp",
                "limits": "limits of grasp",
                "row_duals": "duals",
            },
        ),
        "LoadSeries": Row(
            rg.LoadSeries,
            {"times": [0, 1], "vectors": [[0, 0, 0], [1, 1, 1]]},
            {"times": "rising", "vectors": "table"},
        ),
        "LoadSeries.sampled": Row(
            rg.LoadSeries.sampled,
            {"load": lambda t: LOAD, "duration": 1.0},
            {"load": "function", "instants": "count"},
        ),
        "LoadSeries.__call__": Row(series.__call__, {"t": 0.5}, {"t": "number"}),
        "LoadSeries.at": Row(series.at, {"t": 0.5}),
        "LoadSeries.refined": Row(series.refined, {"instants": 5}, free=("also",)),
        "LoadSeries.from_dict": Row(rg.LoadSeries.from_dict, {"data": series.to_dict()}),
        "TimeScaling": Row(
            rg.TimeScaling, {"duration": 1.0, "control": (1, 0), "degree": 1}, {"control": "control"}
        ),
        "TimeScaling.spline": Row(rg.TimeScaling.spline, {"duration": 1.0}, {"control": "control"}),
        "TimeScaling.minimum_jerk": Row(rg.TimeScaling.minimum_jerk, {"duration": 1.0}),
        "TimeScaling.linear": Row(rg.TimeScaling.linear, {"duration": 1.0}),
        "TimeScaling.fastest": Row(
            rg.TimeScaling.fastest,
            {"change": [[1.0, 0.0], [1.0, 1.0]], "rate_limit": 1.0},
            {"change": "table", "shape": "value", "rate_limit": "limits of two"},
        ),
        "TimeScaling.lasting": Row(scaling.lasting, {"duration": 2.0}),
        "TimeScaling.__call__": Row(scaling.__call__, {"t": 0.5}),
        "TimeScaling.velocity": Row(scaling.velocity, {"t": 0.5}),
        "TimeScaling.acceleration": Row(scaling.acceleration, {"t": 0.5}),
        "TimeScaling.from_dict": Row(rg.TimeScaling.from_dict, {"data": scaling.to_dict()}),
        "choose_state": Row(rg.choose_state, choosing),
        "sensitivity": Row(rg.sensitivity, choosing),
        "pyramid_losses": Row(
            rg.pyramid_losses, {"grasp": space_grasp(), "load": WEIGHT, "facets": (4,)}, {"facets": "counts"}
        ),
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
        "choose_grasp": Row(
            rg.choose_grasp,
            {"shape": SQUARE_OUTLINE, "fingers": 2, "load": WEIGHT_IN_PLANE, "friction": 0.5},
            {
                "shape": "value",
                "fingers": "count",
                "from_corners": "not negative",
                "load_offset": "not negative",
                "length": "positive",
                "min_distance": "positive",
                "disturbance": "value",
                "arcs": "table",
                "tip_radius": "not negative",
                "min_normal": "not negative",
                "keep": "function",
                "removable": "flag",
                "most_boxes": "count",
                "progress": "function",
            },
        ),
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
        "OutlineCut.from_dict": Row(
            rg.OutlineCut.from_dict, {"data": on_outline(0.01).certificate.to_dict()}
        ),
        "placement_map": Row(
            rg.placement_map,
            {"shape": SQUARE_OUTLINE, "load": WEIGHT_IN_PLANE, "friction": 0.5, "count": 8},
            {
                "shape": "value",
                "disturbance": "value",
                "fixed": "some places",
                "free": "count",
                "length": "positive",
            },
        ),
        "contact_regions": Row(
            rg.contact_regions,
            {"shape": SQUARE_OUTLINE, "grasp": placed().grasp, "load": WEIGHT_IN_PLANE},
            {"shape": "value"},
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
        "ChosenGrasp.from_dict": Row(rg.ChosenGrasp.from_dict, {"data": placed().to_dict()}),
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
        "choose_states": Row(
            rg.choose_states,
            {
                "positions": [[1, 0], [-1, 0]],
                "normals": [[-1, 0], [1, 0]],
                "frictions": 0.5,
                "force": [[0, -1.0], [0, -2.0]],
            },
            {
                "positions": "finger rows",
                "normals": "finger rows",
                "frictions": "batch lengths",
                "force": "rows",
                "torque": "numbers",
                "max_force": "batch limits",
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
        "LoadSet.hull": Row(rg.LoadSet.hull, {"loads": [LOAD]}, {"loads": "contacts", "center": "value"}),
        "LoadSet.ball": Row(
            rg.LoadSet.ball,
            {"center": LOAD},
            {"center": "value", "force": "not negative", "torque": "not negative"},
        ),
        "LoadSet.ellipsoid": Row(
            rg.LoadSet.ellipsoid, {"center": LOAD, "axes": np.eye(3)}, {"center": "value", "axes": "axes"}
        ),
        "LoadSet.tilted": Row(rg.LoadSet.tilted, {"load": LOAD, "angle": 0.1}, {"angle": "angle to pi"}),
        "LoadSet.turned": Row(rg.LoadSet.turned, {"load": LOAD}),
        "LoadSet.scaled": Row(loads.scaled, {"factor": 2.0}, {"factor": "not negative"}),
        "LoadSet.support": Row(loads.support, {"twist": [0, 0, 1]}, {"twist": "twists"}),
        "LoadSet.extreme": Row(loads.extreme, {"twist": [0, 0, 1]}, {"twist": "space vector"}),
        "LoadSet.contains": Row(loads.contains, {"load": LOAD}),
        "EquilibriumLocus": Row(rg.EquilibriumLocus, choosing),
        "EquilibriumLocus.given": Row(
            rg.EquilibriumLocus.given,
            {"grasp": GRASP, "load": LOAD, "contact": "P3", "force": [0.0, -1.0]},
            {"force": "planar vector"},
        ),
        "EquilibriumLocus.forces": Row(locus.forces, {"squeeze": middle}),
        "EquilibriumLocus.wrenches": Row(locus.wrenches, {"squeeze": middle}),
        "EquilibriumLocus.margins": Row(locus.margins, {"squeeze": middle}),
        "EquilibriumLocus.segment": Row(locus.segment, {}, {"reach": "reach"}),
        "EquilibriumLocus.state": Row(locus.state, {"squeeze": middle}, {"squeeze": "number"}),
        "EquilibriumLocus.squeeze": Row(locus.squeeze, {"state": locus.best()}),
        "EquilibriumLocus.best": Row(locus.best, {}),
        "SqueezeLocus": Row(rg.SqueezeLocus, {"grasp": GRASP, "load": LOAD}),
        "SqueezeLocus.forces": Row(squeezes.forces, {"squeezes": np.zeros(3)}, {"squeezes": "squeezes"}),
        "SqueezeLocus.squeezes": Row(squeezes.squeezes, {"forces": STATE.forces}, {"forces": "table"}),
        "SqueezeLocus.contains": Row(squeezes.contains, {"point": np.zeros(3)}, {"point": "squeezes"}),
        "SqueezeLocus.state": Row(
            squeezes.state, {"squeezes": squeezes.squeezes(STATE.balanced())}, {"squeezes": "squeezes"}
        ),
        "SqueezeLocus.margins": Row(squeezes.margins, {"squeezes": np.zeros(3)}, {"squeezes": "squeezes"}),
        "SqueezeLocus.best": Row(squeezes.best, {}),
        "SqueezeLocus.sample": Row(squeezes.sample, {"count": 3}),
        "Sensitivity.steps": Row(rg.sensitivity(PAIR, LOAD).steps, {}, {"fraction": "positive"}),
        "Sensitivity.effects": Row(rg.sensitivity(PAIR, LOAD).effects, {}, {"fraction": "positive"}),
        "locus_intervals": Row(rg.locus_intervals, batch, of_batch),
        "best_squeezes": Row(rg.best_squeezes, batch, {**of_batch, "max_force": "batch limits"}),
        "plan_removal": Row(rg.plan_removal, {"start": STATE, "contact": "P3"}, {"load": "load"}),
        "plan_addition": Row(
            rg.plan_addition,
            {"start": transition.end.without("P3"), "contact": GRASP["P3"]},
            {"contact": "value", "load": "load"},
        ),
        "plan_hold": Row(rg.plan_hold, {"start": STATE}, {"load": "load"}),
        "carried_load": Row(
            rg.carried_load,
            {"mass": 1.0, "gravity": [0.0, -9.81]},
            {
                "mass": "positive",
                "gravity": "vector",
                "position": "function",
                "orientation": "function",
                "inertia": "number",
                "step": "positive",
            },
        ),
        "plan_exchange": Row(
            rg.plan_exchange,
            {"start": STATE, "leaving": "P3", "arriving": rg.Contact([9, 9], [1, 0], 1, name="P4")},
            {"leaving": "contact of", "arriving": "value", "load": "load"},
        ),
        "Criteria": Row(
            rg.Criteria, {"objective": "effort"}, {"min_normal": "normals of any", "controlled": "controlled"}
        ),
        "ForceCost": Row(
            rg.ForceCost,
            {"name": "mine"},
            {"name": "own word", "weights": "own weights", "towards": "table", "prices": "table"},
        ),
        "plan_rotation": Row(rg.plan_rotation, {"start": transition.end.without("P3"), "angle": 0.1}),
        "verify": Row(
            rg.verify,
            {"plan": transition},
            {
                "load": "function",
                "curvature": "not negative",
                "position": "squeezes",
                "surface": "curvatures",
            },
        ),
        "Transition.forces": Row(transition.forces, {"t": 0.5}),
        "Transition.wrenches": Row(transition.wrenches, {"t": 0.5}),
        "Transition.rates": Row(transition.rates, {"t": 0.5}),
        "Transition.load": Row(transition.load, {"t": 0.5}),
        "Transition.orientation": Row(transition.orientation, {"t": 0.5}),
        "Transition.margins": Row(transition.margins, {"t": 0.5}),
        "Transition.times": Row(transition.times, {"rate": 10.0}),
        "Transition.retimed": Row(transition.retimed, {"scaling": scaling}),
        "Transition.fastest": Row(transition.fastest, {"rate_limit": 10.0}),
        "Transition.to_dataframe": Row(transition.to_dataframe, {"rate": 10.0}),
        "Transition.from_dict": Row(rg.Transition.from_dict, {"data": transition.to_dict()}),
        "bent Transition.forces": Row(bent().forces, {"t": 0.1}),
        "bent Transition.rates": Row(bent().rates, {"t": 0.1}),
        "turning Transition.forces": Row(turn.forces, {"t": 0.5}),
        "turning Transition.rates": Row(turn.rates, {"t": 0.5}),
        "turning Transition.fastest": Row(
            turn.fastest, {"rate_limit": 10.0}, {"rate_limit": "limits of two"}
        ),
        "RegraspPlan.orientation": Row(whole.orientation, {"t": 0.5}),
        "RegraspPlan.from_dict": Row(rg.RegraspPlan.from_dict, {"data": whole.to_dict()}),
        "RegraspProblem": Row(rg.RegraspProblem, {"outline": outline, **asked, **small}, or_none),
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
        "sweep": Row(
            rg.sweep,
            {"function": "study_cases:product", "grid": {"a": [1, 2]}, "out": _study(), "workers": 0},
            {
                "function": "function name",
                "grid": "grid",
                "out": "path",
                "keep": "contact names",
                "zipped": "flag",
                "plans": "flag",
                "extend": "flag",
                "workers": "workers",
                "client": "client",
                "time_limit": "time limit",
                "memory_limit": "time limit",
                "part_seconds": "not negative",
                "shared": "shared",
                "progress": "listener",
            },
        ),
        "read_study": Row(rg.read_study, {"folder": _study()}, {"folder": "path", "form": "word"}),
        "Outline": Row(rg.Outline, {"vertices": SQUARE}, {"vertices": "ring", "holes": "holes"}),
        "Outline.smooth": Row(rg.Outline.smooth, {"points": SQUARE}, {"points": "ring", "holes": "holes"}),
        "Outline.ellipse": Row(
            rg.Outline.ellipse,
            {"a": 2.0, "b": 1.0},
            {"a": "positive", "b": "positive", "centre": "planar vector", "holes": "holes"},
        ),
        "Outline.from_dict": Row(rg.Outline.from_dict, {"data": outline.to_dict()}),
        "Outline.polygon": Row(outline.polygon, {}),
        "Outline.hole_polygons": Row(rg.Outline(SQUARE, [[[1, 1], [2, 1], [2, 2]]]).hole_polygons, {}),
        "Outline.points": Row(outline.points, {"s": 0.5}, {"s": "numbers"}),
        "Outline.normals": Row(outline.normals, {"s": 0.5}, {"s": "numbers"}),
        "Outline.contact_at": Row(
            outline.contact_at, {"arc_length": 0.5, "friction": 0.5}, {"arc_length": "number"}
        ),
        "Outline.nearest": Row(outline.nearest, {"position": [1.0, 1.0]}, {"position": "planar vector"}),
        "Outline.sample": Row(outline.sample, {"count": 9}),
        "Mesh": Row(
            rg.Mesh,
            {"vertices": box.vertices, "faces": box.faces},
            {"vertices": "vertices", "faces": "faces"},
        ),
        "Mesh.box": Row(rg.Mesh.box, {"a": 1.0, "b": 1.0, "c": 1.0}, dict.fromkeys("abc", "positive")),
        "Mesh.cylinder": Row(
            rg.Mesh.cylinder, {"radius": 1.0, "height": 1.0}, dict.fromkeys(("radius", "height"), "positive")
        ),
        "Mesh.sphere": Row(rg.Mesh.sphere, {"radius": 1.0}, {"radius": "positive"}),
        "Mesh.extruded": Row(rg.Mesh.extruded, {"outline": outline, "height": 1.0}, {"height": "positive"}),
        "Mesh.nearest": Row(box.nearest, {"points": [[0.0, 0.0, 0.0]]}, {"points": "space points"}),
        "Mesh.normals": Row(box.normals, {"points": box.sample(2)}, {"points": "space points"}),
        "Mesh.contact_at": Row(
            box.contact_at, {"point": box.sample(1)[0], "friction": 0.5}, {"point": "space vector"}
        ),
        "Mesh.sample": Row(box.sample, {"count": 3}),
        "Mesh.contacts": Row(box.contacts, {"count": 3, "friction": 0.5}),
    }
    return {**result, **file_rows(), **picture_rows()}


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


def file_rows() -> dict[str, Row]:
    import regrasp.files as files
    from regrasp.files.scenarios.templates import template

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
        "Outline.from_file": Row(rg.Outline.from_file, {"path": "none.svg"}),
        "Mesh.from_file": Row(rg.Mesh.from_file, {"path": "none.stl"}),
        "Mesh.save_stl": Row(mesh().save_stl, {}),
    }


PICTURES = {
    "ax": "value", "units": "value", "label": "text of a label", "colour": "colour", "colours": "colours",
    "force_scale": "positive", "reach": "positive", "control": "flag", "shadow": "flag", "absent": "names",
    "order": "names", "o": "orientation", "torques": "row", "arc_lengths": "row",
    "force_limits": "two limits", "objective": "word", "at_value": "number", "title": "text of a label",
    "caption": "text of a label", "path": "path", "frames_per_second": "positive",
    "move_time": "not negative", "chosen": "value", "load_size": "positive", "force": "planar vector",
    "contact": "contact of", "mesh": "value", "outline": "value", "plan": "value", "shape": "value",
    "components": "two components", "rate_limit": "limits of three", "values": "row",
}  # fmt: skip
"""Of parameters of pictures."""


def picture_rows() -> dict[str, Row]:
    """What every picture draws, and how; the first need not be right where the rest is seen before it."""
    import regrasp.plots as plots

    firsts = {
        "transition": removal, "plan": removal, "value": removal, "grasp": lambda: GRASP,
        "state": lambda: STATE, "locus": lambda: rg.EquilibriumLocus(PAIR, LOAD),
        "contact": lambda: GRASP["P1"],
        "loads": VALUES["LoadSet"], "curve": VALUES["MarginCurve"], "graph": VALUES["HoldGraph"],
        "directions": lambda: np.eye(3),
    }  # fmt: skip
    more = {
        "load_size": 1.0, "outline": ellipse(), "values": [1.0] * 3, "contact": "P1", "shape": ellipse(),
        "path": "none/film.gif",
    }  # fmt: skip
    found = {}
    for name in plots.__all__:
        draw = getattr(plots, name)
        if not inspect.isfunction(draw) or name == "png":
            continue
        first, *others = inspect.signature(draw).parameters
        drawn = regrasp() if name == "plot_regrasp" else firsts.get(first, lambda: None)()
        needed = {first: drawn} | {key: more[key] for key in others if key in more}
        kinds = {key: PICTURES[key] for key in others}
        kinds[first] = "table" if first == "directions" else "value"
        found[f"plots.{name}"] = Row(draw, needed, kinds)
    return found


KINDS |= {
    "contact names": (*ANYTHING[1:4], *ANYTHING[6:], None, 3, nan, HUGE, [OBJECT], ["Q"], [99], [1.5]),
    "load": [value for value in NOT_A_VALUE if not callable(value)],  # what a function does is its own
    "limits of two": (*NOT_NUMBERS, 0, -1, [1, 2, 3], [0, 0], [[1, 1]]),
    "text of a label": (b"x", OBJECT, {}, 1j, None, 3, nan, HUGE, True, []),
    "colour": (*ANYTHING[:2], *ANYTHING[3:], None, 3, nan, HUGE, True, []),
    "colours": (*NOT_A_VALUE[:4], *NOT_A_VALUE[5:], {"P1": 3}, {"P1": "no colour"}),
    "names": (*ANYTHING[:4], *ANYTHING[6:], None, 3, nan, HUGE, True, [3], [None]),
    "row": (*NOT_NUMBERS, np.zeros((2, 2))),
    "orientation": [wrong for wrong in NOT_A_COUNT if type(wrong) is not int or wrong > 0],
    "two components": (*NOT_A_VALUE, ["fx"], ["fx", "fx"], ["fx", "fz"], ["fx", 1], "fx"),
    "limits of three": (*NOT_NUMBERS, 0, -1, [1, 2], [0, 0, 0], [[1, 1, 1]]),
    "two limits": (*NOT_NUMBERS, 5, [1], [0, 1], [-1, 1], [1, 2, 3]),
    "rows": (*NOT_NUMBERS, 5, [1], [1, 2, 3], np.zeros((2, 3)), np.zeros((7, 2))),
    "entries": (*NOT_NUMBERS, -1, [0.5, -0.5], np.ones(7)),
    "batch torque": (*NOT_NUMBERS, np.ones(7)),
    "batch limits": (*NOT_NUMBERS, 0, -1, (1, 2, 3), np.ones(7)),
    "vector of 3 or 6": (*NOT_NUMBERS, 5, [], [1, 2], [1, 2, 3, 4], np.zeros((3, 3))),
    "divisor": (*NOT_A_NUMBER, 0),
    "numbers of grasp": (*NOT_NUMBERS, [1, 2, 3], [-1, 0]),
    "limits of grasp": (
        *[v for v in NOT_NUMBERS if not (isinstance(v, list) and inf in v)],
        [1, 2, 3],
        [-1, 0],
    ),
    "own word": (b"x", OBJECT, {}, 1j, None, 3, nan, HUGE, True, [], "angle"),
    "own weights": (*NOT_NUMBERS, 0, -1, [0, 0], [1, -1], [[1, 1]]),
    "normals of any": (*ANYTHING, "1.0", nan, inf, HUGE, True, -1.0, [], [nan, 1], [-1, 0], [[1, 1]]),
    "least normals": (
        *ANYTHING, "1.0", nan, inf, -inf, HUGE, True, -1.0, [], [nan, 1], [-1, 0], [1, 2, 3, 4, 5], [[1, 1]],
        np.array(["x", "y"]), [OBJECT, 1],
    ),
    "stiffnesses": (*NOT_NUMBERS, [], 0, -1.0, [0, 0], [-1, 1], np.ones((1, 1, 1, 1))),
    "contact limits": (*[v for v in NOT_A_VALUE if v is not None], ([[1, 0, 0]], [1]), ([[1, 0]], [0])),
    "duals": (*NOT_NUMBERS, 5, [1.0], [-1.0], np.ones((2, 2))),
    "bounds": (*NOT_NUMBERS, 5, [], [0, 1], [-1, 1], [1, 2, 3], np.ones((2, 2))),
    "torques": (
        *[v for v in NOT_NUMBERS if not isinstance(v, list) or v[:1] != [inf]],
        *(0, -1, [0, 1], [1, 2, 3], np.ones((2, 2))),
    ),
    "some normal": (*[v for v in NOT_A_VECTOR if v is not None], [0, 0], [1, 2, 3]),
    "rising limits": (*NOT_NUMBERS, 5, [], [2, 1], [1, 1], [-1, 1], np.zeros((2, 2))),
    "finger rows": (*NOT_NUMBERS, [], [1, 2, 3], np.ones((3, 4))),
    "fingers' numbers": (*NOT_NUMBERS, [], -1.0, [1, 2, 3]),
    "batch lengths": (*NOT_NUMBERS, [], 0.0, -1.0, [1, 2, 3]),
    "batch springs": (*NOT_NUMBERS, [], 0.0, -1.0, [1, 2, 3]),
    "curvatures": (*NOT_NUMBERS, [], [1, 2], np.zeros((2, 2))),
    "controlled": ("x", b"x", OBJECT, 3, nan, HUGE, True, [-1], [1.5], ["x"], [OBJECT]),
    "gap": [v for v in NOT_POSITIVE if not (isinstance(v, float) and v == inf)],
    "twists": (*NOT_NUMBERS, 5, [], [1, 2], np.zeros((3, 2))),
    "key": ("", "grasp", OBJECT, 3, nan, None),
    "axes": (*NOT_NUMBERS, 5, [], [1, 2], np.zeros((2, 2)), np.zeros((3, 3, 3))),
    "angle to pi": (*NOT_A_NUMBER, -1.0, 4.0),
    "jacobians": (
        *ANYTHING, 3, nan, HUGE, True, [], [np.eye(2)], [np.eye(3)] * 3, [[1, 2]] * 3, [OBJECT] * 3,
    ),
    "layers": (b"x", OBJECT, 1j, 3, nan, HUGE, True, [], [3], {}, [None]),
    "rising": (*NOT_NUMBERS, 5, [], [0], [0, 0], [1, 2], [0, -1]),
    "control": (*NOT_NUMBERS, 5, [], [1], [1, 2, 0], [0, 1], [[1, 0]]),
    "counts": (*NOT_A_VALUE, [2], [1.5], ["4"], [HUGE], "4"),
    "reach": (*[v for v in NOT_A_NUMBER if not (isinstance(v, float) and v == inf)], -1.0),
    "squeezes": (*NOT_NUMBERS, 5, [], [1], [1, 2, 3, 4], np.zeros((2, 2))),
    "places": (*NOT_A_VALUE, (0, 1), (0, 1, 99), (0, 1, 1.5), (0, 1, HUGE)),
    "bars": (*NOT_NUMBERS, 5, [], [1], [1, 2, 3, 4], np.zeros((4, 2)), np.zeros((2, 3))),
    "ring": (
        *NOT_NUMBERS, 5, [], [1, 2], [[0, 0], [1, 1]], [[0, 0], [1, 1], [2, 2]], np.zeros((4, 2)),
        np.zeros((4, 3)),
    ),
    "holes": (*ANYTHING[2:4], *ANYTHING[5:], None, 3, nan, HUGE, [1], ["x"], [[[0, 0], [1, 1]]]),
    "vertices": (*NOT_NUMBERS, 5, [], [1, 2], np.zeros((8, 2)), np.zeros((8, 3)), np.zeros((2, 3))),
    "faces": (*NOT_NUMBERS, 5, [], [1, 2], [[0, 1]], [[0, 1, 99]], [[0, 1, -9]], [[0, 1, 2.5]], [[0, 1, 2]]),
    "space points": (*NOT_NUMBERS, 5, [1, 2], np.zeros((2, 2))),
    "text": (None, 3, nan, HUGE, b"x", [], {}, OBJECT, "x", "\0", "[" * 5000, "x = " + "[" * 900 + "]" * 900),
}  # fmt: skip


LONG = ("x" * 10_000, "two\nlines " * 1_000, list(range(1_000)), ["word"] * 1_000, {"k" * 9_999: 10**999})
"""What a message must not repeat in full."""


class Case(NamedTuple):
    """One wrong call."""

    name: str
    parameter: str
    wrong: Any


def cases(row_name: str, row: Row) -> Iterator[Case]:
    """Every wrong value for every parameter of a row."""
    for name, parameter in inspect.signature(row.call).parameters.items():
        if name in row.free:
            continue
        kind = row.kinds.get(name, NAMES.get(name))
        assert kind is not None, f"{row_name}: no kind of wrong values for its parameter {name!r}"
        for wrong in KINDS[kind]:
            if not (wrong is None and parameter.default is None):
                yield Case(row_name, name, wrong)
    for name in set(row.right) - inspect.signature(row.call).parameters.keys():  # options of a verb
        for wrong in KINDS[NAMES[name]]:
            yield Case(row_name, name, wrong)


def long_cases(row_name: str, row: Row) -> Iterator[Case]:
    """Every parameter of a row with text and lists that are long; some may be right."""
    parameters = inspect.signature(row.call).parameters
    names = (parameters.keys() | row.right.keys()) - {*row.free, "options"}
    needed = {
        name
        for name in parameters.keys() - {"options"}
        if parameters[name].default is inspect.Parameter.empty
    }
    for name in sorted(names):
        if row.kinds.get(name, NAMES.get(name)) not in ("name", "own word") and needed <= row.right.keys() | {
            name
        }:
            yield from (Case(row_name, name, wrong) for wrong in LONG)


def called_wrongly(row: Row, case: Case) -> Any:
    """The call with the one wrong argument."""
    given = row.right | {case.parameter: case.wrong}
    positional = [
        given.pop(name)
        for name, parameter in inspect.signature(row.call).parameters.items()
        if parameter.kind is inspect.Parameter.POSITIONAL_ONLY and name in given
    ]
    return row.call(*positional, **given)

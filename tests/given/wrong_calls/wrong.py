"""Values that each kind of parameter must refuse, and the kinds of parameters by their names."""

from collections.abc import Sequence
from math import inf, nan
from typing import Any

import numpy as np

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
    "count or places": (*ANYTHING, "3", nan, inf, HUGE, -1, 1.5, 3.0, True, [], [nan, 1], [[1, 2]], [OBJECT]),
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
    "clearance": "not negative", "orientations": "some or all", "candidates": "count or places",
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

LONG = ("x" * 10_000, "two\nlines " * 1_000, list(range(300)), ["word"] * 300, {"k" * 9_999: 10**999})
"""What a message must not repeat in full."""

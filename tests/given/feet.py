"""Paths of two feet that carry what stands on them, for tests of path programs and their search."""

from math import inf

import numpy as np

import regrasp as rg
from regrasp.planning.changes.path_program import PathTask
from regrasp.planning.changes.path_search import planned_path
from regrasp.planning.states.criteria import Criteria

FEET = rg.Grasp([rg.Contact([-1, 0], [0, 1], 0.5), rg.Contact([1, 0], [0, 1], 0.5)])
"""Two feet carry what stands on them; across they can squeeze."""


PAIR = rg.Grasp([rg.Contact([-1, 0], [1, 0], 0.5), rg.Contact([1, 0], [-1, 0], 0.5)])
"""Two fingers that press against each other."""


def on_feet(way: float) -> rg.Grasp:
    """The feet, or turned over: then they hang."""
    return rg.Grasp(rg.Contact(foot.position, way * foot.normal, foot.friction) for foot in FEET)


def task(start=(1.0, 1.0), end=(1.0, 1.0), lean=0.0, count=5, **changes) -> PathTask:
    """Normal forces at both ends; the load's place moves by ``lean`` and back, as a torque."""
    times = np.linspace(0, 1, count)
    loads = np.array([[0.0, -2.0, lean * np.sin(np.pi * t)] for t in times])
    values = {
        "grasp": FEET, "times": times, "loads": loads,
        "start": np.array([[0.0, start[0]], [0.0, start[1]]]),
        "end": np.array([[0.0, end[0]], [0.0, end[1]]]),
        "active": np.ones((count, 2), dtype=bool), "phases": times, "frictions": np.full(2, 0.5),
        "limits": np.full(2, inf), "rates": np.full(2, inf), "least_normals": np.zeros(2),
        "stays": np.ones(2, dtype=bool), "unit": 1.0,
    }  # fmt: skip
    return PathTask(**values | changes)


def planned(asked, objective="change", backend="clarabel"):
    return planned_path(asked, objective, Criteria("angle"), backend).forces

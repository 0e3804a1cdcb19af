"""Contacts, wrenches, grasps, their states, and sets of loads."""

from math import inf

import numpy as np

import regrasp as rg
from paper import GRASP, LOAD, STATE
from values import PAIR, WEIGHT
from wrong_calls.row import Row


def rows() -> dict[str, Row]:
    contact = {"position": [1.0, 2.0], "normal": [0.0, 1.0], "friction": 0.5}
    planar = {"position": "vector", "normal": "normal"}
    loads = rg.LoadSet.ball(LOAD, force=1.0, torque=0.1)
    return {
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
        "LoadSet.from_dict": Row(rg.LoadSet.from_dict, {"data": loads.to_dict()}),
        "LoadSet.scaled": Row(loads.scaled, {"factor": 2.0}, {"factor": "not negative"}),
        "LoadSet.support": Row(loads.support, {"twist": [0, 0, 1]}, {"twist": "twists"}),
        "LoadSet.extreme": Row(loads.extreme, {"twist": [0, 0, 1]}, {"twist": "space vector"}),
        "LoadSet.contains": Row(loads.contains, {"load": LOAD}),
    }

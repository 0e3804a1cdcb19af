"""States that are chosen, what they are chosen by, and all forces that balance."""

import numpy as np

import regrasp as rg
from paper import GRASP, LOAD, STATE
from values import PAIR, WEIGHT, space_grasp
from wrong_calls.row import Row


def rows() -> dict[str, Row]:
    choosing = {"grasp": PAIR, "load": LOAD}
    locus, squeezes = rg.EquilibriumLocus(PAIR, LOAD), rg.SqueezeLocus(GRASP, LOAD)
    middle = float(np.mean(locus.interval))
    batch = {
        "r1": [[-1.0, 0.0], [-1.0, 0.1]], "n1": [[1.0, 0.0], [1.0, 0.0]], "mu1": 0.5,
        "r2": [1.0, 0.0], "n2": [-1.0, 0.0], "mu2": 0.5, "force": [0.0, -1.0], "torque": 0.0,
    }  # fmt: skip
    of_batch = {
        "r1": "rows", "n1": "rows", "r2": "rows", "n2": "rows", "force": "rows", "mu1": "entries",
        "mu2": "entries", "torque": "batch torque",
    }  # fmt: skip
    return {
        "choose_state": Row(rg.choose_state, choosing),
        "sensitivity": Row(rg.sensitivity, choosing),
        "pyramid_losses": Row(
            rg.pyramid_losses, {"grasp": space_grasp(), "load": WEIGHT, "facets": (4,)}, {"facets": "counts"}
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
        "Criteria": Row(
            rg.Criteria, {"objective": "effort"}, {"min_normal": "normals of any", "controlled": "controlled"}
        ),
        "ForceCost": Row(
            rg.ForceCost,
            {"name": "mine"},
            {"name": "own word", "weights": "own weights", "towards": "table", "prices": "table"},
        ),
    }

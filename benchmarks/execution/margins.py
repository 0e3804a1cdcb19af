"""Which measures of a state predict what it withstands: MuJoCo under random disturbances.

    python benchmarks/execution/margins.py [--quick] [-o DIR]

Random grasps of two and three fingers around an ellipse hold a weight with forces chosen for one of five
objectives. A random disturbance grows until some contact has slid by 3e-4 of the object's size: its critical
factor. Beside it stand what the springs' linear answer says, and measures of the state and the grasp, by rank
correlation.
"""

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np

import regrasp as rg
from regrasp.execution import simulate
from regrasp.mechanics.checks import Array

OBJECTIVES = ("angle", "force", "friction_use", "effort", "wrench")
STIFFNESS = 4000.0  # [N/m], far above what these grasps need
SLIPPED, DURATION, RISE = 3e-4, 0.5, 0.4
WEIGHT = rg.Wrench([0.0, -3.0])
RATIO = 3.0  # of force limits to the least peak force


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--quick", action="store_true", help="few grasps, to see that it works")
    arguments.add_argument("-o", "--output", type=Path, default=Path(__file__).parents[1] / "results")
    given = arguments.parse_args()
    rows = measured(4 if given.quick else 60, directions=1 if given.quick else 3)
    found = summary(rows)
    given.output.mkdir(parents=True, exist_ok=True)
    (given.output / "margins.json").write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    for key, value in found.items():
        print(f"{key}: {value}")


def measured(count: int, directions: int) -> list[dict[str, Any]]:
    """A row for each grasp and direction."""
    rng = np.random.default_rng(0)
    outline, rows = rg.Outline.ellipse(0.06, 0.04), []
    while len(rows) < count * directions:
        fingers = int(rng.integers(2, 4))
        places = rng.random(fingers) * outline.length
        grasp = rg.Grasp(outline.contact_at(s, friction=float(rng.uniform(0.3, 0.8))) for s in places)
        objective = str(rng.choice(OBJECTIVES))
        try:
            peak = rg.choose_state(grasp, WEIGHT, "peak").value
            if peak > 10:
                continue
            chosen = rg.choose_state(grasp, WEIGHT, objective, max_force=RATIO * peak)
        except rg.InvalidInput:
            continue
        except rg.Infeasible:
            continue
        state = rg.GraspState(grasp, WEIGHT, chosen.forces)
        if (state.magnitudes < 0.05 * state.magnitudes.max()).any():
            continue  # an idle finger answers nothing
        about = measures(state, RATIO * peak)
        for _ in range(directions):
            d = rng.normal(size=3)
            d /= np.linalg.norm(d)
            rows.append({**about, **withstood(state, d * [1, 1, grasp.size]), "objective": objective})
        print(len(rows), objective, fingers, flush=True)
    return rows


def measures(state: rg.GraspState, limit: float) -> dict[str, float]:
    """Of the state, and of its grasp."""
    grasp, margins = state.grasp, state.margins
    tolerances = rg.tolerances(state).withstood
    quality = rg.quality(grasp, limit=limit)
    return {
        "angle": margins.least_angle,
        "force": margins.least_force,
        "friction_use": -margins.largest_friction_use,
        "sum of normals": float(grasp.cones.normal(state.forces).sum()),
        "wrench": rg.Criteria("wrench").objective.value(state),
        "tilt": tolerances.tilt,
        "load": tolerances.load,
        "wrench_ball_Linf": quality["wrench_ball_Linf"].value,
        "least_singular_value": quality["least_singular_value"].value,
        "isotropy": quality["isotropy"].value,
        "least_friction": -rg.least_friction(grasp, WEIGHT).value,
    }


def withstood(state: rg.GraspState, direction: Array) -> dict[str, float]:
    """The critical factor of one disturbance: linear, and in physics."""
    d = rg.Wrench.from_vector(direction)
    segment = rg.LoadSet.hull([0 * d, d], center=0 * d)
    linear = rg.Criteria("wrench", disturbance=segment).objective.value(state)
    plan = rg.plan_hold(state, end=state, duration=DURATION)
    low, high = 0.0, max(2.5 * linear, 0.2)
    for _ in range(8):
        middle = (low + high) / 2
        if slips(plan, middle * d):
            high = middle
        else:
            low = middle
    return {"linear": linear, "physics": low}


def slips(plan: rg.Transition, disturbance: rg.Wrench) -> bool:
    """Whether a contact slides while a disturbance rises."""
    run = simulate(
        plan, stiffness=STIFFNESS, disturbance=lambda t: min(t / (RISE * DURATION), 1.0) * disturbance
    )
    return run.dropped or float(run.slip.max()) > SLIPPED * plan.grasp.size


def summary(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Rank correlations with what physics withstood, and how near the linear answer is."""
    kinds = [key for key in rows[0] if key not in ("linear", "physics", "objective")]
    physics = np.array([row["physics"] for row in rows])
    linear = np.array([row["linear"] for row in rows])
    known = physics > 0
    ratios = linear[known] / physics[known]
    found: dict[str, Any] = {"runs": len(rows), "linear answer, rank correlation": spearman(linear, physics)}
    found |= {key: spearman(np.array([row[key] for row in rows]), physics) for key in kinds}
    found["linear / physics, quartiles"] = np.percentile(ratios, [25, 50, 75]).round(3).tolist()
    found["within 10 %"] = round(float((abs(ratios - 1) < 0.1).mean()), 3)
    return found


def spearman(a: Array, b: Array) -> float:
    """Rank correlation, ties by their mean rank."""
    ranks = [mean_ranks(x) for x in (a, b)]
    return round(float(np.corrcoef(*ranks)[0, 1]), 3) if min(map(np.std, ranks)) > 0 else float("nan")


def mean_ranks(values: Array) -> Array:
    """(m,) ranks."""
    _, inverse, counts = np.unique(values.round(9), return_inverse=True, return_counts=True)
    ends = np.cumsum(counts)
    return ((2 * ends - counts - 1) / 2)[inverse]


if __name__ == "__main__":
    main()

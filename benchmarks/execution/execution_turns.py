"""Where slip of turning objects comes from: ``python benchmarks/execution/execution_turns.py``.

One regrasp that turns, its steps as long as each of ``DURATIONS``, simulated with each of ``TIMESTEPS``. What
goes with the timestep is of the simulation, what goes with the square of the angular velocity of the turn.
"""

import json
from pathlib import Path

import numpy as np

import regrasp as rg
from regrasp.execution import simulate

RESULTS = Path(__file__).parents[1] / "results" / "execution_turns.json"
DURATIONS = (1.0, 2.0, 4.0)  # [s] of each step
TIMESTEPS = (1.0, 0.5, 0.25)  # of the default
SHAPE = rg.Outline.ellipse(0.04, 0.02)


def regrasp(duration: float) -> rg.RegraspPlan:
    """Three fingers get to other places on an ellipse that turns meanwhile, under its weight."""
    start, goal = (
        rg.Grasp(SHAPE.contact_at(p * SHAPE.length, friction=0.5) for p in places)
        for places in ((0.02, 0.35, 0.7), (0.2, 0.5, 0.85))
    )
    return rg.plan_regrasp(SHAPE, start, goal, rg.Wrench([0, -3.0]), friction=0.5, step_duration=duration)


def measured() -> list[dict[str, float]]:
    """Largest slips [mm] of every run."""
    rows = []
    for duration in DURATIONS:
        plan = regrasp(duration)
        default = simulate(plan, shape=SHAPE)
        step = float(np.diff(default.times[1:3])[0]) / 5  # samples are five steps apart
        for share in TIMESTEPS:
            run = default if share == 1 else simulate(plan, shape=SHAPE, timestep=share * step)
            rows.append(
                {
                    "step_duration": duration,
                    "timestep": share,
                    "slip": 1e3 * float(run.slip.max()),
                    "held": run.held,
                    "limit": 3e-4 * 1e3 * max(s.grasp.size for s in plan.steps),
                }
            )
    return rows


if __name__ == "__main__":
    rows = measured()
    RESULTS.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
    for row in rows:
        print(row)

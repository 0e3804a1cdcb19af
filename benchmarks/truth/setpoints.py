"""What ``verify_setpoints`` takes for a set-point, comparison with the plan included, by number of rows.

    python benchmarks/truth/setpoints.py [-o FILE]

The best of three by processor time, of plans of every kind of path: straight, through instants, turning, in
the plane and in space.
"""

import argparse
import json
from pathlib import Path
from time import process_time

import numpy as np

import regrasp as rg
from regrasp.verification import verify_setpoints

RESULTS = Path(__file__).parents[1] / "results" / "setpoints.json"
ROWS = (1_001, 10_001, 100_001, 1_000_001)
FLAT = rg.Grasp(
    rg.Contact(r, n, 0.3, name=name)
    for name, r, n in (("P1", [-4, -4], [1, 1]), ("P2", [4, -5], [-1, 2]), ("P3", [0, 8], [0, -1]))
)
BALL = rg.Grasp(
    rg.Contact(p, [-x for x in p], 0.7)
    for p in ([1, 0, 0], [-0.5, 0.8, 0.1], [-0.5, -0.8, -0.1], [0, 0.1, 1])
)
LOAD, WEIGHT = rg.Wrench([-1.5, -3.5]), rg.Wrench([0, 0, -1.0])


def plans() -> dict[str, rg.Transition]:
    return {
        "removal": rg.plan_removal(FLAT, "P3", load=LOAD),
        "101 instants": rg.plan_removal(FLAT, "P3", load=LOAD, rate_limit=14.0, duration=1.0),
        "turn": rg.plan_rotation(FLAT.without("P3"), 0.2, load=LOAD),
        "removal in space": rg.plan_removal(BALL, "P4", load=WEIGHT),
        "turn in space": rg.plan_rotation(BALL, 0.5, axis=[1, 0, 0], load=WEIGHT),
    }


def microseconds(plan: rg.Transition, rows: int) -> float:
    """Of a set-point, the best of three [us]."""
    t = np.linspace(0.0, plan.duration, rows)
    forces, angles = plan.forces(t), None if plan.turn is None else plan.orientation(t)
    best = np.inf
    for _ in range(3):
        start = process_time()
        assert verify_setpoints(plan, forces, t, angles).ok
        best = min(best, process_time() - start)
    return float(1e6 * best / rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("-o", type=Path, default=RESULTS)
    found = {name: [round(microseconds(plan, rows), 3) for rows in ROWS] for name, plan in plans().items()}
    parser.parse_args().o.write_text(json.dumps({"rows": ROWS, "us": found}, indent=1) + "\n")
    for name, times in found.items():
        print(f"| {name} | " + " | ".join(f"{time:.2f}" for time in times) + " |")


if __name__ == "__main__":
    main()

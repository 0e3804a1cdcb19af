"""What is said to be withstood, on thousands of random grasps, judged by code that knows none of ours.

    python benchmarks/truth/withstood.py [--quick] [--speeds] [-o DIR]

Tolerances: a thousandth less is withstood by every member, a thousandth more has a witness. The forces of a
deviation follow from the displacement of the object on its fingers' springs, solved for here; stiffness
differs by contact and direction in half of the grasps. Largest loads: a linear program (HiGHS) in the plane,
a conic one (Clarabel) in space says a thousandth less is held and a thousandth more is not. Plans: random
members of the sets of fifty plans at random instants.
"""

import argparse
import json
from collections import Counter
from collections.abc import Callable
from functools import partial
from math import pi
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
from numpy.typing import NDArray

import regrasp as rg
from withstood_grasps import plans, random_grasp, states
from withstood_judges import judge_growth, judge_largest, judge_laws, judge_members, judge_tolerances

Array = NDArray[np.float64]
STATES, LOADS, PLANS, MEMBERS, GRASPS = 3000, 2000, 50, 2000, 2000


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--quick", action="store_true", help="few grasps, to see that it works")
    arguments.add_argument("-o", "--output", type=Path, default=Path(__file__).parents[1] / "results")
    arguments.add_argument("--speeds", action="store_true", help="only processor times, anew")
    given = arguments.parse_args()
    share = 100 if given.quick else 1
    if given.speeds:
        kept = given.output / "withstood.json"
        found = json.loads(kept.read_text(encoding="utf-8"))
        found["processor time"] = speeds(np.random.default_rng(2), 100 // share + 1)
        kept.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
        print(json.dumps(found["processor time"], indent=1))
        return
    began, rng = process_time(), np.random.default_rng(1)
    counts: Counter[str] = Counter()
    given.output.mkdir(parents=True, exist_ok=True)

    def save(**more: Any) -> None:
        found: dict[str, Any] = {"processor_seconds": round(process_time() - began, 1)}
        found |= dict(sorted(counts.items())) | more
        text = json.dumps(found, indent=1) + "\n"
        (given.output / "withstood.json").write_text(text, encoding="utf-8")

    for plan, loads in plans(rng, max(PLANS // share, 3)):
        judge_members(plan, loads, rng, MEMBERS // share, counts)
    for state, _ in states(rng, LOADS // share):
        judge_largest(state, counts)
    for k in range(GRASPS // share):
        judge_laws(random_grasp(rng, 2, 2 + k % 4)[0], counts)
        if k % 10 == 0:
            judge_growth(random_grasp(rng, 2, 2 + k % 3), counts)
    save()
    for k, (state, stiffness) in enumerate(states(rng, STATES // share)):
        judge_tolerances(state, stiffness, counts)
        if k % 250 == 249:
            save()
    save(**{"processor time": speeds(rng, 100 // share + 1)})
    print((given.output / "withstood.json").read_text(encoding="utf-8"))


def speeds(rng: np.random.Generator, count: int) -> dict[str, str]:
    """Processor time of one call, after a first one: median, 95th percentile and largest."""
    spent: dict[str, list[float]] = {}

    def timed(what: str, call: Callable[[], object], items: int = 1) -> None:
        began = process_time()
        call()
        spent.setdefault(what, []).append((process_time() - began) / items)

    rg.wrench_ball(random_grasp(rng, 3, 4)[0], limit=1.0)
    for k in range(10 * count):
        fingers = 4 + k % 5
        grasp, _ = random_grasp(rng, 3, fingers)
        timed(f"wrench_ball to 1 %, space, {fingers} fingers", partial(rg.wrench_ball, grasp, limit=1.0))
    for d, n, what in ((2, 2, "two planar contacts"), (3, 4, "four contacts in space")):
        for state, _ in states(rng, count + 1, d, n):
            timed(f"tolerances, {what}", partial(rg.tolerances, state))
    m = 40 * count
    angles = rng.uniform(0, 2 * pi, (m, 1)) + 2 * pi * np.arange(3) / 3 + rng.uniform(-0.3, 0.3, (m, 3))
    arms = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    pushes, forces = -arms + 0.2 * rng.normal(size=arms.shape), rng.normal(size=(m, 2))
    for objective in ("force", "effort", "angle", "friction_use"):
        many = partial(rg.choose_states, arms, pushes, 0.6, forces, objective=objective)
        rg.choose_states(arms[:9], pushes[:9], 0.6, forces[:9], objective=objective)
        for _ in range(5):
            timed(f"choose_states, three planar fingers, {objective}, a grasp", many, m)
    for _ in range(5):
        timed("batch_tolerances, three planar fingers, a grasp", partial(_batch, arms, pushes), m)
    return {
        what: " / ".join(f"{1e6 * x:.3g} us" for x in (*np.quantile(values, [0.5, 0.95]), max(values)))
        for what, values in spent.items()
    }


def _batch(arms: Array, pushes: Array) -> object:
    return rg.batch_tolerances(arms, pushes, 0.6, pushes)


if __name__ == "__main__":
    main()

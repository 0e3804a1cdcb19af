"""Two versions of the package beside each other: rows of both in turn, each round a process of its own.

    git worktree add ../before COMMIT
    python benchmarks/answers/versions.py ../before/src src --rounds 7

Processor time of one call, the median and quartiles of the rounds' ratios: a busy machine
disturbs both alike.
"""

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from statistics import median, quantiles
from time import process_time

LEAST = 0.15
"""Seconds of each row in each round."""


def rows() -> dict[str, Callable[[], object]]:
    """What versions may know, by name: each call is of new values, as people make them."""
    import numpy as np

    import regrasp as rg

    rng = np.random.default_rng(3)
    three = rg.Grasp(
        [
            rg.Contact([-4, -4], [1, 1], 0.3, name="P1"),
            rg.Contact([4, -5], [-1, 2], 0.3, name="P2"),
            rg.Contact([0, 8], [0, -1], 0.3, name="P3"),
        ]
    )
    two, load = three.without("P3"), rg.Wrench([-1.5, -3.5])
    points = rng.normal(size=(5, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    five = rg.Grasp(rg.Contact(p, -p, 0.6) for p in points)
    weight = rg.Wrench([0, 0, -1.0])
    state = rg.choose_state(three, load, "force")
    found: dict[str, Callable[[], object]] = {}
    for objective in ("angle", "effort", "peak", "force", "friction_use", "peak_normal", "sum_normal"):
        found[f"two contacts, {objective}, closed form"] = lambda o=objective: rg.choose_state(two, load, o)
        found[f"three contacts, {objective}"] = lambda o=objective: rg.choose_state(three, load, o)
        found[f"five contacts in space, {objective}"] = lambda o=objective: rg.choose_state(five, weight, o)
    found["Grasp(...), two contacts, angle"] = lambda: rg.choose_state(rg.Grasp(list(two)), load, "angle")
    found["locus of two contacts"] = lambda: rg.EquilibriumLocus(two, load).interval
    found["plan_removal, angle, from a state"] = lambda: rg.plan_removal(state, "P3")
    found["plan_removal, effort, from a state"] = lambda: rg.plan_removal(state, "P3", objective="effort")
    found["plan_removal, angle, from a new state"] = lambda: rg.plan_removal(
        rg.GraspState(three, load, state.forces), "P3"
    )
    found["plan_removal, effort, from a new state"] = lambda: rg.plan_removal(
        rg.GraspState(three, load, state.forces), "P3", objective="effort"
    )
    found["plan_removal, angle, from a grasp"] = lambda: rg.plan_removal(three, "P3", load=load)
    found["plan_rotation, three contacts, effort"] = lambda: rg.plan_rotation(
        three, 0.5, load=load, objective="effort"
    )
    found["plan_hold, 101 instants"] = lambda: rg.plan_hold(
        three, lambda t: rg.Wrench([-1.5, -3.5 - t]), objective="effort"
    )
    return found


def timed() -> dict[str, float]:
    """Seconds of one call of every row that this version knows, the best of three bunches."""
    seconds = {}
    for name, call in rows().items():
        try:
            call()
        except (AttributeError, ValueError):  # a verb or an objective of later
            continue
        began = process_time()
        call()
        count = max(1, round(LEAST / 3 / max(process_time() - began, 1e-6)))
        bunches = []
        for _ in range(3):
            began = process_time()
            for _ in range(count):
                call()
            bunches.append((process_time() - began) / count)
        seconds[name] = min(bunches)
    return seconds


def measured(source: Path) -> dict[str, float]:
    """The rows of a version, in a process of its own."""
    done = subprocess.run(
        [sys.executable, __file__, "--one"],
        env={**os.environ, "PYTHONPATH": str(source.resolve())},
        stdout=subprocess.PIPE,
        check=True,
    )
    return json.loads(done.stdout)


def main() -> None:
    """The command line above."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("sources", type=Path, nargs="*", help="folders of both versions: before, now")
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--one", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.one:
        print(json.dumps(timed()))
        return
    if len(options.sources) != 2:
        parser.error("give two folders: the version before, and the one now")
    rounds = [[measured(source) for source in options.sources] for _ in range(options.rounds)]
    print("| row | before [us] | now [us] | now / before | quartiles |\n|---|--:|--:|--:|--:|")
    for name in (name for name in rounds[0][0] if name in rounds[0][1]):
        before, now = (median(pair[side][name] for pair in rounds) for side in (0, 1))
        low, ratio, high = quantiles([pair[1][name] / pair[0][name] for pair in rounds], method="inclusive")
        print(f"| {name} | {1e6 * before:.2f} | {1e6 * now:.2f} | {ratio:.4f} | {low:.4f} to {high:.4f} |")


if __name__ == "__main__":
    main()

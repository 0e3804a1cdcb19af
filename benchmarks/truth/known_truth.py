"""Random programs in random units, whose truth is known, through every back end: how many answers are right.

    python benchmarks/truth/known_truth.py [BACKEND ...] [-n COUNT] [-o FILE]

The programs are those of the tests (``known_programs``): whole numbers times powers of two over up
to sixty decades, solvable, infeasible, unbounded, or a ray without a feasible point. A lie is a claim that
is not so; "near" is the word solved for a program whose rows contradict each other by less than a millionth
of their terms, which is within the tolerance of answers. Counts are kept as they come, so that a run that
was ended goes on where it was.
"""

import argparse
import json
import logging
import sys
import time
import warnings
from importlib.metadata import version
from pathlib import Path

import numpy as np

HERE = Path(__file__).parents[1]
sys.path.append(str(HERE.parent / "tests" / "given"))
from known_programs import KINDS, Known, is_a_lie, known  # noqa: E402
from regrasp.programs import Solution, Status, available_backends, solve  # noqa: E402
from regrasp.programs.cones import Cones  # noqa: E402
from regrasp.programs.facts import BACKENDS  # noqa: E402

RESULTS = HERE / "results" / "known_truth.json"
EACH, NEAR, LIMIT = 25, 1e-6, {"highs": 2.0}
"""HiGHS goes round for ever on one of the programs."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("backends", nargs="*", default=["auto", *available_backends()])
    parser.add_argument("-n", type=int, default=3000, help="programs")
    parser.add_argument("-o", type=Path, default=RESULTS)
    asked = parser.parse_args()
    logging.disable()
    found = json.loads(asked.o.read_text()) if asked.o.exists() else {}
    for backend in asked.backends:
        row = found.setdefault(
            backend, {"next": 0, "asked": 0, "right": {}, "of": {}, "lies": [], "near": [], "seconds": 0.0}
        )
        if backend != "auto":
            row["version"] = version(BACKENDS[backend].needs)
        while row["next"] < asked.n:
            for seed in range(row["next"], min(row["next"] + EACH, asked.n)):
                _ask(seed, backend, row)
            row["next"] = seed + 1
            new = asked.o.with_suffix(".new")
            new.write_text(json.dumps(found, indent=1) + "\n")
            new.replace(asked.o)
        right, asked_of = sum(row["right"].values()), row["asked"]
        words = f"{right:5} right ({right / asked_of:.1%}), {len(row['near'])} near, {len(row['lies'])} lies"
        print(f"{backend:9} {asked_of:5} asked, {words}")


def _ask(seed: int, backend: str, row: dict) -> None:
    case, kind = known(seed), KINDS[seed % len(KINDS)]
    if backend != "auto" and not BACKENDS[backend].second_order and case.program.has_second_order:
        return
    start = time.process_time()
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        answer = solve(case.program, backend, throw=False, time_limit=LIMIT.get(backend))
    row["seconds"] = round(row["seconds"] + time.process_time() - start, 3)
    row["asked"] += 1
    row["of"][kind] = row["of"].get(kind, 0) + 1
    row["right"][kind] = row["right"].get(kind, 0) + (answer.status is case.truth)
    if is_a_lie(case, answer):
        row["near" if _is_near(case, answer) else "lies"].append(seed)


def _is_near(case: Known, answer: Solution) -> bool:
    """Whether a point that is said to be a solution keeps all rows to a millionth of the largest term."""
    if answer.status is not Status.SOLVED or case.truth is not Status.INFEASIBLE:
        return False
    A, b, _, _ = case.plain
    x = case.units * answer.value
    return bool(Cones(case.program.blocks).excess(b - A @ x).max() <= NEAR * (np.abs(A) @ np.abs(x)).max())


if __name__ == "__main__":
    main()

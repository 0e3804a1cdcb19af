"""Regrasps in space: how many directions of the load are enough, and what looking at few triples saves.

    python benchmarks/answers/load_directions.py [TASKS]

Random regrasps of a box, four fingers, 40 candidates: moves, margin and processor time with 42, 162 and 400
directions of the load: as they are searched, contacts of both ends and few directions first; among all
triples, each with its margins as the search comes to it; and with all margins found beforehand (42). Prints a
table.
"""

import sys
from collections.abc import Iterator
from statistics import median
from time import process_time

import numpy as np

import regrasp as rg
from regrasp.planning.holds.sequences import Sequence, preferred
from regrasp.planning.holds.stances import REACH

COUNTS = (42, 162, 400)


def tasks(count: int) -> Iterator[rg.RegraspProblem]:
    """Random starts and goals that four fingers hold."""
    rng = np.random.default_rng(0)
    box = rg.Mesh.box(0.06, 0.04, 0.05)
    load, made = rg.Wrench([0, 0, -1.0]), 0
    while made < count:
        places = box.contacts(60, friction=0.6, seed=made)
        start, goal = (rg.Grasp([places[i] for i in rng.choice(len(places), 4, replace=False)]) for _ in "ab")
        try:
            for grasp in (start, goal):
                rg.choose_state(grasp, load, "force")
            problem = rg.RegraspProblem(box, start, goal, load, friction=0.6, seed=made)
        except rg.RegraspError:
            continue
        made += 1
        yield problem


def among_all(problem: rg.RegraspProblem) -> list[Sequence]:
    """The best sequence with all contacts and directions at once."""
    start, goal, last = problem.places
    turn = problem.largest_turn
    stances = problem.setting.stances(problem.graph, turn, REACH, None, 0.0)
    return preferred(stances, start, goal, last)


def main() -> None:
    """Measure and print."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 20
    times: dict[str, list[float]] = {}
    gains: dict[int, list[float]] = {n: [] for n in COUNTS[1:]}
    fewer = dict.fromkeys(gains, 0)
    only = dict.fromkeys(gains, 0)
    looked: list[float] = []
    for number, problem in enumerate(tasks(count)):
        found = {}
        for n in COUNTS:
            few = rg.RegraspProblem(
                problem.outline,
                problem.start,
                problem.goal,
                problem.load,
                0.6,
                orientations=n,
                seed=problem.seed,
            )
            began = process_time()
            found[n] = few.sequences()
            if number:  # what was compiled or loaded for the first is not measured
                times.setdefault(f"{n} directions", []).append(process_time() - began)
            for every in (False, True) if n == COUNTS[0] else (False,):
                again = few.asking(0.0)
                began = process_time()
                if every:
                    _ = again.graph.margins
                same = among_all(again) == found[n]
                how = "all margins first" if every else "all triples"
                if number:
                    times.setdefault(f"{n}, {how}", []).append(process_time() - began)
                assert same, "few triples, or few directions, come to different sequences"
                if n == COUNTS[0] and not every:
                    looked.append(np.isfinite(again.graph._found[1]).mean())
        for n in gains:
            if found[n] and not found[42]:
                only[n] += 1
            elif found[n] and found[n][0].moves < found[42][0].moves:
                fewer[n] += 1
            elif found[n] and found[42] and found[n][0].moves == found[42][0].moves:
                gains[n].append(np.degrees(found[n][0].margin - found[42][0].margin))
    print(
        "| directions | processor time, median | largest | only with these | fewer moves "
        "| wider by, median and largest |"
    )
    print("|---|--:|--:|--:|--:|--:|")
    for what, spent in times.items():
        n = int(what.split()[0].rstrip(","))
        more = (
            f"{only[n]} | {fewer[n]} | {median(gains[n]):.2f}, {max(gains[n]):.2f} deg"
            if n in gains and not what.endswith("triples")
            else "| |"
        )
        print(f"| {what} | {median(spent):.2f} s | {max(spent):.2f} s | {more} |")
    print(f"\nOf {count} tasks {np.mean(looked):.1%} of the triples were looked at with 42 directions.")


if __name__ == "__main__":
    main()

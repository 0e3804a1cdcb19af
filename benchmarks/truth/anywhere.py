"""Regrasps anywhere on an outline beside planning on sampled places: 500 random tasks at one orientation.

    python benchmarks/truth/anywhere.py               goes on where a run before ended; prints the table
    python benchmarks/truth/anywhere.py --tasks 50 -o FILE
    python benchmarks/truth/anywhere.py --limits  the same with least normal forces, force limits, or both

Exact polygons say that a regrasp exists, by a walk, or boxes that none does, by a proof that ``verify``
judges. A sampled sequence where none is said to exist would be a contradiction. Half of the tasks have little
friction, so that some are impossible. The walk is planned, and so is the task with free turning and no
limits, through the contacts of both ends alone, which is always possible.
"""

import argparse
import json
from collections import Counter
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np

import regrasp as rg

OUT = Path(__file__).parents[1] / "results" / "anywhere.json"
LIMITED = OUT.with_name("anywhere_limits.json")
CANDIDATES = (60, 200, 500)
SHAPES = {
    "bowl": [[0, 0], [4, 0], [6, 4], [5, 4], [2, 1], [-1, 4], [-2, 4]],
    "bracket": [[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]],
    "spanner": [
        [0, -0.5], [1.5, -0.35], [8, -0.35], [8.6, -1.3], [9.8, -1.6], [10.9, -1.1], [10.2, -0.45],
        [9.6, -0.45], [9.3, 0], [9.6, 0.45], [10.2, 0.45], [10.9, 1.1], [9.8, 1.6], [8.6, 1.3], [8, 0.35],
        [1.5, 0.35], [0, 0.5],
    ],
}  # fmt: skip


Limits = dict[str, float]


def end(
    rng: np.random.Generator, outline: rg.Outline, friction: float, load: rg.Wrench, limits: Limits
) -> rg.Grasp | None:
    """Three places, two of which hold; None where no pair of many does."""
    s, t = rng.uniform(0, outline.length, (2, 3000))
    pairs = outline.points(s), outline.normals(s), friction, outline.points(t), outline.normals(t), friction
    lo, hi = rg.locus_intervals(*pairs, load.force)
    for k in np.flatnonzero(lo <= hi)[: 40 if limits else 1].tolist():
        places = s[k], t[k], rng.uniform(0, outline.length)
        grasp = rg.Grasp(outline.contact_at(float(x), friction=friction) for x in places)
        try:
            if limits:
                rg.choose_state(grasp.without("P3"), load, "peak", **limits)
                rg.choose_state(grasp, load, "peak", **limits)  # all three push
        except rg.Infeasible:
            continue
        return grasp
    return None


def drawn(rng: np.random.Generator) -> Limits:
    """A least normal force, a force limit, or both, under a load of 1 N."""
    least, most = rng.uniform(0.02, 0.4), rng.uniform(0.6, 2.5)
    return [{"min_normal": least}, {"max_force": most}, {"min_normal": least, "max_force": most}][
        int(rng.integers(3))
    ]


def task(number: int, limited: bool) -> tuple[rg.Outline, rg.Grasp, rg.Grasp, rg.Wrench, float, Limits]:
    """The same for every run."""
    rng = np.random.default_rng((2026, number))
    while True:
        outline = rg.Outline(SHAPES[str(rng.choice(list(SHAPES)))])
        friction = float(rng.uniform(0.02, 0.12) if number % 2 else rng.uniform(0.05, 0.8))
        angle = rng.uniform(0, 2 * np.pi)
        load = rg.Wrench([np.cos(angle), np.sin(angle)])
        limits = drawn(rng) if limited else {}
        start, goal = (end(rng, outline, friction, load, limits) for _ in range(2))
        if start is not None and goal is not None:
            return outline, start, goal, load, friction, limits


def compared(number: int, limited: bool) -> dict[str, Any]:
    """What is decided, in what time [s], and moves of sampled sequences, -1 for none."""
    outline, start, goal, load, friction, limits = task(number, limited)
    begun = process_time()
    found = rg.regrasps_on_outline(outline, start, goal, load, friction=friction, **limits)
    row: dict[str, Any] = {"exists": found.exists, "seconds": process_time() - begun} | limits
    row["exchanges"] = found.exchanges
    if found.certificate is not None:
        begun = process_time()
        row["proven"] = rg.verify(found.certificate).ok
        row["judged"], row["boxes"] = process_time() - begun, len(found.certificate.boxes)
    if found.exists:
        begun = process_time()
        plan = found.plan()
        row["planning"], row["planned"] = process_time() - begun, rg.verify(plan).ok
        row["margin"] = plan.margin
    free = rg.RegraspProblem(outline, start, goal, load, friction, candidates=1, min_normal=0.0)
    row["free"] = rg.verify(free.plans()[0]).ok
    for count in CANDIDATES:
        problem = rg.RegraspProblem(
            outline,
            start,
            goal,
            load,
            friction,
            orientations=1,
            candidates=count,
            **{"min_normal": 0.0} | limits,
        )
        sampled = problem.sequences()
        row[str(count)] = sampled[0].moves if sampled else -1
    return row


def table(rows: list[dict[str, Any]]) -> str:
    """As in the README."""
    exists = Counter(row["exists"] for row in rows)
    none = [row for row in rows if row["exists"] is False]
    proven = sum(row["proven"] for row in none)
    lines = [
        f"{len(rows)} tasks: {exists[True]} possible, {exists[False]} not, {exists[None]} open; "
        f"{proven} proofs accepted.",
        "",
        "| candidates | found | missed | contradictions |",
        "|--:|--:|--:|--:|",
    ]
    for count in map(str, CANDIDATES):
        found = sum(row[count] >= 0 for row in rows)
        missed = sum(row["exists"] is True and row[count] < 0 for row in rows)
        lines.append(f"| {count} | {found} | {missed} | {sum(row[count] >= 0 for row in none)} |")
    apart = sum(row["exchanges"][0] != row["exchanges"][1] for row in rows if row["exchanges"])
    lines += ["", f"Fewest exchanges: bounds differ in {apart} tasks."]
    possible = [row for row in rows if row["exists"]]
    missed = [row for row in possible if row[str(CANDIDATES[0])] < 0]
    for words, those in (("All", possible), (f"Missed by {CANDIDATES[0]}", missed)):
        margins = np.degrees([row["margin"] for row in those] or [0.0])
        lines.append(
            f"{words}: {sum(row['planned'] for row in those)} of {len(those)} walks are planned and "
            f"verified, by {margins.min():.2g} deg or more, {np.median(margins):.2g} in the median."
        )
    lines.append(f"With free turning {sum(row['free'] for row in rows)} of {len(rows)} are possible.")
    timed = (
        ("Impossible tasks are decided, with the proof,", none, "seconds"),
        ("Proofs are judged by verify", none, "judged"),
        ("Possible tasks are decided", possible, "seconds"),
        ("Walks are planned", possible, "planning"),
    )
    for words, those, key in timed:
        spent = 1e3 * np.array([row[key] for row in those] or [0.0])
        lines.append(f"{words} in {np.median(spent):.3g} ms, {spent.max():.3g} at most.")
    return "\n".join(lines)


def main() -> None:
    """Goes on with the tasks that are not in the file, and prints the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--tasks", type=int, default=500)
    parser.add_argument("--limits", action="store_true", help="least normal forces and force limits")
    parser.add_argument("-o", "--out", type=Path, help="where results are and go")
    asked = parser.parse_args()
    asked.out = asked.out or (LIMITED if asked.limits else OUT)
    rows = json.loads(asked.out.read_text(encoding="utf-8")) if asked.out.exists() else []
    compared(0, asked.limits)  # compiles
    for number in range(len(rows), asked.tasks):
        rows.append(compared(number, asked.limits))
        if number % 20 == 19 or number == asked.tasks - 1:
            lines = ",\n".join(json.dumps(each) for each in rows)
            asked.out.write_text(f"[\n{lines}\n]\n", encoding="utf-8")
    print(table(rows))


if __name__ == "__main__":
    main()

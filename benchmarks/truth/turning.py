"""Regrasps over all orientations beside sampled ones: 200 tasks, a quarter of them at whole numbers.

    python benchmarks/truth/turning.py                     goes on where a run before ended; prints the table
    python benchmarks/truth/turning.py --tasks 20 -o FILE  some tasks, into another file

A sampled sequence is better where it has fewer moves, or as many and a margin wider by more than a millionth
of it and of a radian, or where all these are alike and it has fewer steps, or as many and less turning.
"""

import argparse
import json
from collections import Counter
from pathlib import Path
from time import process_time

import numpy as np

import regrasp as rg
from regrasp.outline import parts
from regrasp.planning.holds.pairs import HoldGraph, evenly, named
from regrasp.planning.holds.sequences import MAX_TURN, Sequence, sequences
from regrasp.planning.holds.turning.margins import Candidates
from regrasp.planning.holds.turning.search import ExactSearch, TurningSequence, apart_from_each_other

SAMPLES = (24, 72, 360, 1440)
POINTS = 24
OUT = Path(__file__).parents[1] / "results" / "turning.json"
SHAPES = (rg.Outline.ellipse(2, 1), parts.wrench(), parts.bracket(), parts.cam(), parts.bottle())
Task = tuple[tuple[rg.Contact, ...], rg.Wrench, tuple[int, ...], tuple[int, ...], int]


def on_an_outline(rng: np.random.Generator) -> list[rg.Contact]:
    """Contacts at random places of a part, of one friction."""
    shape, friction = SHAPES[int(rng.integers(len(SHAPES)))], float(rng.choice([0.1, 0.3, 0.6]))
    return [shape.contact_at(float(s), friction=friction) for s in rng.uniform(0, shape.length, POINTS)]


def at_whole_numbers(rng: np.random.Generator) -> list[rg.Contact]:
    """Contacts at whole coordinates, with normals along axes and diagonals, some without friction."""
    cells = rng.permutation(49)[:POINTS]
    contacts = []
    for cell in cells.tolist():
        normal = rng.integers(-1, 2, 2)
        normal = normal if normal.any() else np.array([0, 1])
        friction = float(rng.choice([0.0, 0.5, 1.0]))
        contacts.append(rg.Contact([cell % 7 - 3, cell // 7 - 3], normal, friction))
    return contacts


def tasks(count: int) -> list[Task]:
    """Every fourth one at whole numbers."""
    rng = np.random.default_rng(2026)
    result = []
    for k in range(count):
        whole = k % 4 == 3
        contacts = tuple(named((at_whole_numbers if whole else on_an_outline)(rng), "c"))
        angle = rng.integers(8) * np.pi / 4 if whole else rng.uniform(0, 2 * np.pi)
        start, goal = (tuple(rng.choice(POINTS, 3, replace=False).tolist()) for _ in range(2))
        load = rg.Wrench([0.0, -1.0]) if whole else rg.Wrench([np.cos(angle), np.sin(angle)])
        result.append((contacts, load, start, goal, int(rng.integers(24))))
    return result


def exact(task: Task) -> TurningSequence | None:
    """The best sequence over all orientations."""
    contacts, load, start, goal, last = task
    candidates = Candidates(contacts, load, 3.0, one_finger=False)
    search = ExactSearch(candidates, apart_from_each_other(candidates.points, 0.0), None, MAX_TURN, 0.0)
    found = search.sequences(start, goal, 2 * np.pi * last / 24)
    return found[0] if found else None


def sampled(task: Task, count: int) -> Sequence | None:
    """The best sequence at ``count`` orientations."""
    contacts, load, start, goal, last = task
    graph = HoldGraph(contacts, load, evenly(count))
    found = sequences(graph, start, goal, last * count // 24)
    return found[0] if found else None


def steps_and_turning(angles: np.ndarray, last: float) -> tuple[int, float]:
    """Of a way through these angles of the object, from 0 to the last."""
    whole = np.array([0.0, *angles, last])
    turns = abs((np.diff(whole) + np.pi) % (2 * np.pi) - np.pi)
    return int(np.maximum(np.ceil(turns / MAX_TURN - 1e-7), 1).sum()), float(turns.sum())


def verdict(
    mine: TurningSequence | None, theirs: Sequence | None, last: float, count: int
) -> tuple[str, float]:
    """How the exact sequence does beside a sampled one, and how much wider its margin is [rad]."""
    if mine is None or theirs is None:
        return ("neither" if mine is None and theirs is None else "only exact" if mine else "WORSE"), 0.0
    ours = mine.sequence
    if ours.moves != theirs.moves:
        return ("fewer moves" if ours.moves < theirs.moves else "WORSE"), 0.0
    gain = ours.margin - theirs.margin
    if gain < -1e-6 * (1 + theirs.margin):
        return "WORSE", gain
    if gain > 1e-5:
        return "wider", gain
    angles = 2 * np.pi * np.array([hold[-1] for hold in theirs.holds]) / count
    (steps, turning), (more, further) = (steps_and_turning(a, last) for a in (np.array(mine.angles), angles))
    if gain < 1e-6 and (steps, turning - 1e-6) > (more, further):
        return "WORSE", gain
    return "alike", gain


def compared(task: Task) -> tuple[dict[str, tuple[str, float]], float]:
    """By the number of angles what the verdict is; the seconds of the exact search."""
    begun = process_time()
    mine = exact(task)
    spent = process_time() - begun
    last = 2 * np.pi * task[-1] / 24
    return {str(count): verdict(mine, sampled(task, count), last, count) for count in SAMPLES}, spent


def table(done: list[tuple[dict[str, tuple[str, float]], float]]) -> str:
    """As in the README."""
    words = ("only exact", "fewer moves", "wider", "alike", "neither", "WORSE")
    lines = [
        f"| orientations | {' | '.join(words)} | median gain [deg] | largest [deg] |".replace(
            "WORSE", "worse"
        )
    ]
    lines.append("|--:" * (len(words) + 3) + "|")
    for count in map(str, SAMPLES):
        counted = Counter(each[count][0] for each, _ in done)
        row = np.degrees([e[count][1] for e, _ in done if e[count][0] in ("wider", "alike")] or [0.0])
        cells = " | ".join(str(counted[word]) for word in words)
        lines.append(f"| {count} | {cells} | {np.median(row):.3g} | {row.max():.3g} |")
    median = 1e3 * np.median([spent for _, spent in done])
    return "\n".join(
        [*lines, "", f"{len(done)} tasks on {POINTS} points; exact search {median:.3g} ms in the median"]
    )


def main() -> None:
    """Goes on with the tasks that are not in the file, and prints the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--tasks", type=int, default=200)
    parser.add_argument("-o", "--out", type=Path, default=OUT, help="where results are and go")
    asked = parser.parse_args()
    done = json.loads(asked.out.read_text(encoding="utf-8")) if asked.out.exists() else []
    every = tasks(asked.tasks)
    exact(every[0])  # compiles
    for number in range(len(done), len(every)):
        done.append(compared(every[number]))
        for count, (word, gain) in done[-1][0].items():
            if word == "WORSE":
                print(f"task {number} at {count}: worse, margin by {-gain:.3g} rad", flush=True)
        lines = ",\n".join(json.dumps(each) for each in done)
        asked.out.write_text(f"[\n{lines}\n]\n", encoding="utf-8")
    print(table(done))


if __name__ == "__main__":
    main()

"""Value and bound of a search against the best of all pairs of 200 points and triples of 60.

    python benchmarks/placing/brute_force.py [--objectives peak] [--fingers 2] [--cap 20] [--seconds 300]
    python benchmarks/placing/brute_force.py --table
    python benchmarks/placing/brute_force.py --space [--cap 40]

Every objective on seven outlines, of a load, a hull of four or every orientation by turns, friction 0.4,
forces of at most 3 N where a limit is needed, fingers at corners allowed; a gap of 0.1 % asked for, 1 % of
what is withstood, within ``--cap`` seconds of processor time. Of every orientation samples are judged by a
polygon of 72 loads around all of them. The places that are chosen are judged by the same judges as the
samples (``sampled_places``). A row is kept when it is done, so that a run goes on where it was ended.

In space: the bracket under six loads and a plain box under three, the four norms, three fingers, a gap of 1 %
asked for, fingers at edges allowed, against all triples of 40 points drawn evenly over the faces.
"""

import argparse
from itertools import product
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

import regrasp as rg
from fifty_outlines import outlines
from kept_rows import keep, rows_in, short
from on_surfaces import BOX, BRACKET, SIX, THREE, Surface
from placement_outlines import within
from sampled_places import LARGEST, Places, Task, all_of, best, norms, points_of

OBJECTIVES = (
    "sum_normal", "peak_normal", "peak", "effort", "friction_use", "angle", "force", "wrench_ball",
    "answered", "wrench",
)  # fmt: skip
LIMITED = OBJECTIVES[4:]
FRICTION, LIMIT, AROUND = 0.4, 3.0, 72
FAR_APART = 31  # steps from one of them to the next, so that few placements are left early
POINTS = {2: 200, 3: 60}
SPOTS = 40
MESHES = (("bracket, 6 loads", BRACKET, SIX, 0.6), ("box, 3 loads", BOX, THREE, 0.5))
RESULTS = Path(__file__).parents[1] / "results" / "brute_force.json"
ROUNDING, SOLVED = 1e-7, 1e-6  # of values: of bounds, and of what two solvers say
INNER, ROUND = 1e-4, 1e-2  # and of polygons in circles, and around every orientation


def shapes() -> list[tuple[str, rg.Outline]]:
    """A letter, a gear, a polygon, two curves, a plate with holes, of which fingers may be in, and a part."""
    some = dict(outlines())
    plate = rg.Outline(
        [[0, 0], [4, 0], [5, 2], [3, 4], [0, 3]],
        holes=[[[0.8, 0.8], [1.6, 0.8], [1.6, 1.6], [0.8, 1.6]], [[2.6, 1.8], [3.4, 1.6], [3.0, 2.6]]],
    )
    names = ("letter L", "gear of 8", "polygon 3", "spline 1", "heart")
    return [
        *((name, some[name]) for name in names),
        ("plate with holes", plate),
        ("bracket", some["bracket"]),
    ]


def asked(outline: rg.Outline, objective: str, kind: int) -> tuple[str, dict[str, Any], Task]:
    """What loads are called, what the search is asked, and the same for the judges."""
    reach = float(np.linalg.norm(outline.polygon(), axis=1).max())
    limit = LIMIT if objective in LIMITED else np.inf
    more: dict[str, Any] = {"max_force": limit} if objective in LIMITED else {}
    task = Task(objective, FRICTION, np.array([[0.0, -1.0, 0.02 * reach]]), limit)
    weight = rg.Wrench.from_vector(task.loads[0])
    if objective == "wrench_ball":
        task = task._replace(loads=np.zeros((1, 3)), length=0.5 * reach)
        return "every direction", more | {"load": rg.Wrench([0, 0]), "length": task.length}, task
    if objective in ("answered", "wrench"):
        rows = np.array([[0.3, 0, 0], [-0.3, 0, 0], [0, 0, 0.1 * reach], [0, 0, -0.1 * reach]])
        load = rg.Wrench([0, -1])
        task = task._replace(loads=load.vector[None], deviations=rows)
        deviations = rg.LoadSet.hull(map(rg.Wrench.from_vector, rows))
        return "deviations", more | {"load": load, "disturbance": deviations}, task
    if kind == 0:
        return "one", more | {"load": weight}, task
    if kind == 1:
        rows = np.array([[x, -1, y * reach] for x, y in ((0.3, 0.05), (-0.3, 0.05), (0, -0.1), (0.1, 0.1))])
        hull = rg.LoadSet.hull(map(rg.Wrench.from_vector, rows))
        return "hull of 4", more | {"load": hull}, task._replace(loads=rows)
    angle = 2 * np.pi * FAR_APART * np.arange(AROUND) / AROUND
    far = 1 / np.cos(np.pi / AROUND)  # a polygon around all orientations
    rows = np.column_stack([far * np.cos(angle), far * np.sin(angle), 0 * angle])
    return "turned", more | {"load": rg.LoadSet.turned(rg.Wrench([0, -1]))}, task._replace(loads=rows)


def row(outline: rg.Outline, objective: str, fingers: int, kind: int, cap: float) -> dict[str, Any]:
    """A search and its samples."""
    holes = bool(outline.holes)
    name, given, task = asked(outline, objective, kind)
    begin = perf_counter()
    samples = all_of(points_of(outline, POINTS[fingers], in_holes=holes), fingers)
    sampled, held = best(samples, task)
    result: dict[str, Any] = {"loads": name, "samples": len(samples.positions), "held": held}
    result |= {"best": sampled, "judging": perf_counter() - begin}
    begin = perf_counter()
    ended, progress = within(cap)
    try:
        chosen = rg.choose_grasp(
            outline, fingers, friction=FRICTION, objective=objective, in_holes=holes, from_corners=0.0,
            tolerance=1e-2 if objective == "wrench" else 1e-3, progress=progress, **given,
        )  # fmt: skip
    except (rg.Infeasible, KeyboardInterrupt) as refusal:
        if isinstance(refusal, KeyboardInterrupt) and not ended():
            raise
        return result | {"refused": True, "lies": ["refused"] * held, "seconds": perf_counter() - begin}
    result |= {"value": chosen.value, "bound": chosen.bound, "gap": chosen.gap}
    result["seconds"] = perf_counter() - begin
    again = judged_again(chosen, task)
    return result | {"again": again, "lies": lies(result | {"again": again}, objective, rg.verify(chosen).ok)}


def judged_again(chosen: rg.ChosenGrasp, task: Task) -> float:
    """The value of the places that were chosen, by the judges of samples."""
    there = Places(chosen.grasp.positions[None], chosen.grasp.normals[None])
    if task.deviations is not None or task.objective == "wrench_ball":
        return best(there, task)[0]
    return float(norms(there, task, whole=True)[0]) * (-1 if task.objective in LARGEST else 1)


def lies(found: dict[str, Any], objective: str, verified: bool) -> list[str]:
    """What cannot be."""
    sign = -1 if objective in LARGEST else 1
    value, bound, sampled, again = (sign * found[k] for k in ("value", "bound", "best", "again"))
    size = max(abs(value), 1e-3)
    close = max(abs(value), 0.1)
    about = {"turned": ROUND, "deviations": INNER}.get(found["loads"], SOLVED)
    return [
        word
        for word, is_so in (
            ("bound beaten", sampled < bound - ROUNDING * size),
            ("bound above value", bound > value),
            ("not what it says", abs(again - value) > about * close),
            ("not verified", not verified),
        )
        if is_so
    ]


def gained(found: dict[str, Any], objective: str) -> float:
    """By how much the value is better than the best sample [%]; negative for worse."""
    if not found["held"]:
        return np.inf
    sign = -1 if objective in LARGEST else 1
    return 100 * sign * (found["best"] - found["value"]) / max(abs(found["value"]), 1e-3)


def table(kept: dict[str, Any]) -> str:
    """A line for each objective and number of fingers."""
    lines = [
        "| objective, fingers | outlines | samples | refining buys, median [%] | "
        "most [%] | least [%] | largest gap | lies |",
        "|---|--:|--:|--:|--:|--:|--:|--:|",
    ]
    for objective, fingers in product(OBJECTIVES, POINTS):
        rows = [r for key, r in kept.items() if key.startswith(f"{objective}, {fingers} fingers, ")]
        found = [r for r in rows if "value" in r]
        if not rows:
            continue
        more = [gained(r, objective) for r in found if r["held"]] or [np.nan]
        lines.append(
            f"| `{objective}`, {fingers} | {len(rows)} | "
            f"{sum(r['samples'] for r in rows):,} | {np.median(more):.2f} | "
            f"{max(more):.2f} | {min(more):.3f} | {max((r['gap'] for r in found), default=np.nan):.2g} | "
            f"{sum(len(r['lies']) for r in rows)} |"
        )
    return "\n".join(lines)


def in_space(cap: float) -> None:
    """A line for each mesh and norm."""
    print(
        "| mesh | objective | triples | best of them | value | bound | gap | refining buys [%] | again | "
        "time [s] | wrong |\n|---|---|--:|--:|--:|--:|--:|--:|--:|--:|---|"
    )
    for name, mesh, loads, friction in MESHES:
        spots = Surface(mesh).random(np.random.default_rng(7), SPOTS)
        samples = all_of((spots[:, :3], spots[:, 3:]), 3)
        held = rg.LoadSet.hull(map(rg.Wrench.from_vector, loads))
        for objective in OBJECTIVES[:4]:
            task = Task(objective, friction, loads, np.inf)
            sampled = float(norms(samples, task).min())
            begin = perf_counter()
            chosen = rg.choose_grasp(
                mesh, 3, held, friction=friction, objective=objective, tolerance=0.01, from_corners=0.0,
                progress=within(cap)[1],
            )  # fmt: skip
            took = perf_counter() - begin
            there = Places(chosen.grasp.positions[None], chosen.grasp.normals[None])
            again = float(norms(there, task, whole=True)[0])
            wrong = [
                word
                for word, is_so in (
                    ("bound beaten", sampled < chosen.bound * (1 - ROUNDING)),
                    ("bound above value", chosen.bound > chosen.value),
                    ("not what it says", abs(again / chosen.value - 1) > INNER),
                    ("not verified", not rg.verify(chosen).ok),
                )
                if is_so
            ]
            print(
                f"| {name} | `{objective}` | {len(samples.positions):,} | {sampled:.5f} | "
                f"{chosen.value:.5f} | {chosen.bound:.5f} | {chosen.gap:.3f} | "
                f"{100 * (sampled / chosen.value - 1):.2f} | "
                f"{again:.5f} | {took:.1f} | {', '.join(wrong)} |",
                flush=True,
            )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--objectives", nargs="+", default=OBJECTIVES, choices=OBJECTIVES)
    parser.add_argument("--fingers", nargs="+", type=int, default=(2, 3))
    parser.add_argument("--cap", type=float, default=20.0, help="of a search, of processor time [s]")
    parser.add_argument("--seconds", type=float, default=np.inf, help="after which no other row is begun")
    parser.add_argument("--table", action="store_true")
    parser.add_argument("--space", action="store_true")
    parser.add_argument("-o", "--output", type=Path, default=RESULTS)
    given = parser.parse_args()
    if given.space:
        in_space(given.cap)
        return
    kept = rows_in(given.output)
    if given.table:
        print(table(kept))
        return
    begin = perf_counter()
    for fingers, (i, (name, outline)), objective in product(
        given.fingers, enumerate(shapes()), given.objectives
    ):
        key = f"{objective}, {fingers} fingers, {name}"
        if key in kept or perf_counter() - begin > given.seconds:
            continue
        found = row(outline, objective, fingers, (i + OBJECTIVES.index(objective)) % 3, given.cap)
        keep(given.output, kept, key, short(found))


if __name__ == "__main__":
    main()

"""Degenerate outlines, without friction and with critical friction: answers, refusals, and nothing else.

    python benchmarks/placing/degenerate_outlines.py [--cap 20] [--seconds 300]
    python benchmarks/placing/degenerate_outlines.py --table
    python benchmarks/placing/degenerate_outlines.py --circles [1.01]

Needles, collinear points, tiny edges, pockets, holes, spikes, symmetric shapes whose corners are best, and
coordinates far from zero, under every objective. Each search ends after ``--cap`` seconds of processor time
by an interrupt; what goes on for more than 20 s after it *hangs*. Answers are verified and judged against
all pairs of 40 points and triples of 16. A row is kept when it is done; next is one whose shape, objective,
number of fingers and friction, two by two, are least among those kept. ``--circles`` is of a unit force of
every orientation on ellipses of half axes 1 and this.
"""

import argparse
from collections import Counter
from itertools import combinations, product
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

import numpy as np

import regrasp as rg
from brute_force import OBJECTIVES, asked, judged_again, lies
from kept_rows import keep, rows_in, short
from placement_outlines import within
from sampled_places import all_of, best, points_of

RESULTS = Path(__file__).parents[1] / "results" / "degenerate_outlines.json"
LATE = 20.0  # s after the cap
LONGEST = 400  # letters of what a refusal says
UNPROVEN = ("not proven", "rounding decides")  # in what a refusal says
NONE = 1e-9  # what the judges take for no friction
POINTS = {2: 40, 3: 16}
FRICTIONS = {"none": 0.0, "1e-12": 1e-12, "0.3": 0.3, "critical": 1.0}
HALF = np.arange(16) * np.pi / 8
SHAPES = {
    "needle": rg.Outline([[0, 0], [10, 0], [10, 1e-3], [0, 1e-3]]),
    "sliver": rg.Outline([[0, 0], [10, 0], [5, 1e-2]]),
    "collinear points, tiny edges": rg.Outline(
        [[0, 0], [1, 0], [2, 0], [2 + 1e-6, 0], [4, 0], [4, 3], [2, 3 + 1e-7], [0, 3]]
    ),
    "pocket and hole": rg.Outline(
        [[0, 0], [5, 0], [5, 3], [3, 3], [3, 1], [2, 1], [2, 3], [0, 3]],
        holes=[[[0.4, 0.4], [0.4, 0.8], [0.8, 0.4]]],
    ),
    "slot of 1e-3": rg.Outline([[0, 0], [4, 0], [4, 3], [2.001, 3], [2.001, 1], [2, 1], [2, 3], [0, 3]]),
    "spikes": rg.Outline(
        np.where(np.arange(16) % 2, 0.02, 1.0)[:, None] * np.column_stack([np.cos(HALF), np.sin(HALF)])
    ),
    "square": rg.Outline([[-1, -1], [1, -1], [1, 1], [-1, 1]]),
    "triangle": rg.Outline([[0, 0], [2, 0], [1, np.sqrt(3)]]),
    "chords of an ellipse": rg.Outline(rg.Outline.ellipse(2, 1).polygon(0.01)),
    "flat ellipse": rg.Outline.ellipse(2, 0.01),
    "circle": rg.Outline.ellipse(1, 1),
    "far from zero": rg.Outline(np.array([[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]]) + 1e7),
}


def row(
    outline: rg.Outline, objective: str, fingers: int, friction: float, kind: int, cap: float
) -> dict[str, Any]:
    """How a search ended, and what is wrong with its answer."""
    name, given, task = asked(outline, objective, kind)
    task = task._replace(friction=friction)
    holes = bool(outline.holes)
    begin, used, (_, progress) = perf_counter(), process_time(), within(cap)
    result: dict[str, Any] = {"loads": name, "lies": []}
    chosen = None
    try:
        chosen = rg.choose_grasp(
            outline, fingers, friction=friction, objective=objective, in_holes=holes, from_corners=0.0,
            tolerance=1e-2 if objective == "wrench" else 1e-3, progress=progress, **given,
        )  # fmt: skip
        result |= {"end": "answer", "value": chosen.value, "bound": chosen.bound, "gap": chosen.gap}
    except (rg.Infeasible, KeyboardInterrupt) as stop:
        refusal = stop.__cause__ if isinstance(stop, KeyboardInterrupt) else stop
        if not isinstance(refusal, rg.Infeasible):
            raise
        proof, words = refusal.certificate, str(refusal)
        verified = proof is not None and rg.verify(proof).ok
        proven = verified and not any(word in words for word in UNPROVEN)
        end = "nothing at the cap" if "an interrupt ended" in words else "refusal"
        result |= {"end": "refusal, proven" if proven else end, "words": words[:LONGEST]}
        result["least"] = proof.bound if verified and proof is not None else None
        result["lies"] += ["not verified"] * (proof is not None and not verified)
    except rg.InvalidInput as refusal:
        result |= {"end": "refused as input", "words": str(refusal)[:LONGEST]}
    except Exception as error:
        result |= {"end": "error", "words": repr(error)[:200], "lies": ["error"]}
    result |= {"seconds": perf_counter() - begin, "processor": process_time() - used, "cap": cap}
    late = result["processor"] > cap + LATE
    result["lies"] += ["hangs"] * late
    if friction > NONE:
        samples = all_of(points_of(outline, POINTS[fingers], in_holes=holes), fingers)
        leveled = chosen is not None and task.deviations is not None
        found, held = best(samples, task, chosen.bound if leveled else 0.0)
        result |= {"held": held, "best": found if held else None}
        if held and chosen is None and result["end"].startswith("refus"):
            result["lies"].append("refused")
    if chosen is not None:
        again = judged_again(chosen, task) if friction > NONE else chosen.value
        sampled = result.get("best")
        judged = result | {"again": again, "best": chosen.value if sampled is None else sampled}
        result["again"] = again
        result["lies"] += lies(judged, objective, rg.verify(chosen).ok)
    return result


def spread(every: list[tuple[str, ...]], kept: dict[str, Any]) -> list[tuple[str, ...]]:
    """Those that are not kept in an order whose every beginning has all pairs of choices about as often."""
    counts = Counter(
        pair for choice in every if key_of(choice) in kept for pair in combinations(enumerate(choice), 2)
    )
    left, order = [choice for choice in every if key_of(choice) not in kept], []
    while left:
        rarest = min(left, key=lambda choice: sum(counts[p] for p in combinations(enumerate(choice), 2)))
        left.remove(rarest)
        order.append(rarest)
        counts.update(combinations(enumerate(rarest), 2))
    return order


def key_of(choice: tuple[str, ...]) -> str:
    """What a row is called."""
    shape, objective, fingers, friction = choice
    return f"{shape}; {objective}, {fingers}; {friction}"


def table(kept: dict[str, Any]) -> str:
    """A line for each shape."""
    ends = ("answer", "refusal, proven", "refusal", "refused as input", "nothing at the cap")
    lines = [
        "| outline | searches | gap reached | answers with a gap | refused with proof | not proven | "
        "refused as input | nothing at the cap | of both, with a bound | longest [s] of a processor | "
        "wrong |",
        "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|",
    ]
    for name in SHAPES:
        rows = [(key, r) for key, r in kept.items() if key.startswith(f"{name}; ")]
        if not rows:
            continue
        small = [
            r["end"] == "answer" and r["gap"] <= (1e-2 if "; wrench," in key else 1e-3) for key, r in rows
        ]
        counts = [sum(r["end"] == end for _, r in rows) for end in ends]
        bounded = sum(r["end"] in (ends[2], ends[4]) and (r.get("least") or 0) > 0 for _, r in rows)
        lines.append(
            f"| {name} | {len(rows)} | {sum(small)} | {counts[0] - sum(small)} | {counts[1]} | {counts[2]} | "
            f"{counts[3]} | {counts[4]} | {bounded} | "
            f"{max(r.get('processor', r['seconds']) for _, r in rows):.1f} | "
            f"{sum(bool(r['lies']) for _, r in rows)} |"
        )
    return "\n".join(lines)


def circles(axis: float) -> None:
    """Print a line for each norm and number of fingers: gap, boxes, times to search and to verify [s]."""
    shape, load = rg.Outline.ellipse(1.0, axis), rg.LoadSet.turned(rg.Wrench([0.0, -1.0]))
    rg.choose_grasp(shape, 2, rg.Wrench([0.0, -1.0]), friction=0.5)  # compiles
    for objective in ("sum_normal", "peak_normal", "peak", "effort"):
        for fingers in (2, 3, 4) if axis == 1 else (2,):
            begin = process_time()
            chosen = rg.choose_grasp(shape, fingers, load, friction=0.5, objective=objective)
            found = process_time()
            proven = "yes" if rg.verify(chosen).ok else "NO"
            print(
                f"| {objective}, {fingers} | {chosen.gap:.1e} | {len(chosen.certificate.children):,} | "
                f"{found - begin:.2f} | {proven}, {process_time() - found:.2f} |"
            )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cap", type=float, default=20.0, help="of a search, of processor time [s]")
    parser.add_argument("--seconds", type=float, default=np.inf, help="after which no other row is begun")
    parser.add_argument("--table", action="store_true")
    parser.add_argument("--circles", type=float, nargs="?", const=1.0)
    parser.add_argument("-o", "--output", type=Path, default=RESULTS)
    given = parser.parse_args()
    kept = rows_in(given.output)
    if given.circles:
        circles(given.circles)
        return
    if given.table:
        print(table(kept))
        return
    begin = perf_counter()
    every = list(product(SHAPES, OBJECTIVES, "23", FRICTIONS))
    np.random.default_rng(0).shuffle(every)
    for choice in spread([tuple(map(str, one)) for one in every], kept):
        if perf_counter() - begin > given.seconds:
            break
        shape, objective, fingers, friction = choice
        kind = (list(SHAPES).index(shape) + list(OBJECTIVES).index(objective)) % 3
        key = key_of(choice)
        found = row(SHAPES[shape], objective, int(fingers), FRICTIONS[friction], kind, given.cap)
        keep(given.output, kept, key, short(found))


if __name__ == "__main__":
    main()

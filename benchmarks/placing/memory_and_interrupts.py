"""What a search of placements takes of memory, and what an interrupt at a random moment leaves, and when.

    python benchmarks/placing/memory_and_interrupts.py memory
    python benchmarks/placing/memory_and_interrupts.py interrupts [--count 6] [--case "force, 3, gear"]
    python benchmarks/placing/memory_and_interrupts.py late [--boxes 200000]
    python benchmarks/placing/memory_and_interrupts.py threads

Each search runs in a process of its own, after a small one that loads the compiled code. *Memory* is its
largest resident set (``getrusage``), with ``most_boxes`` of 64 and of more: the difference is that of boxes
and their proof. *Interrupts* are sent (SIGINT) after 0.05 to 6 s of a search whose gap is never reached; what
comes back is a grasp with its gap, verified where its proof is of 10,000 boxes at most, or
``KeyboardInterrupt`` with the bound so far where no placement was found. *Late* ones come when there are so
many boxes, and tell how much clock and processor time there is until the answer. *Threads*: both times of a
search by one and two; and *alone*, the processor time of one that two would not share: what is outside of
rounds, and of each round half, or its longest part. Rows are kept in benchmarks/results.
"""

import argparse
import json
import os
import resource
import signal
import subprocess
import sys
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from time import perf_counter, process_time, thread_time
from typing import Any

import numpy as np

import regrasp as rg
from brute_force import asked
from fifty_outlines import outlines
from kept_rows import keep, rows_in
from on_surfaces import BOX, BRACKET, SIX, THREE
from regrasp.planning.placement import parts
from regrasp.planning.placement.levels import rounds
from regrasp.planning.placement.search import Search
from regrasp.planning.placement.space import surface_boxes
from regrasp.planning.placement.space.surface_search import SurfaceSearch

CASES = {
    "peak, 3, polygon 2": ("peak", 3, "polygon 2", {}),
    "friction_use, 3, spline 2": ("friction_use", 3, "spline 2", {}),
    "force, 3, gear": ("force", 3, "gear", {}),
    "answered, 3, heart": ("answered", 3, "heart", {}),
    "wrench, 3, letter L": ("wrench", 3, "letter L", {}),
    "wrench_ball, 3, gear of 8": ("wrench_ball", 3, "gear of 8", {}),
    "effort, 4, polygon 2": ("effort", 4, "polygon 2", {}),
    "peak, 3, letter T, removable": ("peak", 3, "letter T", {"removable": True}),
    "peak, 3, polygon 2, min_normal": ("peak", 3, "polygon 2", {"min_normal": 0.2}),
    "sum_normal, 3, box": ("sum_normal", 3, None, {}),
    "peak, 4, box": ("peak", 4, None, {}),
    "peak_normal, 3, bracket": ("peak_normal", 3, None, {}),
}
RESULTS = Path(__file__).parents[1] / "results" / "memory_and_interrupts.json"
OF_THREADS = (
    ("answered, 3, heart", 100_000), ("peak, 3, polygon 2", 100_000), ("force, 3, gear", 20_000),
    ("peak_normal, 3, bracket", 4000),
)  # fmt: skip
OF_MEMORY = ("effort, 4, polygon 2", "sum_normal, 3, box", "peak, 4, box")
ENDLESS = ("friction_use, 3, spline 2", "wrench, 3, letter L", "peak, 3, polygon 2, min_normal")
"""Searches in which other things than boxes take the time, or nothing is found."""
MANY, TINY = 200_000, 1e-12
LATEST = 6.0  # s
VERIFIED = 10_000  # boxes at most of a proof that is verified
Keep = Callable[[str, dict[str, Any]], None]


def search(case: str, most: int | None) -> rg.ChosenGrasp:
    """One that does not reach its gap."""
    objective, fingers, name, more = CASES[case]
    more = more | {"tolerance": TINY} | ({} if most is None else {"most_boxes": most})
    if name is None:
        mesh, wrenches, friction = (BRACKET, SIX, 0.6) if "bracket" in case else (BOX, THREE, 0.5)
        loads = rg.LoadSet.hull(map(rg.Wrench.from_vector, wrenches))
        return rg.choose_grasp(mesh, fingers, loads, friction=friction, objective=objective, **more)
    outline = dict(outlines())[name]
    _, given, _ = asked(outline, objective, 1)
    return rg.choose_grasp(outline, fingers, friction=0.4, objective=objective, **given, **more)


def child(case: str, most: int | None, boxes: int | None) -> None:
    """Say that it begins; search; print how it went."""
    signal.signal(
        signal.SIGINT, signal.default_int_handler
    )  # shells have what is in the background ignore it
    search(case, 64)
    begun, shared = [] if boxes is None else interrupted_at(boxes), shared_by_two()
    print("ready", flush=True)
    found: dict[str, Any] = {}
    begin, used = perf_counter(), process_time()
    try:
        chosen = search(case, most)
        found = {"gap": chosen.gap, "boxes": chosen.certificate.leaves}
    except KeyboardInterrupt:
        found = {"interrupted": True}
    if begun:
        begin, used, found["made"] = begun
    found |= {"seconds": perf_counter() - begin, "processor": process_time() - used}
    found["alone"] = found["processor"] - sum(shared)
    print(
        json.dumps(found | {"memory": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024}), flush=True
    )
    if "gap" in found and chosen.certificate.leaves <= VERIFIED:
        print(rg.verify(chosen).ok, flush=True)


def interrupted_at(boxes: int) -> list[Any]:
    """Send an interrupt when a search has so many boxes: clock and processor time then, and how many."""
    begun: list[Any] = []
    goes_on, counted = Search.goes_on, SurfaceSearch.count.fget
    assert counted is not None

    def noted(count: int) -> int:
        if not begun and count >= boxes:
            begun.extend((perf_counter(), process_time(), count))
            signal.raise_signal(signal.SIGINT)
        return count

    def some(search: Search, *args: Any, **more: Any) -> bool:
        result = goes_on(search, *args, **more)
        noted(search.count)
        return result

    Search.goes_on = some  # type: ignore[method-assign]
    SurfaceSearch.count = property(lambda search: noted(counted(search)))  # type: ignore[assignment]
    return begun


def shared_by_two() -> list[float]:
    """Processor time that a second thread would take off the first, to be filled by each round."""
    spared: list[float] = []
    inside = parts.side_by_side

    def timed(work: Callable[[int], Any], *boxes: int) -> list[Any]:
        took = []

        def one(part: int) -> Any:
            begin = thread_time()
            result = work(part)
            took.append(thread_time() - begin)
            return result

        result = inside(one, *boxes)
        spared.append(sum(took) - max(0.5 * sum(took), *took))
        return result

    for module in (parts, rounds, surface_boxes):
        module.side_by_side = timed  # type: ignore[attr-defined]
    return spared


def started(case: str, most: int, *more: str, threads: int = 1) -> subprocess.Popen[str]:
    """A process that is about to search."""
    process = subprocess.Popen(
        [sys.executable, __file__, "child", "--case", case, "--most", str(most), *more],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        env=os.environ | {"NUMBA_NUM_THREADS": str(threads)},
    )  # fmt: skip
    assert process.stdout is not None
    process.stdout.readline()
    return process


def memory(keep: Keep, cases: Sequence[str]) -> None:
    """How much more memory there is with more boxes."""
    for case in (case for case in OF_MEMORY if case in cases):
        few: float = 0.0
        for most in (64, MANY // 4, MANY):
            found = answer(case, most)
            few = few or found["memory"]
            found["each"] = (found["memory"] - few) / most if most > 64 else None
            keep(f"memory; {case}; {most}", found)


def late(keep: Keep, cases: Sequence[str], boxes: int) -> None:
    """How long an answer takes after an interrupt when there are so many boxes."""
    for case in (case for case in cases if case not in ENDLESS):
        keep(f"late; {case}", answer(case, 10_000_000, "--boxes", str(boxes)))


def threads(keep: Keep, cases: Sequence[str]) -> None:
    """Clock and processor time with one thread and with two."""
    for case, most in ((case, most) for case, most in OF_THREADS if case in cases):
        found = {count: answer(case, most, threads=count) for count in (1, 2)}
        kept = {f"{what} {n}": found[n][what] for n in found for what in ("seconds", "processor")}
        kept["alone"] = found[1]["alone"]
        keep(
            f"threads; {case}", kept | {"boxes": found[1]["boxes"], "gaps": [found[n]["gap"] for n in found]}
        )


def answer(case: str, most: int, *more: str, threads: int = 1) -> dict[str, Any]:
    """What a process says of its search."""
    out, _ = started(case, most, *more, threads=threads).communicate()
    found: dict[str, Any] = json.loads(out.splitlines()[0])
    return found


def interrupts(keep: Keep, cases: Sequence[str], count: int) -> None:
    """What came back, and after how long; ``count`` of each."""
    rng = np.random.default_rng(0)
    for case in cases:
        kinds: dict[str, Any] = dict.fromkeys(("answer", "not verified", "before", "nothing", "traceback"), 0)
        took = []
        waits = rng.uniform(0.05, LATEST, count)
        for wait in waits:
            process = started(case, 10_000_000)
            try:
                process.wait(wait)
                kinds["before"] += 1
                continue
            except subprocess.TimeoutExpired:
                process.send_signal(signal.SIGINT)
            assert process.stdout is not None
            begin, line = perf_counter(), process.stdout.readline()
            took.append(perf_counter() - begin)
            out, err = process.communicate()
            kinds["answer"] += "gap" in line
            kinds["not verified"] += out.strip() == "False"
            kinds["nothing"] += "interrupted" in line
            if "Traceback" in err:
                kinds["traceback"] += 1
                print(err[-1500:], file=sys.stderr)
        keep(f"interrupts; {case}", {"sent": len(waits), **kinds, "took": took})


def tables(kept: dict[str, Any]) -> str:
    """Of each kind, a line for each search."""
    lines = header(
        "search", "interrupts", "answers with a gap", "not verified", "ended before", "nothing found yet",
        "traceback", "median [s]", "longest [s]",
    )  # fmt: skip
    for case, row in rows_of(kept, "interrupts"):
        took = row["took"] or [np.nan]
        counts = [row[k] for k in ("sent", "answer", "not verified", "before", "nothing", "traceback")]
        lines.append(f"| {case} | {' | '.join(map(str, counts))} | {np.median(took):.2f} | {max(took):.2f} |")
    lines += header("search", "boxes made", "not split", "gap", "clock [s]", "processor [s]")
    for case, row in rows_of(kept, "late"):
        made = f"{row['made']:,}" if "made" in row else "ended before"
        lines.append(
            f"| {case} | {made} | {row.get('boxes', 0):,} | {row.get('gap', np.nan):.2g} | "
            f"{row['seconds']:.2f} | {row['processor']:.2f} |"
        )
    lines += header("search", "`most_boxes`", "not split", "memory [MB]", "a box [bytes]")
    for case, row in rows_of(kept, "memory"):
        name, most = case.split("; ")
        each = "" if row["each"] is None else f"{row['each']:.0f}"
        lines.append(f"| {name} | {int(most):,} | {row['boxes']:,} | {row['memory'] / 1e6:.0f} | {each} |")
    lines += header(
        "search", "not split", "one thread: clock, processor [s]", "two: clock, processor [s]",
        "processor per clock, one and two", "alone [s]", "one per alone", "the same gap",
    )  # fmt: skip
    for case, row in rows_of(kept, "threads"):
        times = [[row[f"{what} {n}"] for what in ("seconds", "processor")] for n in (1, 2)]
        shown = " | ".join(f"{clock:.1f}, {used:.1f}" for clock, used in times)
        ratio = ", ".join(f"{used / clock:.2f}" for clock, used in times)
        same = "yes" if len(set(row["gaps"])) == 1 else "**no**"
        alone = f"{row['alone']:.2f} | {row['processor 1'] / row['alone']:.2f}" if "alone" in row else " | "
        lines.append(f"| {case} | {row['boxes']:,} | {shown} | {ratio} | {alone} | {same} |")
    return "\n".join(lines)


def header(*names: str) -> list[str]:
    """Of a table."""
    return ["", f"| {' | '.join(names)} |", f"|---{'|--:' * (len(names) - 1)}|"]


def rows_of(kept: dict[str, Any], kind: str) -> list[tuple[str, Any]]:
    """Those of a kind, and what they are of."""
    return [(key.split("; ", 1)[1], row) for key, row in kept.items() if key.startswith(f"{kind}; ")]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", choices=("memory", "interrupts", "late", "threads", "table", "child"))
    parser.add_argument("--count", type=int, default=6)
    parser.add_argument("--case", choices=CASES)
    parser.add_argument("--most", type=int)
    parser.add_argument("--boxes", type=int)
    parser.add_argument("-o", "--output", type=Path, default=RESULTS)
    given = parser.parse_args()
    kept = rows_in(given.output)

    kept_now = partial(keep, given.output, kept)
    cases = tuple(CASES) if given.case is None else (given.case,)
    if given.what == "child":
        child(given.case, given.most, given.boxes)
    elif given.what == "memory":
        memory(kept_now, cases)
    elif given.what == "interrupts":
        interrupts(kept_now, cases, given.count)
    elif given.what == "late":
        late(kept_now, cases, given.boxes or MANY)
    elif given.what == "threads":
        threads(kept_now, cases)
    else:
        print(tables(kept))


if __name__ == "__main__":
    main()

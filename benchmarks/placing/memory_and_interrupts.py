"""What a search of placements takes of memory, and what an interrupt at a random moment leaves, and when.

    python benchmarks/placing/memory_and_interrupts.py memory
    python benchmarks/placing/memory_and_interrupts.py interrupts [--count 60]

Each search runs in a process of its own, after a small one that loads the compiled code. *Memory* is its
largest resident set (``getrusage``), with ``most_boxes`` of 64 and of more: the difference is that of boxes
and their proof. *Interrupts* are sent (SIGINT) after 0.05 to 6 s of a search whose gap is never reached; what
comes back is a grasp with its gap, verified where its proof is of 10,000 boxes at most, or
``KeyboardInterrupt`` where no placement was found.
"""

import argparse
import json
import resource
import signal
import subprocess
import sys
from time import perf_counter
from typing import Any

import numpy as np

import regrasp as rg
from brute_force import asked
from fifty_outlines import outlines
from on_surfaces import BOX, THREE

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
}
OF_MEMORY = ("effort, 4, polygon 2", "sum_normal, 3, box", "peak, 4, box")
MANY, TINY = 200_000, 1e-12
LATEST = 6.0  # s
VERIFIED = 10_000  # boxes at most of a proof that is verified


def search(case: str, most: int | None) -> rg.ChosenGrasp:
    """One that does not reach its gap."""
    objective, fingers, name, more = CASES[case]
    more = more | {"tolerance": TINY} | ({} if most is None else {"most_boxes": most})
    if name is None:
        loads = rg.LoadSet.hull(map(rg.Wrench.from_vector, THREE))
        return rg.choose_grasp(BOX, fingers, loads, friction=0.5, objective=objective, **more)
    outline = dict(outlines())[name]
    _, given, _ = asked(outline, objective, 1)
    return rg.choose_grasp(outline, fingers, friction=0.4, objective=objective, **given, **more)


def child(case: str, most: int | None) -> None:
    """Say that it begins; search; print how it went."""
    signal.signal(
        signal.SIGINT, signal.default_int_handler
    )  # shells have what is in the background ignore it
    search(case, 64)
    print("ready", flush=True)
    found: dict[str, Any] = {}
    try:
        begin = perf_counter()
        chosen = search(case, most)
        found = {"gap": chosen.gap, "boxes": chosen.certificate.leaves, "seconds": perf_counter() - begin}
    except KeyboardInterrupt:
        found = {"interrupted": True}
    print(
        json.dumps(found | {"memory": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024}), flush=True
    )
    if "gap" in found and chosen.certificate.leaves <= VERIFIED:
        print(rg.verify(chosen).ok, flush=True)


def started(case: str, most: int | None) -> subprocess.Popen[str]:
    """A process that is about to search."""
    process = subprocess.Popen(
        [sys.executable, __file__, "child", "--case", case, *([] if most is None else ["--most", str(most)])],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert process.stdout is not None
    process.stdout.readline()
    return process


def memory() -> None:
    """A line for each search."""
    print("| search | `most_boxes` | not split | memory [MB] | a box [bytes] |\n|---|--:|--:|--:|--:|")
    for case in OF_MEMORY:
        few: float = 0.0
        for most in (64, MANY // 4, MANY):
            out, _ = started(case, most).communicate()
            found = json.loads(out.splitlines()[0])
            few = few or found["memory"]
            each = f"{(found['memory'] - few) / most:.0f}" if most > 64 else ""
            print(
                f"| {case} | {most:,} | {found['boxes']:,} | {found['memory'] / 1e6:.0f} | {each} |",
                flush=True,
            )


def interrupts(count: int) -> None:
    """A line for each search: what came back, and after how long."""
    rng = np.random.default_rng(0)
    print(
        "| search | interrupts | answers with a gap | not verified | ended before | nothing found yet | "
        "traceback | median [s] | longest [s] |\n|---|--:|--:|--:|--:|--:|--:|--:|--:|"
    )
    for case in CASES:
        kinds = dict.fromkeys(("answer", "not verified", "before", "nothing", "traceback"), 0)
        took = []
        waits = rng.uniform(0.05, LATEST, max(count // len(CASES), 1))
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
        print(
            f"| {case} | {len(waits)} | {kinds['answer']} | {kinds['not verified']} | "
            f"{kinds['before']} | {kinds['nothing']} | {kinds['traceback']} | "
            f"{np.median(took or [np.nan]):.2f} | {max(took, default=np.nan):.2f} |",
            flush=True,
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", choices=("memory", "interrupts", "child"))
    parser.add_argument("--count", type=int, default=66)
    parser.add_argument("--case", choices=CASES)
    parser.add_argument("--most", type=int)
    given = parser.parse_args()
    if given.what == "child":
        child(given.case, given.most)
    elif given.what == "memory":
        memory()
    else:
        interrupts(given.count)


if __name__ == "__main__":
    main()

"""What a person feels: first calls, the default objective, a pair from Python, regrasps, the slowest call.

    python benchmarks/speed/felt.py                 measures, writes results/felt.json, README.md
    python benchmarks/speed/felt.py --quick -o DIR  a short run into another folder, to see it work

Processor time, one thread against one thread. First calls are made in processes of their own, with an empty
folder for compiled code or with what the process before left there.
"""

import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from math import inf
from pathlib import Path
from resource import RUSAGE_CHILDREN, getrusage
from statistics import median
from time import process_time, thread_time_ns

import daqp
import numpy as np

import regrasp as rg
from closed_form import PACKAGES, QUICK, Effort, close
from command import command
from pairs import Pairs, eliminated
from programs import bare_clarabel, ring
from regrasp.closed_form.choice import EFFORT, best_squeeze
from regrasp.planning.states.criteria import PEAK_RATIO
from regrasp.planning.states.program import state_program
from report import Measure, Row
from timing import Comparison, Side

THREE = """
import regrasp as rg
grasp = rg.Grasp(
    rg.Contact([x, y], normal=[-x, -y], friction=0.6) for x, y in ((1, 0.1), (-0.6, 0.8), (-0.5, -0.9))
)
rg.choose_state(grasp, rg.Wrench([0.2, -1.0], 0.1))
"""
PLANE = """
import numpy as np
import regrasp as rg
angles = 2 * np.pi * np.arange(24) / 24
outline = rg.Outline.smooth(np.column_stack([2 * np.cos(angles), np.sin(angles)]))
start, goal = (
    rg.Grasp(outline.contact_at(s * outline.length, friction=0.5) for s in shares)
    for shares in ((0.1, 0.4, 0.7), (0.2, 0.5, 0.8))
)
"""
SPACE = """
import regrasp as rg
box = rg.Mesh.box(0.06, 0.04, 0.05)
ends = (
    ((0.03, 0.004, 0.003), (-0.03, 0.003, -0.004), (0.004, 0.02, 0.002), (0.003, -0.02, 0.004)),
    ((0.03, 0.006, -0.005), (-0.03, -0.006, 0.004), (0.01, -0.004, 0.025), (0.003, 0.004, -0.025)),
)
start, goal = (rg.Grasp(box.contact_at(point, friction=0.6) for point in points) for points in ends)
"""
PLANE_PLAN = PLANE + "rg.plan_regrasp(outline, start, goal, rg.Wrench([0, -3.0]), friction=0.5)"
SPACE_PLAN = SPACE + "rg.plan_regrasp(box, start, goal, rg.Wrench([0, 0, -1.0]), friction=0.6)"
WARM_UP = "from regrasp.closed_form.compiled import triples\ntriples.PATIENCE = 0\n"  # what it does in space
MEMORY = """
from pathlib import Path
print(next(line.split()[1] for line in Path("/proc/self/status").open() if line.startswith("VmHWM")))
"""


def processor_time(code: str | list[str], folder: str) -> float:
    """Of a process of its own that keeps compiled code in a folder, its start included [s].

    Python's own byte code is there, as after an installation.
    """
    before = getrusage(RUSAGE_CHILDREN)
    alone = {"NUMBA_CACHE_DIR": folder, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    outside = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    given = [code] if isinstance(code, str) else code
    subprocess.run([sys.executable, "-c", *given], env={**outside, **alone}, check=True, capture_output=True)
    after = getrusage(RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def first_calls(effort: Effort, quick: bool) -> Iterator[Row]:
    """In fresh processes."""
    with tempfile.TemporaryDirectory() as folder:
        base = "import numpy, scipy.sparse, clarabel"
        turns = [(processor_time(THREE, folder), processor_time(base, folder)) for _ in range(effort.starts)]
        ours, theirs = zip(*turns, strict=True)
        yield Row.of(
            "first_state", "first `choose_state` of three contacts, `angle`, process and imports included",
            f'`python -c "{base}"`', Comparison(ours, theirs), Measure.TIMES, 1.5, "imports of our modules",
        )  # fmt: skip
        plan = [sys.executable, "-c", THREE + MEMORY]
        shown = subprocess.run(plan, capture_output=True, text=True, check=True)
        resident = 1024 * int(shown.stdout)
        yield Row.alone("first_memory", "and its largest resident memory", resident, Measure.BYTES, 100e6)
    for key, what, code, cold, warm, limit in (
        (
            "plane", "planar `plan_regrasp`", PLANE_PLAN, 3.0, 0.6,
            "imports and the search",
        ),
        (
            "space", "`plan_regrasp` in space", SPACE_PLAN, 5.0, 1.0,
            "imports of SciPy, Numba and Clarabel, half of it; then Numba setting up before the first of its "
            "kept code, reading it, and the search",
        ),
    ):  # fmt: skip
        if quick:
            code = code.removesuffix(")") + ", candidates=8)"
        with tempfile.TemporaryDirectory() as folder:
            seconds = processor_time(code, folder)
            yield Row.alone(
                f"cold_{key}", f"first {what}, nothing compiled before", seconds, Measure.SECONDS, cold,
                "Numba compiles the moves, some 2 s, and says so; the first 8,000 margins are interpreted",
            )  # fmt: skip
            before = "a run before"
            if key == "space":
                before = "`regrasp warm-up`"
                second = processor_time(code, folder)
                yield Row.alone(
                    "second_space", f"the same once more, without `regrasp warm-up`, {what}", second,
                    Measure.SECONDS,
                )  # fmt: skip
                processor_time(WARM_UP + code, folder)
            again = median(processor_time(code, folder) for _ in range(3))
            yield Row.alone(
                f"warm_{key}", f"the same with compiled code of {before}, {what}", again,
                Measure.SECONDS, warm, limit,
            )  # fmt: skip


def commands(quick: bool) -> Iterator[Row]:
    """The command line with all its figures, warm."""
    call = "from regrasp.cli import main; main()"
    examples = Path(__file__).parents[2] / "examples"
    for name, what, goal in (
        ("paper", "the paper's example", 1.2),
        ("regrasp", "a planar regrasp", 2.0),
        ("space-regrasp", "a regrasp in space", 4.0),
    ):
        with tempfile.TemporaryDirectory() as folder:
            code = [call, "plan", str(examples / f"{name}.toml"), "-o", folder]
            kept = os.environ.get("NUMBA_CACHE_DIR", f"{folder}/compiled")
            times = [processor_time(code, kept) for _ in range(2 if quick else 5)][1:]
        yield Row.alone(
            f"command_{name}", f"`regrasp plan` of {what}, figures included, warm", min(times),
            Measure.SECONDS, goal, "Matplotlib: 0.2 s to import it, 0.1 s for its mathematics, then 0.15 s "
            "for a figure of four panels, of which ticks and the sizes of texts are most; our imports 0.2 s",
        )  # fmt: skip


def objectives(effort: Effort) -> Iterator[Row]:
    """The default objective and its like, against one bare program."""
    cases = [("three contacts", *ring(3)), ("six contacts", *ring(6))]
    cases += [(f"{n} contacts in space", *around(n)) for n in (4, 8)]
    for what, grasp, load in cases:
        unit = float(abs(load.vector).max())
        program = state_program(grasp, load, "effort", grasp.frictions.tolist(), [inf] * len(grasp), unit)
        bare = Side(bare_clarabel(program), clock=process_time)
        for objective in ("angle", "friction_use", "force"):
            one = Side(lambda _, o=objective, g=grasp, w=load: rg.choose_state(g, w, o), clock=process_time)
            yield Row.of(
                f"{objective}_{len(grasp)}_{grasp.dimension}", f"`choose_state`, `{objective}`, {what}",
                "bare Clarabel, one program of effort", effort.of(one, bare), Measure.TIMES, 10.0,
                "the least peak, then five or six programs from level 0 to the proof, Newton's method "
                "converging quadratically: a kept solver takes half of a bare call to all of it for "
                "each, which is 40 % of the time; some 350 us of Python are spread evenly over forty "
                "functions; `force` spends half of its time on the last digits",
            )  # fmt: skip


def around(count: int) -> tuple[rg.Grasp, rg.Wrench]:
    """Contacts all over a ball, facing its middle, and a weight."""
    points = np.random.default_rng(count).normal(size=(count, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    return rg.Grasp(rg.Contact(p, -p, 0.8) for p in points), rg.Wrench([0.1, 0.2, -1.0])


def pairs(effort: Effort) -> Iterator[Row]:
    """Two contacts by the public road, against DAQP given the elimination, too."""
    few = list(Pairs.random(2_000).first(effort.sample))
    programs = [eliminated(pair) for pair in few]
    theirs = Side(lambda _: [daqp.solve(*program) for program in programs], len(few), clock=process_time)
    core = Side(
        lambda _: [best_squeeze(*p, EFFORT, inf, inf, PEAK_RATIO) for p in few], len(few), clock=process_time
    )
    contacts = [tuple(rg.Contact(p[i : i + 2], p[i + 2 : i + 4], p[i + 4]) for i in (0, 5)) for p in few]
    for program, pair in zip(programs, few, strict=True):  # the same answers
        squeeze = best_squeeze(*pair, EFFORT, inf, inf, PEAK_RATIO)[0]
        close(daqp.solve(*program)[0], np.array([squeeze]), 1e-4, "DAQP on the eliminated problem")
    grasps = [rg.Grasp(pair) for pair in contacts]

    def loads() -> list[rg.Wrench]:
        return [rg.Wrench(p[10:12], p[12]) for p in few]

    def seen(given: list[rg.Wrench]) -> None:
        for grasp, load in zip(grasps, given, strict=True):
            rg.choose_state(grasp, load, "effort")

    def anew(given: list[rg.Wrench]) -> None:
        for pair, load in zip(contacts, given, strict=True):
            rg.choose_state(rg.Grasp(pair), load, "effort")

    against = "DAQP's bare call on the eliminated problem"
    for key, what, side, goal in (
        ("core", "the closed form on plain numbers", core, 1.0),
        ("seen", "`choose_state`, a grasp made before, a load not seen", seen, 3.0),
        ("anew", "`Grasp(...)` and `choose_state`", anew, 8.0),
    ):
        ours = side if isinstance(side, Side) else Side(side, len(few), loads, clock=process_time)
        yield Row.of(
            f"pair_{key}", f"two planar contacts, `effort`: {what}", against, effort.of(ours, theirs),
            Measure.TIMES, goal, "Python's calls, checks and values",
        )  # fmt: skip


def regrasps(effort: Effort, quick: bool) -> Iterator[Row]:
    """Whole plans, end to end, as points and orientations grow."""
    made: dict[str, object] = {}
    exec(PLANE, made)

    def planned(points: int, orientations: int) -> Side:
        def run(_: object) -> object:
            return rg.plan_regrasp(
                made["outline"], made["start"], made["goal"], rg.Wrench([0, -3.0]), friction=0.5,
                candidates=points, orientations=orientations,
            )  # fmt: skip

        return Side(run, clock=process_time)

    few, many, angles = (8, 16, 8) if quick else (50, 200, 24)
    for key, what, small, large, times in (
        ("points", f"{few} to {many} points", planned(few, angles), planned(many, angles), many / few),
        (
            "angles",
            f"{angles} to {4 * angles} orientations",
            planned(few, angles),
            planned(few, 4 * angles),
            4,
        ),
    ):
        yield Row.growth(
            f"regrasp_{key}", f"planar `plan_regrasp`, end to end, from {what}", effort.of(large, small),
            times, 2.0, "pairs of points, and the moves between them",
        )  # fmt: skip


def slowest(quick: bool) -> Iterator[Row]:
    """The tail of a million closed forms on plain numbers."""
    count = 10_000 if quick else 1_000_000
    few = list(Pairs.random(min(count, 20_000)).first(20_000))
    times = np.empty(count, dtype=np.int64)
    for k in range(count):
        pair = few[k % len(few)]
        began = thread_time_ns()
        best_squeeze(*pair, EFFORT, inf, inf, PEAK_RATIO)
        times[k] = thread_time_ns() - began
    for key, what, value in (
        ("median", "the median", np.median(times)),
        ("p999", "99.9 % take less than", np.quantile(times, 0.999)),
        ("max", "the slowest", times.max()),
    ):
        words = f"{count:,} closed forms one by one, processor time of the thread: {what}"
        yield Row.alone(f"tail_{key}", words, float(value) * 1e-9, Measure.SECONDS)


def rows(quick: bool) -> Iterator[Row]:
    """Every row of the benchmark."""
    effort = QUICK if quick else Effort(rounds=15)
    yield from first_calls(effort, quick)
    yield from commands(quick)
    yield from objectives(effort)
    yield from pairs(effort)
    yield from regrasps(effort, quick)
    yield from slowest(quick)


def main() -> None:
    """Measure, print and write."""
    command("felt", __doc__ or "", rows, PACKAGES)


if __name__ == "__main__":
    main()

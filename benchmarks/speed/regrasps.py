"""Speed of regrasping: the hold graph, its widest holds without a table, and the best sequence on it.

    python benchmarks/speed/regrasps.py                 measures, writes results/regrasps.json, README.md
    python benchmarks/speed/regrasps.py --quick -o DIR  a short run into another folder, to see it work

Every ratio compares two things measured in turn in this one process; rows of one number are measured in it
or, where memory is asked for, in a process of their own. Answers are compared before times are.
"""

import json
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import chain, combinations
from pathlib import Path
from resource import RUSAGE_SELF, getrusage
from time import perf_counter

import highspy
import numpy as np

import holds
import regrasp as rg
from closed_form import PACKAGES, cone_edges
from closed_form import QUICK as QUICK_EFFORT
from closed_form import Effort as Times
from command import command
from regrasp.outline import parts
from regrasp.planning.holds.pairs import HoldGraph, evenly, named
from regrasp.planning.holds.sequences import MAX_TURN, sequences
from regrasp.planning.holds.turning.arcs import Arcs
from regrasp.planning.holds.turning.margins import Candidates
from regrasp.planning.holds.turning.search import ExactSearch, apart_from_each_other
from report import Measure, Row
from timing import Comparison, Side

FRICTION = 0.5


@dataclass(frozen=True)
class Effort:
    """How much to measure: points and orientations of the table, of the run without one, programs solved."""

    times: Times
    points: int = 500
    orientations: int = 72
    many: tuple[int, int] = (2_000, 360)
    sample: int = 500


FULL = Effort(Times(rounds=9))
QUICK = Effort(replace(QUICK_EFFORT, rounds=2), points=60, orientations=12, many=(100, 24), sample=20)


def sweep(effort: Effort) -> Iterator[Row]:
    """All margins of the table, against NumPy and against a linear program per hold."""
    graph = hold_graph(effort.points, effort.orientations)
    _, points, normals, mu = described(graph)
    loads = turned_loads(graph)
    numpy = holds.margins(points, normals, mu, loads, graph.peak_ratio, graph.pairs)
    agree(graph.margins, numpy, "NumPy")
    size = numpy.size
    ours = Side(lambda g: g.margins, size, lambda: hold_graph(effort.points, effort.orientations))
    theirs = Side(lambda _: holds.margins(points, normals, mu, loads, graph.peak_ratio, graph.pairs), size)
    what = (
        f"hold graph, {effort.points} points x {effort.orientations} orientations, per locus with its margin"
    )
    yield Row.of(
        "sweep_numpy", what, "the same formula in chunked NumPy",
        effort.times.of(ours, theirs), Measure.FASTER, 20.0,
        "half of our time is margins, of the one locus in seven that holds; NumPy finds no others, either",
    )  # fmt: skip
    programs, expected = linear_programs(graph, effort.sample)
    solver = highspy.Highs()
    solver.setOptionValue("output_flag", False)

    def solved(_: object) -> list[bool]:
        return [holds_by(solver, program) for program in programs]

    if solved(None) != expected:
        raise RuntimeError("HiGHS: verdicts differ")
    yield Row.of(
        "sweep_highs", what, "one linear program per hold through HiGHS, without a margin, prebuilt",
        effort.times.of(ours, Side(solved, len(programs))), Measure.FASTER, 10_000.0,
        "HiGHS needs little for four unknowns; half of our time is margins, which it does not find",
    )  # fmt: skip


def growth(effort: Effort) -> Iterator[Row]:
    """Cost against the number of loci, by points and by orientations."""
    points, orientations = effort.points, effort.orientations
    for key, small, large in (
        ("points", (points // 2, orientations), (2 * points, orientations)),
        ("orientations", (points, orientations // 2), (points, 2 * orientations)),
    ):
        sides = [Side(lambda g: g.margins, prepare=lambda n=n: hold_graph(*n)) for n in (large, small)]
        loci = [n * (n - 1) / 2 * o for n, o in (large, small)]
        yield Row.growth(
            f"growth_{key}",
            f"hold graph, {large[0]:,} x {large[1]} beside {small[0]:,} x {small[1]}, against the loci",
            effort.times.of(*sides), loci[0] / loci[1], 1.1, "a table beyond the cache",
        )  # fmt: skip


def best_sequence(effort: Effort) -> Iterator[Row]:
    """The search on a graph whose margins are known; the steps of the longest of some random regrasps."""
    graph = hold_graph(effort.points, effort.orientations)
    rng = np.random.default_rng(5)
    _ = graph.margins
    found = []
    for _ in range(40):
        start, goal = (tuple(rng.choice(effort.points, 3, replace=False).tolist()) for _ in range(2))
        best = sequences(graph, start, goal)
        if best:
            found.append((len(best[0].holds), start, goal))
    _, start, goal = max(found)
    taken = [timed(lambda: sequences(graph, start, goal)) for _ in range(effort.times.rounds)]
    yield Row.alone(
        "sequence",
        f"best sequence on {effort.points} x {effort.orientations}, the longest of {len(found)} found",
        float(np.median(taken)), Measure.SECONDS, 0.5, "sweeps over the whole table",
    )  # fmt: skip


def all_orientations(effort: Effort) -> Iterator[Row]:
    """Which pairs hold at any orientation, the widest margin of each, and the best sequence among arcs."""
    graph = hold_graph(effort.points, effort.orientations)
    _, points, normals, mu = described(graph)
    loads, first_second = turned_loads(graph), graph.pairs

    def numpy(_: object) -> np.ndarray:
        return holds.margins(points, normals, mu, loads, graph.peak_ratio, first_second)

    best = numpy(None).max(axis=0)
    if (exact_margins(graph) < best - 1e-6).any():
        raise RuntimeError("a sampled margin is wider than that over all orientations")
    yield Row.of(
        "exact_numpy",
        f"arcs of {effort.points} points over all orientations, with the widest margin without force limits",
        f"chunked NumPy at {effort.orientations} orientations",
        effort.times.of(Side(exact_margins, 1, lambda: graph), Side(numpy, 1)),
        Measure.FASTER, 200.0, "a few nanoseconds a pair, in which other work on the machine shows",
    )  # fmt: skip
    first = [in_a_process("arcs", effort.points, effort.orientations) for _ in range(effort.times.rounds)]
    yield Row.of(
        "exact_first", "the same, the first call in a process", "the first call of the same NumPy",
        Comparison(tuple(t["ours"] for t in first), tuple(t["theirs"] for t in first)),
        Measure.FASTER, 200.0, "memory that the process touches for the first time",
    )  # fmt: skip
    candidates = Candidates(graph.contacts, graph.load, graph.peak_ratio, one_finger=False)
    apart = apart_from_each_other(candidates.points, 0.0)
    rng, taken = np.random.default_rng(5), []
    for _ in range(20):
        start, goal = (tuple(rng.choice(effort.points, 3, replace=False).tolist()) for _ in range(2))
        rounds = []
        for _ in range(effort.times.rounds):
            search = ExactSearch(candidates, apart, None, MAX_TURN, 0.0)
            rounds.append(timed(lambda: search.sequences(start, goal, 1.0)))  # noqa: B023
        taken.append(float(np.median(rounds)))
    yield Row.alone(
        "exact_sequence", f"best sequence among the arcs of {effort.points} points, median of {len(taken)}",
        float(np.median(taken)), Measure.SECONDS, 0.003,
        "margins under force limits of the pairs on the best rows, and the arcs that hold them",
    )  # fmt: skip


def memory(effort: Effort) -> Iterator[Row]:
    """Bytes per locus with a table; time and peak memory without one, in processes of their own."""
    points, orientations = 2 * effort.points, effort.orientations
    table = in_a_process("table", points, orientations)
    yield Row.alone(
        "bytes", f"memory per locus of a table, {points:,} x {orientations}",
        table["bytes"] / table["loci"], Measure.BYTES, 8.0,
        "besides 4 bytes of margin, the indices of pairs and what NumPy needs for their distances",
    )  # fmt: skip
    many = in_a_process("widest", *effort.many)
    loci = f"{effort.many[0]:,} x {effort.many[1]} ({many['loci'] / 1e6:.3g} million loci)"
    what = f"widest hold of each pair, {loci}"
    yield Row.alone(
        "widest_time", what, many["seconds"], Measure.SECONDS, 60.0, "the margins of loci that hold"
    )
    yield Row.alone(
        "widest_memory", f"{what}, peak memory of the process", many["peak"], Measure.GIB, 4.0, ""
    )


def in_a_process(what: str, points: int, orientations: int) -> dict[str, float]:
    """What ``probe`` finds in a fresh process."""
    line = [sys.executable, __file__, "--probe", what, str(points), str(orientations)]
    done = subprocess.run(line, check=True, capture_output=True, text=True)
    found: dict[str, float] = json.loads(done.stdout)
    return found


def probe(what: str, points: int, orientations: int) -> None:
    """Time and memory of one graph in this process, printed as JSON."""
    if what == "arcs":
        print(json.dumps(first_arcs(points, orientations)))
        return
    small = hold_graph(10, 2)
    _ = small.margins, small.widest()
    graph = hold_graph(points, orientations)
    before = peak_bytes()
    seconds = timed((lambda: graph.margins) if what == "table" else graph.widest)
    peak = peak_bytes()
    loci = points * (points - 1) // 2 * orientations
    found = {"seconds": seconds, "bytes": max(peak - before, 1), "peak": peak / 2**30, "loci": loci}
    print(json.dumps(found))


def first_arcs(points: int, orientations: int) -> dict[str, float]:
    """Seconds of the first time that all orientations are looked at here, and of NumPy's at so many."""
    graph = hold_graph(points, orientations)
    _, places, normals, mu = described(graph)
    loads, pairs = turned_loads(graph), graph.pairs
    ours = timed(lambda: exact_margins(graph))
    theirs = timed(lambda: holds.margins(places, normals, mu, loads, graph.peak_ratio, pairs))
    return {"ours": ours, "theirs": theirs}


def exact_margins(graph: HoldGraph) -> np.ndarray:
    """(P,) the widest margin of each pair over all orientations, -1 for none."""
    candidates = Candidates(graph.contacts, graph.load, graph.peak_ratio, one_finger=False)
    return Arcs(candidates).bounds()[graph.pairs]


def peak_bytes() -> int:
    """The most memory of this process so far; getrusage on Linux counts the one it was forked from, too."""
    status = Path("/proc/self/status")
    if status.exists():
        lines = dict(line.split(":", 1) for line in status.read_text(encoding="utf-8").splitlines())
        return 1024 * int(lines["VmHWM"].split()[0])
    return getrusage(RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)


def hold_graph(points: int, orientations: int) -> HoldGraph:
    """A wrench held at points spread at random over its outline, so that nothing is symmetric."""
    outline = parts.wrench()
    places = np.sort(np.random.default_rng(0).uniform(0, outline.length, points)).tolist()
    contacts = named([outline.contact_at(s, friction=FRICTION) for s in places], "c")
    return HoldGraph(tuple(contacts), rg.Wrench([0.3, -3.0]), evenly(orientations))


def described(graph: HoldGraph) -> tuple[tuple[rg.Contact, ...], np.ndarray, np.ndarray, np.ndarray]:
    """Contacts, points, normals and frictions."""
    each = graph.contacts
    points, normals = np.array([c.position for c in each]), np.array([c.normal for c in each])
    return each, points, normals, np.array([c.friction for c in each])


def turned_loads(graph: HoldGraph) -> np.ndarray:
    """(O, 2) the load seen from the turned object."""
    return np.array([graph.load.rotated(-angle).force for angle in graph.angles.tolist()])


def agree(ours: np.ndarray, theirs: np.ndarray, what: str) -> None:
    """Raise unless both say of every locus whether it holds, and with the same margin to 1e-6 rad."""
    if ((ours >= 0) != (theirs >= 0)).any() or abs(ours - theirs).max() > 1e-6:
        raise RuntimeError(f"{what}: answers differ by up to {abs(ours - theirs).max()}")


def linear_programs(graph: HoldGraph, count: int) -> tuple[list[highspy.HighsLp], list[bool]]:
    """Which forces, as rows G f = -w and cone edges >= 0, hold: half of the pairs can, half cannot."""
    rng = np.random.default_rng(1)
    able = graph.margins >= 0
    chosen = chain.from_iterable(
        rng.choice(np.argwhere(able == verdict), count // 2, replace=False).tolist()
        for verdict in (True, False)
    )
    pairs = list(combinations(range(len(graph.contacts)), 2))
    programs, expected = [], []
    for o, p in chosen:
        grasp = rg.Grasp([graph.contacts[k] for k in pairs[p]])
        load = turned_loads(graph)[o]
        rows = np.vstack([grasp.matrix, cone_edges(grasp)])
        program = highspy.HighsLp()
        program.num_col_, program.num_row_ = 4, len(rows)
        program.col_cost_ = np.zeros(4)
        program.col_lower_, program.col_upper_ = np.full(4, -np.inf), np.full(4, np.inf)
        program.row_lower_ = np.r_[-load, 0, np.zeros(4)]
        program.row_upper_ = np.r_[-load, 0, np.full(4, np.inf)]
        program.a_matrix_.format_ = highspy.MatrixFormat.kRowwise
        program.a_matrix_.start_ = np.arange(0, 4 * len(rows) + 1, 4)
        program.a_matrix_.index_ = np.tile(np.arange(4), len(rows))
        program.a_matrix_.value_ = rows.ravel()
        programs.append(program)
        expected.append(bool(able[o, p]))
    return programs, expected


def holds_by(solver: highspy.Highs, program: highspy.HighsLp) -> bool:
    """HiGHS' verdict."""
    solver.passModel(program)
    solver.run()
    return bool(solver.getModelStatus() == highspy.HighsModelStatus.kOptimal)


def timed(call) -> float:
    """Seconds of one call."""
    began = perf_counter()
    call()
    return perf_counter() - began


def rows(quick: bool) -> Iterator[Row]:
    """Every row of the benchmark."""
    effort = QUICK if quick else FULL
    for part in (sweep, growth, best_sequence, all_orientations, memory):
        yield from part(effort)


def main() -> None:
    """Measure, print and write."""
    if sys.argv[1:2] == ["--probe"]:
        probe(sys.argv[2], *map(int, sys.argv[3:]))
        return
    command("regrasps", __doc__ or "", rows, (*PACKAGES, "highspy"))


if __name__ == "__main__":
    main()

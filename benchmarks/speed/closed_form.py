"""Speed of the closed forms, of planning a removal, of its set-points, of batches and of start-up.

    python benchmarks/speed/closed_form.py                measures, writes results/closed_form.json, README.md
    python benchmarks/speed/closed_form.py --quick -o DIR  a short run into another folder, to see it work

Every ratio compares two things measured in turn in this one process (or, for start-up, in turn as processes
of their own). Answers are compared before times are.
"""

import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import chain
from math import inf
from pathlib import Path

import cvxpy
import daqp
import numba
import numpy as np

import regrasp as rg
from agreement import check_agreement, close
from command import command
from pairs import Pairs, quadratics
from regrasp.closed_form.choice import OBJECTIVES, best_squeeze
from regrasp.closed_form.compiled import two_fingers as compiled
from regrasp.planning.states.criteria import PEAK_RATIO
from report import Measure, Row
from timing import Comparison, Side, compare

PACKAGES = ("regrasp", "numpy", "numba", "scipy", "daqp", "cvxpy", "clarabel", "osqp")


@dataclass(frozen=True)
class Effort:
    """How much to measure: rounds, least seconds of a round, sizes."""

    rounds: int = 41
    least: float = 0.02
    sample: int = 200
    pairs: int = 2_000_000
    starts: int = 25

    def of(self, ours: Side, theirs: Side) -> Comparison:
        """Compare two sides with this effort."""
        return compare(ours, theirs, rounds=self.rounds, least=self.least)


QUICK = Effort(rounds=3, least=1e-3, sample=10, pairs=20_000, starts=3)


def choices(effort: Effort) -> Iterator[Row]:
    """Locus and best state: one grasp from Python, and per grasp of a batch on one thread, against DAQP."""
    pairs = Pairs.random(effort.pairs // 2)
    sample = pairs.first(effort.sample)
    threads = numba.get_num_threads()
    for code, objective in enumerate(OBJECTIVES):
        # The least largest |f| is no QP, the least sum of normals an LP: the effort QP is their yardstick.
        same = objective not in ("peak", "sum_normal")
        programs = [quadratics(pair, objective if same else "effort") for pair in sample]
        if same:
            check_agreement(sample, programs, objective)
        solves = [program.data for program in chain.from_iterable(programs)]
        settings = programs[0][0].settings
        direct = Side(_each(lambda data, s=settings: daqp.solve(*data, **s), solves), items=len(sample))
        per_choice = len(solves) / len(sample)
        against = "DAQP, the same choice as one QP"
        if objective in ("angle", "friction_use"):
            against = f"DAQP, bisection by {per_choice:.0f} QPs"
        elif not same:
            against = "DAQP, the effort QP (no QP says peak)"
        elif settings:
            against = "DAQP, the same choice as one LP"
        one = Side(
            _each(lambda p, c=code: best_squeeze(*p, c, inf, inf, PEAK_RATIO), sample), items=len(sample)
        )
        slow = "Python interprets about a hundred operations on floats, one by one"
        yield Row.of(
            f"one_{objective}", f"`{objective}`, one grasp", against, effort.of(one, direct),
            Measure.TIMES, 1.0, slow,
        )  # fmt: skip
        batch = Side(
            lambda _, o=objective: rg.best_squeezes(*pairs.arguments, objective=o), items=effort.pairs // 2
        )
        numba.set_num_threads(1)
        found = effort.of(batch, direct)
        numba.set_num_threads(threads)
        yield Row.of(
            f"batch_{objective}", f"`{objective}`, per grasp of a batch, one thread", against, found,
            Measure.TIMES, 0.1, "branches and divisions of one grasp",
        )  # fmt: skip


def removals(effort: Effort) -> Iterator[Row]:
    """``plan_removal`` in full from a balanced state, against the choice of its end through warm cvxpy."""
    state = paper_state()
    rest = state.grasp.without("P3")
    forces, load = cvxpy.Variable(4), cvxpy.Parameter(3, value=state.load.vector)
    edges = cvxpy.Parameter((4, 4), value=cone_edges(rest))
    matrix = cvxpy.Parameter((3, 4), value=rest.matrix)
    program = cvxpy.Problem(
        cvxpy.Minimize(cvxpy.sum_squares(forces)), [matrix @ forces == -load, edges @ forces >= 0]
    )

    def through_cvxpy(solver: str) -> tuple[np.ndarray, np.ndarray]:
        load.value = state.load.vector
        program.solve(solver=solver, warm_start=True)
        end = np.vstack([forces.value.reshape(2, 2), np.zeros(2)])
        return end, state.forces - end  # Eq. 1-3: end + change T

    solvers = [name for name in ("CLARABEL", "OSQP", "DAQP") if name in cvxpy.installed_solvers()]
    planned = rg.plan_removal(state, "P3", objective="effort").end.forces
    for name in solvers:
        close(through_cvxpy(name)[0], planned, 1e-4, f"cvxpy with {name}")
    sides = {name: Side(lambda _, s=name: through_cvxpy(s)) for name in solvers}
    fastest = min(solvers, key=lambda name: min(sides[name].seconds(1) for _ in range(20)))

    def fresh_states() -> list[rg.GraspState]:
        return [rg.GraspState(state.grasp, state.load, state.forces) for _ in range(20)]

    def plan(states: list[rg.GraspState], objective: str) -> None:
        for given in states:
            rg.plan_removal(given, "P3", objective=objective)

    cases = (
        ("first", "a state seen first", fresh_states),
        ("again", "the same state again", lambda: [state] * 20),
    )
    for objective in ("angle", "effort"):
        for key, given, prepare in cases:
            ours = Side(lambda states, o=objective: plan(states, o), items=20, prepare=prepare)
            yield Row.of(
                f"removal_{objective}_{key}",
                f"`plan_removal`, objective `{objective}`, {given}",
                f"cvxpy, parametrised and warm, {fastest}, objective `effort`",
                effort.of(ours, sides[fastest]),
                Measure.FASTER,
                20.0,
                "judging a state seen first and building values in Python; cvxpy solves `effort` here, the "
                "choice of `angle` would take it a bisection",
            )


def set_points(effort: Effort) -> Iterator[Row]:
    """Eq. 1-3 at 1,001 instants: all forces and wrenches, against the bare NumPy expressions."""
    plan = rg.plan_removal(paper_state(), "P3")
    t, scaling, a, b = np.linspace(0, 1, 1001), plan.scaling, plan.start, plan.end

    def expressions(_: None) -> tuple[np.ndarray, np.ndarray]:
        T = scaling(t)[:, None, None]
        forces = b.forces + (a.forces - b.forces) * T
        return forces, b.wrenches + (a.wrenches - b.wrenches) * T

    def methods(_: None) -> tuple[np.ndarray, np.ndarray]:
        return plan.forces(t), plan.wrenches(t)

    for ours, theirs in zip(methods(None), expressions(None), strict=True):
        close(ours, theirs, 1e-14, "set-points")
    yield Row.of(
        "set_points",
        "Eq. 1-3 at 1,001 instants, `forces(t)` and `wrenches(t)`, each evaluating T(t)",
        "the bare NumPy expressions, T(t) evaluated once for both",
        effort.of(Side(methods), Side(expressions)),
        Measure.TIMES,
        1.5,
        "T(t), a spline of SciPy, is evaluated once in each method",
    )


def loci(effort: Effort) -> Iterator[Row]:
    """``locus_intervals`` and its compiled loop against ``numpy.copyto`` over as many bytes."""
    pairs, count = Pairs.random(effort.pairs), effort.pairs
    source = np.ones(15 * count // 2)  # 13 numbers read and 2 written per pair: 15, half of them to copy
    target = np.ones_like(source)
    lo, hi, whole = np.ones(count), np.ones(count), np.ones(8, dtype=np.int64)
    flat = [a.reshape(-1) for a in pairs.arguments]
    copy = Side(lambda _: np.copyto(target, source), items=count)
    inner = Side(lambda _: compiled.intervals(*flat, whole, lo, hi), items=count)
    public = Side(lambda _: rg.locus_intervals(*pairs.arguments), items=count)
    inner.run(None)
    for ours, theirs in zip(rg.locus_intervals(*pairs.arguments), (lo, hi), strict=True):
        close(ours, theirs, 0.0, "loci")
    threads = numba.get_num_threads()
    for used in sorted({1, threads}):
        numba.set_num_threads(used)
        for key, what, side in (
            ("intervals", "`locus_intervals`", public),
            ("loop", "its compiled loop", inner),
        ):
            yield Row.of(
                f"{key}_{used}",
                f"{what}, {count / 1e6:g} million pairs, {used} thread{'s' * (used > 1)}",
                "`numpy.copyto` of as many bytes, one thread",
                effort.of(side, copy),
                Measure.RATE,
                0.3 * used,
                "five divisions and a square root per pair, and other processes on the same cores "
                "where the load average says so",
            )
    numba.set_num_threads(threads)


def starts(effort: Effort) -> Iterator[Row]:
    """``import regrasp`` and ``regrasp --version`` against an interpreter that imports NumPy."""
    command = Path(sys.executable).with_name("regrasp")
    if not command.exists():
        raise SystemExit("the command regrasp is not installed beside this Python: pip install -e .")
    numpy = _process(sys.executable, "-c", "import numpy")
    for key, what, ours in (
        ("import", "`import regrasp`", _process(sys.executable, "-c", "import regrasp")),
        ("version", "`regrasp --version`", _process(str(command), "--version")),
    ):
        yield Row.of(
            key, what, '`python -c "import numpy"`', compare(ours, numpy, rounds=effort.starts, least=0.0),
            Measure.TIMES, 2.0, "importing our modules and click after NumPy",
        )  # fmt: skip


def paper_state() -> rg.GraspState:
    """The paper's state S_A, balanced."""
    grasp = rg.Grasp(
        [
            rg.Contact([-4, -4], normal=[1, 1], friction=0.3, name="P1"),
            rg.Contact([4, -5], normal=[-1, 2], friction=0.3, name="P2"),
            rg.Contact([0, 8], normal=[0, -1], friction=0.3, name="P3"),
        ]
    )
    forces = [[3.7897, 3.0034], [-3.0096, 4.4156], [0.7199, -3.9190]]
    return rg.GraspState(grasp, rg.Wrench(force=[-1.5, -3.5]), forces).balanced()


def cone_edges(grasp: rg.Grasp) -> np.ndarray:
    """Rows mu f.n -+ f.t >= 0 of two contacts, (4, 4)."""
    rows = np.zeros((4, 4))
    for i, contact in enumerate(grasp):
        n, mu = contact.normal, contact.friction
        t = np.array([-n[1], n[0]])
        rows[2 * i : 2 * i + 2, 2 * i : 2 * i + 2] = mu * n - t, mu * n + t
    return rows


def _each(call: Callable[..., object], arguments: list) -> Callable[[object], None]:
    def run(_: object) -> None:
        for argument in arguments:
            call(argument)

    return run


def _process(*command: str) -> Side:
    return Side(lambda _: subprocess.run(command, check=True, stdout=subprocess.DEVNULL))


def rows(quick: bool) -> Iterator[Row]:
    """Every row of the benchmark."""
    effort = QUICK if quick else Effort()
    for part in (choices, removals, set_points, loci, starts):
        yield from part(effort)


def main() -> None:
    """Measure, print and write."""
    command("closed_form", __doc__ or "", rows, PACKAGES)


if __name__ == "__main__":
    main()

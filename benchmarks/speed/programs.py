"""Speed of the programs: choosing a state and planning a path by solvers, beside the closed form.

    python benchmarks/speed/programs.py                 measures, writes results/programs.json, README.md
    python benchmarks/speed/programs.py --quick -o DIR  a short run into another folder, to see it work

Every ratio compares two things measured in turn in this one process. Answers are compared before times are.
"""

from collections.abc import Callable, Iterator
from functools import partial
from time import process_time

import clarabel
import cvxpy
import numpy as np
import osqp
import quadprog
from scipy import sparse

import regrasp as rg
from agreement import close
from closed_form import PACKAGES, QUICK, Effort, cone_edges, paper_state
from command import command
from pairs import Pairs, quadratics
from regrasp.closed_form.choice import EFFORT, best_squeeze
from regrasp.planning.changes.path_program import PathTask, path_program
from regrasp.planning.changes.path_search import planned_path
from regrasp.planning.states.criteria import PEAK_RATIO, Criteria
from regrasp.planning.states.degenerate import flat_minima
from regrasp.planning.states.program import state_program
from regrasp.programs import Cone, Program, available_backends, solve
from report import Measure, Row
from timing import Side as TimedSide

Side = partial(TimedSide, clock=process_time)  # others have the machine, too
PATH_SIZES = (10, 100, 1_000, 10_000)
OVERHEAD = (
    "a solver kept for programs of one pattern takes half of a bare call, which makes its own; besides, some "
    "40 us of Python that do not grow with the program: 5 for its right side, 12 to audit the answer by "
    "bounds, 10 to end least squares by Newton's method (90 in arrays, in space), and 12 for checks of "
    "arguments and the state; largest forces end with Newton's method on the touched constraints, 100 to 200 "
    "us in arrays, least normal forces in 30 to 150"
)


def overhead(effort: Effort) -> Iterator[Row]:
    """``choose_state`` through Clarabel, audit included, against bare Clarabel with prebuilt matrices."""
    patience, flat_minima.PATIENCE = flat_minima.PATIENCE, 10**9  # nothing is compiled halfway
    try:
        for fingers in (2, 3, 6):
            grasp, load = ring(fingers)
            for objective in ("effort", "peak", "peak_normal"):
                yield overhead_row(effort, grasp, load, objective, f"{fingers} contacts")
        yield first_row(effort, *ring(3), "3 contacts")
        flat_minima.PATIENCE = 0
        yield overhead_row(effort, *ring(3), "peak", "3 contacts", ", compiled")
    finally:
        flat_minima.PATIENCE = patience


def first_row(effort: Effort, grasp: rg.Grasp, load: rg.Wrench, what: str) -> Row:
    """Grasps that were never seen before beside one whose rows are kept from the load before."""
    rng = np.random.default_rng(3)

    def new_grasps() -> list[rg.Grasp]:
        shares = rng.uniform(0.99, 1.0, 20).tolist()
        return [rg.Grasp(c.changed(friction=share * c.friction) for c in grasp) for share in shares]

    def chosen(grasps: list[rg.Grasp]) -> None:
        for each in grasps:
            rg.choose_state(each, load, "effort", method="clarabel")

    return Row.of(
        f"clarabel_first_{len(grasp)}",
        f'`choose_state(method="clarabel")`, `effort`, {what}, a grasp seen first',
        "a grasp under another load before",
        effort.of(Side(chosen, 20, new_grasps), Side(lambda _: chosen([grasp] * 20), 20)), Measure.TIMES,
    )  # fmt: skip


def overhead_row(
    effort: Effort, grasp: rg.Grasp, load: rg.Wrench, objective: str, what: str, how: str = ""
) -> Row:
    """One choice, whose value must be that of bare Clarabel."""
    unit = float(abs(load.vector).max())
    program = state_program(grasp, load, objective, grasp.frictions.tolist(), [np.inf] * len(grasp), unit)
    bare = bare_clarabel(program)
    ours = rg.choose_state(grasp, load, objective, method="clarabel").value
    theirs = bare(None).obj_val * (unit**2 if objective == "effort" else unit)
    close(np.array(ours), np.array(theirs), 1e-6, f"bare Clarabel for {objective}")
    return Row.of(
        f"clarabel_{objective}_{len(grasp)}{'_compiled' if how else ''}",
        f'`choose_state(method="clarabel")`, `{objective}`, {what}{how}',
        "bare Clarabel: construct and solve, matrices prebuilt",
        effort.of(
            Side(lambda _: rg.choose_state(grasp, load, objective, method="clarabel")),
            Side(bare),
        ),
        Measure.TIMES,
        1.7,
        OVERHEAD,
    )


def roads(effort: Effort) -> Iterator[Row]:
    """The least effort of two fingers: the closed form, and every road to it through a solver."""
    pairs = Pairs.random(1000).first(effort.sample)
    programs = [quadratics(pair, "effort")[0] for pair in pairs]
    chosen = [np.array(best_squeeze(*p, EFFORT, np.inf, np.inf, PEAK_RATIO)[1]) for p in pairs]
    closed = Side(lambda _: [best_squeeze(*p, EFFORT, np.inf, np.inf, PEAK_RATIO) for p in pairs], len(pairs))
    data = [program.data for program in programs]
    directly: dict[str, tuple[Callable, list]] = {
        "DAQP, called directly": (lambda p: p.solve()[0], programs),
        "quadprog, called directly": (by_quadprog, [quadprog_data(d) for d in data]),
        "OSQP, set up and solved, its default settings": (by_osqp, [osqp_data(d) for d in data]),
        "Clarabel, constructed and solved": (by_clarabel, [clarabel_data(d) for d in data]),
    }
    for name, (call, arguments) in directly.items():
        if "OSQP" not in name:  # to its default tolerance of 1e-3 it is not comparable
            for argument, forces in zip(arguments, chosen, strict=True):
                close(np.array(call(argument)), forces, 1e-4, name)
        theirs = Side(
            lambda _, c=call, each=arguments: [c(argument) for argument in each], items=len(arguments)
        )
        yield Row.of(
            f"road_{name.split(',')[0].lower()}", "the closed form, one grasp, `effort`", name,
            effort.of(closed, theirs), Measure.FASTER,
        )  # fmt: skip
    state = paper_state()
    rest = state.grasp.without("P3")
    whole = Side(lambda _: rg.choose_state(rest, state.load, "effort"))
    for name, call in (("warm", cvxpy_warm(rest, state.load)), ("cold", cvxpy_cold(rest, state.load))):
        close(call(None), rg.choose_state(rest, state.load, "effort").forces.ravel(), 1e-5, f"cvxpy {name}")
        yield Row.of(
            f"road_cvxpy_{name}", "`choose_state`, closed form, `effort`", f"cvxpy with Clarabel, {name}",
            effort.of(whole, Side(call)), Measure.FASTER,
        )  # fmt: skip


def growth(effort: Effort) -> Iterator[Row]:
    """A path of least change, planned, audited and in exact equilibrium: its cost and how it grows."""
    tasks = {count: path_task(count) for count in PATH_SIZES[: 3 if effort is QUICK else 4]}
    yield from path_growth(effort, tasks, "path")
    many = max(tasks)
    one = Side(
        lambda _: planned_path(tasks[many], "change", Criteria("effort"), "clarabel"), clock=process_time
    )
    least = min(one.seconds(1) for _ in range(effort.rounds))
    yield Row.alone(
        "path_many", f"path of {many:,} instants, processor time", least, Measure.SECONDS, 0.12,
        "LAPACK's factors of the band, a quarter, and passes over arrays that outgrow the processor's cache",
    )  # fmt: skip


def path_growth(effort: Effort, tasks: dict[int, PathTask], what: str) -> Iterator[Row]:
    """The cost at the most instants beside that at the fewest, and at the next to most."""
    sides = {
        count: Side(
            lambda _, task=task: planned_path(task, "change", Criteria("effort"), "clarabel"),
        )
        for count, task in tasks.items()
    }
    first, *_, second, last = sides
    for small in (first, second):
        yield Row.growth(
            f"growth_{small}_{last}", f"{what}, {last:,} instants beside {small:,}",
            effort.of(sides[last], sides[small]), (last - 2) / (small - 2), 1.1,
            "a few more iterations, and factors that outgrow the processor's cache",
        )  # fmt: skip


def path_solvers(effort: Effort) -> Iterator[Row]:
    """The same path of 101 instants by every back end that takes it, beside Clarabel."""
    program = path_program(path_task(101), "change")
    best = solve(program, "clarabel")
    for name in available_backends():
        if name == "clarabel":
            continue
        answer = solve(program, name, throw=False)
        if answer.status is not best.status:
            continue
        close(answer.value, best.value, 1e-4, name)
        yield Row.of(
            f"path_{name}", f"path of 101 instants by {name}", "by Clarabel",
            effort.of(Side(lambda _, n=name: solve(program, n)), Side(lambda _: solve(program, "clarabel"))),
            Measure.TIMES,
        )  # fmt: skip


def ring(fingers: int) -> tuple[rg.Grasp, rg.Wrench]:
    """Contacts around a disc, facing its middle, and its weight and a torque."""
    angles = 2 * np.pi * np.arange(fingers) / fingers + 0.2
    contacts = [rg.Contact([np.cos(a), np.sin(a)], [-np.cos(a), -np.sin(a)], 0.6) for a in angles]
    return rg.Grasp(contacts), rg.Wrench([0.2, -1.0], 0.1)


def path_task(instants: int, start: rg.GraspState | None = None) -> PathTask:
    """The last finger leaves while the object swings, as a program needs it; from the paper's state."""
    start = paper_state() if start is None else start
    count = len(start.grasp)
    end = rg.plan_removal(start, count - 1).end
    t = np.linspace(0, 1, instants)
    sway = np.zeros(start.load.vector.size)
    sway[:2] = np.array([0.06, 0.14]) * np.linalg.norm(start.load.force)
    loads = start.load.vector + np.sin(2 * np.pi * t)[:, None] * sway
    active = np.ones((instants, count), dtype=bool)
    active[-1, -1] = False
    none = np.full(count, np.inf)
    return PathTask(
        start.grasp, t, loads, start.forces, end.forces, active, t, start.grasp.frictions, none, none,
        np.zeros(count), np.arange(count) < count - 1, float(abs(start.load.vector).max()),
    )  # fmt: skip


def bare_clarabel(program: Program) -> Callable[[object], object]:
    """Construct and solve, as someone would who has the matrices."""
    cones = []
    for block in program.blocks:
        kind = {Cone.ZERO: clarabel.ZeroConeT, Cone.NONNEGATIVE: clarabel.NonnegativeConeT}.get(block.cone)
        cones += [kind(block.rows)] if kind else [clarabel.SecondOrderConeT(block.size)] * block.count
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    upper = sparse.triu(program.P, format="csc")
    return lambda _: clarabel.DefaultSolver(upper, program.q, program.A, program.b, cones, settings).solve()


def clarabel_data(data: tuple) -> tuple:
    """Prebuilt: 3 equalities and 4 sides of cones of DAQP's form."""
    H, f, A, upper, lower, _ = data
    rows, b = np.vstack([A[:3], -A[3:]]), np.r_[upper[:3], -lower[3:]]
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    cones = [clarabel.ZeroConeT(3), clarabel.NonnegativeConeT(len(rows) - 3)]
    return sparse.csc_matrix(np.triu(H)), f, sparse.csc_matrix(rows), b, cones, settings


def by_clarabel(data: tuple) -> list[float]:
    return clarabel.DefaultSolver(*data).solve().x


def quadprog_data(data: tuple) -> tuple:
    H, f, A, upper, lower, _ = data
    return H, -f, A.T.copy(), np.r_[upper[:3], lower[3:]], 3


def by_quadprog(data: tuple) -> np.ndarray:
    return quadprog.solve_qp(*data)[0]


def osqp_data(data: tuple) -> dict:
    H, f, A, upper, lower, _ = data
    return {"P": sparse.csc_matrix(H), "q": f, "A": sparse.csc_matrix(A), "l": lower, "u": upper}


def by_osqp(data: dict) -> np.ndarray:
    solver = osqp.OSQP()
    solver.setup(**data, verbose=False)
    return solver.solve().x


def cvxpy_warm(grasp: rg.Grasp, load: rg.Wrench) -> Callable[[object], np.ndarray]:
    """Parametrised and compiled beforehand."""
    forces, given = cvxpy.Variable(4), cvxpy.Parameter(3, value=load.vector)
    problem = cvxpy.Problem(
        cvxpy.Minimize(cvxpy.sum_squares(forces)),
        [grasp.matrix @ forces == -given, cone_edges(grasp) @ forces >= 0],
    )

    def call(_: object) -> np.ndarray:
        given.value = load.vector
        problem.solve(solver="CLARABEL", warm_start=True)
        return forces.value

    return call


def cvxpy_cold(grasp: rg.Grasp, load: rg.Wrench) -> Callable[[object], np.ndarray]:
    """Written down and solved anew."""
    return lambda _: cvxpy_warm(grasp, load)(None)


def rows(quick: bool) -> Iterator[Row]:
    """Every row of the benchmark."""
    effort = QUICK if quick else Effort(rounds=15)
    for part in (overhead, roads, growth, path_solvers):
        yield from part(effort)


def main() -> None:
    """Measure, print and write."""
    command("programs", __doc__ or "", rows, (*PACKAGES, "quadprog", "qpsolvers"))


if __name__ == "__main__":
    main()

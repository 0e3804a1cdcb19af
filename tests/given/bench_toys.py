"""Toy problems, and solvers of an outside package that hang, crash, lie and are slow."""

from dataclasses import asdict, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
from scipy import sparse

from regrasp.bench.problems.problem import BenchProblem, Known, Truth, Verdict
from regrasp.bench.running.result import TIMES, Row
from regrasp.bench.running.solvers import Solver
from regrasp.programs import Block, Cone, Program

MODULE = """
import os, sys, time
from pathlib import Path
from types import SimpleNamespace
import numpy as np

def right(program, **settings):
    from regrasp.programs.calls.clarabel_call import Session, layout
    found = Session(layout(program), tol_feas=1e-9).solve()
    return SimpleNamespace(status=found.status, x=found.x, duals=found.duals, iterations=found.iterations)

def slow(program, **settings):
    time.sleep(0.02)
    return right(program)

def hangs(program, **settings):
    Path(os.environ.get("FAKE_PID", os.devnull)).write_text(str(os.getpid()))
    while True:
        time.sleep(1)

def crashes(program, **settings):
    print("noise " * 1000)
    os.abort()

def leaves(program, **settings):
    sys.exit(3)

def raises(program, **settings):
    raise ValueError("will not")

def eats(program, **settings):
    return np.ones(10**12)

def babbles(program, **settings):
    return SimpleNamespace(status="almost", x=None)

def odd(program, **settings):
    given = right(program)
    times = {"solve_time": float("nan"), "setup_time": -5.0}
    return SimpleNamespace(status="found", x=given.x, said="a\\ud800", **times)

class Unspeakable(Exception):
    def __str__(self):
        raise RuntimeError

def chokes(program, **settings):
    raise Unspeakable

SEEN = {}
def remembers(program, **settings):
    if id(program) not in SEEN:
        SEEN[id(program)] = right(program)
        SEEN.setdefault("kept", []).append(program)  # or its place in memory is taken again
        return SEEN[id(program)]
    return SimpleNamespace(status="failed", x=None, said="known")

def scribbles(program, **settings):
    given = right(program)
    program.q[:] = 1e9
    program.b[:] = 1e9
    return given

def breeds(program, **settings):
    child = os.fork()
    if child == 0:
        time.sleep(60)
        os._exit(0)
    Path(os.environ["FAKE_PID"]).write_text(str(child))
    os.abort()

def asked(program, **settings):
    return SimpleNamespace(status="failed", x=None, said=repr(sorted(settings.items())))

def lies(program, **settings):
    return SimpleNamespace(status="found", x=np.ones(program.q.size) / 3, duals=None)

def denies(program, **settings):
    return SimpleNamespace(status="infeasible", x=None, duals=np.arange(1.0, 1 + program.b.size))

def crashes_on_the_second(program, **settings):
    mark = Path(os.environ["FAKE_PID"])
    calls = len(mark.read_text()) if mark.exists() else 0
    mark.write_text("x" * (calls + 1))
    if calls == 2:
        os.abort()
    return right(program)
"""
NAMES = MODULE.replace("(", " ").split()
FAKES = [after for word, after in pairwise(NAMES) if word == "def" and not after.startswith("_")]


def qp(name: str, total: float, known: Known, follows: str | None = None) -> BenchProblem:
    """Minimise 1/2 |x|^2 with x1 + x2 = total and x >= 0."""
    A = sparse.csc_matrix([[1.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
    blocks = (Block(Cone.ZERO, 1), Block(Cone.NONNEGATIVE, 2))
    b = np.array([total, 0.0, 0.0])
    program = Program(sparse.identity(2, format="csc"), np.zeros(2), A, b, blocks)
    return BenchProblem(name, "toy", program, known, follows)


def solvable(total: float, follows: str | None = None) -> BenchProblem:
    known = Known(Verdict.SOLVABLE, Truth.CLOSED_FORM, total**2 / 4)
    return qp(f"toy/sum/{total:g}", total, known, follows)


INFEASIBLE = qp("toy/negative", -1.0, Known(Verdict.INFEASIBLE, Truth.PROOF))
UNKNOWN = qp("toy/unknown", 3.0, Known(Verdict.UNKNOWN, Truth.NONE))
CONE = BenchProblem(
    "toy/cone",
    "toy",
    Program(
        sparse.csc_matrix((2, 2)),
        np.array([1.0, 0.0]),
        sparse.csc_matrix([[0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]]),
        np.array([2.0, 0.0, 0.0]),
        (Block(Cone.ZERO, 1), Block(Cone.SECOND_ORDER, 2)),
    ),
    Known(Verdict.SOLVABLE, Truth.CLOSED_FORM, 2.0),
)
TOYS = [solvable(1.0), solvable(2.0, "toy/sum/1"), INFEASIBLE, UNKNOWN, CONE]


def install(folder: Path) -> Path:
    """Leave a package in ``folder`` that announces the solvers of ``MODULE``, in the way pip does."""
    info = folder / "fake_solvers-1.2.dist-info"
    info.mkdir(parents=True)
    (folder / "fake_solvers.py").write_text(MODULE)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: fake-solvers\nVersion: 1.2\n")
    lines = [f"{name} = fake_solvers:{name}" for name in FAKES]
    conic = "[regrasp.solvers.conic]\nright-conic = fake_solvers:right\n"
    (info / "entry_points.txt").write_text("\n".join(["[regrasp.solvers]", *lines, conic]))
    return folder


def fake(name: str, *, cones: bool = False) -> Solver:
    return Solver(name, "1.2", cones, entry=f"fake_solvers:{name}")


def by_problem(rows: list[Row]) -> dict[str, Row]:
    return {row.problem: row for row in rows}


def stripped(rows: list[Row]) -> list[dict[str, object]]:
    """Rows without what differs from run to run."""
    return [{name: value for name, value in asdict(row).items() if name not in TIMES} for row in rows]


LIMIT = 10.0
RIGHT = Row(
    problem="a/1", family="a", digest="0", solver="quick", settings="mid", mode="cold", repeat=0, version="1",
    verdict="solvable", truth="closed form", optimum=1.0, unknowns=4, rows=7, nonzeros=16,
    cones="zero 3, non-negative 4", status="found", said="solved", correct=True, why="near", objective=1.0,
    distance=1e-9, primal_residual=1e-10, dual_residual=None, gap=None, absolute_primal_residual=None,
    absolute_dual_residual=None, absolute_gap=None, certificate_residual=None, iterations=5, build_time=1e-5,
    setup_time=None, solve_time=3e-5, total_time=5e-5, memory=2**20, time_limit=LIMIT, machine="here",
)  # fmt: skip
WRONG = {"correct": False, "why": "farther than 1e-05 from the known optimum", "distance": 0.5}


def row(problem: int, solver: str, time: float | None = 5e-5, **changes: object) -> Row:
    return replace(RIGHT, **{"problem": f"a/{problem}", "solver": solver, "total_time": time} | changes)

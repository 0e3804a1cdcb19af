"""Rows of a benchmark, right and wrong ones."""

from dataclasses import replace

from regrasp.bench.running.result import Row

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

"""Programs that other people test their solvers with, and the optima they print.

cvxpy         ``cvxpy.tests.solver_test_helpers``, the linear, quadratic and second-order ones, as cvxpy
              itself lays them out for Clarabel
qpsolvers     ``qpsolvers.problems``
Maros and Meszaros, "A repository of convex quadratic programming problems", Optimization Methods and
Software 11 (1999): a dozen small ones, typed in from where that collection has them: W. Hock,
K. Schittkowski, "Test Examples for Nonlinear Programming Codes" (1981), K. Schittkowski, "More Test
Examples for Nonlinear Programming Codes" (1987), and CUTE; optima as in the repository's table
"""

import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import cvxpy as cp
import numpy as np
import qpsolvers.problems
from cvxpy.tests import solver_test_helpers
from scipy import sparse

from regrasp.programs import Block, Cone, Program


@dataclass(frozen=True)
class Peer:
    """A program and the least value of 1/2 x'Px + q'x + constant; inf where infeasible, -inf if unbounded.

    optimum: None where nobody printed it.
    """

    name: str
    program: Program
    optimum: float | None
    constant: float = 0.0


def peers() -> dict[str, Peer]:
    """All of them by name."""
    return {peer.name: peer for peer in (*_of_cvxpy(), *_of_qpsolvers(), *_of_maros_and_meszaros())}


def qp(
    P: Any, q: Any, G: Any = None, h: Any = None, A: Any = None, b: Any = None, lb: Any = None, ub: Any = None
) -> Program:
    """The program that minimises 1/2 x'Px + q'x subject to A x = b, G x <= h, lb <= x <= ub."""
    q = np.asarray(q, dtype=float).ravel()
    n = q.size
    P = np.asarray(P.toarray() if sparse.issparse(P) else P, dtype=float).reshape(n, n)
    equal, below = [np.zeros((0, n + 1))], [np.zeros((0, n + 1))]
    for rows, matrix, side in ((equal, A, b), (below, G, h)):
        if matrix is not None:
            dense = np.asarray(matrix.toarray() if sparse.issparse(matrix) else matrix, dtype=float)
            rows.append(np.column_stack([dense.reshape(-1, n), np.ravel(side)]))
    for bound, sign in ((lb, -1.0), (ub, 1.0)):
        if bound is not None:
            each = np.column_stack([sign * np.eye(n), sign * np.broadcast_to(bound, n)])
            below.append(each[np.isfinite(each[:, -1])])
    rows = np.vstack([*equal, *below])
    zeros = sum(map(len, equal))
    counts = ((Cone.ZERO, zeros), (Cone.NONNEGATIVE, len(rows) - zeros))
    blocks = tuple(Block(cone, 1, count) for cone, count in counts if count)
    return Program(sparse.csc_matrix(P), q, sparse.csc_matrix(rows[:, :-1]), rows[:, -1], blocks)


# -- cvxpy -----------------------------------------------------------------------------------------------

_CVXPY = (
    *(f"lp_{k}" for k in range(8)), "lp_bound_attr", "qp_0", "qp_bound_attr",
    *(f"socp_{k}" for k in range(5)), "socp_bounds_attr",
)  # fmt: skip


def _of_cvxpy() -> Iterator[Peer]:
    for name in _CVXPY:
        make = getattr(solver_test_helpers, name, None)  # some are newer than others
        if make is None:
            continue
        for axis in (0, 1) if name == "socp_3" else (None,):
            helper = make() if axis is None else make(axis=axis)
            title = f"cvxpy {name}" if axis in (None, 0) else f"cvxpy {name}, axis {axis}"
            yield _laid_out(title, helper.prob, float(helper.expect_val))


def _laid_out(name: str, problem: cp.Problem, optimum: float) -> Peer:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        data, _, inverse = problem.get_problem_data(cp.CLARABEL)
    n, dims = data["c"].size, data["dims"]
    P = sparse.csc_matrix(data["P"]) if data.get("P") is not None else sparse.csc_matrix((n, n))
    P = sparse.triu(P) + sparse.triu(P, 1).T
    sizes = [(Cone.ZERO, dims.zero), (Cone.NONNEGATIVE, dims.nonneg)]
    blocks = [Block(cone, 1, count) for cone, count in sizes if count]
    blocks += [Block(Cone.SECOND_ORDER, size) for size in dims.soc]
    A = sparse.csc_matrix(data["A"]) if data.get("A") is not None else sparse.csc_matrix((0, n))
    b = np.zeros(0) if data.get("b") is None else np.asarray(data["b"], dtype=float)
    sign = -1.0 if isinstance(problem.objective, cp.Maximize) else 1.0
    constant = float(inverse[-1].get("offset", 0.0))
    matrices = [sparse.csc_matrix(matrix, dtype=float) for matrix in (P, A)]
    for matrix in matrices:
        matrix.sum_duplicates()
    program = Program(matrices[0], np.asarray(data["c"], dtype=float), matrices[1], b, tuple(blocks))
    return Peer(name, program, sign * optimum, constant)


# -- qpsolvers -------------------------------------------------------------------------------------------


def _of_qpsolvers() -> Iterator[Peer]:
    module = qpsolvers.problems
    makers: dict[str, Callable[[], Any]] = {
        name.removeprefix("get_"): getattr(module, name)
        for name in sorted(dir(module))
        if name.startswith("get_qp")
    }
    for name, make in makers.items():
        problem, solution = make()
        program = qp(*problem.unpack_as_dense())
        x = solution.x
        value = None if x is None else float(0.5 * x @ program.P @ x + program.q @ x)
        if name == "qpsut02":  # the point that is printed is an optimum to its digits only
            value = None
        yield Peer(f"qpsolvers {name}", program, value)
    R, s, *rows = module.get_sparse_least_squares(60)
    yield Peer("qpsolvers least squares", qp(R.T @ R, -R.T @ s, *rows), None, float(s @ s) / 2)


# -- Maros and Meszaros ------------------------------------------------------------------------------------


def _squares(rows: Any, sides: Any) -> tuple[np.ndarray, np.ndarray, float]:
    """P, q and the constant of |R x - s|^2."""
    R, s = np.asarray(rows, dtype=float), np.asarray(sides, dtype=float)
    return 2 * R.T @ R, -2 * R.T @ s, float(s @ s)


def _of_maros_and_meszaros() -> Iterator[Peer]:
    def peer(name: str, optimum: float, constant: float, *parts: Any, **rows: Any) -> Peer:
        return Peer(f"Maros-Meszaros {name}", qp(*parts, **rows), optimum, constant)

    yield peer(
        "HS21", -99.96, -100.0, np.diag([0.02, 2]), [0, 0],
        G=[[-10, 1]], h=[-10], lb=[2, -50], ub=[50, 50],
    )  # fmt: skip
    hs35 = [[4, 2, 2], [2, 4, 0], [2, 0, 2]], [-8, -6, -4]
    budget = {"G": [[1, 1, 2]], "h": [3], "lb": 0}
    yield peer("HS35", 1 / 9, 9.0, *hs35, **budget)
    yield peer("HS35MOD", 0.25, 9.0, *hs35, **budget, A=[[0, 1, 0]], b=[0.5])
    chain = [[0, 0, 1, 1, -2], [0, 1, 0, 0, -1]]
    apart = [[0, 1, 1, 0, 0], [0, 0, 0, 1, 0], [0, 0, 0, 0, 1]]
    for name, optimum, first, side, bounds in (
        ("HS51", 0.0, [1, -1, 0, 0, 0], 4.0, {}),
        ("HS52", 1859 / 349, [4, -1, 0, 0, 0], 0.0, {}),
        ("HS53", 176 / 43, [1, -1, 0, 0, 0], 0.0, {"lb": -10, "ub": 10}),
    ):
        P, q, constant = _squares([first, *apart], [0, 2, 1, 1])
        yield peer(name, optimum, constant, P, q, A=[[1, 3, 0, 0, 0], *chain], b=[side, 0, 0], **bounds)
    yield peer(
        "HS76", -103 / 22, 0.0, [[2, 0, -1, 0], [0, 1, 0, 0], [-1, 0, 2, 1], [0, 0, 1, 1]], [-1, -3, 1, -1],
        G=[[1, 2, 1, 1], [3, 1, 2, -1], [0, -1, -4, 0]], h=[5, 4, -1.5], lb=0,
    )  # fmt: skip
    yield _hs118()
    D = [[-74, 80, 18, -11, -4], [14, -69, 21, 28, 0], [66, -72, -5, 7, 1], [-12, 66, -30, -23, 3],
         [3, 8, -7, -4, 1], [4, -12, 4, 4, 0]]  # fmt: skip
    P, q, constant = _squares(D, [51, -61, -56, 69, 10, -12])
    G = [[1, 1, 1, 1, 1], [-10, -10, 3, -5, -4], [8, -1, 2, 5, -3], [-8, 1, -2, -5, 3], [4, 2, -3, 5, -1]]
    yield peer("HS268", 0.0, constant, P, q, G=G, h=[5, -20, 40, -11, 30])
    yield peer("TAME", 0.0, 0.0, [[2, -2], [-2, 2]], [0, 0], A=[[1, 1]], b=[1], lb=0)
    yield peer("ZECEVIC2", -4.125, 0.0, np.diag([0, 4]), [-2, -3], G=[[1, 1], [1, 4]], h=[2, 4], lb=0, ub=10)
    sums = np.eye(9, 10) + np.eye(9, 10, 1)
    P, q, constant = _squares(sums, np.zeros(9))
    rows = np.eye(8, 10) + 2 * np.eye(8, 10, 1) + 3 * np.eye(8, 10, 2)
    yield peer("GENHS28", 0.927173694, constant, P, q, A=rows, b=np.ones(8))


def _hs118() -> Peer:
    """Fifteen unknowns in five periods of three."""
    steps = np.eye(12, 15, 3) - np.eye(12, 15)
    sums = np.kron(np.eye(5), np.ones((1, 3)))
    return Peer(
        "Maros-Meszaros HS118",
        qp(
            np.diag(np.tile([0.0002, 0.0002, 0.0003], 5)),
            np.tile([2.3, 1.7, 2.2], 5),
            G=np.vstack([steps, -steps, -sums]),
            h=np.r_[np.tile([6, 7, 6], 4), np.full(12, 7), -60, -50, -70, -85, -100],
            lb=[8, 43, 3, *[0] * 12],
            ub=[21, 57, 16, *[90, 120, 60] * 4],
        ),
        664.82045,
    )

"""Programs of small whole numbers whose truth is known by construction, in units that are powers of two.

Nothing is rounded, so what is said of them holds exactly:

    solved        x, s in K and z in K* are drawn with s'z = 0; b = A x + s, q = -P x - A'z
    infeasible    a last row makes A'y = 0 and b'y < 0 for a y in K* that was drawn
    unbounded     P d = 0, -A d in K and q'd = -1 for a d that was drawn, and a point that is feasible
    both          such a d, and two equations that contradict each other
"""

from typing import NamedTuple

import numpy as np
from scipy import sparse

from regrasp.programs import Block, Cone, Program, Rows, Solution, Status
from regrasp.programs.cones import Cones

KINDS = ("solved", "infeasible", "unbounded", "both")
ROUND = [(5, 3, 4), (5, -3, 4), (5, 4, 3), (13, 5, -12), (13, -12, 5), (5, -4, -3)]
"""On the boundary of the cone of three rows, exactly."""
_CLAIMS = (Status.SOLVED, Status.INFEASIBLE, Status.UNBOUNDED)


class Known(NamedTuple):
    """A program, its truth, its optimum if there is one; A, b, P, q without units, and those of unknowns."""

    program: Program
    truth: Status
    optimum: float
    plain: tuple[np.ndarray, ...]
    units: np.ndarray


def known(seed: int) -> Known:
    """The program of a seed; the kinds come in turn."""
    rng = np.random.default_rng(seed)
    kind, has_cones = KINDS[seed % 4], rng.random() < 0.35
    n, nn, ns = int(rng.integers(1, 6)), int(rng.integers(0, 7)), int(rng.integers(1, 3)) if has_cones else 0
    nz = int(rng.integers(0, min(n, 3) + 1))
    m, first = nz + nn + 3 * ns, nz + nn
    blocks = [Block(Cone.ZERO, 1, nz), Block(Cone.NONNEGATIVE, 1, nn), Block(Cone.SECOND_ORDER, 3, ns)]
    A, x = rng.integers(-3, 4, (m, n)).astype(float), rng.integers(-3, 4, n).astype(float)
    L = rng.integers(-2, 3, (n, int(rng.integers(0, n + 1)))).astype(float)
    q, optimum = rng.integers(-3, 4, n).astype(float), np.nan

    def inside() -> np.ndarray:
        s = np.r_[np.zeros(nz), rng.integers(0, 4, nn), np.zeros(3 * ns)].astype(float)
        for k in range(first, m, 3):
            s[k : k + 3] = ROUND[rng.integers(6)]
            s[k] += rng.integers(0, 2)
        return s

    if kind == "solved":
        s, z = inside(), np.r_[rng.integers(-3, 4, nz), np.zeros(m - nz)].astype(float)
        touched = rng.random(nn) < 0.5
        z[nz:first] = np.where(touched, rng.integers(0, 4, nn), 0)
        s[nz:first][touched] = 0
        for k in range(first, m, 3):
            t = np.array(ROUND[rng.integers(6)], dtype=float)
            s[k : k + 3], z[k : k + 3] = t, rng.integers(0, 3) * t * [1, -1, -1]
        P, b = L @ L.T, A @ x + s
        q = -P @ x - A.T @ z
        optimum = x @ P @ x / 2 + q @ x
    elif kind == "infeasible":
        y = inside() + np.r_[rng.integers(-3, 4, nz), np.zeros(m - nz)]
        P, b = L @ L.T, rng.integers(-5, 6, m) * rng.choice([1.0, 10.0, 1000.0])
        A, b = np.vstack([A, -(y @ A)]), np.r_[b, -(y @ b) - rng.choice([1, 2.0**-3, 2.0**-10])]
        blocks.append(Block(Cone.NONNEGATIVE, 1, 1))
    else:
        d = np.r_[rng.integers(-2, 3, n - 1), 1].astype(float)
        A[:, -1] = -inside() - A[:, :-1] @ d[:-1]
        L[-1] = -(d[:-1] @ L[:-1])
        q[-1] = -1 - q[:-1] @ d[:-1]
        P, b = L @ L.T, A @ x + inside()
        if kind == "both":
            w = rng.integers(-2, 3, n).astype(float)
            w[-1] = -(w[:-1] @ d[:-1])
            A, b = np.vstack([A, w, w]), np.r_[b, 0, rng.choice([1, 2.0**-3, 2.0**-10])]
            blocks.append(Block(Cone.ZERO, 1, 2))
    if kind != "unbounded" and rng.random() < 0.5:  # a bound so far away that it changes nothing
        A = np.vstack([A, rng.choice([-1, 1]) * np.eye(n)[rng.integers(n)]])
        b = np.r_[b, 10.0 ** rng.integers(2, 31)]
        blocks.append(Block(Cone.NONNEGATIVE, 1, 1))
    if rng.random() < 0.2:  # rows that say nothing
        A, b = np.vstack([A, np.zeros((2, n))]), np.r_[b, 0, 0]
        blocks += [Block(Cone.ZERO, 1, 1), Block(Cone.NONNEGATIVE, 1, 1)]
    span = float(rng.choice([0, 0, 5, 15, 30]))
    blocks = [block for block in blocks if block.rows]
    rows = [np.repeat(_unit(rng, span, block.count), block.size) for block in blocks]
    D, E = _unit(rng, span, n), np.concatenate([*rows, np.zeros(0)])
    c = float(_unit(rng, span, 1)[0])
    matrices = (sparse.csc_matrix(c * D[:, None] * P * D), sparse.csc_matrix(E[:, None] * A * D))
    program = Program(matrices[0], c * D * q, matrices[1], E * b, tuple(blocks))
    truth = {"solved": Status.SOLVED, "unbounded": Status.UNBOUNDED}.get(kind, Status.INFEASIBLE)
    return Known(program, truth, optimum, (A, b, P, q), D)


def is_a_lie(case: Known, answer: Solution) -> bool:
    """Whether an answer claims what is not so; one that claims nothing does not."""
    if answer.status not in _CLAIMS:
        return False
    if answer.status is not case.truth:
        return True
    if answer.status is not Status.SOLVED:
        return False
    A, b, P, q = case.plain
    x = case.units * answer.value
    outside = Cones(case.program.blocks).excess(b - A @ x).max(initial=0.0)
    off = abs(x @ P @ x / 2 + q @ x - case.optimum)
    return bool(outside > 1e-3 or off > 1e-3 * (1 + abs(case.optimum)))


def _unit(rng: np.random.Generator, span: float, count: int) -> np.ndarray:
    return 2.0 ** np.round(rng.uniform(-span, span, count))


def projection_on_simplex(point):
    """min 1/2 |x - p|^2 with sum x = 1, x >= 0: sort and shift."""
    n = len(point)
    rows = Rows(n)
    rows.equal(np.ones((1, n)), -1.0)
    rows.at_least_zero(np.eye(n))
    ordered = np.sort(point)[::-1]
    shifts = (np.cumsum(ordered) - 1) / np.arange(1, n + 1)
    shift = shifts[np.flatnonzero(ordered > shifts)[-1]]
    return rows.program(-np.asarray(point), np.eye(n)), np.maximum(point - shift, 0)

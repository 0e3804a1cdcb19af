"""Balls of disturbances in space: what choices reach of the exact factor, and what exact inequalities cost.

    python benchmarks/truth/round_sets.py [--quick] [-o DIR]

The exact factor is a program with two positive semidefinite matrices for each contact, given to Clarabel as
it is: one says that the cone holds an ellipsoid of forces (8 by 8), one that the limit does (7 by 7);
docs/robustness.md says why they are exact.
"""

import argparse
import json
from pathlib import Path
from time import process_time
from typing import Any

import clarabel
import numpy as np
from numpy.typing import NDArray
from scipy import sparse

import regrasp as rg
from withstood_grasps import random_grasp, random_stiffness
from withstood_judges import answers

Array = NDArray[np.float64]
GRASPS = 200


class Inequalities:
    """Rows C x + c, of which matrices are made; x the forces, the factor, and what is added."""

    def __init__(self, size: int) -> None:
        self.size = size
        self.matrices: list[Array] = []
        self.constants: list[Array] = []
        self.cones: list[Any] = []

    def new(self, count: int) -> Array:
        """(count, size) picks new unknowns."""
        self.matrices = [np.pad(m, ((0, 0), (0, count))) for m in self.matrices]
        self.size += count
        return np.eye(self.size)[-count:]

    def rows(self, matrix: Array, constants: Array, cone: Any) -> None:
        """Demand matrix x + constants in the cone."""
        self.matrices.append(matrix)
        self.constants.append(constants)
        self.cones.append(cone)

    def positive(self, matrix: Array, constants: Array) -> None:
        """matrix: (k, k, size), constants: (k, k), symmetric: together positive semidefinite."""
        k = len(constants)
        at = [(i, j) for j in range(k) for i in range(j + 1)]
        scale = np.array([1.0 if i == j else 2**0.5 for i, j in at])
        i, j = np.array(at).T
        self.rows(scale[:, None] * matrix[i, j], scale * constants[i, j], clarabel.PSDTriangleConeT(k))

    def solved(self, q: Array) -> tuple[float, float]:
        """The least q . x, and the processor time of the solver."""
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        A, b = sparse.csc_matrix(-np.vstack(self.matrices)), np.concatenate(self.constants)
        nothing = sparse.csc_matrix((self.size, self.size))
        began = process_time()
        answer = clarabel.DefaultSolver(nothing, q, A, b, self.cones, settings).solve()
        spent = process_time() - began
        good = str(answer.status) in ("Solved", "AlmostSolved")
        return (float(q @ np.array(answer.x)) if good else np.nan), spent


def exact_factor(
    grasp: rg.Grasp, load: rg.Wrench, changes: Array, frictions: Array, limits: Array, exact: bool = True
) -> tuple[float, float]:
    """The widest factor of d = A z, |z| <= 1, and the solver's time. changes: (n, 3, k) R A of each force.

    exact: otherwise limits are |f| + factor |R A| <= limit, as they were once.
    """
    n, unit = len(grasp), float(limits.max())
    todo = Inequalities(3 * n + 1)
    weight = 1 / grasp.lengths
    balance = np.pad(grasp.matrix * weight[:, None], ((0, 0), (0, 1)))
    todo.rows(balance, load.vector * weight / unit, clarabel.ZeroConeT(6))
    todo.rows(np.eye(todo.size)[-1:], np.zeros(1), clarabel.NonnegativeConeT(1))
    for i, contact in enumerate(grasp):
        u, s, _ = np.linalg.svd(changes[i] / unit, full_matrices=False)
        change = (u * s)[:, :3]
        first, second = np.linalg.svd(contact.normal[None])[2][1:]
        pushed = frictions[i] * contact.normal
        skew = todo.new(6)
        x = np.eye(todo.size)
        force, factor = x[3 * i : 3 * i + 3], x[3 * n]

        def arrow(edge: Array, force: Array = force, factor: Array = factor, change: Array = change) -> Array:
            found = np.einsum("ab,s->abs", np.eye(4), edge @ force)
            found[0, 1:] = found[1:, 0] = np.outer(edge @ change, factor)
            return found

        turn = np.zeros((4, 4, todo.size))
        for k, (row, column) in enumerate(zip(*np.tril_indices(4, -1), strict=True)):
            turn[row, column], turn[column, row] = skew[k], -skew[k]
        upper = arrow(second) + turn
        left = np.concatenate([arrow(pushed + first), upper.swapaxes(0, 1)])
        right = np.concatenate([upper, arrow(pushed - first)])
        todo.positive(np.concatenate([left, right], axis=1), np.zeros((8, 8)))
        limit = limits[i] / unit
        if not exact:
            matrix = np.vstack([-np.linalg.norm(change, 2) * factor, force])
            todo.rows(matrix, np.array([limit, 0, 0, 0]), clarabel.SecondOrderConeT(4))
            continue
        share = todo.new(1)[0]
        force, factor = (np.pad(v, [(0, 0)] * (v.ndim - 1) + [(0, 1)]) for v in (force, factor))
        matrix = np.zeros((7, 7, todo.size))
        matrix[0, 0] = -share
        matrix[[1, 2, 3], [1, 2, 3]] = share
        matrix[0, 4:] = matrix[4:, 0] = force
        matrix[1:4, 4:] = np.einsum("ab,s->bas", change, factor)
        matrix[4:, 1:4] = np.einsum("ab,s->abs", change, factor)
        todo.positive(matrix, np.diag([limit, 0, 0, 0, limit, limit, limit]))
    q = np.zeros(todo.size)
    q[3 * n] = -1
    value, spent = todo.solved(q)
    return -value, spent


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--quick", action="store_true", help="few grasps, to see that it works")
    arguments.add_argument("-o", "--output", type=Path, default=Path(__file__).parents[1] / "results")
    given = arguments.parse_args()
    rng, rows = np.random.default_rng(3), []
    while len(rows) < (10 if given.quick else GRASPS):
        grasp, load = random_grasp(rng, 3, 3 + len(rows) % 4)
        if grasp.is_soft:
            continue
        stiffness, torque = random_stiffness(rng, grasp), grasp.size * float(np.exp(rng.uniform(-2, 2)))
        loads = rg.LoadSet.ball(rg.Wrench([0, 0, 0]), force=1.0, torque=torque)
        limit = float(rng.uniform(2, 20))
        try:
            state = rg.choose_state(
                grasp, load, "wrench", disturbance=loads, stiffness=stiffness, max_force=limit
            )
        except rg.Infeasible:
            continue
        began = process_time()
        state = rg.choose_state(
            grasp, load, "wrench", disturbance=loads, stiffness=stiffness, max_force=limit
        )
        spent = process_time() - began
        changes = answers(grasp, stiffness).reshape(len(grasp), 3, 6) @ loads.half_axes
        asked = np.array([c.friction for c in grasp]), np.full(len(grasp), limit)
        exact, time = exact_factor(grasp, load, changes, *asked)
        once, _ = exact_factor(grasp, load, changes, *asked, exact=False)
        rows.append([state.value / exact, state.gap / state.value, once / exact, spent, time])
    share, gap, once, spent, time = np.array(rows).T
    found = {
        "grasps": len(rows),
        "share of the exact factor: least, median": [share.min(), np.median(share)],
        "largest": share.max(),
        "gap that states say, relative: median, largest": [np.median(gap), gap.max()],
        "bound below the exact factor": int((share * (1 + gap) < 1 - 1e-6).sum()),
        "share with |f| + factor |R A| within limits: least, median": [np.nanmin(once), np.nanmedian(once)],
        "choose_state, processor ms: median, largest": [1e3 * np.median(spent), 1e3 * spent.max()],
        "exact inequalities, Clarabel, processor ms: median, largest": [
            1e3 * np.median(time),
            1e3 * time.max(),
        ],
    }
    text = json.dumps({k: np.round(v, 4).tolist() for k, v in found.items()}, indent=1) + "\n"
    (given.output / "round_sets.json").write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()

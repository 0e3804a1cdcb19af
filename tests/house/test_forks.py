"""Loops shared out to threads go on in processes forked from one whose threads run."""

import multiprocessing
import os
import subprocess
import sys

import numpy as np
import pytest

import regrasp as rg
from values import problem, space_problem

pytestmark = [
    pytest.mark.contract,
    pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork here"),
]

LIMIT = 300
"""Seconds: machine code for one thread is compiled in the child where none was kept."""


def intervals(seed: int) -> bytes:
    rng = np.random.default_rng(seed)
    points, normals = rng.normal(size=(2000, 2)), rng.normal(size=(2000, 2))
    lo, hi = rg.locus_intervals(points, normals, 0.5, [3.0, 0.0], [-1.0, 0.0], 0.5, force=[0, -1])
    return lo.tobytes() + hi.tobytes()


def squeezes(seed: int) -> bytes:
    rng = np.random.default_rng(seed)
    points, normals = rng.normal(size=(2000, 2)), rng.normal(size=(2000, 2))
    best = rg.best_squeezes(points, normals, 0.5, [3.0, 0.0], [-1.0, 0.0], 0.5, force=[0, -1])
    return best.tobytes()


def regrasp(seed: int) -> tuple[object, ...]:
    """Margins of pairs, the widest of each, and both searches."""
    asked = problem()
    fresh = rg.RegraspProblem(
        asked.outline, asked.start, asked.goal, asked.load, 0.5, candidates=20 + seed, orientations=8
    )
    cheap = rg.RegraspProblem(
        asked.outline, asked.start, asked.goal, asked.load, 0.5, candidates=20, orientations=8,
        weights=rg.RegraspWeights(turning=0.1),
    )  # fmt: skip
    return fresh.graph.margins.tobytes(), tuple(fresh.plans()), tuple(cheap.plans())


def in_space(seed: int) -> tuple[object, ...]:
    asked = space_problem()
    fresh = rg.RegraspProblem(
        asked.outline, asked.start, asked.goal, asked.load, friction=0.8, candidates=4 + seed, orientations=1
    )
    return fresh.graph.margins.tobytes(), len(fresh.sequences())


@pytest.mark.parametrize("work", [intervals, squeezes, regrasp, in_space])
def test_pool_after_a_first_batch(work: object) -> None:
    wanted = [work(seed) for seed in range(3)]  # type: ignore[operator]
    with multiprocessing.get_context("fork").Pool(2) as pool:
        assert pool.map_async(work, range(3)).get(LIMIT) == wanted  # type: ignore[arg-type]


def test_grandchild_and_a_first_import_in_the_child() -> None:
    """A pool within a pool; and regrasp's loops imported where somebody else's threads run already."""
    code = """
import multiprocessing, os, sys
from numba import njit, prange

@njit(parallel=True)
def total(n):
    s = 0.0
    for i in prange(n):
        s += i
    return s

def batch(depth):
    import regrasp as rg
    lo, hi = rg.locus_intervals([0, 0], [1, 0], 0.5, [3.0, 0.0], [-1.0, 0.0], 0.5, force=[0, -1])
    if depth:
        process = multiprocessing.get_context("fork").Process(target=batch, args=(depth - 1,))
        process.start()
        process.join(200)
        assert process.exitcode == 0, process.exitcode
    assert lo <= hi

total(1000)
process = multiprocessing.get_context("fork").Process(target=batch, args=(1,))
process.start()
process.join(250)
sys.exit(process.exitcode)
"""
    subprocess.run([sys.executable, "-c", code], check=True, timeout=LIMIT)

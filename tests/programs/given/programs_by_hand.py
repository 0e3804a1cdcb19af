"""Programs typed in as lists, what somebody says of them, and what is made of it."""

from dataclasses import replace

import numpy as np
from scipy import sparse

from regrasp.programs import Block, Cone, Program, Status
from regrasp.programs.judging.verdict import judged
from regrasp.programs.solution import Solution


def program(P, q, A, b, *blocks, size=0.0) -> Program:
    n = len(q)
    parts = [sparse.csc_matrix(np.array(M, dtype=float).reshape(-1, n)) for M in (P, A)]
    return Program(parts[0], np.array(q, dtype=float), parts[1], np.array(b, dtype=float), blocks, size)


def zero(count) -> Block:
    return Block(Cone.ZERO, 1, count)


def nonnegative(count) -> Block:
    return Block(Cone.NONNEGATIVE, 1, count)


def claim(p, status, x=None, z=None) -> Solution:
    """An answer of unknowns and duals, NaN where none are given."""
    x = np.full(p.q.size, np.nan) if x is None else np.array(x, dtype=float)
    z = np.full(p.b.size, np.nan) if z is None else np.array(z, dtype=float)
    return Solution(p, "somebody", status, x, z, 7, 0.25, 0.5, "so they say")


def claimed(of, x, z=None, status=Status.SOLVED, allowed=1e-7) -> Solution:
    """What is left of a claim, no feasible point being known."""
    given = claim(of, status, x, np.zeros(of.b.size) if z is None else z)
    return judged(given, allowed, lambda p: replace(given, status=Status.NOT_FOUND))


def nobody(_):
    raise AssertionError("no point is asked for")

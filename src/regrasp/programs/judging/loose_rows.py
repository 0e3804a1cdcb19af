"""Bounds so far away that they hide the rest of a program from solvers, left out and looked at again.

A program without some of its inequalities asks less: where it has no solution, a certificate with zeros for
what was left out is one of the whole; where its solution keeps them it is the whole's, with zero duals.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from regrasp.programs.blocks import Array, Block, Cone
from regrasp.programs.program import Program
from regrasp.programs.solution import Solution

# Right sides, each over the largest entry of its row, this far above all smaller ones are left out.
_FAR = 1e4


def without_loose_rows(program: Program) -> tuple[Program, NDArray[np.bool_]] | None:
    """The program without its loosest inequalities, and which rows (m,) stay; None if none is loose."""
    signs = [block.cone is Cone.NONNEGATIVE for block in program.blocks]
    inequality = np.repeat(signs, [block.rows for block in program.blocks])
    entries = program.terms.in_rows(np.ones(program.q.size))
    sizes = abs(program.b) / np.where(entries > 0, entries, 1.0)
    known = np.unique(sizes[sizes > 0])
    far = np.flatnonzero(known[1:] > _FAR * known[:-1])
    if not far.size:
        return None
    kept = ~(inequality.astype(bool) & (program.b > 0) & (sizes >= known[far[-1] + 1]))
    if kept.all():
        return None
    first, blocks = 0, []
    for block in program.blocks:
        count = int(kept[first : first + block.rows].sum())
        first += block.rows
        if count:
            blocks.append(block if count == block.rows else Block(block.cone, 1, count))
    rest = Program(program.P, program.q, program.A[kept].tocsc(), program.b[kept], tuple(blocks))
    return rest, kept


def with_loose_rows(answer: Solution, program: Program, kept: NDArray[np.bool_]) -> Solution:
    """The answer to a program without loose rows as one to the whole, which is to be judged."""
    duals: Array = np.zeros(program.b.size)
    duals[kept] = answer.duals
    return replace(answer, program=program, duals=duals, said=f"{answer.said}, without loose rows")

"""How far a program is from having a point, or from having none: a program that always has a solution.

    minimise   t
    subject to A x + s = b + t e,   s in K,   t >= -1

e is the largest entry of each inequality, or of the first row of its second-order cone; equalities stay. At
its best t is above 0 where nothing is feasible, and its dual is then a certificate: A'z = 0, z in K*,
b'z = -t e'z. It converges where the program itself, with next to no room or none, does not.
"""

from collections.abc import Callable
from dataclasses import replace
from math import nan

import numpy as np
from scipy import sparse

from regrasp.programs.blocks import Block, Cone
from regrasp.programs.judging.cleaning import cleaned_duals
from regrasp.programs.judging.proofs import infeasibility_residual
from regrasp.programs.program import Program
from regrasp.programs.solution import Solution, Status


def elastic(program: Program) -> Program:
    """The program of the least t."""
    A, n = sparse.csr_matrix(program.A), program.q.size
    entries = program.terms.in_rows(np.ones(n))
    first = program.cones.nonnegative.copy()
    first[[part.start for part in program.cones.round]] = True
    room = sparse.csr_matrix((first * program.cones.largest(entries))[:, None])
    least = sparse.csr_matrix(([-1.0], ([0], [n])), (1, n + 1))
    return Program(
        sparse.csc_matrix((n + 1, n + 1)),
        np.append(np.zeros(n), 1.0),
        sparse.vstack([sparse.hstack([A, -room]), least], format="csc"),
        np.append(program.b, 1.0),
        (*program.blocks, Block(Cone.NONNEGATIVE, 1, 1)),
        size=program.size,
    )


def proven_anyway(solution: Solution, ask: Callable[[Program], Solution], enough: float) -> Solution | None:
    """The proof that a program without an answer has none, by its elastic one; None without a proof.

    enough: the largest residual of a certificate.
    """
    program, m, equal = solution.program, solution.program.b.size, solution.program.cones.zero
    for given in (program, _loosened(program)) if equal.any() else (program,):
        answer = ask(elastic(given))
        if not (answer.value[-1] > 0 and np.isfinite(answer.duals).all()):
            continue
        z = answer.duals[:m].copy()
        z[equal] -= answer.duals[m:-1] if given is not program else 0.0
        z = cleaned_duals(program, z, enough)
        if infeasibility_residual(program, z) <= enough:
            said = f"{solution.said}, but infeasible with room for all"
            nothing = np.full(program.q.size, nan)
            return replace(solution, status=Status.INFEASIBLE, value=nothing, duals=z, said=said)
    return None


def _loosened(program: Program) -> Program:
    """The program with two inequalities for each equality, one in its place and one at the end."""
    equal = program.cones.zero
    A, inside = (
        sparse.csr_matrix(program.A),
        (Cone.NONNEGATIVE if b.cone is Cone.ZERO else b.cone for b in program.blocks),
    )
    blocks = [replace(block, cone=cone) for block, cone in zip(program.blocks, inside, strict=True)]
    return Program(
        program.P,
        program.q,
        sparse.vstack([A, -A[equal]], format="csc"),
        np.r_[program.b, -program.b[equal]],
        (*blocks, Block(Cone.NONNEGATIVE, 1, int(equal.sum()))),
        size=program.size,
    )

"""Our CBF files as MOSEK reads them. Reading takes no licence; what was read is solved by Clarabel.

MOSEK is no dependency: install it by ``pip install mosek`` to run this.
"""

import numpy as np
import pytest
from scipy import sparse

from regrasp.bench.exchange import write_cbf
from regrasp.bench.families import FAMILIES
from regrasp.bench.problems.problem import Verdict
from regrasp.programs import Block, Cone, Program, Status, solve

pytestmark = pytest.mark.oracle

mosek = pytest.importorskip("mosek")
CONIC = [p for family in FAMILIES.values() for p in family.problems() if not p.is_qp]


def as_mosek_reads(path):
    """minimise c'x + c0 subject to F x + g in cones, of the task that MOSEK makes of the file; and c0."""
    with mosek.Env() as env, env.Task() as task:
        task.readdata(str(path))
        assert task.getobjsense() is mosek.objsense.minimize
        assert task.getnumcon() == 0
        n, m = task.getnumvar(), task.getnumafe()
        assert all(task.getvarbound(j)[0] is mosek.boundkey.fr for j in range(n))
        c = np.array([task.getcj(j) for j in range(n)])
        rows, columns, values = (np.array(part) for part in task.getafeftrip())
        F = sparse.csr_matrix((values, (rows, columns)), shape=(m, n))
        g = np.array(task.getafegslice(0, m))
        A, b, blocks = [], [], []
        for k in range(task.getnumacc()):
            places, domain = np.array(task.getaccafeidxlist(k)), task.getaccdomain(k)
            assert not np.any(task.getaccb(k))
            kind = task.getdomaintype(domain)
            part, shift = F[places], g[places]
            if kind is mosek.domaintype.rquadratic_cone:  # 2 u v >= |w|^2 turned into |(..)| <= u + v
                turn = sparse.identity(places.size, format="lil")
                turn[:2, :2] = np.array([[1, 1], [1, -1]]) / np.sqrt(2)
                part, shift = turn.tocsr() @ part, turn @ shift
            cone = {
                mosek.domaintype.rzero: Cone.ZERO,
                mosek.domaintype.rplus: Cone.NONNEGATIVE,
                mosek.domaintype.rminus: Cone.NONNEGATIVE,
            }.get(kind, Cone.SECOND_ORDER)
            sign = -1 if kind is mosek.domaintype.rminus else 1
            A.append(-sign * part)
            b.append(sign * shift)
            sizes = (places.size, 1) if cone is Cone.SECOND_ORDER else (1, places.size)
            blocks.append(Block(cone, *sizes))
        program = Program(
            sparse.csc_matrix((n, n)), c, sparse.vstack(A, format="csc"), np.concatenate(b), tuple(blocks)
        )
        return program, task.getcfix()


@pytest.mark.parametrize("family", sorted({p.family for p in CONIC}))
def test_what_mosek_reads_has_the_known_optimum(family, tmp_path):
    for problem in (p for p in CONIC if p.family == family):
        write_cbf(problem.program, tmp_path / "a.cbf", problem.name)
        program, constant = as_mosek_reads(tmp_path / "a.cbf")
        answer = solve(program, "clarabel", throw=False)
        if problem.known.verdict is Verdict.INFEASIBLE:
            assert answer.status is Status.INFEASIBLE, problem.name
        else:
            assert answer.status is Status.SOLVED, (problem.name, answer.status)
            optimum = answer.objective + constant
            assert optimum == pytest.approx(problem.known.optimum, rel=1e-6, abs=1e-6), problem.name

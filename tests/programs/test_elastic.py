"""Programs with next to no room, or a little less: proven empty, and by how much."""

import numpy as np
import pytest
from scipy import sparse

from regrasp.programs import Rows, Status, solve
from regrasp.programs.backends import least_room
from regrasp.programs.judging.elastic import proven_anyway
from regrasp.programs.judging.proofs import infeasibility_residual
from regrasp.programs.judging.verdict import PROVEN
from regrasp.programs.solution import Solution

pytestmark = pytest.mark.laws


def squeezed(room: float, seed: int):
    """A ball of radius 1 about c and a half-space that leaves ``room`` of it; x in a plane through c."""
    rng = np.random.default_rng(seed)
    n, c = rng.normal(size=3), rng.normal(size=3)
    n /= np.linalg.norm(n)
    across = np.cross(n, rng.normal(size=3))
    rows = Rows(3)
    rows.equal(sparse.csr_matrix(across[None]), -across @ c[None].T)
    rows.second_order(sparse.csr_matrix(np.vstack([np.zeros(3), np.eye(3)])), np.r_[1.0, -c], size=4)
    rows.at_least_zero(sparse.csr_matrix(n[None]), np.array([-(n @ c) - 1 + room]))
    return rows.program(rng.normal(size=3))


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("room", [0.3, 1e-4, 1e-6, 1e-8, -1e-8, -1e-6, -1e-4, -0.3])
def test_how_much_room_is_missing(room: float, seed: int) -> None:
    """Half of it is missing in each of the two, whose largest entries are 1 and the normal's."""
    program = squeezed(room, seed)
    entry = abs(program.A.toarray()[-1]).max()
    assert least_room(program, "clarabel") == pytest.approx(-room / (1 + entry), rel=1e-5, abs=2e-9)
    assert solve(program, throw=False).status is not (Status.INFEASIBLE if room > 0 else Status.SOLVED)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("room", [1e-4, 1e-6, -1e-6, -1e-4])
def test_a_solver_that_stops_may_still_prove(room: float, seed: int) -> None:
    program = squeezed(room, seed)
    nothing = np.full(3, np.nan), np.full(program.b.size, np.nan)
    stopped = Solution(program, "clarabel", Status.STOPPED, *nothing, None, 0.0, 0.0, "stopped")
    found = proven_anyway(stopped, lambda given: solve(given, throw=False), PROVEN)
    assert (found is not None) == (room < 0)
    if found is not None:
        assert found.status is Status.INFEASIBLE
        assert infeasibility_residual(program, found.duals) <= PROVEN

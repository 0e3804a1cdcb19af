"""Both ends of a locus by linear programs, against the closed form: LS_B and LS_A."""

from math import isfinite

import numpy as np
import pytest

import regrasp as rg
from cones import distance_to_cones, slack
from paper import GRASP, LOAD, STATE
from regrasp.planning.surveys.locus_program import locus_program, solved_interval
from regrasp.programs import Cone, available_backends
from strategies import comfortable_pair, random_pair

pytestmark = pytest.mark.oracle

TAKES_LINEAR = sorted({"clarabel", "highs", "piqp", "cvxpy"} & set(available_backends()))
TOLERANCE = {"clarabel": 1e-7, "highs": 1e-6, "piqp": 1e-6, "cvxpy": 1e-6}


def same(found, expected, tolerance, scale):
    for a, b in zip(found, expected, strict=True):
        assert a == b if not isfinite(b) else a == pytest.approx(b, abs=tolerance * (abs(b) + scale))


@pytest.mark.parametrize("backend", TAKES_LINEAR)
def test_comfortable_loci(backend):
    rng = np.random.default_rng(3)
    for _ in range(20 if backend == "cvxpy" else 60):
        grasp, load = comfortable_pair(rng)
        locus = rg.EquilibriumLocus(grasp, load)
        try:
            found = solved_interval(locus, backend)
        except rg.SolverFailed:
            assert backend != "clarabel"  # no certificate of an infinite end
            assert not all(map(isfinite, locus.interval))
            continue
        same(found, locus.interval, TOLERANCE[backend], abs(load.vector).max())


def test_random_loci_of_every_kind():
    rng = np.random.default_rng(4)
    kinds = {"empty": 0, "bounded": 0, "unbounded": 0, "refused": 0}
    for _ in range(300):
        pair = random_pair(rng)
        locus = rg.EquilibriumLocus(pair.grasp, pair.load)
        lo, hi = locus.interval
        kind = "empty" if lo > hi else "bounded" if isfinite(lo) and isfinite(hi) else "unbounded"
        try:
            found = solved_interval(locus)
        except rg.SolverFailed:
            kind, found = "refused", (lo, hi)
        kinds[kind] += 1
        same(found, (lo, hi), 1e-6, abs(pair.load.vector).max())
    assert kinds.pop("refused") <= 6, kinds
    assert min(kinds.values()) > 20, kinds


@pytest.mark.parametrize("contact", ["P1", "P2", "P3"])
def test_the_locus_under_a_given_third_force(contact):
    """LS_A: the squeeze of the state itself lies inside."""
    state = STATE.balanced()
    locus = rg.EquilibriumLocus.given(GRASP, LOAD, contact, state.force(contact))
    lo, hi = solved_interval(locus)
    same((lo, hi), locus.interval, 1e-7, 5.0)
    assert lo <= locus.squeeze(state.without(contact)) <= hi


def test_the_program_in_numbers():
    """Two fingers face to face, weight 2 across: |f.t| = 1 each, so the squeeze is at least 1 / mu."""
    grasp = rg.Grasp([rg.Contact([-1, 0], [1, 0], 0.5), rg.Contact([1, 0], [-1, 0], 0.5)])
    locus = rg.EquilibriumLocus(grasp, rg.Wrench([0, -2]))
    program = locus_program(locus, "lo")
    assert program.q.tolist() == [1.0, 0.0, 0.0, 0.0]
    assert [block.cone for block in program.blocks] == [Cone.ZERO, Cone.NONNEGATIVE]
    at_end = np.array([2.0, 1.0, -2.0, 1.0]) / 2
    assert distance_to_cones(program, slack(program, at_end)) < 1e-15
    assert distance_to_cones(program, slack(program, 0.99 * at_end)) > 1e-3
    same(solved_interval(locus), (2.0, np.inf), 1e-8, 1.0)
    with pytest.raises(rg.InvalidInput, match="end must be one of lo, hi; got 'top'"):
        locus_program(locus, "top")

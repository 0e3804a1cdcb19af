"""Degenerate sets of contacts: a sound verdict or a plain refusal by every back end, never a wrong plan."""

from collections import Counter
from math import inf

import pytest

import oracle
import regrasp as rg
from agreement import FACETS, LEVELS
from degenerate import Degenerate, degenerate_cases
from regrasp.programs import available_backends
from regrasp.programs.backends import BACKENDS

pytestmark = pytest.mark.contract

OBJECTIVES = ("angle", "force", "effort", "peak", "friction_use")
# The share of known verdicts that a back end may refuse: zero loads and wide scales are not for all of them.
REFUSED = {"auto": 0.1, "clarabel": 0.15, "closed-form": 0.1, "daqp": 0.25, "quadprog": 0.2, "highs": 0.15}
OTHERS = 0.4
# Searches for levels ask a back end a dozen times for each case: others than ours on every fourth.
# They take their time before they give a badly scaled linear program up; cvxpy writes each program anew.
SLOW = {"cvxpy": ("effort", "peak"), "proxqp": ("effort",), "scs": ("effort",), "osqp": ("effort", "peak")}


def exactly_held(case: Degenerate, state: rg.GraspState) -> bool:
    grasp = case.grasp
    limits = [contact.max_force for contact in grasp]
    return all(
        oracle.is_held(grasp.positions, grasp.normals, grasp.frictions, limits, case.load, state.forces)
    )


def outcome(case: Degenerate, objective: str, method: str, facets: int | None) -> str:
    """``held``, ``lost`` with a proof, or ``refused``."""
    try:
        state = rg.choose_state(case.grasp, case.wrench, objective, method=method, facets=facets)
    except rg.Infeasible as reason:
        if reason.certificate is None:
            return "refused"
        return "lost" if reason.certificate.is_proof else "unproven"
    except (rg.SolverFailed, rg.InvalidInput):
        return "refused"
    assert state.is_balanced()
    assert exactly_held(case, state)
    return "held"


def test_the_cases_are_what_they_are_called():
    """Two contacts without limits are decided exactly."""
    cases = degenerate_cases()
    assert len({case.name for case in cases}) == len(cases)
    decided = 0
    for case in cases:
        limits = [limit for _, _, _, limit in case.contacts]
        if len(case.contacts) == 2 and limits == [None, None]:
            first, second = (contact[:3] for contact in case.contacts)
            exact = oracle.locus(*first, *second, case.load[:2], case.load[2])
            assert case.held in (None, not exact.empty), case.name
            decided += 1
    assert decided > 10


@pytest.mark.parametrize("backend", ["auto", "closed-form", *available_backends()])
def test_no_back_end_leads_to_a_wrong_verdict(backend):
    facets = None if backend in ("auto", "closed-form") or BACKENDS[backend].second_order else FACETS
    counted, searched = Counter(), backend in ("auto", "closed-form", "clarabel")
    for k, case in enumerate(degenerate_cases()):
        if backend == "closed-form" and len(case.contacts) > 2:
            continue
        objectives = SLOW.get(backend, OBJECTIVES)
        if not searched and k % 4 > 0:
            objectives = [objective for objective in objectives if objective not in LEVELS]
        for objective in objectives:
            verdict = outcome(case, objective, backend, facets)
            assert verdict != "unproven"
            if case.held is not None:
                assert verdict != ("lost" if case.held else "held"), (case.name, objective)
                counted[verdict] += 1
    assert counted["held"] > 0
    assert counted["lost"] > 0
    assert counted["refused"] <= REFUSED.get(backend, OTHERS) * counted.total()


def test_without_a_load_the_least_of_everything_is_nothing_and_margins_need_a_limit():
    case = next(case for case in degenerate_cases() if case.name == "no load, no limits")
    assert not rg.choose_state(case.grasp, case.wrench, "effort", method="clarabel").forces.any()
    with pytest.raises(rg.InvalidInput, match="needs max_force"):
        rg.choose_state(case.grasp, case.wrench, "angle", method="clarabel")
    state = rg.choose_state(case.grasp, case.wrench, "force", method="clarabel", max_force=2.0)
    assert state.margins.least_force > 0.8
    assert state.magnitudes.max() <= 2.0 < inf


def test_a_frictionless_finger_does_not_pull():
    """Along its normal nothing is tangential; the sign of the force decides."""
    case = next(case for case in degenerate_cases() if case.name == "three smooth ones across a line")
    pulled = rg.GraspState(case.grasp, case.wrench, [[0.0, 0.25], [0.0, -0.5], [0.0, -0.25]])
    assert pulled.residual == 0
    assert not pulled.is_balanced()
    balanced = pulled.balanced()
    assert balanced.is_balanced()
    assert exactly_held(case, balanced)

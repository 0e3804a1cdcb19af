"""What solvers are known to be wrong about does not come through as a plan or a verdict."""

import json
from math import isfinite

import pytest

import oracle
import regrasp as rg
from degenerate import degenerate_cases
from misjudgements import FACETS, OBJECTIVES, SETTINGS, has_answer, program_of
from places import ROOT
from regrasp.programs import Status, available_backends, solve
from regrasp.programs.backends import BACKENDS

pytestmark = pytest.mark.contract

KNOWN = json.loads((ROOT / "benchmarks" / "results" / "misjudgements.json").read_text(encoding="utf-8"))
CASES = {case.name: case for case in degenerate_cases()}
RECORDS = KNOWN["misjudgements"]
SOLVERS = sorted({record["solver"] for record in RECORDS if record["solver"] in available_backends()})


def recorded(solver):
    """Every program that the solver was wrong about, at whatever settings."""
    return sorted({(r["case"], r["objective"]) for r in RECORDS if r["solver"] == solver})


def test_the_records_are_complete():
    assert KNOWN["tolerance"] == 1e-5
    assert len(RECORDS) > 20
    for record in RECORDS:
        assert list(record) == [
            "solver", "version", "settings", "case", "objective", "said", "has_answer", "residual",
        ]  # fmt: skip
        assert record["solver"].partition(":")[0] in BACKENDS
        assert record["settings"] in SETTINGS
        assert record["objective"] in OBJECTIVES
        assert record["has_answer"] is has_answer(CASES[record["case"]])
        assert record["residual"] is None or isfinite(record["residual"])
        if record["said"] in ("infeasible", "PrimalInfeasible"):
            assert record["has_answer"]
        else:
            assert record["said"] in ("found", "Solved", "optimal")
            assert record["has_answer"] is False or not (record["residual"] or 1) < KNOWN["tolerance"] / 2


def missed(answer):
    """By how much an answer breaks a row, relative to the largest number in any: equations come first."""
    program = answer.program
    equations = program.blocks[0].rows
    slack = program.b - program.A @ answer.value
    worst = max(abs(slack[:equations]).max(), -slack[equations:].min())
    return worst / max(abs(program.b).max(), abs(program.A @ answer.value).max())


@pytest.mark.parametrize("solver", SOLVERS)
def test_the_audit_lets_none_through(solver):
    for name, objective in recorded(solver):
        case = CASES[name]
        answer = solve(program_of(case, objective), solver, throw=False)
        if answer.status is Status.SOLVED:
            assert missed(answer) <= BACKENDS[solver].tolerance, name
            # What lies outside by less than the tolerance is decided by ``choose_state``, as below.
            assert has_answer(case) is not False or name.endswith("a 1e-6 outside"), name
        if answer.status is Status.INFEASIBLE and has_answer(case):
            # A certificate only says how far away an answer is; this one is that far, in units of the load.
            unit = max(abs(case.wrench.vector))
            least = rg.choose_state(case.grasp, case.wrench, objective, method="closed-form")
            assert least.magnitudes.max() > 1e5 * unit, name


@pytest.mark.parametrize("solver", SOLVERS)
def test_no_plan_and_no_verdict_comes_of_them(solver):
    facets = None if BACKENDS[solver].second_order else FACETS
    for name, objective in recorded(solver):
        case = CASES[name]
        try:
            state = rg.choose_state(case.grasp, case.wrench, objective, method=solver, facets=facets)
        except rg.Infeasible as reason:
            assert case.held is not True or reason.certificate is None, name  # noqa: PT017
            continue
        except rg.SolverFailed:
            continue
        assert case.held is not False, name
        grasp = state.grasp
        limits = [contact.max_force for contact in grasp]
        assert all(
            oracle.is_held(grasp.positions, grasp.normals, grasp.frictions, limits, case.load, state.forces)
        ), name

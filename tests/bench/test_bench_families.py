"""The families are the same at every call, and what they say is known is true."""

import re
from functools import cache

import numpy as np
import pytest

from oracle import locus
from regrasp.bench.families import FAMILIES
from regrasp.bench.problems.problem import Truth, Verdict
from regrasp.programs import Status, solve

pytestmark = pytest.mark.oracle

MOST = 3000  # unknowns; the largest paths are left to the benchmark itself


@cache
def problems(family):
    return [p for p in FAMILIES[family].problems() if p.program.q.size <= MOST]


@pytest.mark.parametrize("family", FAMILIES.values(), ids=lambda family: family.name)
def test_problems_are_reproducible_and_named_once(family):
    first, again = problems(family.name), family.problems()
    for one, other in zip(first, (p for p in again if p.program.q.size <= MOST), strict=True):
        assert one.name == other.name
        assert one.known == other.known
        for a, b in ((one.program.P, other.program.P), (one.program.A, other.program.A)):
            assert (a.data == b.data).all()
            assert (a.indices == b.indices).all()
        assert (one.program.b == other.program.b).all()
    assert all(p.family == family.name and p.name.startswith(f"{family.name}/") for p in first)
    assert len({p.name for p in first}) == len(first)
    assert family.origin
    assert family.formula


@pytest.mark.parametrize("name", FAMILIES)
def test_known_answers_agree_with_a_solver(name):
    for problem in problems(name):
        if "1000m" in problem.name:
            continue  # in kilometres and micronewtons the reference solver is unsound, and our audit says so
        answer = solve(problem.program, "clarabel", throw=False)
        known = problem.known
        if known.verdict is Verdict.SOLVABLE:
            assert answer.status is Status.SOLVED, problem.name
            assert known.distance(answer.objective) < 1e-6, problem.name
        elif known.verdict is Verdict.INFEASIBLE:
            assert answer.status is Status.INFEASIBLE, problem.name


def test_scaled_problems_are_the_same_in_other_units():
    by_grasp = {}
    for problem in problems("scaled"):
        number = problem.name.split("/")[2].split("-")[0]
        newton = float(re.search(r"m-(.*)N$", problem.name).group(1))
        by_grasp.setdefault(number, []).append(problem.known.optimum / newton**2)
    for values in by_grasp.values():
        assert values == pytest.approx([values[0]] * len(values), rel=1e-9)


def test_nearly_infeasible_verdicts_are_those_of_exact_arithmetic():
    from regrasp.bench.families.hard import _edge_grasp

    for room in (1e-1, 1e-3, 1e-6):
        for sign, verdict in ((1, Verdict.SOLVABLE), (-1, Verdict.INFEASIBLE)):
            one, two = _edge_grasp(sign * room)
            exact = locus(
                one.position,
                one.normal,
                one.friction,
                two.position,
                two.normal,
                two.friction,
                [0.0, 1.0],
                0.0,
            )
            kind = "held" if sign > 0 else "lost"
            problem = next(p for p in problems("nearly-infeasible") if p.name.endswith(f"{kind}/{room:.0e}"))
            assert problem.known.verdict is verdict
            assert exact.empty == (sign < 0)


def test_truth_is_known_for_every_problem_but_says_from_where():
    every = [p for name in FAMILIES for p in problems(name)]
    truths = {p.known.truth for p in every}
    assert {Truth.CLOSED_FORM, Truth.PUBLISHED, Truth.PROOF, Truth.REFERENCE} == truths
    assert all(np.isfinite(p.known.accuracy) for p in every)


def test_warm_problems_follow_one_another_with_another_right_side_only():
    for problem in problems("warm"):
        if problem.follows is None:
            before = problem
            continue
        assert problem.follows == before.name
        assert (problem.program.A != before.program.A).nnz == 0
        assert (problem.program.b != before.program.b).any()
        before = problem

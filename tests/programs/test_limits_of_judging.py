"""What is believed, at its limits, on both sides: quick audits, verdicts, far rows, rooms."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import sparse

from programs_by_hand import claim, nobody, nonnegative, program, zero
from regrasp.programs import Block, Cone, Program, Status, solve
from regrasp.programs import backends as table
from regrasp.programs.backends import least_room, solved_at_once, solved_quickly
from regrasp.programs.judging.audit import audited, missed
from regrasp.programs.judging.elastic import elastic, proven_anyway
from regrasp.programs.judging.loose_rows import with_loose_rows, without_loose_rows
from regrasp.programs.judging.proofs import infeasibility_residual
from regrasp.programs.judging.quick import surely_sound
from regrasp.programs.judging.verdict import MISSED, PROVEN, judged
from regrasp.programs.solution import Solution

pytestmark = pytest.mark.contract

BOTH = pytest.mark.parametrize(("share", "inside"), [(0.999, True), (1.001, False)])


# -- quick audits: min x^2 / 2 - x with r x <= r b, unknowns of size 1: floors r, 4 = 2 (|q| + P), 4 and 2


def one(b=0.0, r=1.0, n=1):
    return program(np.eye(n), -np.ones(n), r * np.eye(n), np.full(n, r * b), nonnegative(n), size=1.0)


@BOTH
@pytest.mark.parametrize("r", [1.0, 2.0**10, 2.0**-10])
def test_how_far_outside_is_close(share, inside, r) -> None:
    out = share * 1e-6
    audit = surely_sound(one(1.0, r), np.array([1 + out]), np.zeros(1), 1e-6, 1e-3)
    assert (audit is not None) is inside
    if audit is not None:
        assert audit == pytest.approx(
            (out, out / 4, 0, out / 2, -0.5, out * r, 0, out, out), rel=1e-5, abs=1e-20
        )


@BOTH
def test_gaps_of_what_stopped_are_the_back_end_s_and_rows_and_duals_are_proofs(share, inside) -> None:
    """x = -e with z = 1 + e leaves a gap alone; then a row or the duals are off; polished, if not taken."""

    def scaled(x: float, z: float, limit: float) -> Solution:
        stopped = claim(one(), Status.STOPPED, np.array([x]), np.array([1 + z]))
        by = share * limit / stopped.residual
        return claim(one(), Status.STOPPED, np.array([x * by]), np.array([1 + z * by]))

    for x, z, limit in (-1e-6, 1e-6, 1e-6), (1e-8, -1e-8, PROVEN), (0.0, 1e-8, PROVEN):
        stopped = scaled(x, z, limit)
        found = judged(stopped, 1e-6, nobody)
        assert found.status is Status.SOLVED
        assert (found.said == stopped.said) is inside


@BOTH
@pytest.mark.parametrize("r", [1.0, 2.0**10, 2.0**-10])
def test_how_bent_is_sound(share, inside, r) -> None:
    for more in (share * 4e-6, -share * 4e-6):
        audit = surely_sound(one(0.0, r), np.zeros(1), np.array([(1 + more) / r]), 1e-9, 1e-6)
        assert (audit is not None) is inside
        if audit is not None:
            assert audit.dual == pytest.approx(share * 1e-6)
            assert audit.stationarity == pytest.approx(share * 4e-6)


@BOTH
@pytest.mark.parametrize("r", [1.0, 2.0**10, 2.0**-10])
def test_how_much_of_products_and_gap_is_sound(share, inside, r) -> None:
    """x = -e with z = 1 + e: nothing is bent, and e (1 + e) is the gap and the sum of products."""
    for n, unit in ((1, 2), (3, 4)):  # the gap's unit is 2 n, that of products 4
        e = share * unit * 1e-6
        x, z = np.zeros(n), np.ones(n)
        x[0], z[0] = -e, 1 + e
        audit = surely_sound(one(0.0, r, n), x, z / r, 1e-9, 1e-6)
        assert (audit is not None) is inside
        if audit is not None:
            assert audit.complementarity == pytest.approx(e * (1 + e) / 4)
            assert audit.complementarity >= audited(one(0.0, r, n), x, z / r).complementarity
            assert audit.gap == pytest.approx(e * (1 + e) / (2 * n))
            assert audit.absolute_gap == pytest.approx(e * (1 + e))
            assert audit.objective == pytest.approx(e * e / 2 + e)


def test_what_is_outside_counts_three_times_with_all_duals() -> None:
    e = 1e-8
    audit = surely_sound(one(0.0, 1.0, 3), np.array([e, 0, 0]), np.array([1 - e, 1, 1]), 1e-7, 1e-6)
    assert audit.complementarity == pytest.approx((e * (1 - e) + 3 * e * (3 - e)) / 4, rel=1e-9)
    assert audit.primal == audit.slack_violation == e


@BOTH
def test_a_gap_counts_below_zero_and_duals_of_equations_do(share, inside) -> None:
    """x = 1 - e without a dual: the gap is -e (1 - e), of 2. And x = e of x = 0, where z = -1 - e."""
    e = share * 2e-6
    assert (surely_sound(one(1.0), np.array([1 - e]), np.zeros(1), 1e-9, 1e-6) is not None) is inside
    p = program([[1.0]], [1.0], [[1.0]], [0.0], zero(1), size=1.0)
    audit = surely_sound(p, np.array([e]), np.array([-1 - e]), 1e-5, 1e-5)
    assert audit.complementarity == pytest.approx((1 + 3) * e * (1 + e) / 4)


def test_what_is_as_much_as_it_may_be_is_sound() -> None:
    """In numbers that doubles hold: of the row, of the column, of the gap, of products."""
    e = 2.0**-10
    assert surely_sound(one(1.0), np.array([1 + e]), np.zeros(1), e, 1.0) is not None
    assert surely_sound(one(), np.zeros(1), np.array([1 + 4 * e]), 0.0, e) is not None
    assert surely_sound(one(), -np.full(1, e), np.array([1 + e]), 0.0, e * (1 + e) / 2) is not None
    x, z = np.array([-e, 0, 0]), np.array([1 + e, 1, 1])
    assert surely_sound(one(0.0, 1.0, 3), x, z, 0.0, e * (1 + e) / 4) is not None


def test_quick_audits_need_units_and_duals_of_the_cone() -> None:
    sound = np.zeros(1), np.ones(1)
    assert surely_sound(one(), *sound, 1e-9, 1e-6) is not None
    assert surely_sound(one(1.0), np.ones(1), np.array([-1e-12]), 1e-9, 1e-6) is None
    nothing = program([[0.0]], [0.0], [[1.0]], [1.0], nonnegative(1), size=1.0)
    assert surely_sound(nothing, np.zeros(1), np.zeros(1), 1e-9, 1e-6) is None
    free = program([[1.0]], [-1.0], np.zeros((0, 1)), [], size=1.0)
    assert surely_sound(free, np.ones(1), np.zeros(0), 1e-9, 1e-6)[:4] == (0, 0, 0, 0)


def test_a_kept_solver_is_believed_as_far_as_it_is_sound(monkeypatch) -> None:
    p = one(0.5)
    right = solved_quickly(p)
    assert (right.status, right.build_time, right.solve_time) == (Status.SOLVED, 0, 0)
    for off, sound in ((4e-10, True), (6e-10, False)):  # of a row, of unit 1
        monkeypatch.setattr(
            table, "answered_quickly", lambda _, off=off: (np.array([0.5 + off]), np.full(1, 0.5))
        )
        assert (solved_quickly(p) is not None) is sound
    for off, sound in ((0.9e-8, True), (1.1e-8, False)):  # of the gap, of unit 2
        monkeypatch.setattr(
            table, "answered_quickly", lambda _, off=off: (np.full(1, 0.5), np.array([0.5 + 4 * off]))
        )
        assert (solved_quickly(p) is not None) is sound
    monkeypatch.setattr(table, "answered_quickly", lambda _: None)
    assert solved_quickly(p) is None


def test_who_only_asks_whether_is_told_what_is_sound_as_it_is(monkeypatch) -> None:
    p = program([[1.0]], [-1.0], [[1.0]], [0.5], nonnegative(1))
    assert solved_at_once(p, "auto").value == pytest.approx([0.5])
    none = program([[0.0]], [0.0], [[1.0], [-1.0]], [1, -2], nonnegative(2))
    falls = program([[0.0]], [-1.0], [[-1.0]], [0], nonnegative(1))
    assert solved_at_once(none, "auto") is None
    assert solved_at_once(falls, "clarabel") is None
    for status in (Status.STOPPED, Status.SOLVED, Status.FAILED, Status.NOT_FOUND):
        for off, sound in ((0.0, status in (Status.STOPPED, Status.SOLVED)), (1e-3, False)):
            given = claim(p, status, [0.5 + off], [0.5])
            monkeypatch.setattr(table, "asked", lambda *_, given=given: given)
            answer = solved_at_once(p, "clarabel")
            assert (answer is not None) is sound
            assert answer is None or answer.status is Status.SOLVED


# -- verdicts ------------------------------------------------------------------------------------------------


def test_what_is_sound_is_handed_on_and_what_stopped_is_solved() -> None:
    p = program([[1.0]], [-1.0], [[1.0]], [0.5], nonnegative(1))
    right = claim(p, Status.SOLVED, [0.5], [0.5])
    assert judged(right, 1e-7, nobody) is right
    stopped = judged(replace(right, status=Status.STOPPED), 1e-7, nobody)
    assert (stopped.status, stopped.said) == (Status.SOLVED, "so they say")
    for status in (Status.NOT_FOUND, Status.FAILED, Status.UNSOUND):
        given = replace(right, status=status)
        assert judged(given, 1e-7, nobody) is given


@pytest.mark.parametrize("status", [Status.SOLVED, Status.STOPPED])
def test_what_is_nearly_right_is_polished_and_says_so(status) -> None:
    p = program([[1.0]], [-1.0], [[1.0]], [0.5], nonnegative(1))
    better = judged(claim(p, status, [0.5 + 1e-5], [0.5]), 1e-9, nobody)
    assert (better.status, better.said) == (Status.SOLVED, "so they say, polished")
    np.testing.assert_allclose([*better.value, *better.duals], 0.5, rtol=1e-12)


def test_what_is_far_off_keeps_its_word_or_is_unsound() -> None:
    p = program([[1.0]], [-1.0], [[1.0]], [0.5], nonnegative(1))
    stopped = claim(p, Status.STOPPED, [0.3], [0.5])
    assert judged(stopped, 1e-9, nobody) is stopped
    wrong = judged(replace(stopped, status=Status.SOLVED), 1e-9, nobody)
    assert wrong.status is Status.UNSOUND
    assert wrong.said.startswith("so they say, but residual ")
    assert wrong.said.endswith(" of 1e-09 allowed")


@pytest.mark.parametrize("status", [Status.SOLVED, Status.STOPPED])
def test_numbers_on_their_way_to_a_proof_are_one(status) -> None:
    none = program([[0.0]], [0.0], [[1.0], [-1.0]], [1, -2], nonnegative(2))
    found = judged(claim(none, status, [1.5], [1e9, 1e9 * (1 + 1e-3)]), 1e-7, nobody)
    assert found.status is Status.INFEASIBLE
    assert found.value.shape == none.q.shape
    assert np.isnan(found.value).all()
    assert found.infeasibility_residual <= PROVEN
    falls = program(np.zeros((2, 2)), [-1, 0], [[-1, 1], [-1, 0]], [0, 0], nonnegative(2))
    found = judged(claim(falls, status, [1e9, 1e9 * (1 + 1e-3)], [1, 1]), 1e-7, nobody)
    assert found.status is Status.UNBOUNDED
    assert found.duals.shape == falls.b.shape
    assert np.isnan(found.duals).all()
    assert found.unboundedness_residual <= PROVEN


def test_a_point_of_zeros_needs_no_other_and_others_are_looked_for() -> None:
    falls = program(np.zeros((2, 2)), [0, -1], [[-1, 0]], [0], nonnegative(1))
    given = claim(falls, Status.UNBOUNDED, [0, 1])
    assert judged(given, 1e-7, nobody) is given
    fixed = program(np.zeros((2, 2)), [0, -1], [[1, 0]], [1], zero(1))
    given = claim(fixed, Status.UNBOUNDED, [0, 1])
    none = judged(given, 1e-7, lambda p: claim(p, Status.INFEASIBLE, None, [3.0]))
    assert none.status is Status.INFEASIBLE
    assert none.said == "so they say, but no point satisfies the constraints"
    assert np.isnan(none.value).all()
    assert none.duals.tolist() == [3.0]
    for share, near in ((0.99, True), (1.01, False)):  # of a unit |b| + |a| X = 2
        point = np.array([1 + share * 2 * MISSED, 0])
        assert missed(fixed, point) == pytest.approx(share * MISSED)
        found = judged(given, 1e-7, lambda p, x=point: claim(p, Status.SOLVED, x, [0]))
        assert found.status is (Status.UNBOUNDED if near else Status.UNBOUNDED_OR_INFEASIBLE)


def test_claims_that_prove_nothing_are_unsound() -> None:
    p = program([[1.0]], [-1.0], [[1.0]], [0.5], nonnegative(1))
    for given in (claim(p, Status.INFEASIBLE, None, [1.0]), claim(p, Status.INFEASIBLE),
                  claim(p, Status.UNBOUNDED, [1.0]), claim(p, Status.UNBOUNDED)):  # fmt: skip
        wrong = judged(given, 1e-7, nobody)
        assert wrong.status is Status.UNSOUND
        assert wrong.said.endswith(" of 1e-08 allowed")


def test_a_certificate_that_is_one_is_left_as_it_is() -> None:
    """With a dual that is outside its cone by what the objective does not feel, too."""
    p = program([[0.0]], [0.0], [[1], [-1]], [1, -2], nonnegative(2))
    given = claim(p, Status.INFEASIBLE, None, [1.0, 1.0])
    assert judged(given, 1e-7, nobody) is given


def test_what_only_looks_like_a_proof_ends_no_search() -> None:
    """-x + y <= -1 and x <= 0.95 y meet at (-19, -20), so that (1, 1) is off by 0.05 of 1.95 only."""
    p = program(np.zeros((2, 2)), [0, -0.05], [[-1, 1], [1, -0.95]], [-1, 0], nonnegative(2))
    near = claim(p, Status.STOPPED, np.array([-19.0, -20.0]) * (1 + 1e-4), [1, 1])
    found = judged(near, 1e-9, lambda p: claim(p, Status.STOPPED))
    assert found.status is Status.SOLVED
    assert found.value == pytest.approx([-19, -20])


def test_noise_hides_no_proof() -> None:
    """x <= 1 and x >= 2 by (1, 1); a third row's dual, a thousandth of them, leaves as much as they prove."""
    p = program([[0.0]], [0.0], [[1], [-1], [1e3]], [1, -2, 1e4], nonnegative(3))
    stopped = claim(p, Status.STOPPED, [1.5], [1, 1, 5e-5])
    assert 0.1 < infeasibility_residual(p, stopped.duals) < 1
    found = judged(stopped, 1e-9, nobody)
    assert found.status is Status.INFEASIBLE


@pytest.mark.parametrize(("far", "answered"), [(9e9, False), (9.9999999e9, True)])
def test_a_solution_beside_its_far_rows_is_none(monkeypatch, far, answered) -> None:
    """x <= far is left out, and the rest has its least at 1e10."""
    p = program([[1.0]], [-1e10], [[1], [-1]], [far, 1], nonnegative(2))
    whole = table._solved

    def solved(given, backend, *rest):
        if backend == "auto":
            return whole(given, backend, *rest)
        return claim(given, Status.FAILED) if given.b.size == 2 else claim(given, Status.SOLVED, [1e10], [0])

    monkeypatch.setattr(table, "_solved", solved)
    assert solve(p, throw=False).status is (Status.SOLVED if answered else Status.FAILED)


@pytest.mark.parametrize("status", [Status.UNBOUNDED, Status.UNBOUNDED_OR_INFEASIBLE])
def test_the_residual_of_a_direction_is_what_decides(status) -> None:
    p = program(np.zeros((2, 2)), [0, -1], [[-1, 0]], [1], nonnegative(1))
    assert claim(p, status, [-1e-5, 1]).residual == pytest.approx(1.0)
    assert claim(p, status, [0, 1]).residual == 0
    assert claim(p, Status.STOPPED, [0, 1]).residual == np.inf


# -- rows left out, room --------------------------------------------------------------------------


@BOTH
def test_how_far_a_row_without_entries_is(share, inside) -> None:
    p = program([[1.0]], [1.0], [[0], [2], [-1]], [1e4 / share, 2, 1], nonnegative(3))
    assert (without_loose_rows(p) is None) is not inside
    if inside:
        rest, kept = without_loose_rows(p)
        assert kept.tolist() == [False, True, True]
        whole = with_loose_rows(claim(rest, Status.SOLVED, [-1], [0, 2]), p, kept)
        assert whole.program is p
        assert whole.duals.tolist() == [0, 0, 2]
        assert whole.said == "so they say, without loose rows"


def test_the_loosest_of_several_gaps_is_left_out() -> None:
    p = program([[1.0]], [1.0], [[1]] * 4, [1, 1e5, 1e10, 2e10], nonnegative(4))
    assert without_loose_rows(p)[1].tolist() == [True, True, False, False]


def test_the_program_of_the_least_room() -> None:
    """Largest entries of inequalities and of cones; equations have none, and t is at least -1."""
    rows = [[3, 4], [2, -5], [1, 0], [0, 7], [2, 2]]
    cone = Block(Cone.SECOND_ORDER, 3)
    p = program(np.eye(2), [1, 2], rows, [1, 2, 3, 4, 5], zero(1), nonnegative(1), cone, size=2.0)
    wide = elastic(p)
    assert wide.A.toarray()[:, 2].tolist() == [0, -5, -7, 0, 0, -1]
    assert wide.A.toarray()[:5, :2].tolist() == rows
    assert wide.b.tolist() == [1, 2, 3, 4, 5, 1]
    assert (wide.q.tolist(), wide.P.shape, wide.P.nnz, wide.size) == ([0, 0, 1], (3, 3), 0, 2.0)
    assert wide.blocks == (*p.blocks, nonnegative(1))
    none = Program(
        sparse.csc_matrix((0, 0)), np.zeros(0), sparse.csc_matrix((1, 0)), -np.ones(1), p.blocks[1:2]
    )
    assert elastic(none).A.toarray().tolist() == [[0], [-1]]


def test_room_is_told_by_whom_one_asks_and_only_by_answers(monkeypatch) -> None:
    wide = program([[0.0]], [0.0], [[1], [-1]], [5, 5], nonnegative(2))
    assert least_room(wide, "auto") == pytest.approx(-1, abs=1e-7)
    tight = program([[0.0]], [0.0], [[1], [-1]], [1, -2], nonnegative(2))
    assert least_room(tight, "daqp") == pytest.approx(0.5, abs=1e-7)
    stopped = claim(elastic(tight), Status.STOPPED, [0, 0.5])
    monkeypatch.setattr(table, "asked", lambda *_: stopped)
    assert np.isnan(least_room(tight, "clarabel"))


def test_a_proof_by_room_for_all_says_so() -> None:
    tight = program([[0.0]], [0.0], [[1], [-1]], [1, -2], nonnegative(2))
    stopped = claim(tight, Status.STOPPED)
    found = proven_anyway(stopped, lambda p: solve(p, throw=False), PROVEN)
    assert found.said == "so they say, but infeasible with room for all"
    assert np.isnan(found.value).all()
    assert found.duals.size == 2
    for x, z in (([0, -0.5], [1, 1, 0]), ([0, 0.5], [1, 1, np.nan]), ([0, 0.5], [1, 0, 0])):
        assert proven_anyway(stopped, lambda p, x=x, z=z: claim(p, Status.SOLVED, x, z), PROVEN) is None

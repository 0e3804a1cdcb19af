"""Small things of programs that other tests pass by: shapes, times, options, what is left of a guess."""

import pickle
from multiprocessing import Pipe

import numpy as np
import pytest
from scipy import sparse

from known_programs import known
from programs_by_hand import nonnegative, program, zero
from regrasp.errors import InvalidInput
from regrasp.programs import (
    Block,
    Cone,
    Pattern,
    Program,
    Rows,
    Solution,
    Status,
    available_backends,
    child_side,
    solve,
)
from regrasp.programs import backends as table
from regrasp.programs.facts import BACKENDS, is_available
from regrasp.programs.judging.audit import audited, missed
from regrasp.programs.judging.cleaning import cleaned_direction, cleaned_duals
from regrasp.programs.judging.convexity import why_not_convex
from regrasp.programs.judging.loose_rows import without_loose_rows
from regrasp.programs.judging.polish import polished
from regrasp.programs.judging.proofs import infeasibility_residual, unboundedness_residual
from test_judged_by_their_own_units import QP

pytestmark = pytest.mark.contract


def test_rows_are_one_cone_and_no_rows_are_none() -> None:
    rows = Rows(2)
    rows.second_order(np.ones((3, 2)))
    rows.equal(sparse.csr_matrix((0, 2)))
    rows.at_least_zero(sparse.csr_matrix((0, 2)), np.zeros(0))
    assert rows.program([0, 0]).blocks == (Block(Cone.SECOND_ORDER, 3, 1),)


def test_a_matrix_of_another_shape_is_refused() -> None:
    for P, A in (((3, 3), (1, 2)), ((2, 3), (1, 2)), ((2, 2), (1, 3)), ((2, 2), (2, 2))):
        with pytest.raises(InvalidInput):
            Program(
                sparse.csc_matrix(P),
                np.zeros(2),
                sparse.csc_matrix(A),
                np.zeros(1),
                (Block(Cone.ZERO, 1, 1),),
            )


def test_what_is_available_is_installed() -> None:
    assert not is_available("nobody")
    assert not is_available("nobody:CLARABEL")
    assert all(is_available(name) for name in available_backends())


BOX = program(np.eye(2), [-3.0, -1.0], [[1, 0], [0, 1], [1, 1]], [1, 2, 1.5], nonnegative(3))


@pytest.mark.parametrize("backend", QP)
def test_every_back_end_tells_its_times(backend) -> None:
    answer = solve(BOX, backend)
    assert answer.status is Status.SOLVED
    assert 0 < answer.build_time < 60
    assert 0 < answer.solve_time < 60


@pytest.mark.skipif("piqp" not in available_backends(), reason="needs piqp")
def test_piqp_needs_no_polish() -> None:
    answer = solve(BOX, "piqp")
    assert "polished" not in answer.said
    assert max(answer.audit[:4]) < 1e-9


@pytest.mark.skipif("cvxpy" not in available_backends(), reason="needs cvxpy")
def test_the_solver_named_is_the_one_that_is_asked() -> None:
    """The option is SCS's, and Clarabel has none of its name."""
    answer = solve(BOX, "cvxpy:SCS", max_iters=10_000, eps_abs=1e-9, eps_rel=1e-9)
    assert answer.status is Status.SOLVED
    assert answer.iterations > 0
    assert solve(BOX, "cvxpy:CLARABEL", max_iters=10_000, throw=False).status is not Status.SOLVED


def test_where_all_are_in_one_unit_far_terms_lose_nothing() -> None:
    """A row and a column that rounding alone is left of, beside a unit that is given."""
    far = 1e17
    p = program(np.zeros((2, 2)), [0, 0], [[1, -1]], [1], zero(1), size=1.0)
    assert audited(p, np.array([far, far]), np.zeros(1)).primal < 1e-15


@pytest.mark.parametrize(("far", "loose"), [(0.9999e4, False), (1.0001e4, True)])
def test_how_far_is_far(far, loose) -> None:
    p = program(np.eye(1), [1], [[1], [-1], [2]], [far, 1, 2], nonnegative(3))
    assert (without_loose_rows(p) is not None) is loose


def test_a_far_bound_that_an_answer_would_break_is_kept() -> None:
    """Without x <= 1e9 the least of (x - 1e10)^2 is 1e10: no answer to the whole."""
    p = program([[1.0]], [-1e10], [[1], [-1]], [1e9, 1], nonnegative(2))
    assert solve(p).value == pytest.approx([1e9], rel=1e-6)


@pytest.mark.parametrize("count", [401, 450])
def test_a_large_matrix_that_is_not_definite_is_found(count) -> None:
    """Too many unknowns for a dense factor, and a negative eigenvalue that neither rows nor pairs tell."""
    three = np.array([[1.0, -0.6, -0.6], [-0.6, 1, -0.6], [-0.6, -0.6, 1]])
    rest = sparse.identity(count - 3)
    assert "negative eigenvalue" in why_not_convex(sparse.csc_matrix(sparse.block_diag([rest, three])))
    assert "negative eigenvalue" in why_not_convex(sparse.csc_matrix(sparse.block_diag([three, rest])))
    good = np.array([[1.0, 0.6, 0.6], [0.6, 1, 0.6], [0.6, 0.6, 1]])
    assert why_not_convex(sparse.csc_matrix(sparse.block_diag([rest, good]))) == ""
    rng = np.random.default_rng(count)
    root = sparse.random(count, count, 0.01, random_state=rng) + sparse.identity(count)
    assert why_not_convex(sparse.csc_matrix(root @ root.T)) == ""


def test_a_measure_of_one_unit_is_that_of_the_largest_column() -> None:
    """z = (1, 1) misses the second column by e; alone it has terms 1e-3, beside the first 2."""
    e = 1e-6
    rows, b = [[1.0, 1e-3], [-1.0, -1e-3 + e]], [-1.0, 0.0]
    for size, miss in ((0.0, e / (2e-3 - e)), (1.0, e / 2)):
        p = program(np.zeros((2, 2)), [0, 0], rows, b, nonnegative(2), size=size)
        assert infeasibility_residual(p, np.ones(2)) == pytest.approx(miss, rel=1e-9)


def spoiled(seed, size):
    """The answer to a program of known truth, every number off by up to ``size`` of the largest."""
    case = known(4 * seed)
    answer = solve(case.program, throw=False)
    if answer.status is not Status.SOLVED:
        return None
    rng = np.random.default_rng(seed)
    x, z = answer.value, answer.duals
    return case, x * (1 + size * rng.uniform(-1, 1, x.size)), z * (1 + size * rng.uniform(-1, 1, z.size))


def test_nearly_right_answers_are_made_right() -> None:
    """How many of 39 are, by noise: a guess that is lost lessens one of the counts."""
    counts = []
    for size in (1e-9, 1e-7, 1e-5):
        cases = [case for case in (spoiled(seed, size) for seed in range(40)) if case is not None]
        better = [polished(case.program, x, z, 1e-9) for case, x, z in cases]
        for (case, _, _), found in zip(cases, better, strict=True):
            assert found is None or max(audited(case.program, *found)[:4]) <= 1e-9
        counts.append(sum(found is not None for found in better))
    assert (np.array(counts) >= [36, 35, 35]).all(), counts  # 37 with NumPy 2.4


def test_nearly_right_proofs_are_made_right() -> None:
    """Likewise of infeasible and unbounded ones."""
    counts = []
    for size in (1e-7, 1e-5, 1e-3):
        found = [0, 0]
        for seed in range(40):
            for kind, status in ((1, Status.INFEASIBLE), (2, Status.UNBOUNDED)):
                case = known(4 * seed + kind)
                answer = solve(case.program, throw=False)
                if answer.status is not status:
                    continue
                rng = np.random.default_rng(seed)
                given = answer.duals if kind == 1 else answer.value
                given = given * (1 + size * rng.uniform(-1, 1, given.size))
                if kind == 1:
                    measured = infeasibility_residual(case.program, cleaned_duals(case.program, given, 1e-9))
                else:
                    clean = cleaned_direction(case.program, given, 1e-9)
                    measured = unboundedness_residual(case.program, clean)
                found[kind - 1] += measured <= 1e-9
        counts.append(found)
    assert (np.array(counts) >= [[38, 38], [38, 38], [37, 38]]).all(), counts


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
def test_a_direction_is_measured_whatever_its_length(size) -> None:
    """-x over x >= -1 along (1, e): the row is missed by e of one unit of the direction."""
    e = 1e-6
    p = program(np.zeros((2, 2)), [-1, 0], [[-1, 0], [0, 1]], [1, 1], nonnegative(2), size=1.0)
    assert unboundedness_residual(p, size * np.array([1, e])) == pytest.approx(e, rel=1e-9)
    bent = program(np.diag([0.0, 1.0]), [-1, 0], [[-1, 0]], [1], nonnegative(1), size=1.0)
    assert unboundedness_residual(bent, size * np.array([1, e])) == pytest.approx(1.0, rel=1e-9)


def test_a_sound_answer_is_left_as_it_is() -> None:
    """x^2 / 2 for x >= 2: an objective of 2 is no miss."""
    answer = solve(program([[1]], [0], [[-1]], [-2], nonnegative(1)), "clarabel")
    assert answer.objective == pytest.approx(2)
    assert answer.residual < 1e-8
    assert "polished" not in answer.said


def test_how_far_outside_counts_sides_of_either_sign() -> None:
    """x >= 5 by 1: of a unit |b| + |a| X = 10."""
    p = program([[0.0]], [0.0], [[-1.0]], [-5.0], nonnegative(1))
    assert missed(p, np.array([4.0])) == pytest.approx(0.1)


CONES = program(np.zeros((1, 1)), [0], np.zeros((5, 1)), np.zeros(5), zero(1), nonnegative(1),
                Block(Cone.SECOND_ORDER, 3)).cones  # fmt: skip


@pytest.mark.parametrize(
    ("z", "inside"),
    [
        ([-1, 0, 0, 0, 0], True),
        ([5, -1e-12, 0, 0, 0], False),
        ([0, 1, 5, 3, 4], True),
        ([0, 1, 5, -3, -4 - 1e-9], False),
        ([0, 1, -5, 3, 4], False),
        ([0, np.nan, 5, 3, 4], False),
    ],
)
def test_what_lies_in_the_dual_cone(z, inside) -> None:
    z = np.array(z, dtype=float)
    assert CONES.has_dual(z) is inside
    np.testing.assert_array_equal(CONES.dual(z), z) if inside else None


def test_below_the_apex_the_nearest_is_the_apex() -> None:
    for v in ([0, 0], [1, 0], [0.6, -0.8]):
        assert not CONES.dual(np.array([0, 0, -1.0, *v])).any()
    np.testing.assert_allclose(CONES.dual(np.array([0, 0, -1, 2.0, 0])), [0, 0, 0.5, 0.5, 0])
    np.testing.assert_array_equal(CONES.dual(np.array([0, 0, 1.0, 0, 0])), [0, 0, 1, 0, 0])


def test_cones_of_one_row_are_half_lines() -> None:
    p = program([[0.0]], [1.0], [[-1.0], [-2.0]], [-1.0, -6.0], Block(Cone.SECOND_ORDER, 1, 2))
    assert p.cones.excess(np.array([-2.0, 3.0])).tolist() == [2, 0]
    assert p.cones.dual(np.array([-2.0, 3.0])).tolist() == [0, 3]
    assert solve(p).value == pytest.approx([3])


def test_places_are_named_once_and_shared() -> None:
    with pytest.raises(InvalidInput, match="twice"):
        Pattern((2, 2), [0, 0], [1, 1])
    pattern = Pattern((2, 3), [1, 0, 1], [2, 1, 0])
    made = pattern.filled(np.array([1.0, 2, 3]))
    assert made.toarray().tolist() == [[0, 2, 0], [3, 0, 1]]
    for shared in (made.indices, made.indptr):
        with pytest.raises(ValueError, match="read-only"):
            shared[0] = 1


def test_a_process_apart_is_ready_answers_and_ends(monkeypatch) -> None:
    ends = []
    monkeypatch.setattr(child_side.os, "_exit", ends.append)
    p = program([[1.0]], [-1.0], [[1.0]], [0.5], nonnegative(1))
    for options, expected in (({}, Solution), ({"no_such_setting": 1}, InvalidInput)):
        ours, theirs = Pipe()
        ours.send_bytes(pickle.dumps((p, "clarabel", options)))
        child_side.serve(theirs.fileno())
        assert ours.recv_bytes() == b"ready"
        assert isinstance(pickle.loads(ours.recv_bytes()), expected)
        with pytest.raises(EOFError):
            ours.recv_bytes()
        theirs._handle = None
        ours.close()
    assert ends == [0, 0]


def test_who_needs_squares_and_who_keeps_time() -> None:
    strict = {name for name, backend in BACKENDS.items() if backend.strictly_convex}
    assert strict == {"daqp", "quadprog", "proxqp", "qpalm", "osqp"}
    timed = {name: backend.time_limit for name, backend in BACKENDS.items() if backend.time_limit}
    named = dict.fromkeys(("clarabel", "daqp", "highs", "qpalm", "osqp"), "time_limit")
    assert timed == named | {"scs": "time_limit_secs"}
    assert {name for name, backend in BACKENDS.items() if backend.second_order} == {"clarabel", "cvxpy"}


def test_no_more_solvers_are_kept_than_are_asked_for() -> None:
    from regrasp.programs import clarabel_backend

    for _ in range(70):  # each a pattern of its own
        rows = Rows(1)
        rows.at_least_zero([[1.0]], -1.0)
        assert table.answered_quickly(rows.program([1.0], size=1.0)) is not None
        assert len(clarabel_backend._memory.solvers) <= 64

"""What is believed of answers: each row, column and cone by its own unit, whatever stands elsewhere."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy import sparse

from cones import distance_to_cones, slack
from loops_audit import measures
from programs_by_hand import claimed, nonnegative, program, zero
from regrasp.errors import InvalidInput
from regrasp.programs import Block, Cone, Program, Status, available_backends, solve
from regrasp.programs.facts import BACKENDS
from regrasp.programs.judging.audit import audited
from regrasp.programs.judging.terms import ROUNDING

pytestmark = pytest.mark.contract

QP = [name for name in available_backends() if name != "cvxpy"]


# -- two ways to measure -----------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(40))
def test_the_audit_measures_what_plain_loops_do(seed):
    rng = np.random.default_rng(seed)
    n, counts = int(rng.integers(1, 6)), [int(k) for k in rng.integers(0, 4, 3)]
    m = counts[0] + counts[1] + 3 * counts[2]
    scale = 10.0 ** rng.integers(-3, 4, (m, 1))
    A = rng.normal(size=(m, n)) * (rng.random((m, n)) < 0.7) * scale
    root = rng.normal(size=(n, n))
    cones = [zero(counts[0]), nonnegative(counts[1]), Block(Cone.SECOND_ORDER, 3, counts[2])]
    p = program(
        root @ root.T * (seed % 3 > 0), rng.normal(size=n) * (rng.random(n) < 0.6), A,
        rng.normal(size=m) * (rng.random(m) < 0.6), *[c for c in cones if c.count], size=float(seed % 4 == 0),
    )  # fmt: skip
    x, z = rng.normal(size=n), rng.normal(size=m)
    data = p.P.indptr, p.P.indices, p.P.data, p.q, p.A.indptr, p.A.indices, p.A.data, p.b, p.codes, p.size
    plain = audited(p, x, z)
    np.testing.assert_allclose(measures(*data, x, z), plain, rtol=1e-9, atol=1e-13)
    assert plain.slack_violation == pytest.approx(distance_to_cones(p, slack(p, x)))
    inside = p.cones.dual(z)
    assert distance_to_cones(p, inside, dual=True) == pytest.approx(0, abs=1e-14)
    gradient = p.P @ x + p.q + p.A.T @ inside
    assert plain.stationarity == pytest.approx(abs(gradient).max(initial=0.0))
    assert plain.objective == pytest.approx(0.5 * x @ p.P @ x + p.q @ x)
    assert plain.absolute_gap == pytest.approx(abs(x @ p.P @ x + p.q @ x + p.b @ inside))


def test_the_nearest_dual_by_hand():
    cones = program([[0.0]], [0.0], np.zeros((8, 1)), np.zeros(8), zero(1), nonnegative(1),
                    Block(Cone.SECOND_ORDER, 3, 2)).cones  # fmt: skip
    z = np.array([-7.0, -2.0, 1.0, 3.0, 4.0, -6.0, 3.0, 4.0])
    np.testing.assert_allclose(cones.dual(z), [-7.0, 0.0, 3.0, 1.8, 2.4, 0.0, 0.0, 0.0])
    np.testing.assert_array_equal(cones.excess(np.array([-7.0, 2.0, 1.0, 3.0, 4.0, 6.0, 3.0, 4.0])),
                                  [7.0, 0.0, 4.0, 0.0, 0.0, 0.0, 0.0, 0.0])  # fmt: skip


@given(st.integers(0, 10_000), st.floats(-6, 6), st.floats(-6, 6), st.floats(-6, 6))
@settings(max_examples=40, deadline=None)
def test_units_of_rows_unknowns_and_objective_change_no_measure(seed, rows, unknowns, objective):
    rng = np.random.default_rng(seed)
    n, m = 4, 6
    r = np.repeat(10.0 ** (rows * rng.uniform(-1, 1, 4)), [1, 1, 1, 3])
    c, k = 10.0 ** (unknowns * rng.uniform(-1, 1, n)), 10.0**objective
    root, A = rng.normal(size=(n, n)), rng.normal(size=(m, n))
    entries = abs(A) * c
    largest = np.maximum.reduceat(entries.max(axis=1), [0, 1, 2, 3])
    assume(
        (entries.min(axis=1) > 2 * ROUNDING * np.repeat(largest, [1, 1, 1, 3])).all()
    )  # none was to be zero
    q, b, x, z = rng.normal(size=n), rng.normal(size=m), rng.normal(size=n), rng.normal(size=m)
    blocks = zero(1), nonnegative(2), Block(Cone.SECOND_ORDER, 3)
    one = program(root @ root.T, q, A, b, *blocks)
    other = program(k * (c[:, None] * (root @ root.T) * c), k * c * q, r[:, None] * A * c, r * b, *blocks)
    np.testing.assert_allclose(
        audited(other, x / c, k * z / r)[:4], audited(one, x, z)[:4], rtol=1e-6, atol=1e-13
    )


# -- what a far number must not hide -------------------------------------------------------------------------


@given(st.floats(-9, 9), st.floats(6, 30))
@settings(max_examples=12, deadline=None)
def test_two_values_at_once_are_infeasible_beside_any_far_bound(small, far):
    k = 10.0**small
    p = program([[1.0]], [0.0], [[1.0], [1.0], [1.0]], [0.0, k, k * 10.0**far], zero(2), nonnegative(1))
    for x in (0.0, k / 2, k):
        assert claimed(p, [x]).status is Status.UNSOUND
        assert audited(p, np.array([x]), np.zeros(3)).primal > 0.1
    answer = solve(p)
    assert answer.status is Status.INFEASIBLE
    assert answer.duals @ p.b < 0
    assert abs(p.A.T @ answer.duals).max() <= 1e-8 * abs(answer.duals).max()


@pytest.mark.parametrize("far", [1e6, 1e7, 1e8, 1e12, 1e20, 1e30])
@pytest.mark.parametrize("backend", ["auto", *QP])
def test_a_sum_of_zeros_is_not_one(backend, far):
    rows = [[1, 0], [0, 1], [1, 1], [-1, 0], [0, -1], [1, 0]]
    p = program(np.zeros((2, 2)), [0, 0], rows, [0, 0, 1, 0, 0, far], zero(3), nonnegative(3))
    answer = solve(p, backend, throw=False)
    assert answer.status is Status.INFEASIBLE or (backend != "auto" and answer.status is not Status.SOLVED)
    assert answer.status not in (Status.UNBOUNDED, Status.UNBOUNDED_OR_INFEASIBLE)


def test_far_unknowns_and_answers_far_away_hide_no_miss():
    # x = 0, x = y, y = 1, and x + w = 1e8 for a w of its own
    rows = [[1, 0, 0], [1, -1, 0], [0, 1, 0], [1, 0, 1]]
    p = program(np.zeros((3, 3)), [0, 0, 0], rows, [0, 0, 1, 1e8], zero(4))
    for x in ([0, 1, 1e8], [0.5, 0.75, 1e8], [1, 1, 1e8 - 1]):
        assert claimed(p, x).status is not Status.SOLVED
    assert solve(p).status is Status.INFEASIBLE
    # x = y, x = y + 1: 1e9 - 1e9 is not one
    p = program(np.zeros((2, 2)), [0, 0], [[1, -1], [1, -1], [1, 0]], [0, 1, 1e9], zero(2), nonnegative(1))
    assert claimed(p, [1e9, 1e9]).status is not Status.SOLVED
    assert solve(p).status is Status.INFEASIBLE


def test_a_large_price_elsewhere_hides_no_column_and_no_slack():
    """min 1/2 (x - 1)^2 + 1e8 y with y = 1 and x >= 2: x = 3 is stationary with z = 2, and not the best."""
    p = program(np.diag([1.0, 0.0]), [-1.0, 1e8], [[0, 1], [-1, 0]], [1.0, -2.0], zero(1), nonnegative(1))
    assert claimed(p, [2, 1], [-1e8, 1]).status is Status.SOLVED
    wrong = claimed(p, [3, 1], [-1e8, 2])
    assert wrong.status is Status.UNSOUND
    assert wrong.complementarity > 0.01 > wrong.gap
    assert claimed(p, [2, 1], [-1e8, 1.1]).status is Status.UNSOUND
    assert solve(p).value == pytest.approx([2, 1], rel=1e-4)


def test_a_cone_is_judged_by_its_own_size():
    """|v| <= t with (t, v) = k (1, v) given by equations, beside a number of 1e8."""
    cone = Block(Cone.SECOND_ORDER, 3)
    A = np.vstack([np.eye(4), -np.eye(3, 4)])
    for k in (1e-6, 1.0, 1e6):
        for v, right in ((0.8, True), (0.8 * (1 + 1e-9), True), (0.8 + 1e-4, False)):
            p = program(np.zeros((4, 4)), np.zeros(4), A, [k, 0.6 * k, v * k, 1e8, 0, 0, 0], zero(4), cone)
            answer = claimed(p, [k, 0.6 * k, v * k, 1e8])
            assert (answer.status is Status.SOLVED) is right


# -- nothing to divide by ----------------------------------------------------------------------------------


@pytest.mark.parametrize("backend", ["auto", *QP])
@pytest.mark.parametrize("unit", [1e-5, 1.0, 1e5])
def test_right_sides_of_zero(backend, unit):
    """min (x - u)^2 + (y - u)^2 with x = 3 y: (1.2, 0.4) u."""
    p = program(2 * np.eye(2), [-2 * unit, -2 * unit], [[1, -3]], [0], zero(1))
    answer = solve(p, backend)
    assert answer.value == pytest.approx([1.2 * unit, 0.4 * unit], rel=1e-5)
    assert answer.objective == pytest.approx(-1.6 * unit**2, rel=1e-6)


@pytest.mark.parametrize("n", [1, 2, 5])
def test_least_norms_of_nothing(n):
    """min c with |x| <= c; every number in the answer is a solver's noise."""
    p = program(np.zeros((n + 1, n + 1)), [1, *[0] * n], -np.eye(n + 1), np.zeros(n + 1),
                Block(Cone.SECOND_ORDER, n + 1))  # fmt: skip
    for backend in ("auto", "clarabel", "cvxpy"):
        answer = solve(p, backend)
        assert answer.status is Status.SOLVED
        assert abs(answer.value).max() <= 1e-6


@pytest.mark.parametrize("backend", ["auto", *QP])
def test_programs_without_a_cost(backend):
    p = program(np.zeros((2, 2)), [0, 0], [[1, 1], [-1, 0], [0, -1]], [1, 0, 0], zero(1), nonnegative(2))
    answer = solve(p, backend)
    assert answer.status is Status.SOLVED
    assert answer.value.sum() == pytest.approx(1, abs=1e-5)
    assert answer.objective == 0


@pytest.mark.parametrize("backend", ["auto", *available_backends(), "cvxpy:SCS"])
def test_programs_without_rows_and_with_one_column(backend):
    """min x^2 + x: -1/4 at -1/2; a slope alone has no end."""
    answer = solve(program([[2.0]], [1.0], np.zeros((0, 1)), []), backend)
    assert answer.objective == pytest.approx(-0.25, abs=1e-6)
    assert answer.value == pytest.approx([-0.5], abs=1e-3)
    assert answer.duals.size == 0
    slope = solve(program([[0.0]], [-0.23], np.zeros((0, 1)), []), backend, throw=False)
    assert slope.status in (Status.UNBOUNDED, Status.NOT_FOUND, Status.FAILED, Status.STOPPED, Status.UNSOUND)
    assert backend not in ("auto", "clarabel") or slope.status is Status.UNBOUNDED


# -- objectives that have no least value -------------------------------------------------------------------


@pytest.mark.parametrize("backend", ["auto", *available_backends()])
@pytest.mark.parametrize(
    ("P", "words"),
    [
        ([[-2.0, 0.0], [0.0, 1.0]], r"not positive semidefinite: P\[0, 0\] is -2"),
        ([[0.0, 1.0], [1.0, 0.0]], r"not positive semidefinite: P\[1, 0\] is 1"),
        ([[1.0, -1.0 - 1e-6], [-1.0 - 1e-6, 1.0]], "not positive semidefinite"),
        ([[2.0, 1.0], [0.0, 2.0]], r"not symmetric: P\[1, 0\] is 0 and P\[0, 1\] is 1; give both triangles"),
    ],
)
def test_an_objective_that_is_not_convex_is_refused_by_every_back_end(backend, P, words):
    box = [[1, 0], [0, 1], [-1, 0], [0, -1]]
    with pytest.raises(InvalidInput, match=words):
        solve(program(P, [0, 0], box, [1] * 4, nonnegative(4)), backend)


@given(st.integers(0, 10_000), st.floats(-5, 5))
@settings(max_examples=40, deadline=None)
def test_convexity_is_found_in_any_units(seed, span):
    """R R' of rank n - 1 is convex in any units; less a millionth of its trace in its kernel it is not."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(3, 7))
    scale = 10.0 ** rng.uniform(-abs(span), abs(span), n)
    root = rng.normal(size=(n, n - 1))
    gram = root @ root.T
    kernel = np.linalg.svd(gram)[0][:, -1]
    for matrix, convex in ((gram, True), (gram - 1e-6 * np.trace(gram) * np.outer(kernel, kernel), False)):
        p = program(scale[:, None] * matrix * scale, np.zeros(n), np.zeros((0, n)), [])
        assert (p.why_not_convex == "") is convex, p.why_not_convex


def test_large_matrices_are_factored_sparse():
    n = 500
    chain = sparse.diags([np.full(n - 1, -1.0), np.full(n, 2.0), np.full(n - 1, -1.0)], [-1, 0, 1])
    wide = sparse.csc_matrix(chain @ chain)  # not dominated by its diagonal
    assert Program(wide, np.zeros(n), sparse.csc_matrix((0, n)), np.zeros(0), ()).why_not_convex == ""
    bent = sparse.csc_matrix(wide - 1e-3 * sparse.identity(n))
    words = Program(bent, np.zeros(n), sparse.csc_matrix((0, n)), np.zeros(0), ()).why_not_convex
    assert "negative eigenvalue" in words


# -- limits, on both sides ---------------------------------------------------------------------------------


@pytest.mark.parametrize("allowed", sorted({backend.tolerance for backend in BACKENDS.values()}))
@pytest.mark.parametrize(("share", "sound"), [(0.9, True), (1.1, False)])
@pytest.mark.parametrize("unit", [1e-6, 1.0, 1e6])
def test_tolerances_hold_on_both_sides(allowed, share, sound, unit):
    """x = u; min x^2 / 2 - u x: each measure alone brought just inside or just beyond what is allowed."""
    p = program([[1.0]], [-unit], [[1.0]], [unit], zero(1))
    right = claimed(p, [unit], [0.0], allowed=allowed)
    assert right.residual == 0
    by = np.array([unit * allowed * share])
    T = unit * (2 + 2.0**-11)  # |b| + X
    moved = audited(p, right.value + by * T / unit, np.zeros(1))
    assert moved.primal == pytest.approx(allowed * share, rel=1e-6)
    assert (moved.primal <= allowed) is sound
    V = unit * (4 + 2.0**-11)  # |q| + P X + Z, which is as much again
    pulled = audited(p, right.value, by * V / unit)
    assert pulled.dual == pytest.approx(allowed * share, rel=1e-6)
    assert (pulled.dual <= allowed) is sound


def test_the_tolerances_of_back_ends():
    exact = {"daqp": 1e-7, "quadprog": 1e-7, "piqp": 1e-7, "clarabel": 5e-7}
    loose = {"highs": 1e-6, "proxqp": 1e-6, "cvxpy": 1e-6, "qpalm": 1e-5, "osqp": 1e-5, "scs": 1e-5}
    assert {name: backend.tolerance for name, backend in BACKENDS.items()} == exact | loose


@pytest.mark.parametrize("place", ["value", "duals"])
@pytest.mark.parametrize("spoiled", [np.nan, np.inf, -np.inf])
def test_an_answer_that_is_not_finite_is_no_answer(place, spoiled):
    p = program([[1.0]], [-2.0], [[1.0]], [1.0], nonnegative(1))
    right = solve(p, "clarabel")
    parts = {"value": right.value.tolist(), "duals": right.duals.tolist(), place: [spoiled]}
    answer = claimed(p, parts["value"], parts["duals"])
    assert answer.status is Status.UNSOUND
    assert answer.residual == np.inf


def test_what_the_caller_says_of_size_counts():
    """x >= 0 and nothing else: -1e-9 is nothing beside one, and all there is without."""
    for size, sound in ((0.0, False), (1.0, True)):
        p = program(np.zeros((2, 2)), [0.0, 0.0], [[-1.0, 0.0]], [0.0], nonnegative(1), size=size)
        assert (audited(p, np.array([-1e-9, 0.0]), np.zeros(1)).primal <= 1e-7) is sound


def test_columns_that_stand_twice_are_merged():
    from regrasp.programs import Rows

    rows = Rows(2)
    rows.at_least_zero(sparse.csr_matrix(([1.0, 2.0, 4.0], ([0, 0, 0], [1, 0, 1])), (1, 2)))
    P = sparse.csc_matrix((np.array([3.0, 2.0, 1.0]), np.array([0, 1, 1]), np.array([0, 1, 3])), (2, 2))
    made = rows.program([0.0, 0.0], P)
    for matrix in (made.P, made.A):
        assert matrix.has_canonical_format
    assert made.A.toarray().tolist() == [[-2.0, -5.0]]
    assert made.P.toarray().tolist() == [[3.0, 0.0], [0.0, 3.0]]


@pytest.mark.parametrize("far", [1e2, 1e9, 1e30])
@pytest.mark.parametrize("unit", [2.0**-15, 1.0, 2.0**15])
def test_a_far_bound_on_what_the_objective_does_not_pull_hides_no_gradient(far, unit):
    """(x - y)^2 + (y - 1)^2 with x <= far: at x = y = 0.9 the last column is off by 0.2 of its unit of 2."""
    D = np.array([1.0, unit])
    p = program(
        D[:, None] * [[2, -2], [-2, 4]] * D, D * [0, -2], np.array([[1, 0]]) * D, [far], nonnegative(1)
    )
    assert audited(p, np.array([1.0, 1.0]) / D, np.zeros(1)).dual == 0
    assert audited(p, np.array([0.9, 0.9]) / D, np.zeros(1)).dual > 0.02
    assert claimed(p, np.array([0.9, 0.9]) / D).status is Status.UNSOUND


@pytest.mark.parametrize("far", [1e4, 1e6, 1e8])
def test_an_objective_is_not_right_because_its_terms_are_large(far):
    """(x - y - 1)^2 / 2 far away, off by e: the gap is e (1 + e), of 2 and little of terms 2 far^2."""
    p = program([[1, -1], [-1, 1]], [-1, 1], np.zeros((0, 2)), [])
    e = 2.0**-10
    measured = audited(p, np.array([far + 1 + e, far]), np.zeros(0))
    assert measured.absolute_gap == pytest.approx(e * (1 + e))
    assert measured.gap > 1e-8 if far < 1e5 else measured.gap > 1e-4

"""Proofs that a program has no solution: cleaned where nearly right, and then judged whatever their scale."""

from dataclasses import replace
from itertools import permutations

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from known_programs import known
from programs_by_hand import nonnegative, program, zero
from regrasp.programs import Block, Cone, Rows, Status, available_backends, solve
from regrasp.programs.facts import BACKENDS
from regrasp.programs.judging.cleaning import cleaned_direction, cleaned_duals
from regrasp.programs.judging.proofs import infeasibility_residual, unboundedness_residual
from regrasp.programs.judging.units import OWN
from regrasp.programs.judging.verdict import PROVEN, judged
from regrasp.programs.solution import Solution

pytestmark = pytest.mark.contract

QP = [name for name in available_backends() if name != "cvxpy"]


def random_infeasible(rng, conic):
    """Rows with z'A = 0 and z'b = -1 for a z of K*, each in units of its own, beside far bounds."""
    n, m = int(rng.integers(2, 6)), 9
    z = np.r_[rng.normal(size=2), abs(rng.normal(size=4)), 1.2, 0.6, 0.8 + 0.3 * rng.random()]
    if not conic:
        z[6:] = abs(rng.normal(size=3))
    else:
        z[6] = np.hypot(z[7], z[8])  # on the boundary of its cone
    A, b = rng.normal(size=(m, n)), rng.normal(size=m)
    A -= np.outer(z, z @ A) / (z @ z)
    b -= z * (b @ z + 1) / (z @ z)
    r = np.repeat(10.0 ** rng.uniform(-3, 3, 7), [1] * 6 + [3])
    c = 10.0 ** rng.uniform(-2, 2, n)
    cone = Block(Cone.SECOND_ORDER, 3) if conic else nonnegative(3)
    rows = np.vstack([r[:, None] * A * c, np.diag(c)])
    sides = np.r_[r * b, np.full(n, 10.0 ** rng.uniform(5, 9))]
    P = np.diag(c**2) * float(rng.random() < 0.5)
    p = program(P, c * rng.normal(size=n), rows, sides, zero(2), nonnegative(4), cone, nonnegative(n))
    return p, np.r_[z / r, np.zeros(n)]


@pytest.mark.parametrize("conic", [False, True])
@given(st.integers(0, 10_000), st.floats(-9, -4))
@settings(max_examples=25, deadline=None)
def test_a_certificate_with_noise_is_cleaned_to_a_proof(conic, seed, noise):
    rng = np.random.default_rng(seed)
    p, z = random_infeasible(rng, conic)
    size = abs(z) * abs(p.A).max(axis=1).toarray().ravel()
    spoiled = z * (1 + 10.0**noise * rng.normal(size=z.size))
    spoiled[-p.q.size :] = 1e-3 * 10.0**noise * size.max() * rng.random(p.q.size)
    clean = cleaned_duals(p, spoiled, PROVEN)
    assert infeasibility_residual(p, clean) <= PROVEN
    inside = p.cones.dual(clean)
    assert abs(p.A.T @ inside).max() <= 1e-7 * (abs(p.A.T) @ abs(inside)).max()
    assert p.b @ inside < 0


@given(st.integers(0, 10_000))
@settings(max_examples=15, deadline=None)
def test_random_infeasible_programs_are_never_solved(seed):
    p, _ = random_infeasible(np.random.default_rng(seed), False)
    for backend in ("auto", *np.random.default_rng(seed).permutation(QP)[:2]):
        status = solve(p, backend, throw=False).status
        assert status not in (Status.SOLVED, Status.UNBOUNDED)


@given(st.floats(1, 7), st.floats(-6, 6))
@example(6.75, 0.0)
@settings(max_examples=12, deadline=None)
def test_lines_that_meet_far_away_are_no_contradiction(far, unit):
    """x = y, (1 + e) x = y + u: they meet at u / e, whatever an all but perfect certificate says.

    Rows missed by r and r' move that by (r' - r) / e, relatively by (r' - r) / u; the audit lets each miss a
    ``tolerance`` of its unit, at most |b| + X <= 2 u and the part OWN of its terms, 2 |x|.
    """
    e, u = 10.0**-far, 10.0**unit
    p = program(np.zeros((2, 2)), [0, 0], [[1, -1], [1 + e, -1]], [0, u], zero(2))
    almost = np.array([1.0, -1.0])
    assert infeasibility_residual(p, cleaned_duals(p, almost, 0.0)) > PROVEN
    answer = solve(p, throw=False)
    assert answer.status is not Status.INFEASIBLE
    if answer.status is Status.SOLVED:
        units = 2 * (2 * u + OWN * 2 * abs(answer.value).max())
        assert answer.value == pytest.approx([u / e, u / e], rel=BACKENDS["clarabel"].tolerance * units / u)


def test_the_limit_of_a_certificate_on_both_sides():
    """x <= 1 and (1 + e) x >= 1 + 1 at z = (1, 1): A'z = -e of 2 + e, b'z = -1 of 3."""
    for e, proven in ((0.9 * PROVEN * 2 / 3, True), (1.1 * PROVEN * 2 / 3, False)):
        p = program([[0.0]], [0.0], [[1], [-1 - e]], [1, -2], nonnegative(2))
        for scale in (1e-12, 1.0, 1e12):
            residual = infeasibility_residual(p, scale * np.ones(2))
            assert (residual <= PROVEN) is proven
            assert residual == pytest.approx(e / (2 + e) * 3, rel=1e-6)
    assert infeasibility_residual(p, np.array([1.0, 0.5])) == np.inf  # b'z = 0
    assert infeasibility_residual(p, np.zeros(2)) == np.inf
    assert infeasibility_residual(p, np.full(2, np.nan)) == np.inf


def test_the_limit_of_a_direction_on_both_sides():
    """min -y with x <= (1 - e) y: along (1, 1) the row is crossed by e of its terms, 2 - e."""
    for e, proven in ((1.8 * PROVEN, True), (2.2 * PROVEN, False)):
        p = program(np.zeros((2, 2)), [0, -1], [[1, -1 + e], [-1, 0]], [1, 0], nonnegative(2))
        for scale in (1e-12, 1.0, 1e12):
            residual = unboundedness_residual(p, scale * np.array([1.0, 1.0]))
            assert (residual <= PROVEN) is proven
            assert residual == pytest.approx(e / 2, rel=1e-6)
    assert unboundedness_residual(p, np.array([0.0, -1.0])) == np.inf
    assert unboundedness_residual(p, np.full(2, np.nan)) == np.inf
    bent = program(np.diag([1.0, 0.0]), [0, -1], np.zeros((0, 2)), [])
    assert unboundedness_residual(bent, np.array([1e-3, 1.0])) == 1  # P d is all of its own terms
    assert unboundedness_residual(bent, cleaned_direction(bent, np.array([3e-3, 1.0]), 0.0)) == 0


@pytest.mark.parametrize("k", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize("backend", ["auto", "clarabel", "osqp", "scs", "piqp", "daqp"])
def test_a_ray_that_is_off_is_cleaned(backend, k):
    p = program(k * np.diag([1, 1, 1, 0]), [0, 0, 0, -k], [[1, 0, 0, 0]], [1], nonnegative(1))
    if backend not in ("auto", *QP):
        pytest.skip(f"{backend} is not installed")
    answer = solve(p, backend, throw=False)
    assert answer.status is Status.UNBOUNDED or (backend not in ("auto", "clarabel"))
    assert answer.status not in (Status.SOLVED, Status.INFEASIBLE)
    if answer.status is Status.UNBOUNDED:
        assert answer.value[3] > 0
        assert abs(answer.value[:3]).max() <= 1e-8 * answer.value[3]


@given(st.floats(-4, 2), st.floats(0, 8))
@settings(max_examples=8, deadline=None)
def test_a_ray_proves_nothing_without_a_point(small, price):
    """min x - p y with x = 0 and x = k: y falls for ever from nowhere."""
    k = 10.0**small
    p = program(np.zeros((2, 2)), [1, -(10.0**price)], [[1, 0], [1, 0]], [0, k], zero(2))
    answer = solve(p)
    assert answer.status is Status.INFEASIBLE
    assert infeasibility_residual(p, answer.duals) <= PROVEN


def test_without_a_point_the_word_is_either():
    p = program(np.zeros((2, 2)), [0, -1], [[1, 0]], [1], zero(1))  # zero is no point of it
    nothing = np.full(1, np.nan)
    claim = Solution(p, "somebody", Status.UNBOUNDED, np.array([0.0, 1.0]), nothing, None, 0.0, 0.0, "falls")
    found = replace(claim, status=Status.SOLVED, value=np.array([1.0, 0.0]))
    for status in (Status.NOT_FOUND, Status.STOPPED, Status.UNSOUND, Status.FAILED):
        given_up = judged(claim, 1e-7, lambda _, status=status: replace(found, status=status))
        assert given_up.status is Status.UNBOUNDED_OR_INFEASIBLE
        assert "no point to fall from is known" in given_up.status.advice
    assert judged(claim, 1e-7, lambda _: found).status is Status.UNBOUNDED
    wrong = replace(claim, value=np.array([1.0, 1.0]))  # it leaves x = 1
    assert judged(wrong, 1e-7, lambda _: found).status is not Status.UNBOUNDED_OR_INFEASIBLE
    assert judged(replace(claim, value=np.array([0.0, -1.0])), 1e-7, lambda _: found).status is Status.UNSOUND


@pytest.mark.parametrize("backend", QP)
@pytest.mark.parametrize("quadratic", [0.0, 1.0])
def test_certificates_that_are_handed_out_are_used(backend, quadratic):
    """x + y >= 3 with x, y <= 1; min -x with x, y >= 0."""
    p = program(quadratic * np.eye(2), [0.1, 0.0], [[-1, -1], [1, 0], [0, 1]], [-3, 1, 1], nonnegative(3))
    answer = solve(p, backend, throw=False)
    assert answer.status is Status.INFEASIBLE
    np.testing.assert_allclose(answer.duals / answer.duals[0], 1, atol=1e-7)
    falls = program(np.diag([0, quadratic]), [-1, 0], -np.eye(2), [0, 0], nonnegative(2))
    answer = solve(falls, backend, throw=False)
    assert answer.status in (Status.UNBOUNDED, Status.NOT_FOUND, Status.STOPPED, Status.UNSOUND)
    if backend in ("osqp", "scs", "clarabel", "piqp", "daqp", "qpalm"):
        assert answer.status is Status.UNBOUNDED


@pytest.mark.parametrize("backend", QP)
def test_equations_that_contradict_each_other_are_proven_to(backend):
    """x = 0 and x = 1, beside what has room: of the two and their loosened ones one proves it."""
    p = program([[0.0]], [-1.0], [[1], [1], [1]], [0, 1, 9], zero(2), nonnegative(1))
    answer = solve(p, backend, throw=False)
    assert answer.status is Status.INFEASIBLE
    z = answer.duals / answer.duals[0]
    assert z.sum() == pytest.approx(0, abs=1e-7)
    assert z[2] >= 0 > z[1] + 9 * z[2]


def test_duals_outside_of_the_cone_prove_nothing():
    p = program([[0.0]], [0.0], [[1], [1]], [1, 2], nonnegative(2))  # x <= 1, x <= 2
    assert infeasibility_residual(p, np.array([1.0, -1.0])) == np.inf
    claim = Solution(
        p, "somebody", Status.INFEASIBLE, np.full(1, np.nan), np.array([1.0, -1.0]), None, 0, 0, ""
    )
    assert judged(claim, 1e-7, lambda _: claim).status is Status.UNSOUND


@pytest.mark.parametrize("size", [0.0, 1.0])
@pytest.mark.parametrize("large", [1.0, 1e3, 1e9, 1e15])
def test_rows_that_cancel_hide_no_others(large, size) -> None:
    """x + y = 0, x + y <= 0 and y >= 1 have a point, (-1, 1), whatever the first two weigh."""
    p = program(np.zeros((2, 2)), [0, 0], [[1, 1], [1, 1], [0, -1]], [0, 0, -1], zero(1), nonnegative(2))
    p = replace(p, size=size)
    z = np.array([-large, large, 1.0])
    assert infeasibility_residual(p, z) >= 1e-2
    nothing = np.full(2, np.nan)
    given = Solution(p, "somebody", Status.INFEASIBLE, nothing, z, 7, 0.25, 0.5, "so they say")
    assert judged(given, 1e-7, lambda _: given).status is Status.UNSOUND


def test_a_dual_that_a_step_leaves_at_rounding_proves_nothing() -> None:
    """A program of known truth with a point, and what a back end gave out as a proof that there is none."""
    p = known(1996).program
    given = [0.40265678165853513, 1.525624609441914e-05, -597358.4722383111, 26591.84272842451,
             -1159.9161729793327, 0.0, 51160285.354274504]  # fmt: skip
    assert infeasibility_residual(p, cleaned_duals(p, np.array(given), PROVEN)) > 1e-3


@pytest.mark.parametrize("order", list(permutations(range(3))))
def test_what_rounding_hides_proves_nothing_in_any_order(order) -> None:
    """x - y = 1 and 1e-17 x >= 1e-13 have the point (1e4, 1e4 - 1); with z = 1 A'z is 1e-17 of 1 - 1."""
    rows = Rows(2)
    for k in order:
        row, offset = (([-1.0, 1.0], 1.0), ([1e-17, 0.0], -1e-13), ([1.0, -1.0], -1.0))[k]
        rows.at_least_zero([row], offset)
    program = rows.program([0.0, 0.0])
    for size in (1.0, 2.0**40, 2.0**-40):
        assert infeasibility_residual(program, np.full(3, size)) == pytest.approx(1e-4, rel=1e-2)


def test_what_is_hidden_in_one_column_is_not_made_good_by_another() -> None:
    rows = Rows(2)
    rows.at_least_zero([[-1.0, 1.0], [1e-17, -1e-17], [1.0, -1.0]], [1.0, -1e-13, -1.0])
    assert infeasibility_residual(rows.program([0.0, 0.0]), np.ones(3)) == pytest.approx(1e-4, rel=1e-2)


@pytest.mark.parametrize("order", list(permutations(range(3))))
def test_no_direction_falls_by_what_rounding_hides(order) -> None:
    """Along (1, 1, 1) the objective falls by 1e-13 of 2, and the row x - y + 1e-17 w = 0 is left by 1e-17."""
    rows = Rows(3)
    rows.equal(np.array([[1.0, 1e-17, -1.0]])[:, list(order)])
    program = rows.program(np.array([1.0, -1e-13, -1.0])[list(order)])
    for size in (1.0, 2.0**40, 2.0**-40):
        assert unboundedness_residual(program, np.full(3, size)) == pytest.approx(1e-4, rel=1e-2)


def test_what_cancels_exactly_is_still_a_proof() -> None:
    """x <= 1 and x >= 1 + 1e-12, by z = 1; the least of (1 - 1e-12) x - y for x = y."""
    rows = Rows(1)
    rows.at_least_zero([[-1.0], [1.0]], [1.0, -(1 + 1e-12)])
    assert infeasibility_residual(rows.program([0.0]), np.ones(2)) == 0
    falling = Rows(2)
    falling.equal([[1.0, -1.0]])
    assert unboundedness_residual(falling.program([1 - 1e-12, -1.0]), np.ones(2)) == 0

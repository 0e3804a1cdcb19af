"""Every back end on programs whose answers are known, and what it says where there is none."""

import logging

import numpy as np
import pytest

from known_programs import projection_on_simplex
from regrasp.errors import InvalidInput, SolverFailed, SolverUnavailable
from regrasp.programs import Rows, Status, available_backends, facts, qp_backend, solve
from regrasp.programs import backends as table
from regrasp.programs.answer import Answer

pytestmark = pytest.mark.oracle


QP_ONLY = [name for name in available_backends() if not table.BACKENDS[name].second_order]


CONIC = [name for name in available_backends() if table.BACKENDS[name].second_order] + [
    "cvxpy:CLARABEL",
    "auto",
]


# Relative to the answer's largest entry: interior-point and active-set methods, then first-order ones.
ACCURACY = {
    "auto": 1e-7,
    "clarabel": 1e-7,
    "daqp": 1e-9,
    "quadprog": 1e-9,
    "highs": 1e-5,
    "piqp": 1e-5,
    "proxqp": 1e-6,
    "cvxpy": 1e-6,
    "cvxpy:CLARABEL": 1e-6,
    "qpalm": 1e-4,
    "osqp": 1e-5,
    "scs": 1e-5,
}


def nearest_in_ball(point, radius):
    """min |x - p| as (t, x) with |x| <= radius: p scaled back to the ball."""
    d = len(point)
    rows = Rows(d + 1)
    rows.second_order(np.eye(d + 1), [0.0, *(-np.asarray(point))])  # |x - p| <= t
    rows.second_order(np.vstack([np.zeros(d + 1), np.eye(d + 1)[1:]]), [radius] + [0.0] * d)
    size = np.linalg.norm(point)
    return rows.program([1.0] + [0.0] * d), np.asarray(point) * min(1.0, radius / size)


@pytest.mark.parametrize("backend", sorted({*QP_ONLY, *CONIC}))
@pytest.mark.parametrize("seed", range(5))
def test_every_back_end_finds_the_known_optimum_of_a_qp(backend, seed):
    program, best = projection_on_simplex(np.random.default_rng(seed).normal(size=6))
    solution = solve(program, backend)
    assert solution.status is Status.SOLVED
    np.testing.assert_allclose(solution.value, best, atol=ACCURACY[backend] * abs(best).max())
    assert solution.objective == pytest.approx(0.5 * best @ best + program.q @ best, abs=ACCURACY[backend])


@pytest.mark.parametrize("backend", CONIC)
@pytest.mark.parametrize("radius", [0.5, 2.0, 50.0])
def test_conic_back_ends_find_the_known_optimum_with_second_order_cones(backend, radius):
    program, best = nearest_in_ball([3.0, -4.0, 1.0], radius)
    solution = solve(program, backend)
    np.testing.assert_allclose(solution.value[1:], best, atol=1e-5)
    assert solution.value[0] == pytest.approx(np.linalg.norm(best - [3, -4, 1]), abs=1e-6)


@pytest.mark.parametrize("backend", sorted({*QP_ONLY, *CONIC}))
def test_duals_have_one_sign_convention(backend):
    """min 1/2 x'x - x1 with x2 = 1, x1 <= 1/2: z_equality = -1, z_bound = 1/2 from P x + q + A'z = 0."""
    rows = Rows(2)
    rows.equal([[0.0, 1.0]], -1.0)
    rows.at_least_zero([[-1.0, 0.0]], 0.5)
    solution = solve(rows.program([-1.0, 0.0], np.eye(2)), backend)
    np.testing.assert_allclose(solution.value, [0.5, 1.0], atol=1e-4)
    stationary = (
        solution.program.P @ solution.value + solution.program.q + solution.program.A.T @ solution.duals
    )
    np.testing.assert_allclose(stationary, 0, atol=1e-4)
    np.testing.assert_allclose(abs(solution.duals), [1.0, 0.5], atol=1e-4)
    assert solution.duals[1] > 0


def contradiction():
    rows = Rows(2)
    rows.at_least_zero([[1.0, 1.0], [-1.0, 0.0], [0.0, -1.0]], [-3.0, 1.0, 1.0])  # x + y >= 3, x, y <= 1
    return rows.program([0.0, 0.0], np.eye(2))


def falling():
    rows = Rows(2)
    rows.at_least_zero(np.eye(2))
    return rows.program([-1.0, 0.0])


def test_clarabel_proves_infeasibility_and_unboundedness():
    infeasible, unbounded = solve(contradiction(), "clarabel"), solve(falling(), "clarabel")
    assert infeasible.status is Status.INFEASIBLE
    assert infeasible.infeasibility_residual < 1e-6
    z = infeasible.duals / infeasible.duals.sum()
    np.testing.assert_allclose(z, 1 / 3, atol=1e-6)
    assert unbounded.status is Status.UNBOUNDED
    assert unbounded.unboundedness_residual < 1e-6
    assert unbounded.value[0] > 0


def test_a_back_end_that_refuses_a_program_is_no_verdict():
    pytest.importorskip("quadprog")
    rows = Rows(2)
    rows.at_least_zero(np.eye(2))
    with pytest.raises(SolverFailed, match="P is not positive definite"):
        solve(rows.program([1.0, 1.0], np.ones((2, 2))), "quadprog")


def cheapest_corner():
    """min -x - 2 y on the triangle x + y <= 30, x, y >= 0: the corner (0, 30)."""
    rows = Rows(2)
    rows.at_least_zero([[1.0, 0.0], [0.0, 1.0], [-1.0, -1.0]], [0.0, 0.0, 30.0])
    return rows.program([-1.0, -2.0])


@pytest.mark.parametrize("backend", sorted({*QP_ONLY, *CONIC}))
def test_every_back_end_answers_a_linear_program(backend):
    solution = solve(cheapest_corner(), backend)
    np.testing.assert_allclose(solution.value, [0.0, 30.0], atol=30 * ACCURACY[backend])
    np.testing.assert_allclose(solution.duals, [1.0, 0.0, 2.0], atol=2e-4)


@pytest.mark.parametrize("backend", QP_ONLY)
def test_a_linear_program_that_falls_for_ever_has_no_answer(backend):
    """A back end proves it by a direction or says that it has nothing; it never answers."""
    answer = solve(falling(), backend, throw=False)
    if answer.status is Status.UNBOUNDED:
        assert answer.value[0] > 0
        assert abs(answer.value[1]) <= 1e-9 * answer.value[0] or answer.value[1] > 0
        assert np.isnan(answer.duals).all()
    else:
        assert answer.status in (Status.NOT_FOUND, Status.STOPPED)
        with pytest.raises(SolverFailed):
            solve(falling(), backend)


@pytest.mark.parametrize("backend", QP_ONLY)
def test_a_qp_back_end_with_a_certificate_has_it_used(backend):
    solution = solve(contradiction(), backend)
    assert solution.status is Status.INFEASIBLE
    assert np.isnan(solution.value).all()
    np.testing.assert_allclose(solution.duals / solution.duals.sum(), 1 / 3, atol=1e-9)


@pytest.mark.parametrize("backend", QP_ONLY)
def test_second_order_cones_on_a_qp_back_end_are_refused(backend):
    program, _ = nearest_in_ball([1.0, 1.0], 0.5)
    with pytest.raises(
        InvalidInput, match=r"solves QPs only .* use linearised cones .* or one of .*clarabel"
    ):
        solve(program, backend)


class Lying:
    """A back end that calls a wrong answer solved."""

    def __init__(self, wrong):
        self.wrong = wrong

    def __call__(self, program, name, **options):
        right = solve(program, "clarabel")
        from dataclasses import replace

        return replace(right, backend=name, **self.wrong(right))


@pytest.mark.parametrize(
    "wrong",
    [
        lambda s: {"value": s.value + 1e-3},
        lambda s: {"duals": s.duals * 1.01},
        lambda s: {"duals": -s.duals},
        lambda s: {"value": s.value * np.nan},
        lambda s: {"status": Status.INFEASIBLE},
        lambda s: {"status": Status.UNBOUNDED},
    ],
)
def test_an_answer_whose_own_residuals_fail_is_an_error_whatever_it_was_called(monkeypatch, wrong):
    from regrasp.programs import clarabel_backend

    program, _ = projection_on_simplex(np.array([0.3, 0.9, -0.4]))
    lying, honest = Lying(wrong), clarabel_backend.solve
    module = type("module", (), {"solve": staticmethod(lying)})
    monkeypatch.setitem(table.BACKENDS, "liar", table.Backend("numpy", "liar", True, 1e-7))
    real = table.import_module
    monkeypatch.setattr(table, "import_module", lambda name: module if name == "liar" else real(name))
    assert honest(program, "clarabel").residual < 1e-7
    with pytest.raises(SolverFailed, match="UNSOUND"):
        solve(program, "liar")


def test_auto_goes_on_to_the_next_sound_back_end_and_says_so(monkeypatch, caplog):
    from regrasp.programs import clarabel_backend

    honest = clarabel_backend.solve
    program, best = projection_on_simplex(np.array([0.3, 0.9, -0.4]))
    monkeypatch.setattr(clarabel_backend, "solve", lambda p, name: honest(p, name, max_iter=1))
    with caplog.at_level(logging.WARNING, logger="regrasp.programs"):
        solution = solve(program, "auto")
    assert solution.backend == "daqp"
    np.testing.assert_allclose(solution.value, best, atol=1e-9)
    assert "clarabel: STOPPED" in caplog.text
    assert "trying the next" in caplog.text


def test_options_reach_the_solver():
    program, _ = projection_on_simplex(np.random.default_rng(0).normal(size=8))
    solution = solve(program, "clarabel", throw=False, max_iter=2)
    assert solution.status is Status.STOPPED
    assert solution.iterations == 2
    with pytest.raises(SolverFailed, match="rescale the data or try another back end"):
        solve(program, "clarabel", max_iter=2)
    with pytest.raises(InvalidInput, match="options belong to one solver"):
        solve(program, "auto", max_iter=2)


def test_unknown_and_missing_back_ends(monkeypatch):
    program, _ = projection_on_simplex(np.array([1.0, 2.0]))
    with pytest.raises(SolverUnavailable, match=r"no back end 'simplex'; known: auto, clarabel"):
        solve(program, "simplex")
    with pytest.raises(SolverUnavailable, match=r"cvxpy has no solver 'NOPE' here; it has .*CLARABEL"):
        solve(program, "cvxpy:NOPE")
    monkeypatch.setattr(facts, "_has", lambda package: False)
    assert available_backends() == ()
    with pytest.raises(SolverUnavailable, match=r"needs the package daqp: pip install 'regrasp\[solvers\]'"):
        solve(program, "daqp")


def falling_beside(far, says="found"):
    """min -y with x = far, and a solver that is exact: its proximal steps are 1 / weight long."""
    rows = Rows(2)
    rows.equal([[1.0, 0.0]], [far])

    class Session:
        def __init__(self, given, **_) -> None:
            self.given = given

        def solve(self):
            weights = self.given.P.diagonal()
            return Answer(says, np.array([far, -self.given.q[1] / weights[1]]), np.zeros(1), 3, "done")

    return rows.program([0.0, -1.0]), Session


@pytest.mark.parametrize(("says", "status"), [("found", Status.UNBOUNDED), ("failed", Status.STOPPED)])
def test_the_last_step_is_the_direction_however_far_away_it_begins(monkeypatch, says, status) -> None:
    """The point itself falls, too, but along the equation's far side."""
    program, session = falling_beside(1e9, says)
    exact = type("call", (), {"layout": staticmethod(lambda given: given), "Session": session})
    monkeypatch.setattr(qp_backend, "import_module", lambda _: exact)
    answer = qp_backend.solve(program, "daqp")
    assert answer.status is status
    if status is Status.UNBOUNDED:
        assert answer.value[0] == 0 < answer.value[1]


@pytest.mark.parametrize(("told", "times"), [(4.0, (6.0, 4.0)), (12.0, (0.0, 12.0)), (None, (0.0, 10.0))])
def test_what_a_solver_does_not_tell_of_is_all_its_own(monkeypatch, told, times) -> None:
    class Session:
        def __init__(self, *_, **__) -> None: ...

        def solve(self):
            return Answer("found", np.zeros(2), np.zeros(1), solve_time=told)

    exact = type("call", (), {"layout": staticmethod(lambda given: given), "Session": Session})
    monkeypatch.setattr(qp_backend, "import_module", lambda _: exact)
    clock = iter([100.0, 110.0])
    monkeypatch.setattr(qp_backend, "perf_counter", lambda: next(clock))
    answer = qp_backend.solve(falling_beside(1.0)[0], "highs")
    assert (answer.build_time, answer.solve_time) == times

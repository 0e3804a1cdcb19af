"""Kept solvers answer as new ones do, whatever was asked before, and are believed only if beyond doubt."""

import numpy as np
import pytest
from scipy import sparse

import regrasp as rg
from regrasp.planning.states.program import state_program
from regrasp.programs import Block, Cone, Pattern, Program, clarabel_backend, solve
from regrasp.programs.backends import answered_quickly, solved_quickly
from regrasp.programs.judging.audit import audited
from regrasp.programs.judging.quick import surely_sound

pytestmark = pytest.mark.oracle

OBJECTIVES = ("effort", "peak", "peak_normal", "sum_normal", "force")


def programs(rng: np.random.Generator, dimension: int):
    points = rng.normal(size=(5, dimension))
    normals = 0.3 * rng.normal(size=(5, dimension)) - points
    for _ in range(4):
        mu = rng.uniform(0.3, 1.0, 5)
        grasp = rg.Grasp(rg.Contact(p, n, m) for p, n, m in zip(points, normals, mu, strict=True))
        load = rg.Wrench.from_vector(rng.normal(size=len(grasp.matrix)))
        for objective in OBJECTIVES:
            yield state_program(grasp, load, objective, mu.tolist(), [30.0] * 5, 1.0)


@pytest.mark.parametrize("dimension", [2, 3])
def test_an_answer_does_not_depend_on_what_was_asked_before(dimension) -> None:
    asked = list(programs(np.random.default_rng(dimension), dimension))
    first = [answered_quickly(program) for program in asked]
    assert sum(answer is not None for answer in first) > 10
    for program, answer in zip(asked[::-1], first[::-1], strict=True):
        again = answered_quickly(program)
        assert (again is None) == (answer is None)
        if answer is not None:
            assert all(np.array_equal(a, b) for a, b in zip(answer, again, strict=True))


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_objective_is_that_of_solve_and_bounds_are_above_the_audit(dimension) -> None:
    seen = 0
    for program in programs(np.random.default_rng(10 + dimension), dimension):
        quick = solved_quickly(program)
        if quick is None:
            continue
        seen += 1
        whole = solve(program, "clarabel")
        assert quick.objective == pytest.approx(whole.objective, rel=1e-7, abs=1e-7)
        exact = audited(program, quick.value, quick.duals)
        rounding = 1e-14
        assert all(b >= e - rounding for b, e in zip(quick.audit[:4], exact[:4], strict=True))
        assert quick.absolute_gap == pytest.approx(exact.absolute_gap, abs=1e-12)
    assert seen > 10


def test_what_is_a_little_wrong_is_not_sound_beyond_doubt() -> None:
    program = next(programs(np.random.default_rng(1), 2))
    answer = answered_quickly(program)
    assert answer is not None
    x, z = answer
    assert surely_sound(program, x, z, 5e-10, 1e-8) is not None
    for place in range(x.size):
        off = x.copy()
        off[place] += 1e-6
        assert surely_sound(program, off, z, 5e-10, 1e-8) is None
    for place in range(z.size):
        off = z.copy()
        off[place] -= 1e-6
        assert surely_sound(program, x, off, 5e-10, 1e-8) is None
    assert surely_sound(program, x * np.nan, z, 5e-10, 1e-8) is None


def test_a_kept_solver_takes_every_number_anew() -> None:
    """min p x^2 / 2 - q x with a x <= b: x = q / p or b / a, whichever is less."""
    one, zero = sparse.csc_matrix([[1.0]]), sparse.csc_matrix((1, 1))
    pattern = Pattern((1, 1), [0], [0])
    asked = [(1, 1, 1, 9), (4, 1, 1, 9), (4, 2, 1, 9), (4, 2, 1, 0.25),
             (4, 2, 2, 0.25), (1, 1, 1, 9), (0, 1, 1, 9), (0, 1, 3, 9)]  # fmt: skip
    shared = pattern.filled(np.ones(1))
    for p, q, a, b in asked:
        P, A = float(p) * one if p else zero, shared if a == 1 else pattern.filled(np.array([float(a)]))
        program = Program(
            P, np.array([-float(q)]), A, np.array([float(b)]), (Block(Cone.NONNEGATIVE, 1),), 1.0
        )
        x, z = answered_quickly(program)
        assert x == pytest.approx([min(q / p if p else np.inf, b / a)], rel=1e-6)
        assert z == pytest.approx([(q - p * x[0]) / a], abs=1e-6)


def line(P=((1.0,),), q=(-1.0,)):
    n = len(q)
    pattern = Pattern((1, n), [0] * n, range(n))
    A = pattern.filled(np.ones(n))
    return Program(
        sparse.csc_matrix(np.array(P)), np.array(q), A, np.ones(1), (Block(Cone.NONNEGATIVE, 1),), 1.0
    )


def test_solvers_of_several_patterns_are_kept_side_by_side() -> None:
    clarabel_backend._memory.__dict__.clear()
    for _ in range(2):
        for program in (one := line(), two := line()):
            assert answered_quickly(program) is not None
    assert len(clarabel_backend._memory.solvers) == 4
    assert one is not two


@pytest.mark.parametrize(("far", "is_believed"), [(0.9999e50, True), (1.0001e50, False)])
def test_what_ends_beyond_all_numbers_is_no_answer(monkeypatch, far, is_believed) -> None:
    class Far:
        status, x, z = "Solved", [-far], [0.0]
        update = staticmethod(lambda **_: None)
        solve = classmethod(lambda cls: cls)

    monkeypatch.setattr(clarabel_backend.clarabel, "DefaultSolver", lambda *_: Far)
    assert (answered_quickly(line()) is not None) is is_believed


def test_squares_alone_are_quick() -> None:
    """Places of P that are off its diagonal are no part of what tells patterns apart."""
    assert line([[2.0, 0.0], [0.0, 2.0]], [-1.0, -1.0]).is_quick
    assert not line([[2.0, 1.0], [1.0, 2.0]], [-1.0, -1.0]).is_quick

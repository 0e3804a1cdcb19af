"""Solvers that need squares are asked in steps: what is asked, when it ends, what is said then."""

import types

import numpy as np
import pytest
from scipy import sparse

from regrasp.programs import Rows, Solution, Status, qp_backend
from regrasp.programs.answer import Answer
from regrasp.programs.facts import BACKENDS

pytestmark = pytest.mark.contract
STEPS = [1e-1] * 2 + [1e-2] * 2 + [1e-3] * 10 + [1e-4] * 4 + [1e-5] * 3 + [1e-6] * 3 + [1e-7] * 3


def line(q, P=None):
    """x >= 0 in as many unknowns as q has."""
    rows = Rows(len(q))
    rows.at_least_zero(np.eye(len(q)))
    return rows.program(q, P)


class Scripted:
    """A solver that answers with these points in turn, the last for ever, and keeps what it was asked."""

    def __init__(self, monkeypatch, *answers: Answer) -> None:
        self.asked, self.options, rest = [], [], list(answers)
        outer = self

        class Session:
            def __init__(self, given, **options) -> None:
                outer.asked.append(given)
                outer.options.append(options)

            def solve(self) -> Answer:
                return rest.pop(0) if len(rest) > 1 else rest[0]

        call = types.SimpleNamespace(layout=lambda given: given, Session=Session)
        monkeypatch.setattr(qp_backend, "import_module", lambda _: call)


def found(*x, status="found", duals=None) -> Answer:
    z = np.zeros(len(x)) if duals is None else np.array(duals)
    return Answer(status, np.array(x, dtype=float), z, 1, "done")


@pytest.mark.parametrize(("q", "size"), [([-2.0, 1.0], 2.0), ([0.0, 0.0], 1.0), ([0.25, -0.125], 0.25)])
def test_what_is_asked(monkeypatch, q, size) -> None:
    """The objective and s w_k / 2 |x - x_k|^2, of which x_k gives -s w_k x_k."""
    points = [found(float(k), -2.0 * k) for k in range(1, 40)]
    solver = Scripted(monkeypatch, *points)
    P = np.array([[0.0, 0.0], [0.0, 3.0]])
    program = line(q, P)
    qp_backend.solve(program, "daqp")
    assert len(solver.asked) == len(STEPS) == 27
    for k, (given, weight) in enumerate(zip(solver.asked, STEPS, strict=True)):
        np.testing.assert_allclose(given.P.toarray(), P + size * weight * np.eye(2), rtol=1e-13, atol=0)
        np.testing.assert_allclose(given.q, q - size * weight * np.array([k, -2.0 * k]), rtol=1e-13)
        assert given.A is program.A
        assert given.b is program.b


def test_squares_of_all_unknowns_need_no_steps(monkeypatch) -> None:
    for least, steps in ((1e-300, 1), (0.0, 27)):
        solver = Scripted(monkeypatch, *(found(float(k), 1.0) for k in range(1, 40)))
        program = line([1.0, 1.0], np.diag([least, 1.0]))
        answer = qp_backend.solve(program, "daqp")
        assert len(solver.asked) == steps
        assert (solver.asked[0] is program) is (steps == 1)
        assert answer.status is Status.SOLVED
        assert answer.value.tolist() == [1.0 if steps == 1 else 27.0, 1.0]


def test_solvers_that_need_no_squares_are_asked_once(monkeypatch) -> None:
    for name, backend in BACKENDS.items():
        if ".calls." in backend.module:
            solver = Scripted(monkeypatch, *(found(float(k)) for k in range(1, 40)))
            qp_backend.solve(line([1.0]), name)
            assert len(solver.asked) == (27 if backend.strictly_convex else 1)
            assert solver.options[0] == backend.options


@pytest.mark.parametrize("size", [1.0, 2.0**20])
@pytest.mark.parametrize(("far", "steps"), [(0.9999e-9, 1), (1.0001e-9, 2)])
def test_it_ends_where_it_stands_still(monkeypatch, size, far, steps) -> None:
    """Duals of a step miss by s w |step|: at w = 0.1 a step of 1e-9 is as good as none."""
    solver = Scripted(monkeypatch, found(far, 0.0, duals=[5.0, 6.0]))
    answer = qp_backend.solve(line([size, -size / 2]), "daqp")
    assert len(solver.asked) == steps
    assert (answer.status, answer.said) == (Status.SOLVED, "done")
    assert answer.value.tolist() == [far, 0.0]
    assert answer.duals.tolist() == [5.0, 6.0]


def test_what_moves_by_exactly_as_little_as_is_allowed_stands_still(monkeypatch) -> None:
    """In doubles, at an s of 3."""
    x = 9.999999999999999e-10
    assert 3 * 0.1 * x == 3 * 1e-10
    solver = Scripted(monkeypatch, found(x))
    qp_backend.solve(line([3.0]), "daqp")
    assert len(solver.asked) == 1


@pytest.mark.parametrize(
    ("last", "status"),
    [
        (found(1.0, status="infeasible"), Status.INFEASIBLE),
        (found(1.0, status="unbounded"), Status.UNBOUNDED),
        (found(1.0, status="failed"), Status.STOPPED),
        (Answer("failed", np.ones(1)), Status.NOT_FOUND),
        (Answer("failed", None, np.ones(1)), Status.NOT_FOUND),
        (found(1.0, status="refused"), Status.NOT_FOUND),
        (Answer("found", None, np.zeros(1)), Status.SOLVED),
    ],
)
def test_the_first_answer_that_is_no_point_is_the_answer(monkeypatch, last, status) -> None:
    """Even after steps along which the objective falls for ever."""
    solver = Scripted(monkeypatch, found(1.0), found(2.0), last)
    answer = qp_backend.solve(line([-1.0]), "daqp")
    assert len(solver.asked) == 3
    assert (answer.status, answer.said) == (status, last.said)
    given = last.x is not None and last.status not in ("infeasible", "refused")
    assert np.isnan(answer.value).all() != given
    given = last.duals is not None and last.status not in ("unbounded", "refused")
    assert np.isnan(answer.duals).all() != given


@pytest.mark.parametrize(("miss", "status"), [(0.9999e-3, Status.UNBOUNDED), (1.0001e-3, Status.SOLVED)])
def test_it_falls_for_ever_along_its_last_step(monkeypatch, miss, status) -> None:
    """-x0 over x0, x1 >= 0 along (1, -e): outside the second row by e of one unit of its own."""
    rows = Rows(2)
    rows.at_least_zero([[1.0, 0.0], [1.0, 1.0]])
    program = rows.program([-1.0, 0.0])
    side = -(1 + miss) / (1 - miss)  # (|side| - 1) / (1 + |side|) is the miss
    points = [found(float(k), k * side) for k in range(1, 27)]
    solver = Scripted(monkeypatch, *points, found(100.0, 100 * side, duals=[7.0, 8.0]))
    answer = qp_backend.solve(program, "daqp")
    assert len(solver.asked) == 27
    assert answer.status is status
    if status is Status.UNBOUNDED:
        np.testing.assert_allclose(answer.value, [74.0, 74 * side])
        assert answer.said == "done, falling for ever"
        assert np.isnan(answer.duals).all()
    else:
        np.testing.assert_allclose(answer.value, [100.0, 100 * side])
        assert answer.said == "done"
        assert answer.duals.tolist() == [7.0, 8.0]


@pytest.mark.parametrize(("says", "x", "z"), [("infeasible", 1.0, None), ("unbounded", None, 1.0)])
def test_a_claim_without_its_proof_is_none(monkeypatch, says, x, z) -> None:
    """Nor is what it had in mind besides."""
    given = (None if part is None else np.array([part]) for part in (x, z))
    Scripted(monkeypatch, Answer(says, *given, 4, "so"))
    answer = qp_backend.solve(line([1.0]), "highs")
    assert (answer.status, answer.said) == (Status.NOT_FOUND, "so, without a certificate")
    assert np.isnan(answer.value).all()
    assert np.isnan(answer.duals).all()
    assert answer.iterations == 4


def test_a_limit_of_nothing_is_the_solvers_to_read(monkeypatch) -> None:
    """To SCS it is no limit; a positive one it is told as what is left of it."""
    solver = Scripted(monkeypatch, found(1.0))
    for given, told in ((0, 0), (50.0, pytest.approx(50.0, abs=5))):
        qp_backend.solve(line([1.0]), "scs", time_limit_secs=given)
        assert solver.options[-1]["time_limit_secs"] == told
    assert isinstance(qp_backend.solve(line([1.0]), "highs", presolve="on"), Solution)
    assert solver.options[-1]["presolve"] == "on"


def test_numbers_of_an_answer_are_plain_arrays(monkeypatch) -> None:
    Scripted(monkeypatch, Answer("found", sparse.csc_matrix([[2]]).toarray()[0], np.array([3], dtype=int)))
    answer = qp_backend.solve(line([1.0]), "highs")
    assert answer.value.dtype == answer.duals.dtype == float
    assert (answer.value.tolist(), answer.duals.tolist()) == ([2.0], [3.0])


@pytest.mark.parametrize("x", [(np.inf,), (np.nan,), None])
def test_a_step_without_an_end_is_the_last(monkeypatch, x) -> None:
    answer = found(*x) if x else Answer("found", None, None, 1, "done")
    solver = Scripted(monkeypatch, answer)
    given = qp_backend.solve(line([-1.0]), "daqp")
    assert len(solver.asked) == 1
    assert not np.isfinite(given.value).any()

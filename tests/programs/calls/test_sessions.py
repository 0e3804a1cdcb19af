"""Every solver called by its own name: laid out, set up, updated, timed, and what it says at its ends."""

from importlib import import_module

import numpy as np
import pytest
from scipy import sparse

from programs_by_hand import nonnegative, program, zero
from regrasp.programs import Block, Cone
from regrasp.programs.calls import deadline
from regrasp.programs.calls.form import bounded, ordered, split
from regrasp.programs.facts import is_available

pytestmark = pytest.mark.contract

NAMES = {"highs": "highspy", "proxqp": "proxsuite"}
CERTAIN = {"clarabel": 1e-6, "daqp": 1e-9, "quadprog": 1e-9, "piqp": 1e-5, "qoco": 1e-4}
SOLVERS = [
    name
    for name in ("clarabel", "daqp", "highs", "osqp", "piqp", "proxqp", "qpalm", "quadprog", "scs")
    if is_available(name)
]
try:
    import qoco  # noqa: F401

    SOLVERS.append("qoco")
except ImportError:
    pass


def called(name):
    return import_module(f"regrasp.programs.calls.{NAMES.get(name, name)}_call")


def mixed(*b, more=0):
    """An equation between inequalities; ``more`` unknowns are 1, each by itself."""
    n = 3 + more
    P, A = np.eye(n), np.zeros((4, n))
    P[:2, :2] = [[2, 0.5], [0.5, 2]]
    A[:, :3] = [[1, 0, 0], [0, 1, 1], [0, 1, 0], [1, 1, 0]]
    return program(P, [-3, -1, -1] + [-1] * more, A, b, nonnegative(1), zero(1), nonnegative(2))


ONE, ONE_X, ONE_Z = (0.5, 2, 0.3, 9), (0.5, 0.3, 1.7), (1.85, -0.7, 0.85, 0)
TWO, TWO_X, TWO_Z = (0.25, 1, 0.3, 9), (1 / 4, 7 / 24, 17 / 24), (113 / 48, 7 / 24, 0, 0)
"""By hand: 2 x + y / 2 - 3 + z1 = 0, x / 2 + 2 y - 1 + z2 + z3 = 0, w - 1 + z2 = 0."""
NONE = program(np.eye(2), [0, 0], [[-1, -1], [2, 0], [0, 4]], [-3, 2, 4], zero(1), nonnegative(2))
FALLS = program(np.diag([0, 1]), [-1, 0], [[-1, 0], [0, 1]], [1, 1], nonnegative(2))


def clocked(call, monkeypatch):
    """A clock that tells 1, 2, 4, 8 ..: which of its times a difference is of can be read off."""
    ticks = iter(2.0**k for k in range(60))
    monkeypatch.setattr(call, "perf_counter", lambda: next(ticks))


@pytest.mark.parametrize("name", SOLVERS)
def test_what_is_set_up_updated_and_timed_is_answered(name, monkeypatch, capfd) -> None:
    call = called(name)
    clocked(call, monkeypatch)
    session = call.Session(call.layout(mixed(*ONE)))
    for b, x, z, times in ((ONE, ONE_X, ONE_Z, (1, 4)), (TWO, TWO_X, TWO_Z, (16, 64))):
        if b is TWO:
            session.update(call.layout(mixed(*TWO)))
        answer = session.solve()
        assert answer.status == "found"
        np.testing.assert_allclose(answer.x, x, atol=CERTAIN.get(name, 1e-3))
        np.testing.assert_allclose(answer.duals, z, atol=CERTAIN.get(name, 2e-3))
        assert type(answer.iterations) is int
        assert answer.build_time is None
        if name == "quadprog":  # it keeps nothing, and sets nothing up
            times = None, {1: 1, 16: 4}[times[0]]
        assert (answer.setup_time, answer.solve_time) == times
    assert "iter" not in capfd.readouterr().out.lower()


@pytest.mark.parametrize("name", SOLVERS)
def test_a_program_without_a_point_and_one_that_falls(name, monkeypatch) -> None:
    call = called(name)
    none, falls = (call.Session(call.layout(given)).solve() for given in (NONE, FALLS))
    if name == "qoco":
        assert none.status == "failed"
        return
    assert none.status == "infeasible"
    if name in ("daqp", "quadprog"):
        assert none.duals is None
    elif name == "proxqp":  # its iterate is on its way to one
        assert (none.duals > 0).all()
    else:
        np.testing.assert_allclose(none.duals / none.duals[0], [1, 0.5, 0.25], atol=1e-4)
    if name == "quadprog":
        assert (falls.status, falls.said) == ("refused", "P is not positive definite")
    elif name not in ("highs", "proxqp"):
        assert falls.status == "unbounded"
        if name == "daqp":
            assert falls.x.shape == (2,)
        else:
            np.testing.assert_allclose(falls.x / falls.x[0], [1, 0], atol=1e-5)


@pytest.mark.parametrize("name", [name for name in SOLVERS if name not in ("quadprog", "highs")])
def test_options_reach_it_and_who_stops_tells_how_far_it_came(name) -> None:
    key = {"daqp": "iter_limit", "scs": "max_iters", "qoco": "max_iters"}.get(name, "max_iter")
    call = called(name)
    answer = call.Session(call.layout(mixed(*ONE)), **{key: 1}).solve()
    assert (answer.status, answer.iterations) == ("failed", 1)
    assert answer.x.size == mixed(*ONE).q.size
    assert answer.duals.size == mixed(*ONE).b.size


@pytest.mark.parametrize("name", SOLVERS)
def test_programs_with_rows_of_one_kind_and_without(name) -> None:
    call = called(name)
    free = call.Session(call.layout(program([[2]], [1], [], []))).solve()
    np.testing.assert_allclose(free.x, [-0.5], atol=1e-5)
    assert free.duals.shape == (0,)
    for block, b, x, z in ((zero(1), 1, 1, -3), (nonnegative(1), -1, -1, 1), (nonnegative(1), 1, -0.5, 0)):
        answer = call.Session(call.layout(program([[2]], [1], [[1]], [b], block))).solve()
        np.testing.assert_allclose([*answer.x, *answer.duals], [x, z], atol=2e-3)
    if name != "quadprog":
        corner = program(np.zeros((2, 2)), [-1, -2], [[1, 1], [-1, 0], [0, -1]], [3, 0, 0], nonnegative(3))
        answer = call.Session(call.layout(corner)).solve()
        np.testing.assert_allclose(answer.duals, [2, 1, 0], atol=2e-3)


@pytest.mark.parametrize(
    "name", [name for name in ("qpalm", "osqp", "scs", "daqp", "proxqp") if name in SOLVERS]
)
def test_an_update_goes_on_from_the_last_answer(name) -> None:
    call = called(name)
    session = call.Session(call.layout(mixed(*ONE)))
    first = session.solve().iterations
    session.update(call.layout(mixed(*ONE)))
    assert session.solve().iterations < first


# -- forms, limits


CONES = program(
    [[2, 1], [1, 2]], [1, 2], np.arange(14).reshape(7, 2), np.arange(7),
    Block(Cone.SECOND_ORDER, 2), nonnegative(1), zero(1), Block(Cone.SECOND_ORDER, 2), nonnegative(1),
)  # fmt: skip


def test_bounds_of_rows() -> None:
    given = mixed(*ONE)
    for dense in (False, True):
        data = bounded(given, 7.0, dense=dense)
        assert data.lower.tolist() == [-7, 2, -7, -7]
        assert data.upper.tolist() == [*ONE]
        assert data.equal.tolist() == [False, True, False, False]
        assert [sparse.issparse(part) for part in (data.P, data.A)] == [not dense] * 2
    assert bounded(given).lower.tolist() == [-np.inf, 2, -np.inf, -np.inf]


def test_equations_apart_and_duals_together() -> None:
    given = mixed(*ONE)
    for dense in (False, True):
        data = split(given, dense=dense)
        assert [sparse.issparse(part) for part in (data.P, data.G, data.A)] == [not dense] * 3
        assert (data.h.tolist(), data.b.tolist()) == ([0.5, 0.3, 9], [2])
    assert not np.shares_memory(split(given).P.data, given.P.data)
    assert data.joined([1, 2, 3], [4]).tolist() == [1, 4, 2, 3]
    np.testing.assert_array_equal(data.joined(None, [4]), [np.nan, 4, np.nan, np.nan])
    np.testing.assert_array_equal(data.joined([1, 2, 3], None), [1, np.nan, 2, 3])
    for of, parts in ((zero(1), (None, [2])), (nonnegative(1), ([2], None))):
        assert split(program([[1]], [1], [[1]], [1], of)).joined(*parts).tolist() == [2]


def test_rows_in_the_order_of_cones() -> None:
    data = ordered(CONES)
    assert data.order.tolist() == [3, 2, 6, 0, 1, 4, 5]
    assert (data.zeros, data.non_negatives, data.sizes) == (1, 2, [2, 2])
    assert data.b.tolist() == data.order.tolist()
    assert data.A.toarray()[:, 0].tolist() == [2 * k for k in data.order]
    assert data.P.toarray().tolist() == [[2, 1], [0, 2]]
    assert data.restored(data.b).tolist() == [*range(7)]
    assert ordered(program([[1]], [1], [], [])).order.tolist() == []


def test_what_is_left_of_a_limit(monkeypatch) -> None:
    now = [100.0]
    monkeypatch.setattr(deadline, "monotonic", lambda: now[0])
    limit, none = deadline.Deadline(2.0), deadline.Deadline(None)
    for then, left, over in (
        (100.0, 2.0, False),
        (101.5, 0.5, False),
        (102.0, 1e-9, True),
        (103.0, 1e-9, True),
    ):
        now[0] = then
        assert (limit.left, limit.is_over) == (left, over)
        assert (none.left, none.is_over) == (None, False)

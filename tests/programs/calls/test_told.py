"""What every solver is told, and what is made of what it says: by solvers that only listen."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy import sparse
from test_sessions import FALLS, NONE, ONE, ONE_X, SOLVERS, TWO, called, clocked, mixed

from programs_by_hand import nonnegative, program, zero
from regrasp.programs import Block, Cone

pytestmark = pytest.mark.contract


def needs(*names):
    return pytest.mark.skipif(not {*names} <= {*SOLVERS}, reason=f"needs {names}")


@needs("clarabel")
def test_clarabel_is_silent_on_one_thread_and_takes_cones(monkeypatch) -> None:
    call, kept = called("clarabel"), []
    monkeypatch.setattr(call.clarabel, "DefaultSolver", lambda *given: kept.append(given))
    ball = program(
        np.eye(2), [-3, 0], [[0, 0], [-1, 0], [0, -1], [0, 0], [1, 0], [0, 1], [1, 1], [0, 1]], np.ones(8),
        Block(Cone.SECOND_ORDER, 3, 2), zero(1), nonnegative(1),
    )  # fmt: skip
    call.Session(call.layout(ball), max_iter=7)
    *_, cones, settings = kept[0]
    assert (settings.verbose, settings.max_threads, settings.max_iter) == (False, 1, 7)
    assert [type(cone).__name__ for cone in cones] == [
        "SecondOrderConeT", "SecondOrderConeT", "ZeroConeT", "NonnegativeConeT",
    ]  # fmt: skip


@needs("daqp")
def test_what_daqp_is_told_and_says(monkeypatch) -> None:
    """Its flags by its manual; 5 marks an equation, 1e30 no bound; what is refused is set up again."""
    call, heard, flags = called("daqp"), [], iter(())
    said = {
        2: ("failed", "soft optimal"), 1: ("found", "optimal"), -1: ("infeasible", "infeasible"),
        -2: ("failed", "cycling"), -3: ("unbounded", "unbounded"), -4: ("failed", "iteration limit"),
        -5: ("failed", "non-convex"), -6: ("failed", "initial set not independent"),
        -7: ("failed", "time limit"), 3: ("failed", "exit flag 3"), 4: ("failed", "exit flag 4"),
        -8: ("failed", "exit flag -8"),
    }  # fmt: skip

    class Model:
        def setup(self, *given):
            heard.append(("setup", given[-1].tolist(), given[-2].tolist()))
            return next(flags), 0.0

        def update(self, **given):
            heard.append(("update", sorted(given)))
            return next(flags)

        def solve(self):
            return np.ones(3), 0.0, next(flags), {"lam": np.zeros(4), "iterations": 5}

    monkeypatch.setattr(call.daqp, "Model", Model)
    data = call.layout(mixed(*ONE))
    for flag, (status, words) in said.items():
        flags = iter((0, flag))  # nothing to complain of
        answer = call.Session(data).solve()
        assert (answer.status, answer.said, answer.iterations) == (status, words, 5)
        assert answer.x.tolist() == [1.0] * 3
        assert (answer.duals is None) is (status == "infeasible")
    assert heard[0] == ("setup", [0, 5, 0, 0], [-1e30, 2, -1e30, -1e30])
    for refused, then in ((-5, "setup"), (0, "update"), (1, "update")):
        flags = iter((refused, -1, 1))
        session = call.Session(data)
        session.update(data)
        assert heard[-1][0] == then
        refusal = session.solve()
        assert (refusal.status, refusal.said, refusal.solve_time) == ("infeasible", "infeasible", 0.0)
        assert refusal.iterations is None


@needs("highs")
def test_what_highs_is_told_and_says() -> None:
    call = called("highs")
    lp, qp = (call.layout(of) for of in (program(np.zeros((1, 1)), [1], [[1]], [2], zero(1)), mixed(*ONE)))
    assert (lp.model.hessian_.dim_, qp.model.hessian_.dim_) == (0, 3)
    session = call.Session(lp)
    told = [session._solver.getOptionValue(key)[1] for key in ("output_flag", "threads")]
    assert told == [False, 1]
    with pytest.raises(Exception, match="HiGHS does not take speed = 3"):
        call.Session(lp, speed=3)
    right = session._solver
    for flags, claim, found, (x, z) in (
        ("kInfeasible", "infeasible", (True, True), (None, -2)),
        ("kInfeasible", "infeasible", (False, True), (None, None)),
        ("kUnbounded", "unbounded", (True, True), (3, None)),
        ("kUnbounded", "unbounded", (True, False), (None, None)),
        ("kUnboundedOrInfeasible", "infeasible", (True, True), (None, -2)),
        ("kUnboundedOrInfeasible", "unbounded", (False, True), (3, None)),
        ("kUnboundedOrInfeasible", "failed", (False, False), (None, None)),
        ("kTimeLimit", "failed", (True, True), (None, None)),
        ("kOptimal", "found", (True, True), (4, -5)),
    ):
        session._solver = SimpleNamespace(
            run=lambda: None,
            getModelStatus=lambda flags=flags: SimpleNamespace(name=flags),
            getSolution=lambda: SimpleNamespace(col_value=[4.0], row_dual=[5.0]),
            getDualRay=lambda found=found: (0, found[0], [2.0]),
            getPrimalRay=lambda found=found: (0, found[1], [3.0]),
            getInfo=lambda: SimpleNamespace(
                qp_iteration_count=-1, simplex_iteration_count=7, ipm_iteration_count=2
            ),
        )
        answer = session.solve()
        assert (answer.status, answer.said, answer.iterations) == (claim, flags, 9)
        assert answer.x is x or answer.x.tolist() == [x]
        assert answer.duals is z or answer.duals.tolist() == [z]
    assert right.getModelStatus().name == "kNotset"


@needs("piqp", "proxqp")
@pytest.mark.parametrize(("more", "dense"), [(13, True), (14, False)])
@pytest.mark.parametrize("name", ["piqp", "proxqp"])
def test_few_unknowns_are_dense_ones(name, more, dense) -> None:
    call = called(name)
    data = call.layout(mixed(*ONE, more=more))
    assert [sparse.issparse(part) for part in (data.P, data.G, data.A)] == [not dense] * 3
    session = call.Session(data)
    kinds = {
        "piqp": lambda: call.piqp.DenseSolver if dense else call.piqp.SparseSolver,
        "proxqp": lambda: (call.proxqp.dense if dense else call.proxqp.sparse).QP,
    }
    assert type(session._solver) is kinds[name]()
    assert session._solver.settings.verbose is False
    answer = session.solve()
    np.testing.assert_allclose(answer.x, [*ONE_X, *np.ones(more)], atol=2e-3)


@needs("osqp")
def test_osqp_is_told_to_be_silent(monkeypatch) -> None:
    call, kept = called("osqp"), []
    monkeypatch.setattr(call.osqp, "OSQP", lambda: SimpleNamespace(setup=lambda **given: kept.append(given)))
    call.Session(call.layout(mixed(*ONE)), max_iter=3)
    assert (kept[0]["verbose"], kept[0]["max_iter"]) == (False, 3)
    assert kept[0]["P"].toarray()[:2, :2].tolist() == [[2, 0.5], [0, 2]]


@needs("qpalm")
def test_qpalm_is_told_to_be_silent(monkeypatch) -> None:
    call, kept = called("qpalm"), []
    monkeypatch.setattr(call.qpalm, "Solver", lambda *given: kept.append(given))
    call.Session(call.layout(mixed(*ONE)), max_iter=3)
    assert (kept[0][1].verbose, kept[0][1].max_iter) == (False, 3)


@needs("scs")
def test_what_scs_is_told(monkeypatch) -> None:
    """It wants a row, and starts from its last answer only when it has one."""
    call, kept = called("scs"), []

    class Solver:
        def __init__(self, *given, **options) -> None:
            kept.append((*given, options))

        def update(self, b) -> None:
            kept.append(b.tolist())

        def solve(self, warm_start):
            kept.append(warm_start)
            return {"x": np.zeros(1), "y": np.zeros(1), "info": {"status": "solved", "iter": 1}}

    monkeypatch.setattr(call.scs, "SCS", Solver)
    free = call.layout(program([[2]], [1], [], []))
    session = call.Session(free, max_iters=3)
    given, cone, options = kept.pop()
    assert (cone, options) == ({"z": 0, "l": 1, "q": []}, {"verbose": False, "max_iters": 3})
    assert given["A"].toarray().tolist() == [[0]]
    assert (given["b"].tolist(), given["c"].tolist(), given["P"].toarray().tolist()) == ([1], [1], [[2]])
    assert session.solve().duals.shape == (0,)
    session = call.Session(call.layout(program([[2]], [1], [[1]], [5], zero(1))))
    session.solve()
    session.update(call.layout(program([[2]], [1], [[1]], [6], zero(1))))
    session.solve()
    given, cone, _ = kept[1]
    assert (cone, given["b"].tolist()) == ({"z": 1, "l": 0, "q": []}, [5])
    assert [kept[0], *kept[2:]] == [False, False, [6], True]


@needs("qoco")
def test_what_qoco_is_told(monkeypatch) -> None:
    call, kept = called("qoco"), []
    solver = SimpleNamespace(
        setup=lambda *given, **options: kept.append((given, options)),
        update_vector_data=lambda **given: kept.append(given),
    )
    monkeypatch.setattr(call.qoco, "QOCO", lambda: solver)
    session = call.Session(call.layout(mixed(*ONE)), max_iters=3)
    (n, m, p, P, q, A, b, G, h, count, cones, sizes), options = kept[0]
    assert (n, m, p, count, cones, sizes.tolist(), options) == (3, 3, 1, 3, 0, [], {"max_iters": 3})
    assert (P.toarray()[:2, :2].tolist(), q.tolist()) == ([[2, 0.5], [0, 2]], [-3, -1, -1])
    assert (A.toarray().tolist(), b.tolist()) == ([[0, 1, 1]], [2])
    assert (G.toarray().tolist(), h.tolist()) == ([[1, 0, 0], [0, 1, 0], [1, 1, 0]], [0.5, 0.3, 9])
    session.update(call.layout(mixed(*TWO)))
    assert {key: value.tolist() for key, value in kept[1].items()} == {"b": [1], "h": [0.25, 0.3, 9]}
    for block, there in ((zero(1), (True, False)), (nonnegative(1), (False, True))):
        call.Session(call.layout(program([[0]], [1], [[1]], [2], block)))
        given, _ = kept.pop()
        assert given[3] is None
        assert (given[5] is not None, given[7] is not None) == there


@needs("quadprog")
def test_what_quadprog_is_told_and_counts(monkeypatch) -> None:
    call = called("quadprog")
    clocked(call, monkeypatch)
    session = call.Session(call.layout(mixed(*ONE)))
    assert session.solve().iterations == 4
    for given, status in ((NONE, "infeasible"), (FALLS, "refused")):
        answer = call.Session(call.layout(given)).solve()
        assert answer.status == status
        assert answer.solve_time in (4, 16)
    # A triangle's inverse is taken for the factor that it is said to be: 1/2 x'P x with P = 4.
    given = program([[0.5]], [1], [], [])
    assert call.Session(call.layout(given), factorized=True).solve().x == pytest.approx([-0.25])

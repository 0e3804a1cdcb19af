"""What a solver does besides answering: errors of its own, crashes, endless work. Programs in files."""

import sys
import time
import types

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import sparse

from processes import is_running
from regrasp.errors import InvalidInput, SolverFailed
from regrasp.programs import (
    Block,
    Cone,
    Program,
    Solution,
    Status,
    available_backends,
    qp_backend,
    solve,
)
from regrasp.programs import backends as table
from regrasp.programs.answer import Answer
from regrasp.programs.calls import deadline
from regrasp.programs.facts import BACKENDS, Backend
from regrasp.programs.solution import failed as failed_answer

pytestmark = pytest.mark.contract


def least_square():
    return Program(
        sparse.csc_matrix([[2.0]]), np.array([1.0]), sparse.csc_matrix([[1.0]]), np.array([5.0]),
        (Block(Cone.NONNEGATIVE, 1),),
    )  # fmt: skip


MODULE = """
import os, signal, time
def solve(program, name, **options):
    if name == "raises":
        raise RuntimeError("my own trouble")
    if name == "panics":
        raise BaseException("a panic")
    if name == "crashes":
        os.kill(os.getpid(), signal.SIGSEGV)
    if name == "leaves":
        os._exit(3)
    if name == "breeds":
        child = os.fork()
        if child == 0:
            time.sleep(600)
        with open(__file__ + ".pid", "w") as file:
            file.write(str(child))
        os._exit(4)
    time.sleep(600)
"""


@pytest.fixture
def odd(tmp_path, monkeypatch):
    """Back ends that fail, each in its way, in this process and in others."""
    (tmp_path / "odd_backend.py").write_text(MODULE)
    monkeypatch.syspath_prepend(str(tmp_path))
    for name in ("raises", "panics", "crashes", "leaves", "breeds", "hangs"):
        monkeypatch.setitem(BACKENDS, name, Backend("numpy", "odd_backend", True, 1e-7))
    # Another process knows the back ends of the house only: it gets these by a module that adds them.
    lines = "from regrasp.programs.facts import BACKENDS, Backend\n" + "".join(
        f'BACKENDS["{name}"] = Backend("numpy", "odd_backend", True, 1e-7)\n'
        for name in ("raises", "crashes", "leaves", "breeds", "hangs")
    )
    (tmp_path / "sitecustomize.py").write_text(lines)
    monkeypatch.setenv("PYTHONPATH", f"{tmp_path}:{':'.join(sys.path)}")


@pytest.mark.parametrize(
    ("name", "words"), [("raises", "RuntimeError: my own trouble"), ("panics", "a panic")]
)
def test_an_error_of_the_solvers_own_names_program_and_solver(odd, name, words):
    with pytest.raises(SolverFailed, match=words) as failed:
        solve(least_square(), name)
    assert "program of 1 unknowns, rows 1 non-negative" in str(failed.value)
    assert f"{name}: FAILED" in str(failed.value)
    assert failed.value.solution.status is Status.FAILED
    assert failed.value.program.b.tolist() == [5.0]
    assert np.isnan(failed.value.solution.value).all()


def test_what_ends_the_program_goes_through(monkeypatch):
    for stops in (KeyboardInterrupt, SystemExit):

        def solver(program, name, stops=stops, **options):
            raise stops

        monkeypatch.setattr(
            table, "import_module", lambda _, solver=solver: types.SimpleNamespace(solve=solver)
        )
        with pytest.raises(stops):
            solve(least_square(), "clarabel")


@pytest.mark.parametrize(
    ("name", "words"),
    [("crashes", "was ended by SIGSEGV"), ("leaves", "was ended with exit status 3"), ("raises", "my own")],
)
def test_a_crash_apart_is_an_error_like_others(odd, name, words):
    with pytest.raises(SolverFailed, match=words) as failed:
        solve(least_square(), name, isolated=True)
    assert failed.value.solution.status is Status.FAILED


def test_what_a_solver_started_ends_with_it(odd, tmp_path):
    started = time.monotonic()
    with pytest.raises(SolverFailed, match="exit status 4"):
        solve(least_square(), "breeds", isolated=True)
    assert time.monotonic() - started < 60  # its child sleeps for ten minutes
    child = int((tmp_path / "odd_backend.py.pid").read_text())
    for _ in range(100):
        if not is_running(child):
            return
        time.sleep(0.05)
    pytest.fail("its child lives on")


def test_a_solver_without_a_limit_of_its_own_is_ended(odd):
    with pytest.raises(SolverFailed, match=r"hangs: FAILED \(no answer within 0.5 s\)"):
        solve(least_square(), "hangs", time_limit=0.5)


@pytest.mark.parametrize("backend", ["auto", *(name for name in available_backends() if name != "cvxpy")])
def test_every_back_end_takes_a_time_limit(backend):
    answer = solve(least_square(), backend, time_limit=20.0)
    assert answer.objective == pytest.approx(-0.25, abs=1e-6)


def test_limits_reach_solvers_that_have_an_option(monkeypatch):
    """A limit that is over at once ends Clarabel before it is done."""
    n = 120
    rng = np.random.default_rng(0)
    root = rng.normal(size=(n, n))
    p = Program(
        sparse.csc_matrix(root @ root.T), rng.normal(size=n), sparse.identity(n, format="csc"), np.ones(n),
        (Block(Cone.NONNEGATIVE, 1, n),),
    )  # fmt: skip
    with pytest.raises(SolverFailed, match="clarabel: STOPPED"):
        solve(p, "clarabel", time_limit=1e-9)
    assert solve(p, "clarabel", time_limit=60.0).status is Status.SOLVED


class Clock:
    """A clock that stands still but for what is told to take time, and what limits it was asked with."""

    def __init__(self, monkeypatch) -> None:
        self.now, self.limits = 0.0, []
        monkeypatch.setattr(deadline, "monotonic", lambda: self.now)

    def ask(self, limit) -> None:
        self.now += 1.0
        self.limits.append(limit)


def test_a_limit_is_for_all_back_ends_together(monkeypatch):
    clock = Clock(monkeypatch)

    def solver(program, name, **options):
        clock.ask(options[BACKENDS[name].time_limit])
        return failed_answer(program, name, "too hard")

    monkeypatch.setattr(table, "_AUTO", ("clarabel", "daqp", "osqp", "scs"))
    monkeypatch.setattr(table, "import_module", lambda _: types.SimpleNamespace(solve=solver))
    far = Program(
        sparse.csc_matrix([[2.0]]), np.ones(1), sparse.csc_matrix([[1.0], [1.0]]), np.array([1.0, 1e9]),
        (Block(Cone.NONNEGATIVE, 1, 2),),
    )  # fmt: skip
    for limit, asked in ((2.5, 3), (3.0, 3), (3.5, 4), (5.5, 6)):  # without the far bound the first once more
        clock.limits.clear()
        with pytest.raises(SolverFailed):
            solve(far, time_limit=limit)
        assert clock.limits == [limit - k for k in range(asked)]


def test_a_limit_is_for_the_question_of_a_point_too(monkeypatch):
    clock = Clock(monkeypatch)

    def solver(program, name, **options):
        clock.ask(options["time_limit"])
        falls = np.array([1.0]), np.full(2, np.nan)
        return Solution(program, name, Status.UNBOUNDED, *falls, 1, 0.0, 0.0, "falls")

    monkeypatch.setattr(table, "import_module", lambda _: types.SimpleNamespace(solve=solver))
    falling = Program(
        sparse.csc_matrix((1, 1)), -np.ones(1), sparse.csc_matrix([[-1.0], [-1.0]]), np.array([-1.0, 0.0]),
        (Block(Cone.NONNEGATIVE, 1, 2),),
    )  # fmt: skip
    for limit, limits in ((1.0, [1.0]), (1.5, [1.5, 0.5])):
        clock.limits.clear()
        answer = solve(falling, "clarabel", throw=False, time_limit=limit)
        assert answer.status is Status.UNBOUNDED_OR_INFEASIBLE
        assert clock.limits == limits


def test_a_limit_is_for_all_proximal_steps_together(monkeypatch):
    clock = Clock(monkeypatch)

    class Session:
        def __init__(self, data, **options) -> None:
            clock.ask(options["time_limit"])

        def solve(self):
            return Answer("found", np.array([-clock.now]), np.zeros(0))

    steps = types.SimpleNamespace(layout=lambda program: program, Session=Session)
    monkeypatch.setattr(qp_backend, "import_module", lambda _: steps)
    none = sparse.csc_matrix((1, 1)), np.ones(1), sparse.csc_matrix((0, 1)), np.zeros(0), ()
    solve(Program(*none), "daqp", throw=False, time_limit=100.0)
    assert clock.limits == [100.0 - k for k in range(27)]


@pytest.mark.parametrize("limit", [0, -1.0, np.inf, np.nan])
def test_a_limit_that_is_none_is_refused(limit):
    with pytest.raises(InvalidInput, match="time_limit must be a positive number of seconds or None"):
        solve(least_square(), "clarabel", time_limit=limit)


def test_apart_or_not_the_answer_is_the_same():
    here, there = (solve(least_square(), "daqp", isolated=apart) for apart in (False, True))
    assert here.value.tolist() == there.value.tolist()
    assert there.program.b.tolist() == [5.0]
    with pytest.raises(InvalidInput, match="Clarabel has no setting 'speed'"):
        solve(least_square(), "clarabel", isolated=True, speed=3)


@pytest.mark.parametrize("backend", ["auto", *available_backends(), "cvxpy:CVXOPT", "cvxpy:SCS"])
def test_a_right_side_of_1e30_is_answered_or_a_failure_with_its_program(backend):
    p = Program(
        sparse.csc_matrix([[2.0]]), np.array([1.0]), sparse.csc_matrix([[1.0]]), np.array([1e30]),
        (Block(Cone.NONNEGATIVE, 1),),
    )  # fmt: skip
    answer = solve(p, backend, throw=False)
    if answer.status is Status.SOLVED:
        assert answer.objective == pytest.approx(-0.25, abs=1e-6)
        return
    assert backend != "auto"
    with pytest.raises(SolverFailed, match=r"^program of 1 unknowns, rows 1 non-negative: ") as failed:
        solve(p, backend)
    assert failed.value.program is p


# -- files -------------------------------------------------------------------------------------------------


@given(st.integers(0, 10_000))
@settings(max_examples=20, deadline=None)
def test_a_program_is_saved_and_loaded_in_a_line_each(tmp_path_factory, seed):
    rng = np.random.default_rng(seed)
    n, k = int(rng.integers(1, 5)), int(rng.integers(0, 3))
    blocks = (Block(Cone.ZERO, 1, 2), Block(Cone.NONNEGATIVE, 1), Block(Cone.SECOND_ORDER, 3, k))[: 2 + k]
    m = sum(block.rows for block in blocks)
    A = sparse.random(m, n, 0.6, format="csc", random_state=seed)
    p = Program(sparse.identity(n, format="csc"), rng.normal(size=n), A, rng.normal(size=m), blocks, 0.5)
    again = Program.load(p.save(tmp_path_factory.mktemp("programs") / "p.npz"))
    assert again.blocks == p.blocks
    assert again.size == 0.5
    for one, other in ((p.P, again.P), (p.A, again.A)):
        assert (one != other).nnz == 0
    for one, other in ((p.q, again.q), (p.b, again.b)):
        assert one.tolist() == other.tolist()


def test_a_failure_keeps_its_program(tmp_path):
    with pytest.raises(SolverFailed) as failed:
        solve(least_square(), "clarabel", max_iter=1)
    path = failed.value.program.save(str(tmp_path / "failed.npz"))
    assert solve(Program.load(path)).objective == pytest.approx(-0.25)


def test_files_that_hold_no_program_are_refused(tmp_path):
    path = least_square().save(tmp_path / "p.npz")
    whole = path.read_bytes()
    for content in (b"", b"nothing", whole[: len(whole) // 2]):
        path.write_bytes(content)
        with pytest.raises(InvalidInput, match=r"p\.npz"):
            Program.load(path)
    with pytest.raises(InvalidInput, match=r"gone\.npz"):
        Program.load(tmp_path / "gone.npz")
    parts = {"q": np.zeros(1), "b": np.zeros(1), "size": np.zeros(()), "cones": np.array([[1, 1, 1]])}
    for name in "PA":
        parts |= {
            f"{name}_data": np.ones(1),
            f"{name}_indices": np.zeros(1, int),
            f"{name}_indptr": np.array([0, 1]),
        }
    wrong = {
        "expected the arrays": {"more": np.zeros(1)},
        "not the matrices": {"A_indices": np.array([7])},
        "not the cones": {"cones": np.array([[5, 1, 1]])},
        "must be finite": {"q": np.array([np.nan])},
        "cones must cover": {"cones": np.array([[1, 1, 2]])},
    }
    for words, change in wrong.items():
        np.savez(path, **(parts | change))
        with pytest.raises(InvalidInput, match=words):
            Program.load(path)
    np.savez(path, **(parts | {"q": np.array(["x"])}))
    with pytest.raises(InvalidInput, match="not the matrices"):
        Program.load(path)

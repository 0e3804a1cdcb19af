"""Answers spoilt on their way, and solvers that end in every other way: right, or a failure in a line."""

import threading
import types
import warnings
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy import sparse

from known_programs import Known, is_a_lie, known
from regrasp.errors import InvalidInput, RegraspError, SolverFailed
from regrasp.programs import Block, Cone, Program, Status, available_backends, child, solve
from regrasp.programs import backends as table
from regrasp.programs.answer import given_numbers
from regrasp.programs.cones import Cones
from regrasp.programs.solution import Solution

pytestmark = pytest.mark.contract

ONE = sparse.csc_matrix([[1.0]])
LINE = Program(ONE, np.ones(1), ONE, np.ones(1), (Block(Cone.NONNEGATIVE, 1),))


def solver(monkeypatch, called: Callable[..., object]) -> None:
    """The back end is ``called``."""
    monkeypatch.setattr(table, "import_module", lambda _: types.SimpleNamespace(solve=called))


class Own(np.ndarray):
    """A solver's own kind of array."""


RNG = np.random.default_rng(0)


def one(value: Callable[[float], float]) -> Callable[[np.ndarray], np.ndarray]:
    """One of the numbers is another."""

    def spoil(v: np.ndarray) -> np.ndarray:
        v = v.copy()
        v[RNG.integers(v.size)] = value(v[0])
        return v

    return spoil


NUMBERS = [
    *(lambda v, e=e: v * (1 + e * RNG.normal(size=v.size)) for e in (1e-12, 1e-9, 1e-6, 1e-3)),
    *(lambda v, e=e: v + e * abs(v).max() * RNG.normal(size=v.size) for e in (1e-12, 1e-9, 1e-6, 1e-3)),
    *map(one, (lambda x: -x, lambda x: 2 * x, lambda x: 0.0, lambda x: np.nan, lambda x: np.inf)),
    lambda v: 0 * v, lambda v: np.nan * v, lambda v: -v, lambda v: 1e200 * v, lambda v: 1e-200 * v,
    lambda v: RNG.permutation(v), lambda v: v.astype(np.float32), lambda v: v.view(Own),
    lambda v: v.astype(">f8"), lambda v: np.repeat(v, 2)[::2], lambda v: np.ma.masked_array(v, mask=True),
    list, lambda v: None,
]  # fmt: skip
NONE_AT_ALL = [
    lambda v: v[:-1], lambda v: np.append(v, 1.0), lambda v: v[:, None], lambda v: v[None], lambda v: 1.0,
    lambda v: v + 1j, lambda v: np.array(["1"] * v.size), lambda v: v.astype(object), lambda v: v > 0,
    lambda v: "x", lambda v: object(), lambda v: [[1.0], [2.0, 3.0]], lambda v: v[:0], lambda v: {},
]  # fmt: skip
CLAIMS = [None, None, None, Status.SOLVED, Status.INFEASIBLE, Status.UNBOUNDED, Status.STOPPED]


@pytest.mark.parametrize("backend", available_backends())
def test_what_is_nearly_right_is_made_right_or_refused(backend, monkeypatch) -> None:
    """Certificates, points and claims of programs of known truth, solvable and not, each spoilt somehow."""
    real, entry = table.asked, table.BACKENDS[backend]
    RNG.bit_generator.state = np.random.default_rng(len(backend)).bit_generator.state

    def asked(*given):
        answer = real(*given)
        kinds = [NUMBERS[k] for k in RNG.integers(len(NUMBERS), size=2)]
        value, duals = (kind(v) for kind, v in zip(kinds, (answer.value, answer.duals), strict=True))
        status = CLAIMS[RNG.integers(len(CLAIMS))] or answer.status
        spoilt = replace(answer, value=value, duals=duals, status=status)
        return replace(spoilt, **{k: given_numbers(getattr(spoilt, k), v.size) for k, v in sides(answer)})

    def sides(answer):
        return ("value", answer.value), ("duals", answer.duals)

    monkeypatch.setattr(table, "asked", asked)
    seeds = [seed for seed in range(5000, 5090) if entry.second_order or not hard(seed)]
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        for seed in seeds[: 6 if backend in ("cvxpy", "proxqp", "scs") else 16]:
            case = known(seed)
            answer = solve(case.program, backend, throw=False)
            assert not is_a_lie(case, answer) or is_near(case, answer), (seed, str(answer))
            assert "\n" not in str(answer)


def is_near(case: Known, answer: Solution) -> bool:
    """Whether a point that is called a solution misses by little beside the largest numbers there are."""
    A, b, P, q = case.plain
    x = case.units * answer.value
    if answer.status is not Status.SOLVED or case.truth is Status.UNBOUNDED:
        return False
    size = float(max((abs(A) @ abs(x)).max(initial=0.0), abs(b).max(initial=0.0)))
    outside = Cones(case.program.blocks).excess(b - A @ x)
    off, terms = abs(x @ P @ x / 2 + q @ x - case.optimum), abs(x) @ abs(P) @ abs(x) + abs(q).max() * size
    return bool((outside <= 1e-5 * size).all() and (case.truth is Status.INFEASIBLE or off <= 1e-5 * terms))


def hard(seed: int) -> bool:
    return bool(known(seed).program.has_second_order)


@pytest.mark.parametrize("spoil", NONE_AT_ALL)
def test_what_is_no_list_of_so_many_numbers_is_a_failure(spoil, monkeypatch) -> None:
    right = solve(LINE, "clarabel")
    for name in "value", "duals":
        spoilt = replace(right, **{name: spoil(getattr(right, name))})
        solver(monkeypatch, lambda *_, spoilt=spoilt, **__: spoilt)
        with pytest.raises(SolverFailed, match=r"^program of 1 unknowns, .*: clarabel: FAILED \(") as raised:
            solve(LINE, "clarabel")
        assert "\n" not in str(raised.value)
    for nothing in None, "solved", 3:
        solver(monkeypatch, lambda *_, nothing=nothing, **__: nothing)
        assert solve(LINE, "clarabel", throw=False).status is Status.FAILED


def test_numbers_are_copied_and_plain() -> None:
    held = np.ones(2).view(Own)
    for given in (
        held,
        np.ones(2, np.float32),
        np.ones(2, int),
        [1, 1],
        (1.0, 1),
        np.ma.masked_array(held, mask=True),
    ):
        found = given_numbers(given, 2)
        assert (type(found), found.dtype, found.tolist()) == (np.ndarray, np.dtype(float), [1, 1])
        assert found.flags.writeable
        assert not np.shares_memory(found, held)
    assert np.isnan(given_numbers(None, 3)).tolist() == [True] * 3


class Speechless(Exception):
    def __str__(self) -> str:
        raise RuntimeError("no words")


class Panic(BaseException):
    pass


ERRORS = [
    ValueError("not\nso"), MemoryError(), RuntimeError("x" * 9999), ArithmeticError("1/0"),
    KeyError("k"), StopIteration(), UserWarning("careful"), RecursionError(), Panic("\n\n"), Speechless(),
    np.linalg.LinAlgError("singular"), OSError(28, "full"), AssertionError(),
    UnicodeDecodeError("utf8", b"\xff", 0, 1, "bad"),
]  # fmt: skip


@pytest.mark.parametrize("error", ERRORS, ids=lambda error: type(error).__name__)
@pytest.mark.parametrize("backend", ["clarabel", "daqp", "auto"])
def test_whatever_a_solver_raises_is_its_failure_in_a_line(error, backend, monkeypatch) -> None:
    def called(*_, **__):
        raise error

    solver(monkeypatch, called)
    with pytest.raises(SolverFailed) as raised:
        solve(LINE, backend)
    said = str(raised.value)
    assert said.startswith("program of 1 unknowns, rows 1 non-negative: ")
    assert f"FAILED ({type(error).__name__}" in said
    assert "\n" not in said
    assert len(said) < 600


def test_a_crash_is_a_failure_whatever_its_end_is_called(tmp_path, monkeypatch) -> None:
    """In a process of its own, whose words we hear; all at once, as each takes a second to start."""
    ends = [
        ("os.abort()", "by SIGABRT"),
        ("os.kill(os.getpid(), 9)", "by SIGKILL"),
        ("os._exit(0)", "with exit status 0"),
        ("sys.exit(7)", "with exit status 7"),
        ("return 3", "AttributeError"),
        ("os.write(json.loads(sys.argv[1])[1], b'\\0\\0\\0\\3abc'); signal.pause()", "none that can be read"),
        ("signal.signal(15, signal.SIG_IGN); signal.pause()", "no answer within 0.5 s"),
        ("os.kill(os.getpid(), signal.SIGSTOP)", "no answer within 0.5 s"),
    ]
    lines = ["import json, os, signal, sys", "def solve(program, name, **options):", "    k = int(name)"]
    lines += [f"    if k == {k}:\n        {end}" for k, (end, _) in enumerate(ends)]
    (tmp_path / "ending.py").write_text("\n".join(lines) + "\n")
    lines = ["from regrasp.programs.facts import BACKENDS, Backend"]
    lines += [f"BACKENDS['{k}'] = Backend('numpy', 'ending', True, 1e-7)" for k in range(len(ends))]
    (tmp_path / "sitecustomize.py").write_text("\n".join(lines) + "\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setenv("PYTHONPATH", f"{tmp_path}:{':'.join(child.sys.path)}")
    found: dict[int, Solution] = {}

    def apart(k: int, limit: float) -> None:
        found[k] = child.solved_apart(LINE, str(k), limit, {})

    threads = [
        threading.Thread(target=apart, args=(k, 0.5 if "0.5 s" in words else 30.0))
        for k, (_, words) in enumerate(ends)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for k, (end, words) in enumerate(ends):
        assert found[k].status is Status.FAILED
        assert words in found[k].said, (end, found[k].said)


def test_options_that_cannot_be_handed_on_are_refused() -> None:
    with pytest.raises(InvalidInput, match="options for another process must be plain values"):
        solve(LINE, "clarabel", isolated=True, speed=lambda: 3)


ODD = [None, "yes", 1, 0.0, [], object(), np.ones(2), {"a": 1}]


@pytest.mark.parametrize("odd", ODD, ids=lambda odd: type(odd).__name__)
def test_words_of_other_kinds_are_refused_in_a_line(odd) -> None:
    for given in (
        {"throw": odd}, {"isolated": odd}, {"program": odd}, {"backend": odd},
        {"time_limit": True if odd is None or odd is ODD[2] else odd},
    ):  # fmt: skip
        with pytest.raises(RegraspError) as raised:
            solve(**{"program": LINE, "backend": "clarabel", **given})
        assert "\n" not in str(raised.value)
    assert solve(LINE, "clarabel", throw=np.True_, time_limit=np.float64(9)).status is Status.SOLVED


@pytest.mark.skipif("scs" not in available_backends(), reason="scs is not installed")
@pytest.mark.parametrize("seed", [1821, 2057])
def test_where_scs_stopped_is_no_point_of_a_program_that_hardly_lacks_one(seed) -> None:
    """Rows contradict each other by 1e-7 and 1e-5 of their sides: one was solved, the other unbounded."""
    case = known(seed)
    answer = solve(case.program, "scs", throw=False)
    assert not is_a_lie(case, answer)

"""Hundreds of the hostile problems of ``benchmarks/truth/million.py``: nothing wrong, nothing that hangs."""

from collections import Counter

import numpy as np
import pytest

import million
from exact_judge import is_escape, is_held, state_faults
from hostile import problem

pytestmark = pytest.mark.oracle

FIRST = 5_000_000
"""Other problems than the benchmark's."""


@pytest.mark.parametrize("part", range(5))
def test_no_answer_is_wrong(part: int) -> None:
    words: Counter[str] = Counter()
    for seed in range(FIRST + 50 * part, FIRST + 50 * part + 50):
        for verb, word in million.answers(seed):
            assert not word.startswith(million.WRONG), (seed, verb, word)
            assert not word.startswith("invalid"), (seed, verb, word)
            words[word] += 1
    assert words["refused though held"] == 0
    assert words["solver failed"] <= 2
    assert min(words["held"], words["verified"], words["proven"]) > 10


def test_chunks_are_kept_and_told(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(million, "CHUNK", 2)
    monkeypatch.setattr(million, "warm", lambda: None)
    million.run(3, tmp_path)
    first = (tmp_path / "00000000.json").stat().st_mtime_ns
    million.run(4, tmp_path)
    assert (tmp_path / "00000000.json").stat().st_mtime_ns == first  # done before
    assert sorted(p.name for p in tmp_path.iterdir()) == ["00000000.json", "00000002.json"]
    assert "choose_state" in million.table(tmp_path)


def test_the_judge_tells_right_from_wrong() -> None:
    """A weight on two supports: a pull, a slip, a limit, an imbalance; motions that prove and do not."""
    r, n, mu = np.array([[-1.0, 0], [1, 0]]), np.array([[0.0, 1], [0, 1]]), np.array([0.5, 0.5])
    none, load = np.full(2, np.inf), np.array([0.0, -1, 0])
    half, sideways = np.array([[0, 0.5], [0, 0.5]]), np.array([[1.0, 0], [-1, 0]])
    assert state_faults(r, n, mu, none, load, half) == []
    assert state_faults(r, n, mu, none, load, half * (1 + 2e-11)) == ["not in equilibrium"]
    assert state_faults(r, n, mu, none, load, half + 0.25 * sideways) == []
    slips = state_faults(r, n, mu, none, load, half + (0.25 + 1e-12) * sideways)
    assert slips == ["0 is outside its cone", "1 is outside its cone"]
    assert state_faults(r, n, mu, np.array([0.5, 0.4999]), load, half) == ["1 is above its limit"]
    assert state_faults(r, n, mu, none, np.array([0.0, 0, 2]), [1, -1] * np.array([[0, -1.0], [0, -1]]).T)
    assert is_held(r, n, mu, np.array([0.0, -1, 1]))
    assert not is_held(r, n, mu, np.array([0.0, -1, 1 + 1e-15]))
    assert not is_held(r, n, mu, np.array([0.5 + 1e-15, -1, 0]))
    tip = np.array([0, 1.0, 1.0])  # about the left support, counter-clockwise
    assert is_escape(r, n, mu, none, np.array([0.0, -1, 1.1]), tip)
    assert not is_escape(r, n, mu, none, np.array([0.0, -1, 0.9]), tip)
    assert not is_escape(r, n, mu, none, np.array([0.0, -1, 1.1]), -tip)
    assert not is_escape(r, n, mu, none, np.array([0.0, -1, 1.1]), np.array([0.0, 0.9, 1.0]))
    assert is_escape(r, n, mu, np.array([0.4, 0.4]), load, np.array([0.0, -1, 0]))
    assert not is_escape(r, n, mu, np.array([0.6, 0.6]), load, np.array([0.0, -1, 0]))


def test_forces_of_a_billion_loads_hold_nothing() -> None:
    """Two supports that face each other but for a hair, and a pull across: only huge forces would do."""
    r, n, mu = np.array([[-1.0, 0], [1, 0]]), np.array([[1.0, 0], [-1, 0]]), np.array([0.5, 0.5])
    for hair, held in ((1e-7, True), (1e-11, False)):
        mu[:] = hair
        assert is_held(r, n, mu, np.array([0.0, -1, 0])) == held


def test_the_squeeze_of_a_load_next_to_none_is_not_nothing() -> None:
    """A level search without a load may be left with zero forces, which cannot be scaled to their limits."""
    words = dict(million.answers(20_000_126))
    assert words["choose_state"] == "held"
    assert words["plan_removal"] == words["plan_rotation"] == "verified"


@pytest.mark.parametrize("seed", [21_362, 23_010, 33_823, 41_356])
def test_a_solver_that_diverges_is_no_fault_of_the_answer(seed: int) -> None:
    """Answers of 1e200 overflowed in units, slopes and motions; one without any proof was a failure."""
    for verb, word in million.answers(seed):
        assert not word.startswith((*million.WRONG, "solver failed")), (verb, word)


def test_problems_are_the_same_every_time() -> None:
    for seed in (1, 2, 3):
        a, b = problem(seed), problem(seed)
        assert a.kind == b.kind
        assert (a.load == b.load).all()
        assert (a.positions == b.positions).all()

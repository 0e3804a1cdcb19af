"""A solver in a process of its own: how long it is waited for, and what is said of its end."""

import os
import pickle
import threading
from contextlib import contextmanager
from multiprocessing import Pipe
from threading import TIMEOUT_MAX, Event

import numpy as np
import pytest
from scipy import sparse

from regrasp.errors import InvalidInput
from regrasp.programs import Block, Cone, Program, Status, child, child_side
from regrasp.programs.solution import Solution

pytestmark = pytest.mark.contract

ONE = sparse.csc_matrix([[1.0]])
PROGRAM = Program(ONE, np.ones(1), ONE, np.ones(1), (Block(Cone.NONNEGATIVE, 1),))
ANSWER = Solution(PROGRAM, "there", Status.SOLVED, -np.ones(1), np.zeros(1), 3, 0.25, 0.5, "so")


class Process:
    """One that ended with this code, or lives if it has none."""

    pid = 0

    def __init__(self, code: int | None) -> None:
        self.code, self.waited = code, False

    def poll(self) -> int | None:
        return self.code

    def wait(self) -> int | None:
        self.waited = True
        return self.code


@pytest.fixture
def played(monkeypatch):
    """``solved_apart`` with a process that sends these messages and ends with this code."""
    limits, ended = [], []

    @contextmanager
    def ended_after(process, seconds):
        limits.append(seconds)
        yield Event()

    monkeypatch.setattr(child, "ended_after", ended_after)
    monkeypatch.setattr(child, "end_group", ended.append)
    monkeypatch.setattr(child, "_LOOK", 0.0)

    def play(*messages: bytes, code: int | None = 0, time_limit=None):
        ours, theirs = Pipe()
        process = Process(code)
        for message in messages:
            theirs.send_bytes(message)
        monkeypatch.setattr(child, "piped", lambda _: (ours, process))
        answer = child.solved_apart(PROGRAM, "there", time_limit, {"speed": 2})
        assert ours.closed
        assert process.waited
        assert ended.pop() is process
        asked = pickle.loads(theirs.recv_bytes())
        assert asked[1:] == ("there", {"speed": 2})
        assert asked[0].b.tolist() == [1.0]
        return answer, limits

    return play


@pytest.mark.parametrize(("given", "limit"), [(None, float("inf")), (2.5, 2.5)])
def test_a_minute_to_start_and_the_limit_to_answer(played, given, limit) -> None:
    answer, limits = played(b"ready", pickle.dumps(ANSWER), time_limit=given)
    assert limits == [60.0, limit]
    assert answer.program is PROGRAM
    assert (answer.status, answer.iterations, answer.said) == (Status.SOLVED, 3, "so")
    assert (answer.build_time, answer.solve_time) == (0.25, 0.5)


@pytest.mark.parametrize(
    ("code", "ended"),
    [(0, "with exit status 0"), (1, "with exit status 1"), (-1, "by SIGHUP"), (-9, "by SIGKILL")],
)
@pytest.mark.parametrize("messages", [(), (b"ready",)])
def test_a_process_that_ends_without_a_word_is_a_crash_though_its_pipe_is_open(
    played, messages, code, ended
) -> None:
    answer, _ = played(*messages, code=code)
    assert (answer.status, answer.said) == (Status.FAILED, f"crashed: its process was ended {ended}")


def test_what_is_raised_there_is_raised_here(played) -> None:
    with pytest.raises(InvalidInput, match="no such thing"):
        played(b"ready", pickle.dumps(InvalidInput("no such thing")))


def test_pipes_are_handed_on_as_posix_does(monkeypatch) -> None:
    def piped(*_):
        raise AssertionError("no process is started")

    monkeypatch.setattr(child, "piped", piped)
    with monkeypatch.context() as other:
        other.setattr(child.os, "name", "nt")
        with pytest.raises(InvalidInput, match="as POSIX systems do; leave isolated"):
            child.solved_apart(PROGRAM, "daqp", None, {})


TELLS = """
import json, os, sys
where, channel, *more = json.loads(sys.argv[1])
os.write(channel, os.environ["OURS"].encode() + b" " + os.environ["ALL"].encode() + bytes(more))
"""


def test_a_process_is_told_of_its_surroundings_and_its_end_is_heard(monkeypatch) -> None:
    monkeypatch.setenv("ALL", "theirs")
    ours, process = child.piped(TELLS, 65, 66, environment={"OURS": "ours"})
    try:
        assert process.wait(20) == 0
        assert os.read(ours.fileno(), 100) == b"ours theirsAB"
        assert ours.poll(5)  # by nobody else is the other end held open
        with pytest.raises(EOFError):
            ours.recv_bytes()
    finally:
        child.end_group(process)
        ours.close()


def test_a_timer_is_no_longer_than_there_are_and_keeps_nobody_waiting(monkeypatch) -> None:
    ended = []
    monkeypatch.setattr(child, "end_group", ended.append)
    for seconds, least in ((float("inf"), TIMEOUT_MAX), (100.0, 100.0)):
        before = set(threading.enumerate())
        with child.ended_after(None, seconds) as late:
            (timer,) = set(threading.enumerate()) - before
            assert timer.interval == least
            assert timer.daemon
        timer.join(5)
        assert not timer.is_alive()
        assert not late.is_set()
    assert ended == []


class Channel:
    """One that has something to be read at these looks."""

    def __init__(self, *looks: bool) -> None:
        self.looks, self.waits = list(looks), []

    def poll(self, seconds: float) -> bool:
        self.waits.append(seconds)
        return self.looks.pop(0)


def test_what_was_sent_before_the_end_is_read() -> None:
    """Between two looks the process wrote and ended."""
    for looks, code in (((True,), None), ((False, True), None), ((False, True, True), 0)):
        channel = Channel(*looks)
        child.awaited(channel, Process(code))
        assert channel.looks == []
    channel = Channel(False, False)
    with pytest.raises(EOFError):
        child.awaited(channel, Process(0))
    assert channel.waits == [0.1, 0]


def test_a_back_end_is_imported_before_it_says_that_it_is_ready(monkeypatch) -> None:
    order = []
    monkeypatch.setattr(child_side, "warm", lambda name: order.append(("warm", name)))
    monkeypatch.setattr(child_side, "asked", lambda *given: order.append(given[1:]) or ANSWER)
    monkeypatch.setattr(child_side.os, "_exit", lambda code: order.append(code))
    ours, theirs = Pipe()
    ours.send_bytes(pickle.dumps((PROGRAM, "there", {"speed": 2})))
    child_side.serve(theirs.fileno())
    theirs._handle = None
    assert order == [("warm", "there"), ("there", {"speed": 2}), 0]
    assert ours.recv_bytes() == b"ready"
    ours.close()

"""A time limit holds while a message is sent, too, and while a reply stops halfway."""

import os
import signal
import subprocess
import sys
import time
from multiprocessing import Pipe

import pytest

from regrasp.bench.running import process as runner
from regrasp.bench.running.process import Worker, WorkerLost
from regrasp.programs import child
from regrasp.programs.child import ended_after

pytestmark = pytest.mark.contract
MUCH = b"x" * 5_000_000  # far more than a pipe holds

_DEAF = "import time; time.sleep(60)"
_HALF = """
import json, os, struct, sys, time
channel = json.loads(sys.argv[1])[1]
os.write(channel, struct.pack("!i", 1000) + b"half")
time.sleep(60)
"""


@pytest.mark.parametrize("code", [_DEAF, _HALF], ids=["reads nothing", "half a reply"])
def test_a_worker_is_given_up_in_time(monkeypatch, code) -> None:
    monkeypatch.setattr(runner, "_CODE", code)
    worker = Worker(0)
    for message in (MUCH, b"little"):
        start = time.monotonic()
        with pytest.raises(WorkerLost, match=r"no answer within 0\.5 s"):
            worker.ask(message, within=0.5)
        assert time.monotonic() - start < 20
        assert worker.loaded is None


def test_a_worker_that_ends_is_no_timeout(monkeypatch) -> None:
    monkeypatch.setattr(runner, "_CODE", "import sys; sys.exit(3)")
    with pytest.raises(WorkerLost, match="ended with exit status 3"):
        Worker(0).ask(MUCH, within=60.0)


@pytest.mark.parametrize("code", [_DEAF, _HALF], ids=["reads nothing", "half a reply"])
def test_a_solver_that_does_not_start_is_given_up_in_time(monkeypatch, code) -> None:
    from regrasp.programs import Block, Cone, Program

    monkeypatch.setattr(child, "_CODE", code)
    monkeypatch.setattr(child, "_START", 0.5)
    monkeypatch.setattr(child.pickle, "dumps", lambda given: MUCH)
    import numpy as np
    from scipy import sparse

    one = sparse.csc_matrix([[1.0]])
    program = Program(one, np.ones(1), one, np.ones(1), (Block(Cone.NONNEGATIVE, 1),))
    answer = child.solved_apart(program, "daqp", 10.0, {})
    assert "its process did not start within 0.5 s" in answer.said


def test_a_block_in_time_ends_nothing() -> None:
    ours, theirs = Pipe()
    process = subprocess.Popen([sys.executable, "-c", _DEAF], start_new_session=True)
    try:
        with ended_after(process, float("inf")) as late:
            theirs.send(1)
            assert ours.recv() == 1
        assert not late.is_set()
        assert process.poll() is None
        with ended_after(process, 0.01) as late:
            process.wait(20)
        assert late.is_set()
        assert process.returncode == -signal.SIGKILL
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()

"""``regrasp explore`` serves its page until it is interrupted, and refuses what it cannot open."""

import os
import signal
import subprocess
import sys
from urllib.request import urlopen

import pytest

pytestmark = pytest.mark.end_to_end

COMMAND = [sys.executable, "-m", "regrasp", "explore"]


def test_it_serves_until_it_is_interrupted():
    with subprocess.Popen(
        [*COMMAND, "cam", "--no-browser"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        env=os.environ | {"PYTHONUNBUFFERED": "1"},
    ) as process:  # fmt: skip
        first = process.stdout.readline()
        assert first.startswith("cam: http://127.0.0.1:")
        with urlopen(first.split()[-1]) as page:
            assert b"<title>regrasp explore</title>" in page.read()
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=30)
    assert (process.returncode, err) == (0, "")
    assert out.endswith("Ended.\n")


def test_what_it_cannot_open_is_one_line():
    done = subprocess.run([*COMMAND, "teapot"], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.startswith("Error: expected a scenario (.toml), a drawing")
    assert done.stderr.count("\n") == 1

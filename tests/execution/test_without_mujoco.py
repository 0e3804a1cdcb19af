"""Without the simulator one line says what to install."""

import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.contract

HIDDEN = "import sys; sys.modules['mujoco'] = None; "


def test_importing_execution_needs_no_simulator() -> None:
    code = "import sys, regrasp.execution; print('mujoco' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"


def test_simulate_names_the_extra() -> None:
    code = (
        HIDDEN + "from regrasp.execution import simulate\ntry:\n    simulate(None)\n"
        "except ImportError as error:\n    print(error)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "simulate needs MuJoCo: pip install 'regrasp[mujoco]'"


def test_the_command_names_the_extra(tmp_path: Path) -> None:
    from executed_plans import removal
    from regrasp.files import write_plan

    write_plan(removal(), tmp_path / "plan.json")
    code = (
        HIDDEN
        + f"sys.argv = ['regrasp', 'simulate', {str(tmp_path)!r}]; from regrasp.cli import main; main()"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "simulate needs MuJoCo: pip install 'regrasp[mujoco]'" in done.stderr

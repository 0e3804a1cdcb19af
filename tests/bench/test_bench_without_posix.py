"""The benchmark where the modules of POSIX are not there."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.contract


def test_it_starts_without_fcntl_and_resource(tmp_path: Path) -> None:
    for name in ("fcntl", "resource"):
        (tmp_path / f"{name}.py").write_text(f"raise ModuleNotFoundError('No module named {name}')\n")
    code = (
        "import regrasp.bench.running.worker, regrasp.disk.staging\n"
        "from pathlib import Path\n"
        "from regrasp.bench.running.machine import can_limit_memory\n"
        "from regrasp.bench.running.jobs import Limits\n"
        "from regrasp.bench.running.store import Store\n"
        "from regrasp.errors import InvalidInput\n"
        "assert not can_limit_memory() and Limits().memory_of(1) == 0\n"
        "with Store(Path('rows'), {'solvers': {}}): pass\n"
        "with regrasp.disk.staging.whole_folder('out') as folder: (folder / 'a').write_text('b')\n"
        "try: Limits(memory_limit=1).memory_of(1)\n"
        "except InvalidInput as error: print(error)\n"
    )
    path = os.pathsep.join([str(tmp_path), *filter(None, [os.environ.get("PYTHONPATH")])])
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=tmp_path, env=os.environ | {"PYTHONPATH": path}, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert (done.stdout, done.stderr) == (
        "this system limits no process's memory; leave memory_limit out\n",
        "",
    )
    assert (tmp_path / "out" / "a").read_text() == "b"

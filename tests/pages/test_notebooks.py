"""Every notebook runs from its first cell to its last, in a kernel of its own."""

import json
from pathlib import Path

import pytest
from jupyter_client.manager import run_kernel

from places import ROOT

pytestmark = pytest.mark.documents

NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))
PATIENCE = 300
"""For one cell [s]."""


def ran(sources: list[str]) -> None:
    """Run cells one after the other, beside the notebooks; one that raises is an error with its traceback."""
    with run_kernel(kernel_name="python3", cwd=str(ROOT / "notebooks")) as kernel:
        for source in sources:
            answer = kernel.execute(source, reply=True, allow_stdin=False, timeout=PATIENCE)["content"]
            if answer["status"] != "ok":
                raise AssertionError("\n".join([source, *answer.get("traceback", [str(answer)])]))


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(path: Path) -> None:
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    ran(["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"])


def test_a_cell_that_raises_is_seen() -> None:
    with pytest.raises(AssertionError, match=r"(?s)^1 / zero.*ZeroDivisionError"):
        ran(["zero = 0", "1 / zero"])

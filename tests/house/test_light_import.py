"""``import regrasp`` loads NumPy and nothing heavy besides."""

import subprocess
import sys

import pytest

pytestmark = pytest.mark.architecture

HEAVY = {
    "matplotlib",
    "cvxpy",
    "clarabel",
    "numba",
    "scipy",
    "pandas",
    "pydantic",
    "qpsolvers",
    "click",
    "rich",
    "shapely",
    "svgpathtools",
    "ezdxf",
    "trimesh",
    "plotly",
    "mujoco",
    "rosbags",
    "pyarrow",
    "dask",
    "distributed",
    "xarray",
    "anywidget",
}


def loaded(code: str) -> set[str]:
    """The top-level packages a fresh interpreter has loaded after ``code``."""
    show = "import sys; print(*{name.split('.')[0] for name in sys.modules})"
    done = subprocess.run(
        [sys.executable, "-c", f"{code}\n{show}"], capture_output=True, text=True, check=True
    )
    return set(done.stdout.split())


def test_importing_regrasp_is_light() -> None:
    assert loaded("import regrasp") & HEAVY == set()


def test_what_is_loaded_is_seen() -> None:
    assert loaded("import regrasp, pydantic") & HEAVY == {"pydantic"}

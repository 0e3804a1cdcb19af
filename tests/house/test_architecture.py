"""The house keeps its import rules (docs/architecture.md), checked by parsing the sources."""

from collections.abc import Iterator, Set
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

import imports
import regrasp
from imports import imported
from packages import floor, may_import, room

pytestmark = pytest.mark.architecture

ROOT = Path(regrasp.__file__).parent

# Floor (folder or module) -> floors it may import. A new floor needs a line here.
FLOORS: dict[str, Set[str]] = {
    "errors": set(),
    "display": {"errors"},
    "compilation": set(),
    "threads": set(),
    "later": set(),
    "disk": {"errors", "mechanics", "disk"},  # output written whole or not at all
    "closed_form": {"closed_form", "compilation", "threads"},
    "programs": {"errors", "compilation", "later", "programs"},
    "mechanics": {"errors", "display", "mechanics", "threads"},
    "plans": {"errors", "display", "mechanics", "closed_form", "plans"},  # values: nothing here plans
    "planning": {
        "errors",
        "display",
        "mechanics",
        "closed_form",
        "outline",
        "mesh",
        "programs",
        "plans",
        "planning",
        "threads",
    },
    "motions": {"errors", "mechanics", "outline", "mesh", "plans", "planning", "motions"},
    "execution": {"errors", "display", "mechanics", "outline", "mesh", "plans", "motions", "execution"},
    "measures": {
        "errors",
        "display",
        "mechanics",
        "closed_form",
        "programs",
        "plans",
        "planning",
        "measures",
    },
    "process_limits": set(),  # of processes that solve, for the benchmark and for studies
    "verification": {
        "errors",
        "display",
        "mechanics",
        "verification",
    },  # the checker shares no code with the planner
    "outline": {"errors", "mechanics", "outline"},
    "mesh": {"errors", "mechanics", "outline", "mesh"},
    "files": {
        "disk",
        "errors",
        "later",
        "mechanics",
        "outline",
        "mesh",
        "closed_form",
        "programs",
        "plans",
        "planning",
        "motions",
        "verification",
        "files",
    },
    "studies": {
        "disk",
        "errors",
        "process_limits",
        "mechanics",
        "plans",
        "planning",
        "programs",
        "verification",
        "files",
        "studies",
    },
    "plots": {
        "disk",
        "errors",
        "later",
        "mechanics",
        "outline",
        "mesh",
        "closed_form",
        "plans",
        "planning",
        "motions",
        "execution",
        "web",
        "plots",
    },
    "web": set(),  # scripts and styles of pages
    "explore": {
        "errors",
        "mechanics",
        "outline",
        "mesh",
        "plans",
        "planning",
        "verification",
        "files",
        "web",
        "explore",
    },
    "bench": {
        "disk",
        "errors",
        "process_limits",
        "mechanics",
        "closed_form",
        "plans",
        "planning",
        "programs",
        "files",
        "plots",
        "studies",
        "bench",
    },
    "cli": {
        "disk",
        "",
        "errors",
        "mechanics",
        "outline",
        "mesh",
        "plans",
        "planning",
        "motions",
        "verification",
        "files",
        "plots",
        "execution",
        "studies",
        "explore",
        "bench",
        "cli",
    },
    # regrasp/__init__.py: the public names
    "": {
        "errors",
        "mechanics",
        "outline",
        "mesh",
        "plans",
        "motions",
        "planning",
        "measures",
        "verification",
        "studies",
    },
    "__main__": {"cli"},
}
# Room -> rooms of its floor that it may import besides its own; rooms side by side never import each other.
_HOLDS = {"planning.states"}
_DRAWN = {"plots.look", "plots.grasps"}
ROOMS: dict[str, Set[str]] = {
    "planning.states": set(),
    "planning.surveys": _HOLDS,
    "planning.robustness": _HOLDS | {"planning.surveys"},
    "planning.changes": _HOLDS,
    "planning.holds": _HOLDS,
    "planning.regrasps": _HOLDS | {"planning.surveys", "planning.changes", "planning.holds"},
    "planning.anywhere": _HOLDS | {"planning.regrasps"},
    "planning.placement": _HOLDS | {"planning.surveys", "planning.changes", "planning.holds"},
    "plots.look": set(),
    "plots.grasps": {"plots.look"},
    "plots.over_time": _DRAWN,
    "plots.wrench_space": _DRAWN,
    "plots.escapes": _DRAWN,
    "plots.regrasps": _DRAWN,
    "plots.surveys": _DRAWN,
    "plots.placement": _DRAWN,
    "plots.pages": _DRAWN
    | {"plots.over_time", "plots.wrench_space", "plots.escapes", "plots.regrasps", "plots.surveys"},
    "files.plans": set(),
    "files.scenarios": set(),
    "bench.problems": set(),
    "bench.judging": {"bench.problems"},
    "bench.running": {"bench.problems", "bench.judging"},
    "bench.reporting": {"bench.problems", "bench.running", "bench.judging"},
}


def sources() -> dict[str, str]:
    return imports.sources(ROOT)


def violations(module: str, modules: dict[str, str]) -> Iterator[str]:
    for name in imported(module, modules):
        package = name.split(".")[0]
        if package == "regrasp":
            if floor(name) not in FLOORS[floor(module)] or not open_to(room(module), room(name)):
                yield f"{module} imports {name}"
        elif not may_import(module, package):
            yield f"{module} imports {package}"


def open_to(here: str, there: str) -> bool:
    """Whether a room may import another of its floor."""
    if here == there or here.split(".")[0] != there.split(".")[0] or here not in ROOMS:
        return True
    return there not in ROOMS or there in ROOMS[here]


def cycle(modules: dict[str, str]) -> list[str]:
    """Modules that import one another in a ring, or nothing."""
    graph = {module: imported(module, modules) & modules.keys() for module in modules}
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def test_every_floor_has_its_rule() -> None:
    modules = sources()
    assert len(modules) > 40
    assert {floor(module) for module in modules} <= FLOORS.keys()


def test_every_module_keeps_to_its_floor() -> None:
    modules = sources()
    assert [broken for module in modules for broken in violations(module, modules)] == []


def test_no_import_cycles() -> None:
    assert cycle(sources()) == []


# -- the rules above catch what they are for ------------------------------------------------------------

OFFENCES = [
    ("regrasp.closed_form.best", "from regrasp.errors import InvalidInput", "regrasp.errors"),
    ("regrasp.closed_form.best", "import numba", "numba"),
    ("regrasp.closed_form.best", "from numba.core import types", "numba"),
    ("regrasp.programs.program", "from regrasp.mechanics import Grasp", "regrasp.mechanics"),
    ("regrasp.programs.program", "import clarabel", "clarabel"),
    ("regrasp.programs.clarabel_backend", "import cvxpy as cp", "cvxpy"),
    ("regrasp.planning.cvxpy_backend", "import cvxpy as cp", "cvxpy"),
    (
        "regrasp.mechanics.state",
        "from regrasp.planning.states.two_fingers import best_state",
        "regrasp.planning.states.two_fingers",
    ),
    ("regrasp.mechanics.state", "import scipy.optimize", "scipy"),
    ("regrasp.mechanics.state", "def f():\n    import clarabel", "clarabel"),
    ("regrasp.verification", "from regrasp.closed_form import locus", "regrasp.closed_form.locus"),
    ("regrasp.verification.plans", "from ..plans import timing", "regrasp.plans.timing"),
    ("regrasp.plans.timing", "import matplotlib.pyplot as plt", "matplotlib"),
    ("regrasp.plans.timing", "import_module('matplotlib')", "matplotlib"),
    ("regrasp.plans.timing", "from .. import plots", "regrasp.plots"),
    ("regrasp.plans.timing", "import shapely", "shapely"),
    ("regrasp.execution.simulation", "import mujoco", "mujoco"),
    ("regrasp.planning", "from regrasp.execution import simulate", "regrasp.execution"),
    ("regrasp.plots.pages.page_scene", "from plotly import graph_objects", "plotly"),
    ("regrasp.outline.svg.reader", "from ...files.source import text_of", "regrasp.files.source"),
    ("regrasp.outline.outline", "from regrasp.mesh import Mesh", "regrasp.mesh"),
    ("regrasp.plans.timing", "import trimesh", "trimesh"),
    ("regrasp.plans.timing", "from pydantic import BaseModel", "pydantic"),
    ("regrasp.plans.timing", "if TYPE_CHECKING:\n    import regrasp.files", "regrasp.files"),
    ("regrasp.planning", "from ..plots.look import style", "regrasp.plots.look.style"),
    ("regrasp", "from regrasp.plots.look import style", "regrasp.plots.look.style"),
]


@pytest.mark.parametrize(("module", "source", "named"), OFFENCES, ids=[f"{o[0]}: {o[1]}" for o in OFFENCES])
def test_an_offence_is_caught(module: str, source: str, named: str) -> None:
    assert list(violations(module, sources() | {module: source})) == [f"{module} imports {named}"]


@pytest.mark.parametrize(
    ("module", "source"),
    [
        (
            "regrasp.programs.cvxpy_backend",
            "import cvxpy as cp\nfrom regrasp.programs.program import Program",
        ),
        ("regrasp.closed_form.compiled.two_fingers", "from numba import njit\nfrom . import best"),
        ("regrasp.plots.look.style", "from mpl_toolkits.mplot3d import Axes3D"),
        ("regrasp.mechanics.state", "from fractions import Fraction\n'import clarabel'"),
    ],
)
def test_what_is_allowed_passes(module: str, source: str) -> None:
    assert list(violations(module, sources() | {module: source})) == []


def test_a_cycle_is_caught_in_functions_too() -> None:
    ring = {"regrasp.mechanics.contact": "def f():\n    from .grasp import Grasp"}
    found = cycle(sources() | ring)
    assert {"regrasp.mechanics.contact", "regrasp.mechanics.grasp"} <= set(found)
    assert cycle({"a": "import b", "b": "import c", "c": ""}) == []

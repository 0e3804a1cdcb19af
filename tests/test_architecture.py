"""The house keeps its import rules (design, section 3), checked by parsing the sources."""

import ast
import subprocess
import sys
from collections.abc import Iterator, Set
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

import regrasp

ROOT = Path(regrasp.__file__).parent

# Floor (folder or module) -> floors it may import. A new floor needs a line here.
FLOORS: dict[str, Set[str]] = {
    "errors": set(),
    "display": {"errors"},
    "closed_form": {"closed_form"},
    "programs": {"errors", "programs"},
    "mechanics": {"errors", "display", "mechanics"},
    "planning": {"errors", "display", "mechanics", "closed_form", "outline", "mesh", "programs", "planning"},
    "verification": {"errors", "mechanics", "verification"},  # the checker shares no code with the planner
    "outline": {"errors", "mechanics", "outline"},
    "mesh": {"errors", "mechanics", "outline", "mesh"},
    "files": {
        "errors",
        "mechanics",
        "outline",
        "mesh",
        "closed_form",
        "programs",
        "planning",
        "verification",
        "files",
    },
    "plots": {"errors", "mechanics", "outline", "mesh", "closed_form", "planning", "plots"},
    "bench": {"errors", "mechanics", "closed_form", "planning", "programs", "files", "plots", "bench"},
    "cli": {
        "",
        "errors",
        "mechanics",
        "outline",
        "mesh",
        "planning",
        "verification",
        "files",
        "plots",
        "bench",
    },
    # regrasp/__init__.py: the public names
    "": {"errors", "mechanics", "outline", "mesh", "planning", "verification"},
    "__main__": {"cli"},
}
SOLVERS = {
    "clarabel", "cvxpy", "qpsolvers", "osqp", "daqp", "quadprog", "piqp", "proxsuite", "scs", "ecos",
    "highspy", "gurobipy", "mosek", "qpoases", "cvxopt",
}  # fmt: skip
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
}
LINES = 430


def sources(root: Path = ROOT) -> dict[str, str]:
    """Module name -> source, for every module of the package at ``root``."""
    found = {}
    for path in root.rglob("*.py"):
        parts = path.relative_to(root).with_suffix("").parts
        found[".".join((root.name, *parts)).removesuffix(".__init__")] = path.read_text(encoding="utf-8")
    return found


def imported(module: str, modules: dict[str, str]) -> set[str]:
    """Every module imported anywhere in ``module``: in functions, for types only or by a literal name."""
    is_package = any(name.startswith(f"{module}.") for name in modules)
    found: set[str] = set()
    for node in ast.walk(ast.parse(modules[module])):
        if isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                here = module.split(".") if is_package else module.split(".")[:-1]
                base = ".".join([*here[: len(here) - node.level + 1], *([base] if base else [])])
            for alias in node.names:
                whole = f"{base}.{alias.name}"
                found.add(whole if whole in modules else base)
        elif isinstance(node, ast.Call) and node.args and isinstance(node.args[0], ast.Constant):
            called = ast.unparse(node.func).rpartition(".")[2]
            if called in ("import_module", "__import__"):
                found.add(str(node.args[0].value))
    return found


def floor(module: str) -> str:
    return [*module.split("."), ""][1]


def violations(module: str, modules: dict[str, str]) -> Iterator[str]:
    here = floor(module)
    for name in imported(module, modules):
        package = name.split(".")[0]
        if package == "regrasp":
            if floor(name) not in FLOORS[here]:
                yield f"{module} imports {name}"
        elif not may_import(module, package):
            yield f"{module} imports {package}"


def may_import(module: str, package: str) -> bool:
    """Whether a module may import a package from outside the project."""
    here = floor(module)
    if package in ("matplotlib", "mpl_toolkits"):
        return here == "plots"
    if package == "plotly":
        return module == "regrasp.plots.page"
    if package == "pydantic":
        return here == "files"
    if package == "numba":
        return module in (
            "regrasp.closed_form.compiled",
            "regrasp.closed_form.compiling",
            "regrasp.closed_form.compiled_holds",
            "regrasp.closed_form.compiled_pairs",
            "regrasp.closed_form.compiled_paths",
            "regrasp.closed_form.compiled_shift",
            "regrasp.closed_form.compiled_stances",
            "regrasp.closed_form.compiled_triples",
            "regrasp.programs.compiled_audit",
        )
    if package in SOLVERS:
        # The benchmark calls solvers through others with their own defaults, which the back ends do not.
        places = ("programs.{}_backend", "programs.calls.{}_call", "bench.calls.{}_call")
        return module in [f"regrasp.{place.format(package)}" for place in places]
    if package in ("click", "rich"):
        return here == "cli"
    if package == "shapely":
        return here in ("outline", "mesh")
    if package in ("svgpathtools", "ezdxf"):
        return here == "outline"
    if package == "trimesh":
        return here == "mesh"
    if here in ("errors", "display", "closed_form", "mechanics", "verification"):
        return package == "numpy" or package in sys.stdlib_module_names
    return True


def cycle(modules: dict[str, str]) -> list[str]:
    """Modules that import one another in a ring, or nothing."""
    graph = {module: imported(module, modules) & modules.keys() for module in modules}
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def loaded(code: str) -> set[str]:
    """The top-level packages a fresh interpreter has loaded after ``code``."""
    show = "import sys; print(*{name.split('.')[0] for name in sys.modules})"
    done = subprocess.run(
        [sys.executable, "-c", f"{code}\n{show}"], capture_output=True, text=True, check=True
    )
    return set(done.stdout.split())


def test_every_floor_has_its_rule() -> None:
    modules = sources()
    assert len(modules) > 40
    assert {floor(module) for module in modules} <= FLOORS.keys()


def test_every_module_keeps_to_its_floor() -> None:
    modules = sources()
    assert [broken for module in modules for broken in violations(module, modules)] == []


def test_no_import_cycles() -> None:
    assert cycle(sources()) == []


def test_files_read_in_one_sitting() -> None:
    assert {m: n for m, text in sources().items() if (n := len(text.splitlines())) > LINES} == {}


def test_importing_regrasp_is_light() -> None:
    assert loaded("import regrasp") & HEAVY == set()


def test_what_is_loaded_is_seen() -> None:
    assert loaded("import regrasp, pydantic") & HEAVY == {"pydantic"}


# -- the rules above catch what they are for ------------------------------------------------------------

OFFENCES = [
    ("regrasp.closed_form.best", "from regrasp.errors import InvalidInput", "regrasp.errors"),
    ("regrasp.closed_form.best", "import numba", "numba"),
    ("regrasp.closed_form.best", "from numba.core import types", "numba"),
    ("regrasp.programs.program", "from regrasp.mechanics import Grasp", "regrasp.mechanics"),
    ("regrasp.programs.program", "import clarabel", "clarabel"),
    ("regrasp.programs.clarabel_backend", "import cvxpy as cp", "cvxpy"),
    ("regrasp.planning.cvxpy_backend", "import cvxpy as cp", "cvxpy"),
    ("regrasp.mechanics.state", "from regrasp.planning.locus import best_state", "regrasp.planning.locus"),
    ("regrasp.mechanics.state", "import scipy.optimize", "scipy"),
    ("regrasp.mechanics.state", "def f():\n    import clarabel", "clarabel"),
    ("regrasp.verification", "from regrasp.closed_form import path", "regrasp.closed_form.path"),
    ("regrasp.verification.plans", "from ..planning import timing", "regrasp.planning.timing"),
    ("regrasp.planning.timing", "import matplotlib.pyplot as plt", "matplotlib"),
    ("regrasp.planning.timing", "import_module('matplotlib')", "matplotlib"),
    ("regrasp.planning.timing", "from .. import plots", "regrasp.plots"),
    ("regrasp.planning.timing", "import shapely", "shapely"),
    ("regrasp.plots.page_scene", "from plotly import graph_objects", "plotly"),
    ("regrasp.outline.svg", "from ..files.source import text_of", "regrasp.files.source"),
    ("regrasp.outline.outline", "from regrasp.mesh import Mesh", "regrasp.mesh"),
    ("regrasp.planning.timing", "import trimesh", "trimesh"),
    ("regrasp.planning.timing", "from pydantic import BaseModel", "pydantic"),
    ("regrasp.planning.timing", "if TYPE_CHECKING:\n    import regrasp.files", "regrasp.files"),
    ("regrasp.planning", "from ..plots import style", "regrasp.plots.style"),
    ("regrasp", "from regrasp.plots import style", "regrasp.plots.style"),
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
        ("regrasp.closed_form.compiled", "from numba import njit\nfrom . import best"),
        ("regrasp.plots.style", "from mpl_toolkits.mplot3d import Axes3D"),
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

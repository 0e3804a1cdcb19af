"""Which package from outside the project may be imported where."""

import sys

SOLVERS = {
    "clarabel", "cvxpy", "qpsolvers", "osqp", "daqp", "quadprog", "piqp", "proxsuite", "scs", "ecos",
    "highspy", "gurobipy", "mosek", "qpoases", "cvxopt",
}  # fmt: skip


def floor(module: str) -> str:
    """The first name below the package."""
    return [*module.split("."), ""][1]


def room(module: str) -> str:
    """The two first names below the package, where they are a room with rules of its own."""
    return ".".join(module.split(".")[1:3])


def may_import(module: str, package: str) -> bool:
    """Whether a module may import a package from outside the project."""
    here = floor(module)
    if package in ("matplotlib", "mpl_toolkits"):
        return here == "plots"
    if package == "plotly":
        return module == "regrasp.plots.pages.page"
    if package == "anywidget":
        return module == "regrasp.explore.widget"
    if package == "rosbags":
        return module == "regrasp.files.plans.bag"
    if package in ("pyarrow", "dask", "distributed", "xarray"):
        return here == "studies"
    if package == "pydantic":
        return here == "files"
    if package == "numba":
        return room(module) == "closed_form.compiled" or module == "regrasp.compilation"
    if package in SOLVERS:
        # The benchmark calls solvers through others with their own defaults, which the back ends do not.
        places = ("programs.{}_backend", "programs.calls.{}_call", "bench.calls.{}_call")
        return module in [f"regrasp.{place.format(package)}" for place in places]
    if package in ("click", "rich"):
        return here == "cli"
    if package == "mujoco":
        return module == "regrasp.execution.engine"
    if package == "shapely":
        return here in ("outline", "mesh", "motions")
    if package in ("svgpathtools", "ezdxf"):
        return here == "outline"
    if package == "trimesh":
        return here == "mesh"
    if here in ("errors", "display", "closed_form", "mechanics", "verification"):
        return package == "numpy" or package in sys.stdlib_module_names
    return True

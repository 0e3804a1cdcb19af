"""What is known of each back end: the package, how it is called, what it takes and how well it answers."""

from functools import cache
from importlib.util import find_spec
from typing import Any, NamedTuple


class Backend(NamedTuple):
    """A way to solve programs.

    needs: the package that must be installed. module: ours, which imports it. second_order: takes such cones.
    tolerance: largest measure of an answer that counts as sound. options: that bring the solver near this
    accuracy; those that are given override them. strictly_convex: it refuses a linear objective, or stops
    short of its optimum. time_limit: its own option for one [s], or empty.
    """

    needs: str
    module: str
    second_order: bool
    tolerance: float
    options: dict[str, Any] = {}  # noqa: RUF012 - read only
    strictly_convex: bool = False
    time_limit: str = ""


_CALLS = "regrasp.programs.calls."
# At 1e-12 Clarabel stops with insufficient progress.
_CLARABEL = dict.fromkeys(
    ("tol_gap_abs", "tol_gap_rel", "tol_feas", "tol_infeas_abs", "tol_infeas_rel"), 1e-10
)
# Presolve keeps HiGHS from telling a ray; OSQP says aloud that it polishes, and ``polish`` does.
_FINE = {"eps_abs": 1e-9, "eps_rel": 1e-9}
# Active-set and interior-point methods answer to 1e-7 or better; first-order methods (osqp, scs) do not.
BACKENDS = {
    "clarabel": Backend(
        "clarabel", "regrasp.programs.clarabel_backend", True, 5e-7, _CLARABEL, time_limit="time_limit"
    ),
    "daqp": Backend("daqp", _CALLS + "daqp_call", False, 1e-7, {}, True, "time_limit"),
    "quadprog": Backend("quadprog", _CALLS + "quadprog_call", False, 1e-7, {}, True),
    "highs": Backend(
        "highspy", _CALLS + "highspy_call", False, 1e-6, {"presolve": "off"}, time_limit="time_limit"
    ),
    "piqp": Backend("piqp", _CALLS + "piqp_call", False, 1e-7, {"eps_abs": 1e-10, "eps_rel": 1e-10}),
    "proxqp": Backend(
        "proxsuite", _CALLS + "proxsuite_call", False, 1e-6,
        # Ten thousand times 1500 steps take minutes where rounding is above eps_abs.
        {"eps_abs": 1e-10, "eps_rel": 0.0, "default_rho": 1e-2, "max_iter": 5000, "max_iter_in": 50}, True,
    ),
    "qpalm": Backend(
        "qpalm", _CALLS + "qpalm_call", False, 1e-5, {**_FINE, "max_iter": 20_000}, True, "time_limit"
    ),
    "osqp": Backend(
        "osqp", _CALLS + "osqp_call", False, 1e-5, {**_FINE, "max_iter": 50_000}, True,
        "time_limit",
    ),
    "scs": Backend(
        "scs", _CALLS + "scs_call", False, 1e-5, {**_FINE, "max_iters": 200_000}, time_limit="time_limit_secs"
    ),
    "cvxpy": Backend("cvxpy", "regrasp.programs.cvxpy_backend", True, 1e-6),
}  # fmt: skip


def named(name: str) -> Backend | None:
    """The back end of a name, of ``cvxpy:<SOLVER>`` cvxpy; None for any other."""
    return BACKENDS.get("cvxpy" if name.startswith("cvxpy:") else name)


def is_available(name: str) -> bool:
    """Whether a back end is installed here, one of cvxpy's solvers if cvxpy is."""
    backend = named(name)
    return backend is not None and is_installed(backend)


def available_backends() -> tuple[str, ...]:
    """Names of the back ends installed here; ``cvxpy:<SOLVER>`` names one of cvxpy's solvers besides."""
    return tuple(name for name, backend in BACKENDS.items() if is_installed(backend))


def is_installed(backend: Backend) -> bool:
    """Whether the package of a back end is here."""
    return _has(backend.needs)


@cache
def _has(package: str) -> bool:
    return find_spec(package) is not None

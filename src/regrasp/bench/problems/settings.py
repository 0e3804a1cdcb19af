"""The four accuracies solvers are asked for, in each solver's own option names.

They are those of qpbenchmark (github.com/qpsolvers/qpbenchmark, ``solver_settings.py`` and ``test_set.py``):
``default`` leaves a solver's own defaults alone; ``low``, ``mid`` and ``high`` set the absolute tolerance of
residuals and gap to 1e-3, 1e-6 and 1e-9 and the relative one to zero, with the check of the gap switched on
where it is not by default. A solver without such options, quadprog for one, answers alike to all four.
"""

from typing import Any

from regrasp.errors import InvalidInput, shown

SETTINGS = ("default", "low", "mid", "high")
_ASKED = {"low": 1e-3, "mid": 1e-6, "high": 1e-9}
# Solvers measure residuals each in its own norm and scaling, and an objective errs by more than they do; a
# decade is allowed for that.
_ALLOWED = 10.0
# Where no accuracy was asked for: ten times the loosest that solvers ask of themselves, OSQP's 1e-3.
_DEFAULT_RIGHT = 1e-2

_ABSOLUTE: dict[str, tuple[str, ...]] = {
    "clarabel": ("tol_feas", "tol_gap_abs"),
    "cvxpy:CLARABEL": ("tol_feas", "tol_gap_abs"),
    "daqp": ("primal_tol", "dual_tol"),
    "highs": ("primal_feasibility_tolerance", "dual_feasibility_tolerance"),
    "osqp": ("eps_abs",),
    "piqp": ("eps_abs", "eps_duality_gap_abs"),
    "proxqp": ("eps_abs", "eps_duality_gap_abs"),
    "qpalm": ("eps_abs",),
    "scs": ("eps_abs",),
    "qoco": ("abstol",),
    "cvxopt": ("feastol",),
    "kvxopt": ("feastol",),
    "ecos": ("feastol",),
    "gurobi": ("FeasibilityTol", "OptimalityTol"),
    "hpipm": ("tol_stat", "tol_eq", "tol_ineq", "tol_dual_gap"),
    "jaxopt_osqp": ("tol",),
    "qpax": ("solver_tol",),
    "qtqp": ("atol",),
    "sip": ("eps_abs",),
    "cvxpy:CVXOPT": ("feastol", "abstol"),
    "cvxpy:ECOS": ("feastol", "abstol"),
    "cvxpy:QOCO": ("abstol",),
}
_RELATIVE: dict[str, tuple[str, ...]] = {
    "clarabel": ("tol_gap_rel",),
    "cvxpy:CLARABEL": ("tol_gap_rel",),
    "osqp": ("eps_rel",),
    "piqp": ("eps_rel", "eps_duality_gap_rel"),
    "proxqp": ("eps_rel", "eps_duality_gap_rel"),
    "qpalm": ("eps_rel",),
    "scs": ("eps_rel",),
    "qoco": ("reltol",),
    "qtqp": ("rtol",),
    "sip": ("eps_rel",),
    "cvxpy:QOCO": ("reltol",),
}
_SWITCHED = {"piqp": {"check_duality_gap": True}, "proxqp": {"check_duality_gap": True}}
# Through cvxpy, SCS takes the smaller of the two tolerances for both, so a zero would never be met.
_ALIKE = {"cvxpy:SCS": "eps"}
_WITHOUT = ("quadprog",)


def options(solver: str, settings: str, *, outside: bool = False) -> dict[str, Any]:
    """What a solver is given for ``settings``; outside solvers get ``eps_abs`` and ``eps_rel``.

    Raises ``InvalidInput`` for settings that do not exist, and for a solver whose options are not known.
    """
    check(settings)
    if settings == "default" or solver in _WITHOUT:
        return {}
    asked = _ASKED[settings]
    if outside:
        return {"eps_abs": asked, "eps_rel": 0.0}
    if solver in _ALIKE:
        return {_ALIKE[solver]: asked}
    if solver not in _ABSOLUTE:
        raise InvalidInput(
            f"it is not known how {solver} is asked for {settings} accuracy; run it with default settings"
        )
    absolute = dict.fromkeys(_ABSOLUTE[solver], asked)
    return absolute | dict.fromkeys(_RELATIVE.get(solver, ()), 0.0) | _SWITCHED.get(solver, {})


def is_known(solver: str) -> bool:
    """Whether a solver of the house can be asked for an accuracy."""
    return solver in _ABSOLUTE or solver in _ALIKE or solver in _WITHOUT


def right_within(settings: str) -> float:
    """The relative error with which an answer is right: ten times what was asked for, by default 1e-2."""
    check(settings)
    return _ALLOWED * _ASKED[settings] if settings in _ASKED else _DEFAULT_RIGHT


def check(settings: str) -> None:
    """Raises ``InvalidInput`` for settings that do not exist."""
    if settings not in SETTINGS:
        raise InvalidInput(f"no settings {shown(settings)}; there are {', '.join(SETTINGS)}")

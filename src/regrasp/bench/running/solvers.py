"""The solvers that can be measured here: those installed, and those that outside packages announce.

A package announces a solver by an entry point, whose name is the solver's::

    [project.entry-points."regrasp.solvers"]
    mine = "my_module:solve"

``solve(program, **settings)`` gets a ``regrasp.programs.Program`` and nothing else for default settings, else
``eps_abs`` and ``eps_rel``. If it has an attribute ``layout``, it gets ``layout(program)`` instead, made
before the clock starts. It returns anything with the attributes ``status`` (``found``, ``infeasible``,
``unbounded``, ``failed`` or ``refused``), ``x`` (n,), and where it has them ``duals`` (m,), ``iterations``,
``said``, ``build_time``, ``setup_time`` and ``solve_time`` [s]; ``regrasp.bench.problems.answer.Answer`` is
such a value. A solver of QPs is announced in the group ``regrasp.solvers``, one that takes second-order cones
too in ``regrasp.solvers.conic``.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from importlib.metadata import EntryPoint, PackageNotFoundError, entry_points, version
from importlib.util import find_spec
from typing import Any

from regrasp.bench.problems.settings import is_known
from regrasp.errors import InvalidInput, shown
from regrasp.programs.answer import Answer
from regrasp.programs.calls.form import Call
from regrasp.programs.program import Program

GROUPS = {"regrasp.solvers": False, "regrasp.solvers.conic": True}
_THROUGH = ("qpsolvers", "cvxpy")
# Packages called directly, by the name of the solver; the others are called through qpsolvers.
_DIRECT = {
    "clarabel": "clarabel",
    "daqp": "daqp",
    "highs": "highspy",
    "osqp": "osqp",
    "piqp": "piqp",
    "proxqp": "proxsuite",
    "qoco": "qoco",
    "qpalm": "qpalm",
    "scs": "scs",
}
_TAKE_CONES = ("clarabel", "qoco", "scs")
_PACKAGES = _DIRECT | {
    "hpipm": "hpipm_python",
    "gurobi": "gurobipy",
    "jaxopt_osqp": "jaxopt",
    "sip": "sip_python",
}


@dataclass(frozen=True)
class Solver:
    """A solver that can be measured.

    version: of its package. takes_cones: of second order. updates: whether it can be given another right
    side. entry: the outside entry point ``module:function``, or empty.
    """

    name: str
    version: str
    takes_cones: bool
    updates: bool = False
    entry: str = ""

    @property
    def release(self) -> str:
        """Its version, and of an outside solver what is called."""
        return f"{self.version} ({self.entry})" if self.entry else self.version

    @property
    def outside(self) -> bool:
        """Whether another package announces it."""
        return bool(self.entry)

    def load(self) -> Call:
        """How to call it; imports the solver, which can take seconds."""
        if self.entry:
            called = EntryPoint(self.name, self.entry, "regrasp.solvers").load()
            return Call(getattr(called, "layout", _as_it_is), called)
        if self.name in _DIRECT:
            return Call(_module(_DIRECT[self.name]).layout, partial(_once, self.session()))
        _, _, inner = self.name.partition(":")
        if inner:
            return Call(_as_it_is, partial(_module("cvxpy").solve, name=inner))
        through = _module("qpsolvers")
        return Call(partial(through.layout, name=self.name), partial(through.solve, name=self.name))

    def session(self) -> Callable[..., Any]:
        """The class of its sessions: set up with a layout, updated with another, and solved."""
        session: Callable[..., Any] = _module(_DIRECT[self.name]).Session
        return session


def _once(session: Callable[..., Any], data: Any, **options: Any) -> Answer:
    answer: Answer = session(data, **options).solve()
    return answer


def _module(package: str) -> Any:
    floor = "bench" if package in _THROUGH else "programs"
    return import_module(f"regrasp.{floor}.calls.{package}_call")


def _as_it_is(program: Program) -> Program:
    return program


def installed_solvers() -> dict[str, Solver]:
    """Every solver here by name. Imports qpsolvers and cvxpy, which takes a second or two.

    Raises ``InvalidInput`` for an entry point with the name of another solver.
    """
    found: dict[str, Solver] = {}
    names = [*_module("qpsolvers").installed()]
    names += [name for name, package in _DIRECT.items() if name not in names and find_spec(package)]
    for name in sorted(filter(is_known, names)):
        found[name] = Solver(
            name, _version(_PACKAGES.get(name, name)), name in _TAKE_CONES, updates=name in _DIRECT
        )  # fmt: skip
    for inner in _module("cvxpy").installed():
        if is_known(f"cvxpy:{inner}"):
            release = f"{_version(inner.lower())} by cvxpy {_version('cvxpy')}"
            found[f"cvxpy:{inner}"] = Solver(f"cvxpy:{inner}", release, True)
    for group, cones in GROUPS.items():
        for point in entry_points(group=group):
            if point.name in found:
                raise InvalidInput(
                    f"the entry point {point.value} announces a solver {shown(point.name)}, "
                    "but another has that name already; give it another"
                )
            release = point.dist.version if point.dist else "unknown"
            found[point.name] = Solver(point.name, release, cones, entry=point.value)
    return found


def chosen_solvers(names: Iterable[str]) -> list[Solver]:
    """The solvers of these names in this order, or all of them.

    Raises ``InvalidInput`` for an unknown name.
    """
    there = installed_solvers()
    names = list(dict.fromkeys(names))
    for name in names:
        if name not in there:
            raise InvalidInput(f"no solver {shown(name)} here; there are {', '.join(there)}")
    return [there[name] for name in names or there]


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "unknown"

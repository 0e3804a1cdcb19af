"""The least friction with which contacts hold a load."""

from collections.abc import Container, Iterable
from dataclasses import dataclass, field
from math import inf

import numpy as np

from regrasp.errors import Infeasible, SolverFailed
from regrasp.mechanics.checks import items, number
from regrasp.mechanics.escape import EscapeTwist
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.state import GraspState, check_load
from regrasp.mechanics.value import ArrayValue
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.choosing import choose_forces
from regrasp.planning.states.criteria import ChosenState, Criteria
from regrasp.planning.states.escape import escape_twist
from regrasp.planning.states.linear.row_duals import escape_by_rows
from regrasp.planning.states.separation import cleared
from regrasp.planning.states.solving import force_unit
from regrasp.planning.surveys.extremes.load_reach import Share, largest_share

SQUEEZE = 1e6
"""Forces are at most this multiple of the load where nothing else limits them."""
MOST = 1e4
"""A load that is not held with this coefficient counts as held with none."""

_FORMULA = 1e3
_SETTLED = 1e-9
_TINY = 1e-6
_STILL = 1e-9
_ROUNDING = 1e-13
_BELOW = (2e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4)


@dataclass(frozen=True, eq=False, repr=False)
class LeastFriction(ArrayValue):
    """The least coefficient, one for all contacts, with which forces hold a load.

    Args:
        grasp: the contacts that hold.
        load: external wrench on the object about its centre of mass, object frame [N, N m].
        value: mu [-], proven by ``state``, whose contacts have it; infinite where 1e4 is not enough.
        bounds: (lower, value): with any smaller coefficient than ``lower`` the object escapes by ``escape``,
            which is None where lower is 0, for want of a proof, too. Where less is needed the more fingers
            squeeze, value is what forces of 1e6 times the load reach.
        state: a state.
        escape: the twist along which less friction loses the object, or None.
    """

    grasp: Grasp
    load: Wrench
    value: float
    bounds: tuple[float, float]
    state: GraspState | None = field(compare=False)
    escape: EscapeTwist | None = field(compare=False)

    def __float__(self) -> float:
        return self.value

    def __str__(self) -> str:
        names = ", ".join(self.grasp.names)
        less = "" if self.value == inf else "with less "
        why = "" if self.escape is None else f"; {less}the object escapes by {self.escape}"
        if self.value == inf:
            return f"no friction coefficient up to {MOST:g} lets {names} hold {self.load!r}{why}"
        return f"{names} hold {self.load!r} with friction {self.value:.6g} or more{why}"

    def __repr__(self) -> str:
        return f"LeastFriction({self})"


def least_friction(
    grasp: Grasp,
    load: Wrench,
    *,
    contacts: Iterable[str | int] | None = None,
    max_force: float | None = None,
) -> LeastFriction:
    """The least friction coefficient, one for all contacts, with which they hold a load.

    The contacts' own coefficients do not matter.

    Closed form for two planar contacts; else what is left is halved by programs that always have an answer.

    Args:
        grasp: the contacts that hold.
        load: external wrench on the object about its centre of mass, object frame [N, N m].
        contacts: those that have friction, all if not given; the others stay without.
        max_force: limits every force besides the contacts' own limits [N]; their linear ones count, too.
            Torsion of soft fingers stays as it is, per normal force.

    Raises:
        InvalidInput: For bad input.
    """
    check_load(grasp, load)
    rough = (
        range(len(grasp))
        if contacts is None
        else {grasp.index(contact) for contact in items(contacts, "contacts")}
    )
    if max_force is not None:
        number(max_force, "max_force", above=0)
    if not load.vector.any():
        smooth = _with(grasp, 0.0, rough)
        still = GraspState(smooth, load, [[0.0] * smooth.width] * len(grasp))
        return LeastFriction(grasp, load, 0.0, (0.0, 0.0), still, None)
    general = SQUEEZE * force_unit(grasp, load)
    criteria = Criteria("effort", general if max_force is None else min(max_force, general), reserve=0.0)
    if (found := _smooth(_with(grasp, 0.0, rough), load, criteria)) is not None:
        return LeastFriction(grasp, load, 0.0, (0.0, 0.0), found, None)
    mu, state, escape = _by_formula(grasp, load, criteria, rough) or _by_halving(grasp, load, criteria, rough)
    if state is None:
        most = _with(grasp, MOST, rough)
        escape = escape_twist(most, load, most.frictions.tolist(), criteria.limits(most))
        return LeastFriction(grasp, load, inf, (MOST if escape else 0.0, inf), None, escape)
    lower = 0.0 if escape is None else _coefficient(escape.grasp)
    for share in _BELOW:
        if mu * (1 - share) <= lower:
            break
        less = _with(grasp, mu * (1 - share), rough)
        proof = _excluded(less, load, largest_share(less, load, criteria.limits(less)), rough, criteria)
        if proof is not None and lower < _coefficient(proof.grasp) <= mu:
            lower, escape = _coefficient(proof.grasp), proof
    return LeastFriction(grasp, load, mu, (lower, mu), state, escape)


def _by_formula(
    grasp: Grasp, load: Wrench, criteria: Criteria, rough: Container[int]
) -> "tuple[float, GraspState | None, EscapeTwist | None] | None":
    """Two planar contacts: the closed form of the least friction use."""
    if grasp.dimension == 3 or len(grasp) != 2 or grasp.limit_rows is not None:
        return None
    given = _with(grasp, _FORMULA, rough)
    used = Criteria("friction_use", criteria.max_force, reserve=0.0)
    try:
        state = ChosenState(given, load, used, choose_forces(given, load, used))
    except Infeasible:
        return inf, None, None
    mu = _FORMULA * state.value * (1 + _ROUNDING)
    return mu, GraspState(_with(grasp, mu, rough), load, state.forces), None


def _by_halving(
    grasp: Grasp, load: Wrench, criteria: Criteria, rough: Container[int]
) -> tuple[float, GraspState | None, EscapeTwist | None]:
    """What is left is halved; forces and twists that do more than was asked take the step they allow."""
    low, high, tried = 0.0, inf, 1.0
    state, escape = None, None
    while high == inf or high - low > _SETTLED * high:
        given = _with(grasp, tried, rough)
        found = largest_share(given, load, criteria.limits(given))
        held = found.state
        if held is not None:
            high, state = min(tried, _need(held, rough) * (1 + _ROUNDING)), held
        else:
            proof = _excluded(given, load, found, rough, criteria)
            low = tried
            if proof is not None and (
                escape is None or _coefficient(proof.grasp) > _coefficient(escape.grasp)
            ):
                low, escape = max(low, _coefficient(proof.grasp)), proof
        if low >= min(high, MOST):
            break
        if high == inf:
            tried *= 10
        else:
            tried = (low + high) / 2 if low > 0 or high < _TINY else high / 10
    if state is None:
        return inf, None, None
    return high, GraspState(_with(grasp, high, rough), load, state.forces), escape


def _coefficient(grasp: Grasp) -> float:
    """The one that its contacts share."""
    return float(grasp.frictions.max())


def _need(state: GraspState, rough: Container[int]) -> float:
    """The coefficient that forces need."""
    cones = state.grasp.cones
    measured = cones.measured(state.forces)
    normal, tangential = cones.normal(measured), cones.tangential(measured)
    pairs = enumerate(zip(normal.tolist(), tangential.tolist(), strict=True))
    return max((t / n for i, (n, t) in pairs if t > 0 and i in rough), default=0.0)


def _excluded(
    grasp: Grasp, load: Wrench, found: Share, rough: Container[int], criteria: Criteria
) -> EscapeTwist | None:
    """The proof that a twist is, v_n >= mu |v_t| at every contact, for the largest mu it excludes."""
    twist = found.twist
    if not twist.any() or not np.isfinite(twist).all():
        return None
    mu = grasp.frictions.tolist()
    if grasp.limit_rows is not None:  # of what was tried, since limits count
        by_rows = escape_by_rows(grasp, load, twist, found.row_duals, mu, criteria.limits(grasp))
        if by_rows is not None:
            return by_rows
    for motion in (twist, cleared(grasp, twist, mu, [inf] * len(grasp))):
        velocities = (grasp.cones.matrix.T @ motion).reshape(len(grasp), -1)
        normal = (velocities * grasp.cones.normals).sum(axis=1)
        across = np.linalg.norm(velocities - normal[:, None] * grasp.cones.normals, axis=1)
        pairs = enumerate(zip(normal.tolist(), across.tolist(), strict=True))
        # a contact that stands still but for rounding excludes nothing, and forbids nothing
        ratios = [n / t for i, (n, t) in pairs if t > _STILL * across.max() and i in rough]
        bound = min(min(ratios, default=0.0), MOST) * (1 - _ROUNDING)
        # force limits may let it exclude more than that: what was tried
        for share in sorted({bound, _coefficient(grasp)}, reverse=True):
            given = _with(grasp, share, rough)
            limits = tuple(criteria.limits(given))
            proof = EscapeTwist(given, load, motion, tuple(given.frictions.tolist()), limits)
            if proof.is_proof:
                return proof
    return None


def _with(grasp: Grasp, mu: float, rough: Container[int]) -> Grasp:
    """The grasp with one coefficient at some contacts, and none at the others."""
    return Grasp(
        c.changed(friction=mu) if mu > 0 and i in rough else c.changed(friction=0.0, torsion=None)
        for i, c in enumerate(grasp)
    )


def _smooth(grasp: Grasp, load: Wrench, criteria: Criteria) -> GraspState | None:
    """A state without friction, if there is one."""
    try:
        return ChosenState(grasp, load, criteria, choose_forces(grasp, load, criteria))
    except (Infeasible, SolverFailed):
        return None

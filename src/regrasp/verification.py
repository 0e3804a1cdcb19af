"""Independent check of a plan, decided in exact rational arithmetic.

Every double is a rational number, so the conditions are decided on the very numbers of the plan, without
rounding and, for cones and limits, with zero tolerance:

    cone         f.n >= 0   and   |f|^2 |n|^2 <= (1 + mu^2) (f.n)^2
    limit        |f|^2 <= max_force^2
    equilibrium  |sum f_i + F|^2 <= eps^2 s^2   and   |sum r_i x f_i + tau|^2 <= eps^2 s^2 l^2

with s the largest of |F|, |tau| / l and |f_i|, l the largest |r_i|, and eps = 2^-40: forces in doubles cannot
cancel to nothing. Friction below 2^-40 counts as 2^-40, for the same reason: a double cannot express a
direction more finely. All of these hold at every t when they hold at both ends and 0 <= T(t) <= 1, because
f(t) lies on the segment between the ends; and a B-spline stays within its control values.

Shares no code with the planner: it imports mechanics only, and of these only the values.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import inf, sqrt
from typing import Protocol

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.wrench import torque

RESOLUTION = Fraction(1, 2**40)
"""eps above: largest residual relative to the forces, and the least friction told from none."""

Vector = list[Fraction]


class Scaling(Protocol):
    """T(t) as ``verify`` sees it: a B-spline by its control values."""

    @property
    def duration(self) -> float:
        """[s]."""

    @property
    def control(self) -> tuple[float, ...]:
        """Control values, first to last."""


class Plan(Protocol):
    """What ``verify`` needs to know of a transition."""

    @property
    def kind(self) -> str:
        """``removal`` or ``addition``."""

    @property
    def contact(self) -> str:
        """Name of the finger that leaves or arrives."""

    @property
    def start(self) -> GraspState:
        """The state at t = 0."""

    @property
    def end(self) -> GraspState:
        """The state at t = duration."""

    @property
    def scaling(self) -> Scaling:
        """The time function between them."""


@dataclass(frozen=True)
class Verification:
    """The verdict on a plan.

    violations: each broken condition in words; none for a valid plan.
    worst_residual: largest equilibrium residual at an end, relative to the forces [-].
    least_angle: smallest angle margin over both ends and the contacts in use [rad], for information.
    least_cone_slack: smallest (1 + mu^2) - |f|^2 / (f.n)^2 over forces, exact before rounding; >= 0 inside.
    """

    violations: tuple[str, ...]
    worst_residual: float
    least_angle: float
    least_cone_slack: float

    @property
    def ok(self) -> bool:
        """Whether the plan holds the object at every instant, inside every cone and limit."""
        return not self.violations

    def __str__(self) -> str:
        if self.ok:
            return (
                f"verified in exact arithmetic: in equilibrium within {float(RESOLUTION):.1g} of the forces, "
                f"every force inside its cone, by {self.least_angle:.6g} rad or more"
            )
        return "\n".join(["not verified:", *(f"  {violation}" for violation in self.violations)])


def verify(plan: Plan) -> Verification:
    """Check a transition in exact arithmetic: both ends, the path between them and the idle finger."""
    violations: list[str] = []
    if plan.start.grasp != plan.end.grasp:
        violations.append("start and end have different contacts")
    if plan.start.load != plan.end.load:
        violations.append("start and end have different loads, so the straight path keeps no equilibrium")
    violations += _check_scaling(plan.scaling)
    violations += _check_idle(plan)
    residuals, slacks, angles = [0.0], [inf], [inf]
    for label, state in (("start", plan.start), ("end", plan.end)):
        residual, slack, broken = _check_state(state, label)
        residuals.append(residual)
        slacks.append(slack)
        violations += broken
        angles.append(state.margins.least_angle)
    return Verification(tuple(violations), max(residuals), min(angles), min(slacks))


def verify_setpoints(plan: Plan, forces: Array) -> Verification:
    """Check sampled forces (m, n, d) of a plan, the numbers that a controller will be given.

    Rows that are inside by more than rounding are settled in floating point, whose error is bounded; the
    others are decided exactly.
    """
    start, doubt = plan.start, float(RESOLUTION)
    grasp, load, d = start.grasp, start.load.vector, start.grasp.dimension
    if forces.ndim != 3 or forces.shape[1:] != start.forces.shape:
        return Verification(
            (f"set-points must have shape (m, {len(grasp)}, {d}), got {forces.shape}",), inf, 0, 0
        )
    normal = (forces * grasp.normals).sum(axis=-1)
    tangential = np.linalg.norm(forces - normal[..., None] * grasp.normals, axis=-1)
    magnitude = np.linalg.norm(forces, axis=-1)
    inside = grasp.frictions * normal - tangential > doubt * magnitude
    inside &= magnitude <= grasp.max_forces * (1 - doubt)
    total = np.concatenate([forces, torque(grasp.positions, forces)], axis=-1).sum(axis=1) + load
    arm = grasp.size or 1.0
    scale = np.maximum(magnitude.max(axis=1), np.linalg.norm(load[:d]))
    off = np.maximum(np.linalg.norm(total[:, :d], axis=1), np.linalg.norm(total[:, d:], axis=1) / arm)
    settled = inside.all(axis=1) & (off <= doubt / 2 * scale)
    violations, slacks, residuals = [], [inf], [0.0]
    for row in np.flatnonzero(~settled):
        state = GraspState(grasp, start.load, forces[row])
        residual, slack, broken = _check_state(state, f"set-point {row}")
        violations += broken
        slacks.append(slack)
        residuals.append(residual)
    angles = np.where(
        magnitude > doubt * scale[:, None], np.arctan(grasp.frictions) - np.arctan2(tangential, normal), inf
    )
    return Verification(tuple(violations), max(residuals), float(angles.min(initial=inf)), min(slacks))


def _check_scaling(scaling: Scaling) -> list[str]:
    control = [Fraction(c) for c in scaling.control]
    broken = []
    if control[0] != 1 or control[-1] != 0:
        broken.append(
            f"time scaling runs from {scaling.control[0]:g} to {scaling.control[-1]:g}, not from 1 to 0"
        )
    if min(control) < 0 or max(control) > 1:
        broken.append("time scaling may leave [0, 1], so the path may leave the segment between its ends")
    if not scaling.duration > 0:
        broken.append(f"duration is {scaling.duration:g} s, not greater than 0")
    return broken


def _check_idle(plan: Plan) -> list[str]:
    if plan.kind not in ("removal", "addition"):
        return [f"kind {plan.kind!r} is neither removal nor addition"]
    state, when = (plan.end, "end") if plan.kind == "removal" else (plan.start, "start")
    if plan.contact not in state.grasp.names:
        return [f"contact {plan.contact!r} is not one of {', '.join(state.grasp.names)}"]
    force = state.forces[state.grasp.names.index(plan.contact)].tolist()
    if any(force):
        return [f"{when}: {plan.contact} must carry no force, it carries {force}"]
    return []


def _check_state(state: GraspState, label: str) -> tuple[float, float, list[str]]:
    """(residual, least cone slack, violations) of one state."""
    residual, violations = _check_equilibrium(state, label)
    slacks = [inf]
    for i, name in enumerate(state.grasp.names):
        slack, broken = _check_force(state, i, f"{label}: force of {name}")
        slacks.append(slack)
        violations += broken
    return residual, min(slacks), violations


def _check_force(state: GraspState, i: int, what: str) -> tuple[float, list[str]]:
    contact = state.grasp.contacts[i]
    f, n = _exact(state.forces[i].tolist()), _exact(contact.normal.tolist())
    normal, ff, nn = _dot(f, n), _dot(f, f), _dot(n, n)
    mu = max(Fraction(contact.friction), RESOLUTION)
    broken = []
    if normal < 0:
        broken.append(f"{what} pulls: normal component {float(normal):.3g}")
    elif ff * nn > (1 + mu * mu) * normal * normal:
        use = sqrt(max(ff * nn - normal * normal, Fraction(0))) / float(mu * normal) if normal else inf
        broken.append(f"{what} is outside its friction cone: it uses {use:.12g} of the friction available")
    limit = contact.max_force
    if limit is not None and ff > Fraction(limit) ** 2:
        broken.append(f"{what} is {sqrt(ff):.12g}, above its limit {limit:.12g}")
    slack = float((1 + mu * mu) - ff * nn / (normal * normal)) if normal > 0 else (inf if ff == 0 else -inf)
    return slack, broken


def _check_equilibrium(state: GraspState, label: str) -> tuple[float, list[str]]:
    d = state.grasp.dimension
    load = _exact(state.load.vector.tolist())
    force, torque = load[:d], load[d:]
    positions = [_exact(c.position.tolist()) for c in state.grasp.contacts]
    forces = [_exact(f) for f in state.forces.tolist()]
    for r, f in zip(positions, forces, strict=True):
        force = [a + b for a, b in zip(force, f, strict=True)]
        torque = [a + b for a, b in zip(torque, _cross(r, f), strict=True)]
    arm2 = max(_dot(r, r) for r in positions) or Fraction(1)
    scale2 = max(_dot(load[:d], load[:d]), _dot(load[d:], load[d:]) / arm2, *(_dot(f, f) for f in forces))
    residual2 = max(_dot(force, force), _dot(torque, torque) / arm2)
    if scale2 == 0:
        return 0.0, []
    relative = sqrt(residual2 / scale2)
    if residual2 > RESOLUTION**2 * scale2:
        return relative, [
            f"{label}: not in equilibrium, G f + w_ext is {relative:.3g} of the largest force "
            f"(allowed {float(RESOLUTION):.1e})"
        ]
    return relative, []


def _exact(values: Sequence[float]) -> Vector:
    return [Fraction(value) for value in values]


def _dot(a: Vector, b: Vector) -> Fraction:
    return sum((x * y for x, y in zip(a, b, strict=True)), start=Fraction(0))


def _cross(r: Vector, f: Vector) -> Vector:
    if len(r) == 2:
        return [r[0] * f[1] - r[1] * f[0]]
    return [r[1] * f[2] - r[2] * f[1], r[2] * f[0] - r[0] * f[2], r[0] * f[1] - r[1] * f[0]]

"""How far forces are from the boundary of their friction cones."""

from dataclasses import dataclass
from math import atan, atan2, hypot, inf, nan, pi
from operator import mul

import numpy as np

from regrasp.display import table
from regrasp.mechanics.checks import Array, read_only
from regrasp.mechanics.value import ArrayValue

# A force below this fraction of the largest one is rounding: the contact carries no force.
IDLE = 2.0**-40
COLUMNS = ("angle margin [deg]", "force margin [N]", "friction use [-]")
"""Of a table of margins."""


@dataclass(frozen=True, eq=False)
class Margins(ArrayValue):
    """Margins of each contact, NaN where the contact carries no force and a margin has no meaning.

    For one state each is (n,); for m instants each is (m, n).
    """

    angle: Array
    """alpha_i minus the angle between f_i and n_i [rad]; at most alpha_i, positive inside the cone."""
    force: Array
    """Distance of f_i to the boundary of its cone [N]; positive inside, 0 for a contact without force."""
    friction_use: Array
    """|f_t| / (mu f_n) [-]; 0 along the normal, 1 on the boundary, smaller is safer. NaN for a frictionless
    contact pushed along its normal, infinite for any force a cone cannot make at all."""

    def rows(self) -> list[list[float]]:
        """For each contact of one state its numbers in the order of ``COLUMNS``."""
        angles = np.degrees(self.angle)
        return [list(row) for row in np.stack([angles, self.force, self.friction_use], axis=-1).tolist()]

    def _repr_html_(self) -> str | None:
        """Of one state a row for each contact, for notebooks; of many instants their text."""
        if self.angle.ndim != 1:
            return None
        return table(["contact", *COLUMNS], ([i, *row] for i, row in enumerate(self.rows(), 1)))

    @property
    def least_angle(self) -> float:
        """The smallest angle margin over the contacts in use [rad]; NaN when none is."""
        return _over_used(self.angle, np.fmin, inf)

    @property
    def least_force(self) -> float:
        """The smallest force margin over the contacts in use [N]; NaN when none is."""
        return _over_used(np.where(np.isnan(self.angle), nan, self.force), np.fmin, inf)

    @property
    def largest_friction_use(self) -> float:
        """The largest friction use over the contacts in use [-]; NaN when none is."""
        return _over_used(self.friction_use, np.fmax, -inf)


def margins(forces: Array, normals: Array, frictions: Array) -> Margins:
    """Margins of ``forces`` (..., n, d) in the cones of unit ``normals`` (n, d) and ``frictions`` (n,)."""
    normal = (forces * normals).sum(axis=-1)  # f_n
    tangent = forces - normal[..., None] * normals
    tangential = np.sqrt((tangent**2).sum(axis=-1))  # |f_t|
    magnitude = np.sqrt((forces**2).sum(axis=-1))
    idle = magnitude <= IDLE * magnitude.max(axis=-1, keepdims=True)

    angle = np.arctan(frictions) - np.arctan2(tangential, normal)
    # The nearest boundary point lies on the nearer edge, or at the apex for a force that points well out.
    edge = (frictions * normal - tangential) / np.hypot(1.0, frictions)
    force = np.where(angle >= -pi / 2, edge, -magnitude)
    available = np.maximum(frictions * normal, 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        use = np.where(normal < 0, inf, tangential / available)
    # Nothing used of nothing; a double cannot express the direction of less friction than that.
    straight = (frictions <= IDLE) & (normal > 0) & (tangential <= IDLE * magnitude)
    return Margins(
        read_only(np.where(idle, nan, angle)),
        read_only(np.where(idle, 0.0, force)),
        read_only(np.where(idle | straight, nan, use)),
    )


_FEW = 12  # contacts whose margins take less in plain numbers than as arrays


def least_angle(forces: Array, normals: Array, frictions: Array) -> float:
    """``margins(...).least_angle`` of one state (n, d), to rounding."""
    if len(forces) > _FEW:
        return margins(forces, normals, frictions).least_angle
    used = _used_parts(forces, normals, frictions)
    return min([atan(mu) - atan2(tangent, normal) for normal, tangent, _, mu in used], default=nan)


def largest_use(forces: Array, normals: Array, frictions: Array) -> float:
    """``margins(...).largest_friction_use`` of one state (n, d), to rounding."""
    if len(forces) > _FEW:
        return margins(forces, normals, frictions).largest_friction_use
    uses = []
    for normal, tangent, size, mu in _used_parts(forces, normals, frictions):
        if mu <= IDLE and normal > 0 and tangent <= IDLE * size:
            continue
        available = mu * normal
        uses.append(tangent / available if available > 0 else inf if normal < 0 or tangent > 0 else nan)
    return max((use for use in uses if use == use), default=nan)


def _used_parts(forces: Array, normals: Array, frictions: Array) -> list[tuple[float, float, float, float]]:
    """(f_n, |f_t|, |f|, mu) of the contacts that carry force."""
    parts = []
    for f, n, mu in zip(forces.tolist(), normals.tolist(), frictions.tolist(), strict=True):
        normal = sum(map(mul, f, n))
        tangent = hypot(*[a - normal * b for a, b in zip(f, n, strict=True)])
        parts.append((normal, tangent, hypot(*f), mu))
    least = IDLE * max([size for _, _, size, _ in parts], default=0.0)
    return [part for part in parts if part[2] > least]


def _over_used(values: Array, pick: np.ufunc, start: float) -> float:
    if np.isnan(values).all():
        return nan
    return float(pick.reduce(values, axis=None, initial=start))


def friction_needed(forces: Array, normals: Array, torsions: Array | None = None) -> Array:
    """(..., n) the least coefficient that keeps each force inside its cone [-]: |f_t| / f_n.

    forces: (..., n, d) [N], of soft fingers (..., n, 4) with ``torsions`` (n,) [m], whose limit surface
    leaves |f_t| / sqrt(f_n^2 - (m / torsion)^2). 0 for a contact without force, infinite where none does.
    """
    d = normals.shape[1]
    linear = forces[..., :d]
    normal = (linear * normals).sum(axis=-1)  # f_n
    tangential = np.sqrt(((linear - normal[..., None] * normals) ** 2).sum(axis=-1))
    magnitude = np.sqrt((linear**2).sum(axis=-1))
    available = normal
    if torsions is not None:
        twist = np.divide(forces[..., 3], torsions, out=np.zeros_like(normal), where=torsions > 0)
        left = np.maximum((normal - abs(twist)) * (normal + abs(twist)), 0.0)
        available = np.where(normal > 0, np.sqrt(left), normal)
    idle = magnitude <= IDLE * magnitude.max(axis=-1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        needed = np.where(available > 0, tangential / available, inf)
    return np.where(idle, 0.0, needed)

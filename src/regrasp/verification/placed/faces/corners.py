"""States at the corners of regions on faces, and the torque that their mixtures may lack.

Doubles decide where more than all of their rounding is left, rationals (``exact``) where it is not. With
u = 2^-53, sums and products of a few terms are off by some tens of u times the sum of their sizes, for which
2^-46 = 128 u is taken; normals are of length 1 to 2 u. Forces are divided by the largest of all, so that
squares are no less than doubles hold but of forces that rationals judge.
"""

from fractions import Fraction
from itertools import product
from math import inf
from typing import Any

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.verification.exact import HELD, RESOLUTION, check_forces, exact, load_size
from regrasp.verification.placed.regions import above

_ROUNDING = 2.0**-46
_LEAST = 1e-140  # of the largest force: squares of less lose digits
_FOCUS = 32.0  # focus times width, up to which corners that are uneven by rounding do not count


class Corners:
    """The states (c, s) at all combinations of corners of patches under one load."""

    def __init__(self, regions: Any, load: int) -> None:
        self.grasp, self.limit = regions.grasp, float(regions.max_force)
        self.load, self.moments = np.asarray(regions.loads)[load], np.asarray(regions.moments)[load]
        self.patches = [np.asarray(p) for p in regions.patches]
        self.points = np.array(list(product(*self.patches)))  # (c, k, 3)
        self.forces = np.asarray(regions.forces)[load]  # (c, s, k, 3)
        self.tilts, self.focus = np.asarray(regions.tilts)[load], np.asarray(regions.focus)[load]
        self.wide = [i for i, p in enumerate(self.patches) if len(p) > 1]
        self.signs = np.array(list(product((-1.0, 1.0), repeat=len(self.wide))))
        self.asked = load_size(self.grasp, self.load[None])
        self.unit = float(np.abs(self.forces).max()) or 1.0
        self.scaled = self.forces / self.unit
        self.along = (self.scaled * self.grasp.normals).sum(axis=-1)
        self.size = np.linalg.norm(self.scaled, axis=-1)

    def wrong(self) -> tuple[float, list[str]]:
        """The largest residual, of the forces, and what is wrong with the first state that is."""
        residuals, balanced = self.balanced()
        told = balanced & (self.in_cones() & self.below_limit()).all(axis=2)
        residual = float(residuals[told].max(initial=0.0))
        for corner, sign in np.argwhere(~told).tolist():
            worse, broken = self._exactly(corner, sign)
            residual = max(residual, worse)
            if broken:
                return residual, broken
        return residual, []

    def in_cones(self) -> np.ndarray:
        """(c, s, k) which forces doubles show to be in their cones."""
        mu = self.grasp.frictions
        across = np.linalg.norm(self.scaled - self.along[..., None] * self.grasp.normals, axis=-1)
        clear = mu * self.along - across > _ROUNDING * (1 + mu) * self.size
        return np.asarray(clear & (self.size > _LEAST))

    def below_limit(self) -> np.ndarray:
        """(c, s, k) which forces doubles show to be no larger than they may be."""
        return np.asarray(self.size * self.unit * (1 + _ROUNDING) <= self.limit)

    def balanced(self) -> tuple[Array, np.ndarray]:
        """(c, s) residuals, of the largest force of each state, and which doubles show to be small enough."""
        load, torque = np.split(self.load / self.unit, 2)
        signed = self.signs * self.moments[self.wide] / self.unit
        lever = np.linalg.norm(self.points, axis=2).max(axis=1)[:, None]
        lever[lever == 0] = 1.0
        off = np.linalg.norm(self.scaled.sum(axis=2) + load, axis=-1)
        torques = np.cross(self.points[:, None], self.scaled).sum(axis=2) + torque
        twist = np.linalg.norm(torques + signed @ self.grasp.normals[self.wide], axis=-1) / lever
        terms = self.size.sum(axis=2) + np.linalg.norm(load)
        terms = terms + (np.linalg.norm(torque) + np.abs(signed).sum(axis=1)) / lever
        residual, largest = np.maximum(off, twist), self.size.max(axis=2)
        allowed = float(RESOLUTION) * largest
        if self.asked:
            allowed = np.minimum(allowed, float(HELD) * self.asked / self.unit)
        return residual / np.maximum(largest, _LEAST), np.asarray(residual + _ROUNDING * terms <= allowed)

    def _exactly(self, corner: int, sign: int) -> tuple[float, list[str]]:
        at = [
            Contact(p, c.normal, c.friction, name=c.name)
            for p, c in zip(self.points[corner], self.grasp, strict=True)
        ]
        load = exact(self.load.tolist())
        for way, i in zip(self.signs[sign].tolist(), self.wide, strict=True):
            moment = Fraction(way) * Fraction(float(self.moments[i]))
            for axis, n in enumerate(exact(self.grasp[i].normal.tolist())):
                load[3 + axis] += moment * n
        forces = self.forces[corner, sign]
        residual, _, broken = check_forces(at, forces, load, self.asked, f"corner {corner + 1}")
        return residual, broken + [f"corner {corner + 1}: {words}" for words in above(forces, self.limit)]

    def lacks(self, i: int) -> float:
        """The most torque about its normal that mixtures of a finger's forces may lack, from above [N m]."""
        patch, contact = self.patches[i], self.grasp[i]
        n, r, s = contact.normal, contact.position, float(self.focus[i])
        wide = float(np.linalg.norm(patch[:, None] - patch, axis=2).max())
        if abs(s) * wide > _FOCUS:
            return inf
        at = self.points[:, None, i] - r  # (c, 1, 3)
        f, along, size = self.scaled[:, :, i], self.along[:, :, i], self.size[:, :, i]
        tilt = self.tilts[i] - (self.tilts[i] @ n) * n
        aside = np.linalg.norm(f - along[..., None] * (n + tilt + s * at), axis=-1)
        terms = size * (1 + np.linalg.norm(self.tilts[i]) + abs(s) * np.linalg.norm(at, axis=-1))
        aside = np.where(f.any(axis=-1), aside + _ROUNDING * terms + _LEAST, 0.0)
        least, most = along - _ROUNDING * size - _LEAST, float((along + _ROUNDING * size).max())
        slope = np.where(aside > 0, inf, 0.0)
        np.divide(aside, least, out=slope, where=least > 0)
        radius = float(np.linalg.norm(patch - r, axis=1).max())
        steepest = float(slope.max())
        by_slope = most * steepest * radius if steepest < inf else inf
        return min(by_slope, float(aside.max()) * wide) * self.unit * (1 + _ROUNDING)

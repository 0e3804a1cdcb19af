"""Friction cones as circular cones, soft fingers included.

A soft finger's force (f, m) with a torque m about the normal lies inside its limit surface
(|f_t| / mu)^2 + (m / e)^2 <= f_n^2. With g = mu m / e that is |(f_t, g)| <= mu f_n: the circular cone
of a point contact with one tangent more. So whatever knows circular cones of any dimension knows soft
fingers, if it is given forces as (f, g), normals as (n, 0) and the grasp matrix for g. Nothing else changes.
"""

from functools import cached_property

import numpy as np

from regrasp.mechanics.checks import Array, read_only
from regrasp.mechanics.orientation.tangents import tangents_of


class Cones:
    """The cones of a grasp; ``forces`` are (..., n, w) with w of 2, 3, or 4 where a finger is soft.

    matrix: (3 or 6, n w) of stacked forces as the cones measure them. normals: (n, w), unit.
    """

    def __init__(self, matrix: Array, normals: Array, frictions: Array, torsions: Array | None) -> None:
        self._d, self._frictions = normals.shape[1], frictions
        self._arms: Array | None = None
        self.matrix, self.normals = matrix, normals
        if torsions is None:
            return
        self._arms = torsions / np.where(
            torsions > 0, frictions, 1.0
        )  # torque per g [m]; 0 of point contacts
        scaled = matrix.reshape(6, len(normals), 4).copy()
        scaled[:, :, 3] *= self._arms
        self.matrix = read_only(scaled.reshape(6, -1))
        self.normals = read_only(np.pad(normals, ((0, 0), (0, 1))))

    @cached_property
    def tangents(self) -> Array:
        """(n, w - 1, w) orthonormal directions across each normal."""
        across = tangents_of(self.normals[:, : self._d])
        if self._arms is None:
            return read_only(across)
        result = np.zeros((len(across), 3, 4))
        result[:, :2, :3], result[:, 2, 3] = across, 1.0
        return read_only(result)

    def measured(self, forces: Array) -> Array:
        """Forces as the cones measure them: torques about normals as the tangential forces mu m / e."""
        if self._arms is None:
            return forces
        result = forces.copy()
        result[..., 3] = np.divide(
            forces[..., 3], self._arms, out=np.zeros(forces.shape[:-1]), where=self._arms > 0
        )
        return result

    def forces(self, measured: Array) -> Array:
        """The forces of ``measured``."""
        if self._arms is None:
            return measured
        result = measured.copy()
        result[..., 3] *= self._arms
        return result

    def measuring(self, rows: Array, i: int) -> Array:
        """Rows (m, w) that multiply forces of contact ``i``, as rows that multiply ``measured`` ones."""
        if self._arms is None:
            return rows
        result = rows.copy()
        result[:, 3] *= self._arms[i]
        return result

    def normal(self, measured: Array) -> Array:
        """(..., n) normal forces [N]."""
        result: Array = (measured * self.normals).sum(axis=-1)
        return result

    def tangential(self, measured: Array) -> Array:
        """(..., n) |f_t|, of soft fingers |(f_t, g)| [N]."""
        across = measured - self.normal(measured)[..., None] * self.normals
        result: Array = np.sqrt((across * across).sum(axis=-1))
        return result

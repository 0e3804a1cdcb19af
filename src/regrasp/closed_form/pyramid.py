"""Friction cones as inner pyramids of m facets, in the squeezes of three contacts.

An inner pyramid has its edges on the cone, so whatever it accepts is truly safe. With m unit tangents t_k
spread evenly, each half way between two edges, its facets are the rows

    rho f.n - f.t_k >= 0,    rho = mu cos(pi / m).

Narrowed by an angle delta < atan(mu) whose tangent is s, the friction is tan(atan(mu) - delta), which is
(mu - s) / (1 + mu s).

The first edge leans towards the normal of the triangle's plane where that is far enough from the contact's
normal, and else towards the centroid of the triangle. Both belong to the triangle alone, and m is even, so
that neither the frame nor the order of the contacts changes a verdict.
"""

from math import cos, pi, sin, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from regrasp.closed_form.triple import Frame, Three, Vector, along_squeezes, cross, dot, plus, scaled

# The plane's normal is far enough from n up to this (n . k)^2, which is no angle that people build with.
_UPRIGHT = 0.55


def facet_angles(facets: int) -> NDArray[np.float64]:
    """(m, 2) cosine and sine of the angle from the first edge to every t_k."""
    angles = [(2 * k + 1) * pi / facets for k in range(facets)]
    return np.array([(cos(a), sin(a)) for a in angles])


def first_edge(frame: Frame, i: int, n: Vector) -> Vector:
    """The unit tangent towards which the first edge of contact i leans."""
    k, arm = frame[0], frame[3][i]
    rise = dot(n, k)
    towards = plus(k, -rise, n) if rise * rise <= _UPRIGHT else plus(arm, -dot(arm, n), n)
    return scaled(1.0 / sqrt(dot(towards, towards)), towards)


def write_tangents(
    frame: Frame, normals: Three, angles: NDArray[np.float64], tangents: Any, ahead: Any, sideways: Any
) -> None:
    """Fills tangents (3, 3m), the t_k of all contacts, and what the squeezes do along normals and tangents.

    ahead (4, 3) and sideways (4, 3m) get the growth of f_i.n_i and f_i.t_k with x12, x23 and x31; their last
    row is for the load, see ``write_load``.
    """
    m = len(angles)
    for i in range(3):
        n = normals[i]
        e1 = first_edge(frame, i, n)
        e2 = cross(n, e1)
        ahead[0, i], ahead[1, i], ahead[2, i] = along_squeezes(frame, i, n)
        for j in range(m):
            t, at = plus(scaled(angles[j, 0], e1), angles[j, 1], e2), i * m + j
            tangents[0, at], tangents[1, at], tangents[2, at] = t
            sideways[0, at], sideways[1, at], sideways[2, at] = along_squeezes(frame, i, t)


def write_load(normals: Three, tangents: Any, forces: Three, ahead: Any, sideways: Any) -> None:
    """Fills the last rows of ``ahead`` and ``sideways`` with the particular forces along n_i and t_k."""
    m = tangents.shape[1] // 3
    for i in range(3):
        fx, fy, fz = forces[i]
        ahead[3, i] = dot(forces[i], normals[i])
        for at in range(i * m, (i + 1) * m):
            sideways[3, at] = tangents[0, at] * fx + tangents[1, at] * fy + tangents[2, at] * fz


def slope(mu: float, narrowed: float, cos_half: float) -> float:
    """The rho of a pyramid with cos(pi / m) = ``cos_half``, narrowed by the angle of this tangent."""
    return cos_half * (mu - narrowed) / (1.0 + mu * narrowed)


def write_facets(
    ahead: Any, sideways: Any, mu: Vector, narrowed: float, cos_half: float, first: int, rows: Any
) -> None:
    """Fills ``rows`` (4, ...) from column ``first`` on: coefficients of x12, x23, x31 and the constant."""
    m = sideways.shape[1] // 3
    for i in range(3):
        rho = slope(mu[i], narrowed, cos_half)
        for c in range(4):
            lean = rho * ahead[c, i]
            for at in range(i * m, (i + 1) * m):
                rows[c, first + at] = lean - sideways[c, at]

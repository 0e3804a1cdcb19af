"""The least of a cost of squares, from multipliers of the balance that are nearly the best.

    minimise   sum_i a_i |f_i|^2 + c_i . f_i   subject to   G f + w = 0,   f_i in cone_i

with all a_i > 0 has a dual of one unknown y per wrench component: f_i(y) is the point of the cone nearest to
-(c_i + G_i'y) / (2 a_i), and G f(y) + w = 0 says that the y is best. Newton's method from a solver's y leaves
rounding after a step or two. So forces lie inside the cones and are the best there are, if they balance: of
both one is asked here at the end. In the plane on plain numbers, else in arrays.
"""

import numpy as np
from numpy.typing import NDArray

_Array = NDArray[np.float64]
_STEPS = 6
# Equilibrium counts as reached at this residual relative to the largest force or load, as in ``face_newton``.
_BALANCED = 5e-14
_FLAT = 1e-12
_FAST = 1e-3  # of the residual left by a step: the next one need not look at the curvature again


def least_in_plane(
    y: list[float], fingers: list[tuple[float, ...]], load: list[float]
) -> list[tuple[float, float]] | None:
    """The best forces of planar fingers; None where Newton's method does not reach equilibrium.

    y: (3,). fingers: of each its two torques per force, normal, friction, 1 / (2 a) and c. load: (3,).
    """
    y0, y1, y2 = y
    w0, w1, w2 = load
    largest = max(abs(w0), abs(w1), abs(w2))
    for _ in range(_STEPS):
        r0, r1, r2 = w0, w1, w2
        h00 = h01 = h02 = h11 = h12 = h22 = 0.0
        size, forces = largest, []
        for tx, ty, nx, ny, mu, soft, cx, cy in fingers:
            x, z = -soft * (cx + y0 + tx * y2), -soft * (cy + y1 + ty * y2)
            along, across = x * nx + z * ny, z * nx - x * ny
            if mu > 0 and mu * along >= abs(across):  # a smooth finger that would pull is not inside
                h00 += soft
                h11 += soft
                h02 += soft * tx
                h12 += soft * ty
                h22 += soft * (tx * tx + ty * ty)
            else:
                slope = mu if across > 0 else -mu
                ex, ey = nx - slope * ny, ny + slope * nx
                pushed = (x * ex + z * ey) / (1 + mu * mu)
                if pushed <= 0:
                    forces.append((0.0, 0.0))
                    continue
                x, z, turn, share = pushed * ex, pushed * ey, tx * ex + ty * ey, soft / (1 + mu * mu)
                h00 += share * ex * ex
                h01 += share * ex * ey
                h02 += share * ex * turn
                h11 += share * ey * ey
                h12 += share * ey * turn
                h22 += share * turn * turn
            forces.append((x, z))
            r0 += x
            r1 += z
            r2 += tx * x + ty * z
            size = max(size, abs(x), abs(z))
        if max(abs(r0), abs(r1), abs(r2)) <= _BALANCED * size:
            return forces
        # L D L' of the curvature, without pivots: it is positive definite or of no use.
        if not h00 > 0:
            return None
        l1, l2 = h01 / h00, h02 / h00
        d1 = h11 - l1 * h01
        if not d1 > _FLAT * h11:
            return None
        k = (h12 - l1 * h02) / d1
        d2 = h22 - l2 * h02 - k * k * d1
        if not d2 > _FLAT * h22:
            return None
        s1 = r1 - l1 * r0
        s2 = (r2 - l2 * r0 - k * s1) / d2
        s1 = s1 / d1 - k * s2
        y0 += r0 / h00 - l1 * s1 - l2 * s2
        y1 += s1
        y2 += s2
    return None


def least(
    y: _Array, matrix: _Array, load: _Array, frictions: _Array, soft: _Array, linear: _Array
) -> _Array | None:
    """The best forces (n, w), each along its normal and across it; None without equilibrium.

    y: (r,). matrix: (r, n w) of such forces. soft: (n,) 1 / (2 a). linear: (n, w) c.
    """
    n, w = linear.shape
    softness, root = soft[:, None], np.sqrt(1 + frictions * frictions)
    parts = matrix.reshape(-1, n, w)
    heaviest = np.maximum.reduce(np.abs(load))
    edge, back = np.empty((n, w)), np.empty((n, w))
    edge[:, 0], back[:, 0] = 1 / root, frictions / root
    inverse, before = None, np.inf
    for _ in range(_STEPS):
        v = -softness * (linear + (y @ matrix).reshape(n, w))
        along, beside = v[:, 0], v[:, 1:]
        across = np.sqrt(np.einsum("ij,ij->i", beside, beside))
        inside = (frictions > 0) & (frictions * along >= across)
        beyond = np.where(across > 0, across, 1.0) * root
        pushed = np.maximum(along + frictions * across, 0.0) / root
        back[:, 1:] = beside / -beyond[:, None]
        edge[:, 1:] = -frictions[:, None] * back[:, 1:]
        f = np.where(inside[:, None], v, pushed[:, None] * edge)
        off = matrix @ f.ravel() + load
        largest = max(np.maximum.reduce(np.abs(f), axis=None), heaviest)
        left = np.maximum.reduce(np.abs(off))
        if left <= _BALANCED * largest:
            return f
        if inverse is not None and left <= _FAST * before:  # the curvature is known well enough
            y, before = y + inverse @ off, left
            continue
        # How the nearest points move: with v inside, along the edge and around the rim beyond it.
        rim = np.where(inside, 1.0, pushed * frictions / beyond)
        H = (matrix * (soft * rim).repeat(w)) @ matrix.T
        for direction, share in (
            (edge, np.where(inside | (pushed <= 0), 0.0, soft * (1 - rim))),
            (back, np.where(inside, 0.0, -soft * rim)),
        ):
            moved = np.einsum("rij,ij->ri", parts, direction)
            H += (moved * share) @ moved.T
        try:
            inverse = np.linalg.inv(H)
        except np.linalg.LinAlgError:
            return None
        y, before = y + inverse @ off, left
    return None

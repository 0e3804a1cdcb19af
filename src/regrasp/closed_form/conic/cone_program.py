"""A small convex program over half-lines and second-order cones, by a primal-dual interior-point method.

    minimise w/2 |x|^2 + c . x   subject to   A x + s = b,   s in K = R_+^l x Q x ... x Q

Mehrotra's predictor and corrector in the coordinates of Nesterov and Todd, W z = W^-1 s = lambda, dense and
without any structure of the problem (Vandenberghe, The CVXOPT linear and quadratic cone program solvers,
2010). Everything is written into arrays that are handed in, so that one program after the other costs no
memory. Cones lie one after the other: ``flat`` numbers by themselves, then ``first[k]`` to ``first[k + 1]``.
"""

from math import inf, sqrt
from typing import Any

MOST_STEPS = 60
_NEAR = 0.99  # of the way to the boundary
_GAP, _PRIMAL, _DUAL = 1e-11, 1e-12, 1e-10
_ENOUGH = 1e4  # times these, where rounding ends the steps
_STRICT = 100.0  # duals that stay a little off leave little of a strictly convex cost: 1e-9 of it at most
_LEAST = 1e-200
_STUCK, _LOST = 1e-9, 1e3


def scale(s: Any, z: Any, flat: int, first: Any, w: Any, eta: Any, point: Any) -> bool:
    """The scaling of s and z: w, eta (per cone) and lambda; whether both are inside."""
    for i in range(flat):
        if not (s[i] > 0.0 and z[i] > 0.0):
            return False
        w[i] = sqrt(s[i] / z[i])
        point[i] = sqrt(s[i] * z[i])
    for k in range(first.size - 1):
        a, end = first[k], first[k + 1]
        ss, zz = s[a] * s[a], z[a] * z[a]
        for i in range(a + 1, end):
            ss -= s[i] * s[i]
            zz -= z[i] * z[i]
        if not (ss > 0.0 and zz > 0.0 and s[a] > 0.0 and z[a] > 0.0):
            return False
        ss, zz = sqrt(ss), sqrt(zz)
        product = s[a] * z[a]
        for i in range(a + 1, end):
            product += s[i] * z[i]
        gamma = sqrt((1.0 + product / (ss * zz)) / 2.0)
        w[a] = (s[a] / ss + z[a] / zz) / (2.0 * gamma)
        for i in range(a + 1, end):
            w[i] = (s[i] / ss - z[i] / zz) / (2.0 * gamma)
        eta[k] = sqrt(ss / zz)
    for k in range(first.size - 1):  # lambda = W z
        apply(z, first, w, eta, point, k, False)
    return True


def apply(v: Any, first: Any, w: Any, eta: Any, out: Any, k: int, inverse: bool) -> None:
    """Writes W v, or W^-1 v, of cone k."""
    a, end = first[k], first[k + 1]
    sign = -1.0 if inverse else 1.0
    size = 1.0 / eta[k] if inverse else eta[k]
    inner = 0.0
    for i in range(a + 1, end):
        inner += w[i] * v[i]
    head = v[a]
    share = sign * head + inner / (1.0 + w[a])
    out[a] = size * (w[a] * head + sign * inner)
    for i in range(a + 1, end):
        out[i] = size * (v[i] + share * w[i])


def applied(v: Any, flat: int, first: Any, w: Any, eta: Any, out: Any, inverse: bool) -> None:
    """Writes W v, or W^-1 v."""
    for i in range(flat):
        out[i] = v[i] / w[i] if inverse else v[i] * w[i]
    for k in range(first.size - 1):
        apply(v, first, w, eta, out, k, inverse)


def divided(point: Any, d: Any, flat: int, first: Any, out: Any) -> None:
    """Writes u with lambda o u = d."""
    for i in range(flat):
        out[i] = d[i] / point[i]
    for k in range(first.size - 1):
        a, end = first[k], first[k + 1]
        det, inner = point[a] * point[a], 0.0
        for i in range(a + 1, end):
            det -= point[i] * point[i]
            inner += point[i] * d[i]
        head = (point[a] * d[a] - inner) / det
        for i in range(a + 1, end):
            out[i] = (d[i] - head * point[i]) / point[a]
        out[a] = head


def product(p: Any, q: Any, flat: int, first: Any, out: Any) -> None:
    """Writes p o q."""
    for i in range(flat):
        out[i] = p[i] * q[i]
    for k in range(first.size - 1):
        a, end = first[k], first[k + 1]
        inner = p[a] * q[a]
        for i in range(a + 1, end):
            inner += p[i] * q[i]
        for i in range(a + 1, end):
            out[i] = p[a] * q[i] + q[a] * p[i]
        out[a] = inner


def reach(point: Any, d: Any, flat: int, first: Any) -> float:
    """The inverse of the largest step along d from lambda that stays in the cone; 0 for any."""
    most = 0.0
    for i in range(flat):
        most = max(most, -d[i] / point[i])
    for k in range(first.size - 1):
        a, end = first[k], first[k + 1]
        det = point[a] * point[a]
        for i in range(a + 1, end):
            det -= point[i] * point[i]
        root = sqrt(max(det, _LEAST))
        head, ahead = point[a] / root, 0.0
        for i in range(a + 1, end):
            ahead += point[i] / root * d[i]
        rho, across = (head * d[a] - ahead) / root, 0.0
        share = (rho * root + d[a]) / (head + 1.0)
        for i in range(a + 1, end):
            across += ((d[i] - share * point[i] / root) / root) ** 2
        most = max(most, sqrt(across) - rho)
    return most


def factored(h: Any, size: int) -> bool:
    """Writes the Cholesky factor of h into its lower part; whether there is one."""
    for j in range(size):
        pivot = h[j, j]
        for k in range(j):
            pivot -= h[j, k] * h[j, k]
        if not pivot > 0.0:
            return False
        root = sqrt(pivot)
        h[j, j] = root
        for i in range(j + 1, size):
            entry = h[i, j]
            for k in range(j):
                entry -= h[i, k] * h[j, k]
            h[i, j] = entry / root
    return True


def solved(h: Any, size: int, right: Any) -> None:
    """Writes the solution in the place of the right side."""
    for i in range(size):
        entry = right[i]
        for k in range(i):
            entry -= h[i, k] * right[k]
        right[i] = entry / h[i, i]
    for i in range(size - 1, -1, -1):
        entry = right[i]
        for k in range(i + 1, size):
            entry -= h[k, i] * right[k]
        right[i] = entry / h[i, i]


def minimise(
    weight: float, c: Any, A: Any, b: Any, size: int, rows: int, flat: int, first: Any, x: Any, s: Any,
    z: Any, room: Any, h: Any, scaled: Any,
) -> int:  # fmt: skip
    """Writes x (size,), s and z (rows,) from a start with s and z inside the cone; 1 where they are solved.

    A: at least (rows, size). room: (12, rows). h: (size, size). scaled: (rows, size).
    """
    w, eta, point, u = room[0], room[1], room[2], room[3]
    dz, ds, rz, t, right, dx = room[4], room[5], room[6], room[7], room[8], room[9]
    cones = flat + first.size - 1
    best_x, best_z, best = room[10], room[11], inf
    for _ in range(MOST_STEPS):
        # residuals and gap
        gap, largest, primal, dual, cost = 0.0, 1.0, 0.0, 0.0, 1.0
        for j in range(size):
            largest = max(largest, abs(x[j]))
        for i in range(rows):
            gap += s[i] * z[i]
            entry = s[i] - b[i]
            for j in range(size):
                entry += A[i, j] * x[j]
            rz[i] = entry
            primal = max(primal, abs(entry))
        for j in range(size):
            entry = weight * x[j] + c[j]
            for i in range(rows):
                entry += A[i, j] * z[i]
            right[j] = -entry
            dual = max(dual, abs(entry))
            cost = max(cost, abs(c[j]), abs(weight * x[j]))
        objective = 0.0
        for j in range(size):
            objective += (weight * x[j] / 2.0 + c[j]) * x[j]
        unit = _GAP * max(1.0, abs(objective))
        far = max(gap / unit, primal / largest / _PRIMAL, dual / cost / _DUAL)
        score = far
        if weight > 0.0:  # c'x + w/2 |x|^2 can fall by no more than gap + dual^2 size / (2 w)
            left = max(gap / unit, primal / largest / _PRIMAL, dual * dual * size / (2.0 * weight) / unit)
            score = min(far, _STRICT * left)
        if score < best:
            best = score
            for j in range(size):
                best_x[j] = x[j]
            for i in range(rows):
                best_z[i] = z[i]
        if far <= 1.0 or not far < inf or (best <= _ENOUGH and far > _LOST * best):
            break
        if not scale(s, z, flat, first, w, eta, point):
            break
        mean = gap / cones
        # the matrix: w I + (W^-1 A)' (W^-1 A), columns of A one after the other
        for j in range(size):
            for i in range(rows):
                t[i] = A[i, j]
            applied(t, flat, first, w, eta, u, True)
            for i in range(rows):
                scaled[i, j] = u[i]
        for j in range(size):
            for k in range(j + 1):
                entry = weight if j == k else 0.0
                for i in range(rows):
                    entry += scaled[i, j] * scaled[i, k]
                h[j, k] = entry
            h[j, j] += 1e-14 * h[j, j]
        if not factored(h, size):
            break
        applied(rz, flat, first, w, eta, t, True)
        for i in range(rows):
            rz[i] = t[i]  # W^-1 rz
        # predictor: lambda o (W dz + W^-1 ds) = -lambda o lambda, so u = -lambda
        for i in range(rows):
            u[i] = -point[i]
        direction(scaled, h, size, rows, right, rz, u, dx, dz, ds)
        step = min(1.0, 1.0 / max(reach(point, dz, flat, first), reach(point, ds, flat, first), 1.0))
        sigma = (1.0 - step) ** 3
        # corrector
        product(dz, ds, flat, first, t)
        for i in range(rows):
            t[i] = -t[i]
        for i in range(flat):
            t[i] += sigma * mean
        for k in range(first.size - 1):
            t[first[k]] += sigma * mean
        divided(point, t, flat, first, ds)
        for i in range(rows):
            u[i] = ds[i] - point[i]
        direction(scaled, h, size, rows, right, rz, u, dx, dz, ds)
        most = max(reach(point, dz, flat, first), reach(point, ds, flat, first))
        step = min(1.0, _NEAR / most) if most > 0.0 else 1.0
        for j in range(size):
            x[j] += step * dx[j]
        applied(ds, flat, first, w, eta, t, False)
        applied(dz, flat, first, w, eta, u, True)
        for i in range(rows):
            s[i] += step * t[i]
            z[i] += step * u[i]
        if step < _STUCK:
            break
    for j in range(size):
        x[j] = best_x[j]
    for i in range(rows):
        z[i] = best_z[i]
    return 1 if best <= _ENOUGH else 0


def direction(
    scaled: Any, h: Any, size: int, rows: int, right: Any, rz: Any, u: Any, dx: Any, dz: Any, ds: Any
) -> None:
    """Writes dx, W dz and W^-1 ds."""
    for j in range(size):
        entry = right[j]
        for i in range(rows):
            entry -= scaled[i, j] * (rz[i] + u[i])
        dx[j] = entry
    solved(h, size, dx)
    for i in range(rows):
        entry = rz[i] + u[i]
        for j in range(size):
            entry += scaled[i, j] * dx[j]
        dz[i] = entry
        ds[i] = u[i] - entry

"""The least of a cost of planar forces on the face in sight, on plain numbers.

Cones in the plane are polyhedra: on a face f = B q, of columns b that are a force inside its cone, along an
edge or along its normal, so that three equations are left,

    squares   sum_b (G b)(G b)'/ 2a y = w - sum_b G b (c.b) / 2a,   q_b = -(c + G'y).b / 2a
    a vertex  (G B) q = -w,   (G B)' y = -c.b

What pulls at a finger, v = -(c + G'y + 2 a f), then has to point out of what it touches (Karush, Kuhn,
Tucker). Loops over plain numbers: a few fingers take a fifth of the time that arrays do.
"""

from math import inf, sqrt

from regrasp.closed_form.least.faces import NEAR, NONE, OVER, PEAK_NORMAL, SIGN, TRACE

_Row = list[float]
_INSIDE, _CLOCKWISE, _OTHER, _IDLE, _SMOOTH = 0, 1, -1, 2, 3
# Below this a determinant is rounding.
_FLAT = 1e-12


def least_in_plane(
    x: list[_Row],
    matrix: list[_Row],
    load: _Row,
    normals: list[_Row],
    frictions: _Row,
    limits: _Row,
    squares: _Row,
    linear: list[_Row],
    kind: int,
) -> list[_Row] | None:
    """The best forces (n, 2) near ``x``, in units of force; None where they are not found.

    The arguments are those of ``face_newton.refined``; frictions are 0 or more than nothing. kind:
    ``NONE``, with all squares above zero or all zero, or ``PEAK_NORMAL``.
    """
    heights = [f[0] * n[0] + f[1] * n[1] for f, n in zip(x, normals, strict=True)]
    t = max(heights) if kind == PEAK_NORMAL else inf
    faces, columns = [], []  # columns: G b, b, its finger, its cost
    shared = [0.0, 0.0, 0.0]
    m0, m1, m2 = matrix
    for i, ((fx, fy), (nx, ny), mu, h) in enumerate(zip(x, normals, frictions, heights, strict=True)):
        size = sqrt(fx * fx + fy * fy)
        if limits[i] - size < NEAR:
            return None
        side = nx * fy - ny * fx  # along the tangent (-ny, nx)
        is_high = t - h < NEAR
        if size < TRACE:
            faces.append((_IDLE, False))
            continue
        if mu == 0:
            face, parts = _SMOOTH, [(nx, ny)]
        elif mu * h - abs(side) < NEAR:
            face = _CLOCKWISE if side < 0 else _OTHER
            slope = -face * mu
            parts = [(nx - slope * ny, ny + slope * nx)]
        else:
            face, parts = _INSIDE, [(nx, ny), (-ny, nx)]
        faces.append((face, is_high))
        for b, (bx, by) in enumerate(parts):
            j = 2 * i
            g = [m[j] * bx + m[j + 1] * by for m in (m0, m1, m2)]
            if is_high and b == 0:
                shared = [s + each for s, each in zip(shared, g, strict=True)]
            else:
                columns.append((g, bx, by, i, linear[i][0] * bx + linear[i][1] * by))
    found = _by_squares(columns, load, squares) if squares[0] else _vertex(columns, shared, load, kind)
    if found is None:
        return None
    q, y, t = found
    forces = [[0.0, 0.0] for _ in x]
    for (_, bx, by, i, _), part in zip(columns, q, strict=True):
        forces[i][0] += part * bx
        forces[i][1] += part * by
    y0, y1, y2 = y
    for i, ((face, is_high), force, (nx, ny), mu) in enumerate(
        zip(faces, forces, normals, frictions, strict=True)
    ):
        if is_high:
            slope = 0.0 if face in (_INSIDE, _SMOOTH) else -face * mu
            force[0] += t * (nx - slope * ny)
            force[1] += t * (ny + slope * nx)
        fx, fy = force
        j, a = 2 * i, 2 * squares[i]
        vx = -(linear[i][0] + m0[j] * y0 + m1[j] * y1 + m2[j] * y2 + a * fx)
        vy = -(linear[i][1] + m0[j + 1] * y0 + m1[j + 1] * y1 + m2[j + 1] * y2 + a * fy)
        up, across = nx * vx + ny * vy, nx * vy - ny * vx
        if face == _IDLE:
            if up + mu * abs(across) > SIGN:
                return None
            continue
        h, side = nx * fx + ny * fy, nx * fy - ny * fx
        if not (0 <= h <= t + OVER and sqrt(fx * fx + fy * fy) < limits[i]):
            return None
        if face == _INSIDE:
            if abs(side) > mu * h + OVER:
                return None
        elif face != _SMOOTH:
            if -face * across < -SIGN:
                return None
            up += mu * -face * across
        if is_high and up < -SIGN:
            return None
    return forces


_Columns = list[tuple[_Row, float, float, int, float]]


def _by_squares(columns: _Columns, load: _Row, squares: _Row) -> tuple[_Row, _Row, float] | None:
    """q, y and no t."""
    a, b, c, d, e, f = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    r0, r1, r2 = load
    weights = []
    for (g0, g1, g2), bx, by, i, cost in columns:
        weight = 1 / (2 * squares[i] * (bx * bx + by * by))
        weights.append(weight)
        a, b, c = a + weight * g0 * g0, b + weight * g0 * g1, c + weight * g0 * g2
        d, e, f = d + weight * g1 * g1, e + weight * g1 * g2, f + weight * g2 * g2
        part = weight * cost
        r0, r1, r2 = r0 - g0 * part, r1 - g1 * part, r2 - g2 * part
    inverse = _inverse([[a, b, c], [b, d, e], [c, e, f]])
    if inverse is None:
        return None
    y = _times(inverse, [r0, r1, r2])
    for _ in range(2):  # the second time takes away the rounding of the first
        q, (r0, r1, r2) = [], load
        for (g, _, _, _, cost), weight in zip(columns, weights, strict=True):
            part = -weight * (cost + g[0] * y[0] + g[1] * y[1] + g[2] * y[2])
            q.append(part)
            r0, r1, r2 = r0 + part * g[0], r1 + part * g[1], r2 + part * g[2]
        if max(abs(r0), abs(r1), abs(r2)) < 1e-14:
            break
        y = [s + each for s, each in zip(y, _times(inverse, [r0, r1, r2]), strict=True)]
    return q, y, inf


def _vertex(columns: _Columns, shared: _Row, load: _Row, kind: int) -> tuple[_Row, _Row, float] | None:
    """q, y and t where three columns meet."""
    sides = [g for g, *_ in columns]
    costs = [cost for *_, cost in columns]
    if kind != NONE:
        sides, costs = [*sides, shared], [*costs, 1.0]
    if len(sides) != 3:
        return None
    inverse = _inverse([list(row) for row in zip(*sides, strict=True)])
    if inverse is None:
        return None
    q = _times(inverse, [-s for s in load])
    off = [s + sum(p * g[k] for p, g in zip(q, sides, strict=True)) for k, s in enumerate(load)]
    q = [p - each for p, each in zip(q, _times(inverse, off), strict=True)]
    y = [-sum(inverse[k][r] * costs[k] for k in range(3)) for r in range(3)]
    return (q, y, inf) if kind == NONE else (q[:2], y, q[2])


def _inverse(rows: list[_Row]) -> list[_Row] | None:
    """Of three rows by their cofactors; None where they depend on one another."""
    (a, b, c), (d, e, f), (g, h, i) = rows
    A, B, C = e * i - f * h, f * g - d * i, d * h - e * g
    whole = a * A + b * B + c * C
    if not abs(whole) > _FLAT * (abs(a * A) + abs(b * B) + abs(c * C)):
        return None
    return [
        [A / whole, (c * h - b * i) / whole, (b * f - c * e) / whole],
        [B / whole, (a * i - c * g) / whole, (c * d - a * f) / whole],
        [C / whole, (b * g - a * h) / whole, (a * e - b * d) / whole],
    ]


def _times(rows: list[_Row], v: _Row) -> _Row:
    return [a * v[0] + b * v[1] + c * v[2] for a, b, c in rows]

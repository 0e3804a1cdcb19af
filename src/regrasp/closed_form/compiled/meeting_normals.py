"""Three fingers whose normals nearly meet and balance, on middles of sides: where little friction is used.

How much of friction mu they use follows, where it is little, from normal forces: f = f0 + s c balance the
force of a load, c those that balance with none, s anything the limit allows. Friction holds the torque that
is left, at distances d along the normals from the point where two of them meet, a the arms of the normals:

    use(load, s) = |torque + sum f_i a_i| / (mu sum f_i d_i),

least at an end of s, or zero in between: an estimate, to start from.
"""

import numpy as np

from regrasp.compilation import kept


@kept("three normals that meet", error_model="numpy", nogil=True, _nrt=False)
def meeting(places, loads, limit, mu, first, found):  # type: ignore[no-untyped-def]
    """Puts triples from ``first`` on in the place of the worst of ``found`` (n, 4): their use, and places.

    places: (m, 4) point and normal, by the angles of normals. loads: (L, 3), to be made. limit: of forces.
    """
    m, turning = len(places), 0.0
    for load in range(len(loads)):
        turning = max(turning, abs(loads[load, 2]))
    worst = 0
    for n in range(len(found)):
        if found[n, 0] > found[worst, 0]:
            worst = n
    ax, ay, nx, ny = places[first]
    a = ax * ny - ay * nx
    for j in range(first + 1, m):
        bx, by, mx, my = places[j]
        ck = nx * my - ny * mx
        if not ck > 0.0:
            continue
        b = bx * my - by * mx
        qx, qy = (a * mx - b * nx) / ck, (a * my - b * ny) / ck
        da, db = abs((ax - qx) * nx + (ay - qy) * ny), abs((bx - qx) * mx + (by - qy) * my)
        for k in range(j + 1, m):
            cx, cy, ox, oy = places[k]
            ci, cj = mx * oy - my * ox, ox * ny - oy * nx
            if not (ci > 0.0 and cj > 0.0):
                continue
            c = cx * oy - cy * ox
            dc = abs((cx - qx) * ox + (cy - qy) * oy)
            off = abs(ci * a + cj * b + ck * c) + turning * max(ci, cj, ck) / limit
            least = found[worst, 0]
            if not off < least * mu * (ci * da + cj * db + ck * dc):
                continue
            use = 0.0
            for load in range(len(loads)):
                x, y, torque = loads[load]
                # of all f that make the force, those with none at the third finger
                fi, fj = (x * my - y * mx) / ck, (nx * y - ny * x) / ck
                lo = max(0.0, max(-fi / ci, -fj / cj))
                hi = min(limit / ck, min((limit - fi) / ci, (limit - fj) / cj))
                if lo > hi:
                    use = np.inf
                    break
                smallest, before = np.inf, 0.0
                for end in range(2):
                    s = lo if end == 0 else hi
                    gi, gj, gk = fi + s * ci, fj + s * cj, s * ck
                    left = torque - gi * a - gj * b - gk * c
                    smallest = min(smallest, abs(left) / (mu * (gi * da + gj * db + gk * dc)))
                    if left * before < 0.0:
                        smallest = 0.0
                    before = left
                use = max(use, smallest)
                if use >= least:
                    break
            if use < least:
                found[worst, 0], found[worst, 1], found[worst, 2], found[worst, 3] = use, first, j, k
                for n in range(len(found)):
                    if found[n, 0] > found[worst, 0]:
                        worst = n

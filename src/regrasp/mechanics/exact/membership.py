"""Whether planar cones hold a load, decided in rational arithmetic: a linear program over their edges.

Every force in a planar cone is a sum of its two edges, so -w_ext is to be a sum of edge wrenches with factors
>= 0: the first phase of the simplex method, its rows the three equations of balance, its pivots Bland's,
which cannot cycle.
"""

from collections.abc import Sequence
from fractions import Fraction

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.opposition import exact
from regrasp.mechanics.wrench import Wrench

Row = list[Fraction]


def vertex_forces(grasp: Grasp, load: Wrench, frictions: Sequence[float]) -> Array | None:
    """Forces (n, 2) on at most three edges of the cones that balance a load, to rounding; None if none do."""
    edges: list[Row] = []
    owners: list[int] = []
    for i, (contact, mu) in enumerate(zip(grasp, frictions, strict=True)):
        (a, b), (x, y), m = exact(contact.normal), exact(contact.position), Fraction(mu)
        for s in (1, -1) if m else (1,):
            fx, fy = a - s * m * b, b + s * m * a
            edges.append([fx, fy, x * fy - y * fx])
            owners.append(i)
    factors = _factors(edges, [-w for w in exact(load.vector)])
    if factors is None:
        return None
    forces = [[Fraction(0), Fraction(0)] for _ in grasp.contacts]
    for place, factor in factors.items():
        for k in (0, 1):
            forces[owners[place]][k] += factor * edges[place][k]
    return np.array([[float(x) for x in force] for force in forces])


def _factors(edges: list[Row], target: Row) -> dict[int, Fraction] | None:
    """Factors >= 0 by edge whose sum is the target; None if there are none."""
    count = len(edges)
    table = [
        [
            *((-1 if t < 0 else 1) * edge[k] for edge in edges),
            *(Fraction(int(k == j)) for j in range(3)),
            abs(t),
        ]
        for k, t in enumerate(target)
    ]
    basis = [count, count + 1, count + 2]
    while True:
        missing = [k for k in range(3) if basis[k] >= count]
        gains = (j for j in range(count) if j not in basis and sum(table[k][j] for k in missing) > 0)
        enter = next(gains, None)
        if enter is None:
            if any(table[k][-1] for k in missing):
                return None
            return {basis[k]: table[k][-1] for k in range(3) if basis[k] < count}
        leave = min((table[k][-1] / table[k][enter], basis[k], k) for k in range(3) if table[k][enter] > 0)[2]
        pivot = table[leave][enter]
        table[leave] = [x / pivot for x in table[leave]]
        for k in range(3):
            if k != leave and table[k][enter]:
                factor = table[k][enter]
                table[k] = [x - factor * y for x, y in zip(table[k], table[leave], strict=True)]
        basis[leave] = enter

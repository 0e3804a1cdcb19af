"""Measures from force limits and friction: what wrenches can be made."""

from collections.abc import Iterator
from math import cos, inf, pi, sin

import numpy as np

from regrasp.errors import Infeasible
from regrasp.measures.measure import BY_LENGTH, ROA, UNMOVED, Measure
from regrasp.measures.wrench_ball import radius
from regrasp.measures.wrench_sets import WrenchSet
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.choosing import choose_state

_DIVIDED = "none: torques divided by length"
FACETS = 8
"""Edges that stand for a round cone where generators are needed."""


def generators(wrenches: WrenchSet, facets: int) -> Array:
    """(m, N) wrenches along the edges of the cones: both in the plane, of inner pyramids in space."""
    columns = []
    for axis, tangents in zip(wrenches.axes, wrenches.tangents, strict=True):
        if not tangents.any():
            around = np.zeros((1, axis.size))
        elif len(tangents) == 1:
            around = np.array([-tangents[0], tangents[0]])
        else:
            angles = [2 * pi * k / facets for k in range(facets)]
            around = np.array([cos(a) * tangents[0] + sin(a) * tangents[1] for a in angles])
            if len(tangents) == 3 and tangents[2].any():
                around = np.vstack([around, tangents[2], -tangents[2]])
        columns.append(axis + around)
    result: Array = np.vstack(columns).T
    return result


def least_weight(columns: Array) -> float:
    """Max l with W x = 0, sum x = 1, x >= l; 0 where no combination vanishes."""
    from scipy.optimize import linprog

    m, k = columns.shape
    equal = np.zeros((m + 1, k + 1))
    equal[:m, :k], equal[m, :k] = columns / abs(columns).max(), 1.0
    goal = np.zeros(k + 1)
    goal[k] = -1.0
    below = np.hstack([-np.eye(k), np.ones((k, 1))])
    right = np.r_[np.zeros(m), 1.0]
    answer = linprog(goal, A_ub=below, b_ub=np.zeros(k), A_eq=equal, b_eq=right, bounds=[(0, 1)] * (k + 1))
    return max(0.0, float(-answer.fun)) if answer.status == 0 else 0.0


def hull_volume(columns: Array) -> float:
    """Of the hull of wrenches (m, N) and the origin; 0 where it is flat."""
    from scipy.spatial import ConvexHull, QhullError

    points = np.vstack([np.zeros(len(columns)), columns.T])
    if np.linalg.matrix_rank(columns) < len(columns):
        return 0.0
    try:
        return float(ConvexHull(points).volume)
    except QhullError:
        return 0.0


def limit_measures(
    grasp: Grasp, limits: Array, length: float, gap: float, facets: int, load: Wrench | None
) -> Iterator[Measure]:
    """limits: (n,) each finger's largest normal force, for L1 their mean the limit of the sum [N]."""
    d, m = grasp.dimension, len(grasp.matrix)
    each = WrenchSet.of(grasp, limits, False, length)
    whole = WrenchSet.of(grasp, np.full(len(grasp), limits.mean()), True, length)
    how = "closed form" if d == 2 else "search"
    ferrari = f"{ROA}; Ferrari and Canny 1992"
    for name, wrenches, words in (
        ("wrench_ball_Linf", each, "min over |u| = 1 of sum_i h_i(u)"),
        ("wrench_ball_L1", whole, "min over |u| = 1 of max_i h_i(u)"),
    ):
        lower, upper, _ = radius(grasp, wrenches, length, gap)
        yield Measure(name, upper, "N", "[0, inf)", True, words, ferrari, _DIVIDED, how, (lower, upper))
    forces = np.where(np.arange(m) < d, 1.0, 0.0)
    mirtich = f"{ROA}; Mirtich and Canny 1994"
    for name, kind, metric, factor, unit, scales, origin in (
        ("decoupled_force", "forces without torque", forces, 1.0, "N", "none", "changes it"),
        ("decoupled_torque", "torques without force", 1.0 - forces, length, "N m", "in proportion", UNMOVED),
    ):
        lower, upper, _ = radius(grasp, each, length, gap, metric)
        yield Measure(
            name, factor * upper, unit, "[0, inf)", True, f"largest ball of {kind} (Linf)", mirtich, scales,
            how, (factor * lower, factor * upper), origin,
        )  # fmt: skip
    columns = generators(whole, facets)
    exact = "" if d == 2 else f", inner pyramids of {facets}"
    yield Measure(
        "wrench_volume", hull_volume(columns), f"N^{m}", "[0, inf)", True,
        f"volume of the L1 wrenches' hull{exact}", f"{ROA}; Miller and Allen 1999", _DIVIDED,
        origin=BY_LENGTH,
    )  # fmt: skip
    yield Measure(
        "min_weight", least_weight(columns), "-", f"[0, 1/{columns.shape[1]}]", True,
        f"max l: W x = 0, sum x = 1, x >= l{exact}", "Li, Culbertson, Burdick and Ames 2023 (FRoGGeR)",
        _DIVIDED, "program", origin=UNMOVED,
    )  # fmt: skip
    if load is not None:
        try:
            least = choose_state(grasp, load, "sum_normal", reserve=0.0).value
        except Infeasible:
            least = inf
        yield Measure(
            "least_normal_sum", least, "N", "[0, inf]", False, "min sum n_i . f_i that balance the load",
            f"{ROA}; Liu, Xu and others 2004", "none", "program",
        )  # fmt: skip

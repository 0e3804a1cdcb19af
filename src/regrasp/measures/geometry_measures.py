"""Measures from where the contacts are."""

from collections.abc import Iterator
from math import pi, sqrt

import numpy as np

from regrasp.measures.measure import ROA, UNMOVED, Measure
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp

_FLAT = 1e-9


def polygon(grasp: Grasp) -> Array | None:
    """(n, 2) the contacts in their plane, around their centroid; None of two, and where it is none."""
    away = grasp.positions - grasp.positions.mean(axis=0)
    if len(grasp) < 3:
        return None
    _, sizes, axes = np.linalg.svd(away)
    if sizes[2:].max(initial=0.0) > _FLAT * sizes[0]:
        return None
    points = away if grasp.dimension == 2 else away @ axes[:2].T
    result: Array = points[np.argsort(np.arctan2(points[:, 1], points[:, 0]), kind="stable")]
    return result


def area(points: Array) -> float:
    """Of a polygon, by the shoelace formula."""
    x, y = points.T
    return float(abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2)


def inner_angles(points: Array) -> Array:
    """(n,) of a polygon taken counter-clockwise, in [0, 2 pi); their sum is (n - 2) pi."""
    ahead, back = np.roll(points, -1, axis=0) - points, np.roll(points, 1, axis=0) - points
    turn = np.arctan2(back[:, 1], back[:, 0]) - np.arctan2(ahead[:, 1], ahead[:, 0])
    angles: Array = turn % (2 * pi)
    return angles


def geometry_measures(grasp: Grasp) -> Iterator[Measure]:
    """Of the contacts' places and normals."""
    points, n = polygon(grasp), len(grasp)
    if points is not None:
        mean = pi * (n - 2) / n
        largest = (n - 2) * (pi - mean) + 2 * mean
        off = float(abs(inner_angles(points) - mean).sum() / largest)
        yield Measure(
            "polygon_shape",
            off,
            "-",
            "[0, 1]",
            False,
            "sum |angle_i - mean| / largest such sum",
            f"{ROA}; Park and Starr 1992",
            "none",
            origin=UNMOVED,
        )
        yield Measure(
            "polygon_area",
            area(points),
            "m^2",
            "[0, inf)",
            True,
            "area of the polygon of the contacts",
            f"{ROA}; Mirtich and Canny 1994",
            "by its square",
            origin=UNMOVED,
        )
    yield Measure(
        "centroid_distance",
        float(np.linalg.norm(grasp.positions.mean(axis=0))),
        "m",
        "[0, inf)",
        False,
        "|mean r_i|, the centre of mass at the origin",
        f"{ROA}; Ding, Lee and Wang 2001",
        "in proportion",
    )
    if grasp.dimension == 3:
        spread = np.linalg.svd(grasp.normals, compute_uv=False)
        yield Measure(
            "normals_off_plane",
            float(spread[2] / sqrt(n)) if n > 2 else 0.0,
            "-",
            "[0, 0.577]",
            True,
            "sigma_min(n_1 ... n_n) / sqrt n: root mean square off the best plane",
            ROA,
            "none",
            origin=UNMOVED,
        )

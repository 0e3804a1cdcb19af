"""Regions on a polygon that go on past vertices that are no corners, proven as on a curve.

Curves of a drawing are rows of chords there: a region that ends with its chord says nothing of the curve.
"""

import numpy as np

from regrasp.errors import Infeasible
from regrasp.mechanics.checks import Array
from regrasp.planning.placement.curves.curved_sides import CurvedSides
from regrasp.planning.placement.regions.contact_arcs import ContactRegions
from regrasp.planning.placement.regions.curved import CurvedPlaces, widest_around
from regrasp.planning.placement.regions.needs import LESS
from regrasp.planning.placement.sides import Sides

_AT_END = 2e-6  # of the length, from a vertex
_ENOUGH = 0.99  # of what is to be wide, on one side each, that wider regions have at least


class _Straight(CurvedSides):
    """Sides of a polygon as cubics."""

    u_at = Sides.u_at


def around_bends(found: ContactRegions, loads: Array, widest: str) -> ContactRegions:
    """Regions on one side of the outer boundary each, or larger ones past vertices that are no corners."""
    shape, at = found.shape, found.places
    vertices = shape.polygon()
    ends = np.roll(vertices, -1, axis=0)
    control = np.stack([vertices, (2 * vertices + ends) / 3, (vertices + 2 * ends) / 3, ends], axis=1)
    edges = np.arange(len(vertices))
    sides = _Straight(vertices, edges, np.stack([edges, edges + 1.0], axis=1), control, shape)
    places = CurvedPlaces(shape, sides, found.grasp, at, loads)
    vertex = np.concatenate([sides.starts, [shape.length]])
    at_vertex = np.abs(found.arcs[..., None] % shape.length - vertex).min(axis=2) < _AT_END * shape.length
    limit = found.max_force / (1 + LESS)
    if not (at_vertex & ~places.at_corners(found.arcs)).any():
        return found
    if places.cells(places.spans(np.stack([at, at], axis=1)), limit) is None:  # not by the next side's normal
        return found
    try:
        bent = widest_around(places, limit, widest)
    except Infeasible:  # by rounding, which those on one side each do without
        return found
    most, more = (_reach(each, places, widest) for each in (found, bent))
    return bent if bent.widths.prod() > found.widths.prod() and more >= _ENOUGH * most else found


def _reach(regions: ContactRegions, places: CurvedPlaces, widest: str) -> float:
    """What is to be as wide as can be; of a product its regions alone decide [m]."""
    if widest == "product":
        return 0.0
    if widest == "least":
        return float(regions.widths.min())
    away = np.abs(regions.arcs - regions.places[:, None])
    return float(away.min(where=~places.at_corners(regions.arcs), initial=np.inf))

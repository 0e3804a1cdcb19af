"""The verdict on regions of contacts: states at all their corners.

Fix all fingers but one, which may be anywhere between two ends of an arc of a straight side, and let both
ends hold a load, with normal forces N_a and N_b of that finger. Mixed with weights 1 - c and c, its forces
press at c N_b / ((1 - c) N_a + c N_b) of the way, which runs from 0 to 1 with c; so for each place between
there are forces, mixtures of those at the ends, that hold the load there. Cones and limits are convex and
keep them. Finger by finger, the corners of a box of arcs prove the whole of it. On curves, and on rows of
sides, the corners are beside it (``curved_regions``).
"""

from fractions import Fraction
from itertools import product
from math import inf
from typing import Any, Protocol

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.state import GraspState
from regrasp.verification.exact import RESOLUTION, check_state, dot, exact, least_angle, root
from regrasp.verification.placed.curved_regions import beside, chords, covered
from regrasp.verification.placed.curves.pieces import Cubics, Pieces, StraightSides
from regrasp.verification.placed.protocol import Shape
from regrasp.verification.placed.widest import Widest, widest_wrong
from regrasp.verification.verdict import Verification

_TO_THE_END = 1 - 2e-6  # of the way to the end of a side, which counts as all of it
_ALIKE = 1e-9  # normals on a curve, at arc lengths that are off by rounding
_TURNED = 4 * float(RESOLUTION)  # normals that differ by no more are the same


class Curved(Shape, Protocol):
    """The same with its points."""

    def points(self, s: float) -> Array:
        """(2,) the point at an arc length [m]."""

    def normals(self, s: float) -> Array:
        """(2,) the unit normal into the object there; at a vertex that of the side after it."""


class Regions(Protocol):
    """What ``verify`` needs to know of regions, whoever found them; arcs (k, 2) are arc lengths [m]."""

    @property
    def shape(self) -> Curved:
        """The outline."""

    @property
    def grasp(self) -> Grasp:
        """The contacts."""

    @property
    def places(self) -> Array:
        """(k,) of the contacts."""

    @property
    def arcs(self) -> Array:
        """Of each finger."""

    @property
    def half_width(self) -> float:
        """Every finger may be so far off its place, or to the end of its side [m]."""

    @property
    def spans(self) -> Array | None:
        """(k, 2) of arcs not on one side each: number of the piece and fraction of it passed; else None."""

    @property
    def cells(self) -> Array | None:
        """(c, k, 2) parts of spans, for which corners stand one after the other; None for all in one."""

    @property
    def widest(self) -> Widest | None:
        """The proof that no arcs around the places are all longer than its bound; None for none."""

    @property
    def max_force(self) -> float:
        """Limit on every force [N]."""

    @property
    def corners(self) -> tuple[GraspState, ...]:
        """States at all combinations of ends of arcs."""


def verify_regions(regions: Regions) -> Verification:
    """The verdict on regions: that wherever in them the fingers are, they hold the loads of the corners."""
    broken = _check_corners(regions) + above_own(regions.grasp, regions.max_force)
    residuals, slacks, angles = [0.0], [inf], [inf]
    for i, state in enumerate(regions.corners, 1):
        residual, slack, violations = check_state(state, f"corner state {i}")
        residuals.append(residual)
        slacks.append(slack)
        angles.append(least_angle(state.grasp, state.forces))
        violations += [f"corner state {i}: {words}" for words in above(state.forces, regions.max_force)]
        broken += violations
    proof = regions.widest
    return Verification(
        tuple(broken), max(residuals), min(angles), min(slacks), widest=None if proof is None else proof.bound
    )


def above(forces: Array, limit: float) -> list[str]:
    """That one of forces (k, d) is larger than a limit, in words and exactly; nothing where none is."""
    largest = max(dot(f, f) for f in map(exact, forces.tolist()))
    if limit >= 0 and (limit == inf or largest <= Fraction(limit) ** 2):
        return []
    return [f"a force of {root(largest):.12g} is above {limit:.12g}"]


def above_own(grasp: Grasp, limit: float) -> list[str]:
    """That a limit on every force is not within the limits of contacts, or they have others."""
    return [
        f"forces may be {limit:.12g}, above the max_force of {contact.name}"
        for contact in grasp
        if contact.max_force is not None and not limit <= contact.max_force
    ] + [f"{c.name} has linear limits, which regions do not keep" for c in grasp if c.limits is not None]


def _check_corners(regions: Regions) -> list[str]:
    """That every load has a state at every combination of ends, and that arcs are on straight sides."""
    control = regions.shape.cubics()
    if control is not None or regions.spans is not None:
        if regions.widest is not None:
            return ["that arcs are the widest is proven of arcs on one straight side each alone"]
        if control is not None:
            return _check_curved(regions, Cubics(control))
        return _check_curved(regions, StraightSides(np.asarray(regions.shape.polygon())))
    rings = rings_of(regions.shape)
    vertices, along = np.concatenate(rings), np.concatenate([np.roll(r, -1, axis=0) - r for r in rings])
    lengths = np.hypot(*along.T)
    starts = np.concatenate([[0.0], np.cumsum(lengths)])
    slack = float(RESOLUTION) * float(starts[-1])
    ends, normals, edges = [], [], []
    places, half = np.asarray(regions.places), regions.half_width
    if np.shape(regions.arcs) != (len(regions.grasp), 2) or places.shape != (len(regions.grasp),):
        return ["an arc and a place for each finger are needed"]
    for i, (lo, hi) in enumerate(regions.arcs.tolist(), 1):
        if not -inf < lo <= hi < inf:
            return [f"arc {i} must not end before it begins"]
        middle = 0.5 * (lo + hi) % starts[-1]
        edge = min(int(np.searchsorted(starts, middle, side="right")) - 1, len(vertices) - 1)
        off = lo - 0.5 * (lo + hi) + middle  # the arc begins here, on this turn around the outline
        if not (starts[edge] - slack <= off and off + hi - lo <= starts[edge + 1] + slack):
            return [f"arc {i} is not on one straight side"]
        unit = along[edge] / lengths[edge]
        place = float(places[i - 1]) + off - lo
        point, normal = vertices[edge] + (place - starts[edge]) * unit, np.array([-unit[1], unit[0]])
        contact = regions.grasp[i - 1]
        turned = np.abs(normal - contact.normal).max() > _TURNED
        if turned or not np.abs(point - contact.position).max() <= slack:
            return [f"contact {i} is not at its place"]
        before, after = place - off, off + hi - lo - place
        room = (place - starts[edge]) * _TO_THE_END, (starts[edge + 1] - place) * _TO_THE_END
        short = max(min(half, room[0]) - before, min(half, room[1]) - after)
        if not (0 <= half < inf and short <= slack):
            return [f"arc {i} is less than the half width {half:.12g} about its place"]
        ends.append([vertices[edge] + (s - starts[edge]) * unit for s in (off, off + hi - lo)])
        normals.append(normal)
        edges.append(edge)
    proof = regions.widest
    broken = _missing(regions, regions.corners, ends, normals, regions.grasp.frictions, slack)
    return broken if proof is None or broken else widest_wrong(proof, regions, rings, edges)


def rings_of(shape: Any) -> list[Array]:
    """(n, 2) vertices of a polygon and of each of its holes, clockwise: the material is on the left."""
    return [np.asarray(shape.polygon()), *(hole[::-1] for hole in getattr(shape, "hole_polygons", tuple)())]


def _check_curved(regions: Regions, pieces: Pieces) -> list[str]:
    """The same on a curve, where the ends are those of chords beside it."""
    k, n, spans = len(regions.grasp), pieces.count, np.asarray(regions.spans)
    if not spans.shape == np.shape(regions.arcs) == (k, 2):
        return ["an arc and its span are needed for each finger"]
    if np.shape(regions.places) != (k,):
        return ["a place is needed for each finger"]
    if not regions.corners:
        return ["no corner has a state"]
    cells = np.asarray([spans] if regions.cells is None else regions.cells)
    if cells.shape[1:] != (k, 2) or not covered(cells, spans):
        return ["the cells do not cover the arcs"]
    if not ((cells >= -n) & (cells[:, :, :1] <= cells) & (cells <= 2 * n)).all():
        return ["a cell must not end before it begins, nor run around more than once"]
    each, rest = divmod(len(regions.corners), len(cells))
    if rest:
        return ["some states of corners are missing"]
    slack = float(RESOLUTION) * pieces.reach
    for i in range(k):
        place, half = float(regions.places[i]), regions.half_width
        if not np.hypot(*(regions.shape.points(place) - regions.grasp.positions[i])) <= 100 * slack:
            return [f"contact {i + 1} is not at its place"]
        away, (lo, hi) = 100 * slack, regions.arcs[i].tolist()
        near = place + away * np.array([0.0, -1.0, 1.0])
        if min(pieces.to_corners(place)) <= away:  # at a corner the normal is of the side that the arc is on
            inside = min(away, 0.5 * (hi - lo))
            near = np.clip(near, lo + inside, hi - inside)
        normals = (regions.shape.normals(s) for s in near if np.isfinite(s))
        if not any(np.abs(n - regions.grasp.normals[i]).max() <= _ALIKE for n in normals):
            return [f"contact {i + 1} has another normal than its place"]
        before, after = place - regions.arcs[i, 0], regions.arcs[i, 1] - place
        room = [_TO_THE_END * far for far in pieces.to_corners(place)]
        short = max(min(half, room[0]) - before, min(half, room[1]) - after)
        if not (0 <= half < inf and short <= slack):
            return [f"arc {i + 1} is less than the half width {half:.12g} about its place"]
        if not before + after <= 2 * chords(pieces, spans[i]) + slack:
            return [f"arc {i + 1} is longer than its span"]
        for u, s in zip(spans[i], regions.arcs[i], strict=True):
            if not np.hypot(*(pieces.point(float(u)) - regions.shape.points(s))) <= 100 * slack:
                return [f"the span of arc {i + 1} is another arc"]
    for number, cell in enumerate(cells):
        states = regions.corners[number * each : (number + 1) * each]
        broken = _cell_wrong(regions, pieces, cell, states, slack)
        if broken:
            return broken
    return []


def _cell_wrong(
    regions: Regions, pieces: Pieces, cell: Array, states: tuple[GraspState, ...], slack: float
) -> list[str]:
    """That states beside a curve stand for all places of a cell (k, 2)."""
    k, first, last = len(cell), states[0].grasp, states[-1].grasp
    if len(first) != k or len(last) != k or not (first.normals == last.normals).all():
        return ["corners must have one normal for each finger"]
    ends = []
    for i in range(k):
        at = np.array([first.positions[i], last.positions[i]])
        friction = float(regions.grasp.frictions[i])
        if not beside(pieces, cell[i], at, first.normals[i], float(first.frictions[i]), friction):
            return [f"the corners do not stand for all places of arc {i + 1}"]
        ends.append(list(at))
    return _missing(regions, states, ends, first.normals, first.frictions, slack)


def _missing(
    regions: Regions, states: Any, ends: list[Any], normals: Any, frictions: Array, slack: float
) -> list[str]:
    loads = {tuple(state.load.vector.tolist()) for state in regions.corners}
    if not loads:
        return ["no corner has a state"]
    missing = 0
    for corner in product(*ends):
        here = {
            tuple(state.load.vector.tolist())
            for state in states
            if len(state.grasp) == len(corner)
            and np.abs(state.grasp.positions - corner).max() <= slack
            and np.abs(state.grasp.normals - normals).max() <= _TURNED
            and (state.grasp.frictions <= frictions).all()
        }
        missing += len(loads - here)
    return [f"{missing} states of corners are missing"] if missing else []

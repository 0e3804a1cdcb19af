"""How far the fingers of a grasp may miss their places: regions within which every choice holds."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import product
from types import MappingProxyType
from typing import overload

import numpy as np

from regrasp.errors import Infeasible, InvalidInput, RegraspError, shown
from regrasp.mechanics.checks import Array, number, read_only
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.limits.limit_rows import refuse_limits
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.value import ArrayValue
from regrasp.mechanics.wrench import Wrench
from regrasp.mesh.mesh import Mesh
from regrasp.outline.outline import Outline
from regrasp.outline.polygon import PolygonBoundary
from regrasp.planning.placement.curves.curved_regions import CurvedPlaces
from regrasp.planning.placement.laws import LAWS
from regrasp.planning.placement.loads import check_planar, inner_and_outer
from regrasp.planning.placement.reachable import sides_of
from regrasp.planning.placement.search import Search
from regrasp.planning.placement.sides import Sides, moved
from regrasp.planning.placement.space.choosing import check_space
from regrasp.planning.placement.space.face_regions import FaceRegions, regions_on_faces
from regrasp.planning.states.choosing import choose_state

PEAK_RATIO = 3.0
"""Default limit on every force, as a multiple of the least largest force of the grasp as it is."""
_ON_SIDE = 1e-6  # of the size: farther from every side a contact is not on the outline
_HALVINGS = 40
_ON_CURVES = 11
_POWERS: Mapping[str, tuple[int, ...]] = MappingProxyType({"together": (), "least": (8, 60), "product": (0,)})
_SHORTEST, _TRADED, _BETTER = 0.005, 9, 1e-4  # least step, halvings and gain of a trade
_LESS = 1e-6  # of widths and of friction, given up so that forces at the corners exist for solvers, too


@dataclass(frozen=True, eq=False, repr=False)
class ContactRegions(ArrayValue):
    """Arcs of an outline, one for each finger: wherever in them the fingers are, they hold the loads.

    Args:
        shape: the outline.
        grasp: the contacts in the middle of it all.
        places: (k,) their arc lengths [m].
        arcs: (k, 2) arc lengths at which regions begin and end: all may be anywhere in theirs at once [m].
        half_width: every finger may be so far off, to either side or to the end of its side less two
            millionths of the way, all at once [m].
        alone: (k, 2) how far one finger may be off, back and ahead, while the others are at their places: not
            proven by ``corners``, nor judged by ``regrasp.verify`` [m].
        max_force: no force need be larger [N].
        corners: states at all combinations of ends of the arcs, load by load: the proof (fact 12). On a curve
            they are beside it, at the ends of chords, with the cones that all points of a part share, cell by
            cell.
        spans: (k, 2) of arcs on a curve, number of the cubic and fraction of it passed; None on a polygon.
        cells: (c, k, 2) boxes of parts of the arcs, as ``spans``, which cover all of them; None on a polygon.
    """

    shape: Outline
    grasp: Grasp
    places: Array
    arcs: Array
    half_width: float
    alone: Array
    max_force: float
    corners: tuple[GraspState, ...]
    spans: Array | None = None
    cells: Array | None = None

    @property
    def widths(self) -> Array:
        """(k,) of the arcs [m]."""
        result: Array = self.arcs[:, 1] - self.arcs[:, 0]
        return result

    def __repr__(self) -> str:
        widths = ", ".join(f"{w:.4g}" for w in self.widths)
        return f"ContactRegions(all off by {self.half_width:.4g}, widths {widths})"


@overload
def contact_regions(
    shape: Outline,
    grasp: Grasp,
    load: Wrench | LoadSet,
    *,
    max_force: float | None = None,
    widest: str = "together",
) -> ContactRegions: ...
@overload
def contact_regions(
    shape: Mesh,
    grasp: Grasp,
    load: Wrench | LoadSet,
    *,
    max_force: float | None = None,
    widest: str = "together",
) -> FaceRegions: ...
def contact_regions(
    shape: Outline | Mesh,
    grasp: Grasp,
    load: Wrench | LoadSet,
    *,
    max_force: float | None = None,
    widest: str = "together",
) -> ContactRegions | FaceRegions:
    """Independent regions around the contacts of a grasp: every choice within them holds the loads.

    On straight sides every placement of a box of arcs holds a load, with forces below a limit, if and only if
    the box's corners do: between two ends of one arc, forces are mixed so that the centre of pressure of that
    finger is where it stands. So corners prove regions, and the half width is exact to rounding. From there
    the ends of the arcs are moved out one after the other as far as they go. On a curve chords beside parts
    of the arcs, and the cones that all points of a part share, take the place of sides (``curved_regions``):
    what is returned is proven, too, if not always the widest. On a mesh regions are polygons on
    flat faces, around discs; their corners prove them where forces there hold a little torque about each
    normal on top.

    Args:
        shape: a polygon, a smooth outline, or a mesh of flat faces.
        grasp: contacts on its outer boundary to a millionth, all of one friction, relative to the centre of
            mass; up to six, on a mesh three or four, away from edges. Regions are around the points of the
            boundary that are nearest to them.
        load: external wrench on the object about its centre of mass, or a set of them [N, N m].
        max_force: limit on every force, beside those of the contacts, of which the least counts for all [N];
            three times the least that the grasp needs if there is none.
        widest: what is as large as can be: how far all may be off ``together``, the ``least`` arc, or the
            ``product`` of all arcs; the last two on polygons, by trading one end of an arc for others while
            that helps, which nothing proves the largest.

    Raises:
        Infeasible: Where the grasp itself does not hold the loads.
        InvalidInput: For arguments that are not what they must be.
    """
    if not isinstance(shape, Outline | Mesh):
        raise InvalidInput(f"shape must be an Outline or a Mesh, got {shown(shape)}")
    where, d = ("planar Grasp", 2) if isinstance(shape, Outline) else ("Grasp in space", 3)
    if not isinstance(grasp, Grasp) or grasp.dimension != d or not 2 <= len(grasp) <= 6:
        raise InvalidInput(f"grasp must be a {where} of two to six contacts, got {shown(grasp)}")
    refuse_limits(grasp, "a search for regions")
    if len(set(grasp.frictions.tolist())) > 1:
        raise InvalidInput("contacts of a grasp with regions must all have the same friction")
    limits = [c.max_force for c in grasp if c.max_force is not None]
    if max_force is not None:
        limits.append(number(max_force, "max_force", above=0))
    given = min(limits, default=None)
    if not isinstance(widest, str) or widest not in _POWERS:
        raise InvalidInput(f"widest must be one of {', '.join(_POWERS)}; got {shown(widest)}")
    straight = isinstance(shape, Outline) and isinstance(shape.boundary, PolygonBoundary)
    if widest != "together" and not straight:
        raise InvalidInput(f"widest {widest!r} is for polygons; on other shapes regions are wide together")
    if isinstance(shape, Mesh):
        return regions_on_faces(shape, grasp, check_space(shape, load), given, _limit)
    check_planar(load)
    _, loads = inner_and_outer(load, 1e-3)
    if not isinstance(shape.boundary, PolygonBoundary):
        return _on_curve(CurvedPlaces(shape, grasp, loads), given)
    sides = sides_of(shape, 0.0)
    places, u = _on_sides(sides, grasp)
    kept = float(grasp.frictions[0]) * (1 - _LESS)
    search = Search(sides, len(grasp), kept, loads, LAWS["peak"], 0.0, 0.0)
    limit = _limit(search.norm_at(places, u), given)
    at = (sides.contact(int(side), v, kept, "at") for side, v in zip(places, u, strict=True))
    grasp = Grasp(map(moved, grasp, at))
    return _widest(shape, grasp, search, places, u, limit, _POWERS[widest])


def _limit(least: float, given: float | None) -> float:
    """Of forces, where a grasp needs ``least``."""
    if not least < np.inf:
        raise Infeasible(
            "the grasp itself holds the loads not at all, or on a knife's edge, with a millionth of its "
            "friction kept back"
        )
    if given is None and least == 0.0:
        raise InvalidInput("no force follows from a zero load: give max_force")
    limit = PEAK_RATIO * least if given is None else given * (1 - _LESS)
    if least > limit:
        raise Infeasible(f"the grasp itself needs a force of {least:.6g} N, above max_force {limit:.6g} N")
    return limit


def _on_curve(around: CurvedPlaces, given: float | None) -> ContactRegions:
    at, k = around.places, len(around.places)
    single = np.stack([at, at], axis=1)
    limit = _limit(around.need(around.spans(single)), given)
    far = 0.25 * around.shape.length
    ways: Array = np.array([-1.0, 1.0])

    def holds(box: Array) -> bool:
        return around.cells(around.spans(box), limit) is not None

    half = (1 - _LESS) * _farthest(lambda width: holds(single + width * ways), far, _ON_CURVES)
    box, alone = single + half * ways, np.zeros((k, 2))
    for i, end in product(range(k), range(2)):
        last = at[i] + far * ways[end]
        box[i, end] = at[i] + (1 - _LESS) * (_moved_out(holds, box, i, end, last, _ON_CURVES) - at[i])
        alone[i, end] = (1 - _LESS) * abs(_moved_out(holds, single, i, end, last, _ON_CURVES) - at[i])
    cells = around.cells(around.spans(box), limit)
    if cells is None:
        raise Infeasible("the regions found were left without forces by rounding")
    return ContactRegions(
        around.shape, around.grasp, read_only(at), read_only(box), half * (1 - _LESS), read_only(alone),
        limit * (1 + _LESS), tuple(s for cell in cells for s in around.states(cell, limit * (1 + _LESS))),
        read_only(around.spans(box)), read_only(np.array(cells)),
    )  # fmt: skip


def _widest(
    shape: Outline,
    grasp: Grasp,
    search: Search,
    places: np.ndarray,
    u: Array,
    limit: float,
    powers: tuple[int, ...],
) -> ContactRegions:
    sides, k = search.sides, len(places)
    lengths = sides.lengths[sides.edges[places]]
    ends = np.stack([u, u], axis=1)
    room = sides.ends[places]  # (k, 2)
    ways: Array = np.array([-1.0, 1.0])

    def holds(box: Array) -> bool:
        return all(search.norm_at(places, np.array(c)) <= limit for c in product(*box))

    def off(width: float) -> Array:
        result: Array = np.clip(u[:, None] + ways * width / lengths[:, None], room[:, :1], room[:, 1:])
        return result

    half = _farthest(lambda width: holds(off(width)), float(lengths.max()))
    box = off(half * (1 - _LESS))
    for i, end in product(range(k), range(2)):
        box[i, end] = _moved_out(holds, box, i, end, room[i, end])
    for power in powers:
        box = _traded(holds, box, u, room, lengths, power)
    if powers:
        free = box != room  # ends that are not the end of their side
        half = float(
            (np.abs(box - u[:, None]) * lengths[:, None]).min(where=free, initial=half + lengths.max())
        )
    box = u[:, None] + (1 - _LESS) * (box - u[:, None])
    alone = np.zeros((k, 2))
    for i, end in product(range(k), range(2)):
        reached = _moved_out(holds, ends, i, end, room[i, end])
        alone[i, end] = abs(reached - u[i]) * lengths[i]
    corners = []
    for corner in product(*box):
        at = Grasp(
            sides.contact(int(side), float(v), c.friction, c.name or "")
            for side, v, c in zip(places, corner, grasp, strict=True)
        )
        try:
            corners += [_plain(at, Wrench.from_vector(w), limit) for w in search.loads]
        except RegraspError as error:
            raise Infeasible(
                f"a corner of the regions was left without forces by rounding: {error}"
            ) from None
    starts = sides.starts[sides.edges[places]] - sides.edges[places] * lengths
    return ContactRegions(
        shape, grasp, read_only(starts + u * lengths), read_only(starts[:, None] + box * lengths[:, None]),
        half * (1 - _LESS) ** 2, read_only(alone * (1 - _LESS)), limit * (1 + _LESS), tuple(corners),
    )  # fmt: skip


def _plain(grasp: Grasp, load: Wrench, limit: float) -> GraspState:
    return GraspState(grasp, load, choose_state(grasp, load, "peak", max_force=limit * (1 + _LESS)).forces)


def _farthest(holds: Callable[[float], bool], most: float, halvings: int = _HALVINGS) -> float:
    """The largest width that holds, of nested ones; 0 holds."""
    if holds(most):
        return most
    lo, hi = 0.0, most
    for _ in range(halvings):
        middle = 0.5 * (lo + hi)
        lo, hi = (middle, hi) if holds(middle) else (lo, middle)
    return lo


def _moved_out(
    holds: Callable[[Array], bool], box: Array, i: int, end: int, last: float, halvings: int = _HALVINGS
) -> float:
    """Where one end of a box may be moved towards ``last``."""

    def moved(fraction: float) -> Array:
        there = box.copy()
        there[i, end] = box[i, end] + fraction * (last - box[i, end])
        return there

    fraction = _farthest(lambda part: holds(moved(part)), 1.0, halvings)
    return float(moved(fraction)[i, end])


def _traded(
    holds: Callable[[Array], bool], box: Array, u: Array, room: Array, lengths: Array, power: int
) -> Array:
    """A better box: one end is drawn in, and the others move out, while that helps.

    power: 0 for the product of all widths, else for a mean of them that is near the least if it is high.
    """
    ends = list(product(range(len(u)), range(2)))

    def score(of: Array) -> float:
        wide = np.maximum((of[:, 1] - of[:, 0]) * lengths, 1e-12 * lengths.max())
        mean = np.log((wide.min() / wide) ** power @ np.ones(len(wide))) / (power or 1)
        return float(np.log(wide.min()) - mean if power else np.log(wide).sum())

    best, step = score(box), 1.0
    while step > _SHORTEST:
        helped = False
        for j, first in product(range(len(ends)), range(1, len(ends))):
            i, end = ends[j]
            tried = box.copy()
            tried[i, end] += step * (u[i] - box[i, end])
            for k in range(len(ends)):
                other = ends[(j + first + k) % len(ends)]
                tried[other] = _moved_out(holds, tried, *other, room[other], _TRADED)
            found = score(tried)
            if found > best + _BETTER:
                best, box, helped = found, tried, True
        step *= 1.0 if helped else 0.5
    return box


def _on_sides(sides: Sides, grasp: Grasp) -> tuple[np.ndarray, Array]:
    """The sides that contacts are on, by point and normal, and their u."""
    unit = sides.vectors / sides.lengths[:, None]
    places, u = [], []
    for contact in grasp:
        away = contact.position - sides.vertices
        along = np.clip((away * unit).sum(axis=1), 0.0, sides.lengths)
        distance = np.hypot(*(away - along[:, None] * unit).T) / sides.size
        turned = np.hypot(contact.normal[0] + unit[:, 1], contact.normal[1] - unit[:, 0])
        side = int(np.argmin(distance + turned))
        if distance[side] + turned[side] > _ON_SIDE:
            raise InvalidInput(f"contact {contact.name} is on no side of the outline, with its inward normal")
        places.append(side)
        u.append(side + along[side] / sides.lengths[side])
    return np.array(places), np.array(u)

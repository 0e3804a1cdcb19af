"""How far the fingers of a grasp may miss their places on straight sides: exact by corners."""

from itertools import product

import numpy as np

from regrasp.errors import Infeasible, InvalidInput
from regrasp.mechanics.checks import Array, read_only
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.state import GraspState
from regrasp.outline.outline import Outline
from regrasp.outline.polygon import PolygonBoundary
from regrasp.planning.placement.reachable import sides_of
from regrasp.planning.placement.regions.bends import around_bends
from regrasp.planning.placement.regions.contact_arcs import ContactRegions
from regrasp.planning.placement.regions.corners import Corners, states_at
from regrasp.planning.placement.regions.cuts import Cuts
from regrasp.planning.placement.regions.growing import HALVINGS, farthest, moved_out, traded
from regrasp.planning.placement.regions.least_arc import LeastArc
from regrasp.planning.placement.regions.needs import LESS, ON_EDGE, limit_of
from regrasp.planning.placement.sides import Sides, moved

_EDGE = 1e-5  # of the size: fingers that may be off by no more, and corners without forces, are on an edge
_ON_SIDE = 1e-6  # of the size: farther from every side a contact is not on the outline


def on_sides(shape: Outline, grasp: Grasp, loads: Array, given: float | None, widest: str) -> ContactRegions:
    """What ``contact_regions`` finds on a polygon."""
    straight = all(isinstance(hole, PolygonBoundary) for hole in shape.holes)
    sides = sides_of(shape, 0.0, in_holes=straight)  # into holes that are curves nobody asks fingers
    places, u = _sides_under(sides, grasp)
    kept = float(grasp.frictions[0]) * (1 - LESS)
    corners, table = Corners(len(grasp), loads, sides.size), np.ascontiguousarray(sides.table())
    on, ends = np.repeat(places[:, None], 2, axis=1), np.repeat(u[:, None], 2, axis=1)
    limit = limit_of(corners.need(table, kept, on, ends), given, grasp, loads)
    to = (sides.contact(int(side), v, kept, "at") for side, v in zip(places, u, strict=True))
    grasp = Grasp(map(moved, grasp, to))
    k = len(places)
    lengths = sides.lengths[sides.edges[places]]
    room = sides.ends[places]  # (k, 2)
    ways: Array = np.array([-1.0, 1.0])
    cuts = Cuts(sides, places, float(grasp.frictions[0]), loads, limit * (1 + LESS))

    def holds(box: Array) -> bool:
        if corners.hold(table, kept, on, box, limit):
            return True
        if widest == "least":
            cuts.add(corners.worst(box))
        return False

    def out(box: Array, i: int, end: int, halvings: int = HALVINGS) -> float:
        def at_end(moved: Array) -> bool:  # corners at the moved end decide
            thin = moved.copy()
            thin[i, 1 - end] = moved[i, end]
            return holds(thin)

        return moved_out(at_end, box, i, end, room[i, end], halvings)

    def off(width: float) -> Array:
        result: Array = np.clip(u[:, None] + ways * width / lengths[:, None], room[:, :1], room[:, 1:])
        return result

    half = farthest(lambda width: holds(off(width)), float(lengths.max()))
    box = off(half * (1 - LESS))
    for i, end in product(range(k), range(2)):
        box[i, end] = out(box, i, end)
    proof = None
    if widest == "least":
        found, wide = LeastArc(cuts, u, holds), float(((box[:, 1] - box[:, 0]) * lengths).min())
        proof = found.run(box[:, 0])
        if found.width > wide:
            box = found.box(found.starts, found.width)
        for i, end in product(range(k), range(2)):
            box[i, end] = out(box, i, end)
    if widest == "product":
        box = traded(out, box, u, lengths)
    if widest != "together":
        free = box != room  # ends that are not the end of their side
        half = float(
            (np.abs(box - u[:, None]) * lengths[:, None]).min(where=free, initial=half + lengths.max())
        )
    box = u[:, None] + (1 - LESS) * (box - u[:, None])
    alone = np.zeros((k, 2))
    for i, end in product(range(k), range(2)):
        reached = out(ends, i, end)
        alone[i, end] = abs(reached - u[i]) * lengths[i]
    states = list[GraspState]()
    for corner in product(*box):
        at = Grasp(
            sides.contact(int(side), float(v), c.friction, c.name or "")
            for side, v, c in zip(places, corner, grasp, strict=True)
        )
        try:
            states += states_at(at, loads, limit * (1 + LESS))
        except Infeasible:
            if half <= _EDGE * sides.size:
                raise Infeasible(ON_EDGE) from None
            raise
    starts = sides.starts[sides.edges[places]] - sides.edges[places] * lengths
    regions = ContactRegions(
        shape, grasp, read_only(starts + u * lengths), read_only(starts[:, None] + box * lengths[:, None]),
        half * (1 - LESS) ** 2, read_only(alone * (1 - LESS)), limit * (1 + LESS), tuple(states),
        widest=proof,
    )  # fmt: skip
    if (sides.edges[places] >= len(shape.polygon())).any():
        return regions
    return around_bends(regions, loads, widest)


def _sides_under(sides: Sides, grasp: Grasp) -> tuple[np.ndarray, Array]:
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
            raise InvalidInput(
                f"contact {contact.name} is on no side of the outline or of a hole that is a polygon, with "
                "its inward normal"
            )
        places.append(side)
        u.append(side + along[side] / sides.lengths[side])
    return np.array(places), np.array(u)

"""How far the fingers of a grasp may miss their places on a curve: proven by points beside it.

A force acts along a line, so one of a finger at p on a part of a curve, h off a chord A B, is one on the
chord where that line meets it: within h tan(gamma) of the foot of p, gamma the widest angle of a force of the
cone to the chord's normal. Let fingers at A and B, with forces in the cones of all points of the part,
hold a load. Their mixtures press on the chord from A to B; the places where they would have to press to be
forces at p stay between, if A and B are so far beyond the feet of the part. So some mixture does: there are
forces for p, in its own cone and within the limit. Finger by finger this proves all places of a box of parts.
The shorter parts are, the less it loses: a box that is not proven so is halved into cells, up to some number.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from itertools import product

import numpy as np

from regrasp.errors import Infeasible, InvalidInput
from regrasp.mechanics.checks import Array, read_only
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.state import GraspState
from regrasp.outline.outline import Outline
from regrasp.planning.placement.curves.curved_sides import CurvedSides, curved_sides
from regrasp.planning.placement.regions.contact_arcs import ContactRegions
from regrasp.planning.placement.regions.corners import Corners, states_at
from regrasp.planning.placement.regions.growing import farthest, moved_out
from regrasp.planning.placement.regions.needs import LESS, limit_of
from regrasp.planning.placement.regions.seeking import MOST, Seeking
from regrasp.planning.placement.sides import moved

ON_CURVE = 1e-6  # of the size: farther from the curve a contact is not on it
_BEYOND = 1e-9  # of the size, by which chords are longer than they must be, for rounding
_CELLS, _STATES = 16, 4096  # at most
_ALIKE = 1e-6  # of turns of parts: the first of those that are as wide is halved, whatever rounding says
_SMALLER = (1.0, 0.999, 0.99, 0.97, 0.9, 0.8, 0.6, 0.3)
_KEPT = 4096  # parts of the outline
_LITTLE = 0.02  # parts that turn by less are not halved [rad]
_ON_CURVES, _OUT = 11, 6  # halvings, those after a search
_WAYS: Array = np.array([-1.0, 1.0])
_STEEP = 1.3  # angles of forces to a chord's normal of no more are tried [rad]


@dataclass(frozen=True)
class _Part:
    """Of an outline: a point, the direction of its chord, how far from that point it is along it and off it.

    turned: how far its tangents are from one another [rad].
    """

    base: Array
    tangent: Array
    along: tuple[float, float]
    off: float
    turned: float

    @property
    def normal(self) -> Array:
        """The inward normal of its chord."""
        return np.array([-self.tangent[1], self.tangent[0]])


class CurvedPlaces:
    """Parts of an outline around contacts of one grasp, and whether loads are held all over them.

    sides: all of its outer boundary, as cubics. places: (k,) arc lengths of the contacts [m]. room: (k, 2)
    those beyond which regions do not go, a corner or a quarter of the outline away.
    """

    def __init__(
        self, shape: Outline, sides: CurvedSides, grasp: Grasp, places: Array, loads: Array
    ) -> None:  # fmt: skip
        self.shape, self.sides, self.grasp, self.places, self.loads = shape, sides, grasp, places, loads
        self._corners = Corners(len(grasp), loads, sides.size)
        self._part, self._u_at = lru_cache(_KEPT)(self._part_between), lru_cache(_KEPT)(sides.u_at)
        self.far, corners = 0.25 * shape.length, shape.boundary.corners
        away = (_WAYS[:, None] * (corners - self.places[:, None, None])) % shape.length
        reach = np.minimum(away.min(axis=2, initial=np.inf), self.far)
        self.room: Array = self.places[:, None] + _WAYS * reach

    def at_corners(self, box: Array) -> np.ndarray:
        """(k, 2) which ends of arcs are nearly as far as a corner."""
        away, reach = (np.abs(ends - self.places[:, None]) for ends in (box, self.room))
        return np.asarray((reach < self.far) & (away >= (1 - 3 * LESS) * reach))

    def spans(self, box: Array) -> Array:
        """(k, 2) the u of arc lengths (k, 2), which may run past the start."""
        turns = np.floor(box / self.shape.length)
        at = [[self._u_at(float(s)) for s in row] for row in box - turns * self.shape.length]
        result: Array = np.array(at) + turns * len(self.sides.control)
        return result

    def cells(self, span: Array, limit: float) -> list[Array] | None:
        """Parts (k, 2) in u whose corners need no more than a limit, which make up a box; None for none."""
        if not self._ends_hold(span, limit):
            return None
        most = min(_CELLS, max(1, _STATES // (2 ** len(span) * len(self.loads))))
        proven, left = [], [span]
        while left:
            cell = left.pop()
            if self.need(cell, limit) <= limit:
                proven.append(cell)
                continue
            turns = [self._part(lo, hi).turned for lo, hi in cell.tolist()]
            i = int(np.argmax(np.array(turns) >= (1 - _ALIKE) * max(turns)))
            if turns[i] < _LITTLE or len(proven) + len(left) + 2 > most:
                return None
            left += [cell.copy(), cell]
            left[-1][i, 1] = left[-2][i, 0] = cell[i].mean()
        return proven

    def corners(self, span: Array) -> tuple[Array, Array, float] | None:
        """(k, 2, 2) points, (k, 2) normals and friction of fingers beside parts; None where cones differ."""
        mu = float(self.grasp.frictions[0]) * (1 - LESS)
        parts = [self._part(lo, hi) for lo, hi in span.tolist()]
        turned = max(part.turned for part in parts)
        alpha = np.arctan(mu) - turned / 2 - (1e-9 if turned > 0 else 0.0)
        if not 0 <= alpha <= _STEEP or turned > 1:
            return None
        ends = []
        for part in parts:
            lo, hi = part.along
            reach = part.off * np.tan(alpha) + (_BEYOND * self.sides.size if lo < hi else 0.0)
            ends.append(part.base + np.array([[lo - reach], [hi + reach]]) * part.tangent)
        return np.array(ends), np.array([p.normal for p in parts]), float(np.tan(alpha))

    def _part_between(self, lo: float, hi: float) -> "_Part":
        points, tangents = self.sides.hull(lo, hi)
        middle, turn, turned = _turned(tangents)
        t = middle * np.cos(turn) + np.array([-middle[1], middle[0]]) * np.sin(turn)
        along, off = (points - points[0]) @ t, (points - points[0]) @ [-t[1], t[0]]
        return _Part(points[0], t, (float(along.min()), float(along.max())), float(np.abs(off).max()), turned)

    def need(self, span: Array, limit: float = np.inf) -> float:
        """The largest least force that a corner needs, or one above a limit [N]; infinite for none."""
        found = self.corners(span)
        if found is None:
            return np.inf
        ends, normals, mu = found
        return self._need(ends, np.repeat(normals[:, None], 2, axis=1), mu, limit)

    def _ends_hold(self, span: Array, limit: float) -> bool:
        """Whether fingers at the ends of parts need no more than a limit."""
        mu = float(self.grasp.frictions[0]) * (1 - LESS)
        if np.arctan(mu) > _STEEP:
            return False
        parts = [self._part(u, u) for u in span.ravel().tolist()]
        points, normals = np.array([p.base for p in parts]), np.array([p.normal for p in parts])
        return self._need(points.reshape(-1, 2, 2), normals.reshape(-1, 2, 2), mu, limit) <= limit

    def _need(self, ends: Array, normals: Array, mu: float, limit: float) -> float:
        """The largest least force with which fingers at one of two points each (k, 2, 2) hold the loads."""
        n = np.arange(2 * len(ends))
        ends, normals = ends.reshape(-1, 2), normals.reshape(-1, 2)
        table = np.column_stack([ends / self.sides.size, 0 * ends, normals, n, n, n])
        on = n.reshape(-1, 2)
        return self._corners.need(table, mu, on, on.astype(float), limit)

    def states(self, span: Array, limit: float) -> tuple[GraspState, ...]:
        """States at all corners, load by load, which prove a cell."""
        found = self.corners(span)
        assert found is not None
        ends, normals, mu = found
        states = list[GraspState]()
        for corner in product(range(2), repeat=len(ends)):
            at = Grasp(
                Contact(p[e], n, mu, name=c.name)
                for p, n, e, c in zip(ends, normals, corner, self.grasp, strict=True)
            )
            states += states_at(at, self.loads, limit)
        return tuple(states)


def on_curve(
    shape: Outline, control: Array, grasp: Grasp, loads: Array, given: float | None, widest: str
) -> ContactRegions:
    """What ``contact_regions`` finds on a smooth outline."""
    sides = curved_sides(shape, control)
    places = np.array([shape.nearest(c.position + shape.centre_of_mass) for c in grasp])
    for contact, s in zip(grasp, places, strict=True):
        away = np.hypot(*(shape.points(s) - contact.position)) / sides.size
        if away + np.hypot(*(shape.normals(s) - contact.normal)) > ON_CURVE:
            raise InvalidInput(f"contact {contact.name} is not on the outline, with its inward normal")
    at = [shape.contact_at(float(s), friction=0.0) for s in places]
    around = CurvedPlaces(shape, sides, Grasp(map(moved, grasp, at)), places, loads)
    least = around.need(around.spans(np.stack([places, places], axis=1)))
    return widest_around(around, limit_of(least, given, around.grasp, loads), widest)


def widest_around(around: CurvedPlaces, limit: float, widest: str) -> ContactRegions:
    """Regions whose forces are below a limit [N], by which the grasp itself holds."""
    at, k, room = around.places, len(around.places), around.room
    single = np.stack([at, at], axis=1)

    def holds(box: Array) -> bool:
        return around.cells(around.spans(box), limit) is not None

    def off(width: float) -> Array:
        result: Array = np.clip(single + width * _WAYS, room[:, :1], room[:, 1:])
        return result

    half = farthest(lambda width: holds(off(width)), float(np.abs(room - single).max()), _ON_CURVES)
    box, alone = single + (1 - LESS) * (off(half) - single), np.zeros((k, 2))
    for i, end in product(range(k), range(2)):
        last = float(room[i, end])
        box[i, end] = at[i] + (1 - LESS) * (moved_out(holds, box, i, end, last, _ON_CURVES) - at[i])
        alone[i, end] = (1 - LESS) * abs(moved_out(holds, single, i, end, last, _ON_CURVES) - at[i])
    if widest != "together":
        box = _sought(holds, at, box, room, widest)
    free = ~around.at_corners(box)
    half = float(np.abs(box - single).min(where=free, initial=(1 - LESS) * half))
    for part in _SMALLER:  # a box within one that holds may be cut otherwise, and fail
        inside = single + part * (box - single)
        cells = around.cells(around.spans(inside), limit)
        if cells is not None:
            break
    else:
        raise Infeasible("the regions found were left without forces by rounding")
    box, half = inside, part * half
    return ContactRegions(
        around.shape, around.grasp, read_only(at), read_only(box), half * (1 - LESS), read_only(alone),
        limit * (1 + LESS), tuple(s for cell in cells for s in around.states(cell, limit * (1 + LESS))),
        read_only(around.spans(box)), read_only(np.array(cells)),
    )  # fmt: skip


def _sought(holds: Callable[[Array], bool], at: Array, box: Array, room: Array, widest: str) -> Array:
    """A box of a longer least arc or a larger product of arcs, if one is found."""
    longest = (1 - LESS) * np.abs(room - at[:, None]).ravel()

    def there(off: Array) -> Array:
        return at[:, None] + off.reshape(-1, 2) * _WAYS

    def score(off: Array) -> float:
        return float(np.log(np.maximum(off[::2] + off[1::2], 1e-12 * longest.max())).sum())

    start = np.abs(box - at[:, None]).ravel()
    seeking = Seeking(lambda off: holds(there(off)), longest, MOST[widest])
    found = there(seeking.least(start))
    if np.ptp(found, axis=1).min() < 1.001 * np.ptp(box, axis=1).min():  # where it began, by rounding
        found = box
    else:
        for i, end in product(range(len(at)), range(2)):
            found[i, end] = moved_out(holds, found, i, end, there(longest)[i, end], _OUT)
    if widest == "least":
        return found
    start, other = (np.abs(each - at[:, None]).ravel() for each in (box, found))
    seeking.left = MOST[widest]
    return there(seeking.product(max(start, other, key=score), score))


def _turned(tangents: Array) -> tuple[Array, float, float]:
    """A direction between tangents, how far their middle is turned from it, and how wide they are [rad]."""
    middle = tangents.sum(axis=0)
    middle /= np.hypot(*middle)
    turned = np.arctan2(middle[0] * tangents[:, 1] - middle[1] * tangents[:, 0], tangents @ middle)
    return middle, 0.5 * float(turned.max() + turned.min()), float(np.ptp(turned))

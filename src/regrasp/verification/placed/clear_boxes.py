"""Which boxes of a proof doubles show to be excluded, by more than all of their rounding together."""

from typing import NamedTuple, Protocol

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.verification.placed.forces.limited import roughly_excluded
from regrasp.verification.placed.protocol import Proof

ROUNDING = 1e-13  # of the terms of a sum of a few products: more than a hundred roundings
SMALL = 1e-140  # squares of less lose digits, and doubles of less than 1e-308 all of them; of 1 / it overflow
_AT_ONCE = 20_000  # stretches of sides
_ADDED = 200  # gains of a box: their sum loses less than what is taken from each


class Edges(Protocol):
    """The boundary."""

    def roughly(self, edges: np.ndarray, lo: Array, hi: Array, y: Array) -> Array:
        """(m,) the most work on stretches along twists y (m, 3), but for rounding."""

    def roughly_parts(self, edges: np.ndarray, lo: Array, hi: Array, y: Array) -> list[tuple[Array, Array]]:
        """Of points whose hulls contain stretches a and c of ``limited`` (m,), but for rounding."""

    def lengths(self) -> Array:
        """(k,) about those of all edges [m]."""


def is_plain(proof: Proof, boundary: Edges) -> bool:
    """Whether doubles lose no digits of the lengths and limits of a proof, nor of their squares."""
    edges = np.unique(proof.sides[:, 0]).astype(int)
    limits = proof.bound, proof.margin, proof.min_normal, proof.max_force or 0.0
    sizes = [*boundary.lengths()[edges].tolist(), *(limit for limit in limits if limit != 0)]
    return all(SMALL < size < 1 / SMALL for size in sizes)


def clear_boxes(proof: Proof, boundary: Edges, play: float = 0.0) -> np.ndarray:
    """(n,) whether each box is excluded for sure; what is not may be, too, and rationals tell.

    play: by which a circle is off one.
    """
    number, m = np.asarray(proof.number), len(proof.sides)
    arcs = np.asarray(proof.arcs)
    told = (np.asarray(proof.children)[:, 1] == 0) & (number >= 0) & (number < len(proof.loads))
    told &= (arcs >= 0).all(axis=(1, 2)) & (arcs < m).all(axis=(1, 2))
    told &= (arcs[:, :, 0] <= arcs[:, :, 1]).all(axis=1)
    if proof.by_side is not None:
        by_side = np.asarray(proof.by_side)[:, 0]
        told[by_side[(by_side >= 0) & (by_side < len(told))]] = False
    found: np.ndarray = np.zeros(len(arcs), bool)
    boxes = np.flatnonzero(told)
    if not len(boxes):
        return found
    rows = (arcs[boxes, :, 1] - arcs[boxes, :, 0] + 1).sum(axis=1)
    parts = np.flatnonzero(np.diff(np.cumsum(rows) // _AT_ONCE)) + 1
    with np.errstate(all="ignore"):
        for some in np.split(boxes, parts):
            found[some] = _clear(proof, boundary, some, play)
        if proof.movers is not None and proof.control is None:
            found[np.unique(np.asarray(proof.movers)[:, 0])] = False
            found |= told & (
                _clear_of_movers(proof, boundary, told) | _clear_of_groups(proof, boundary, told)
            )
    return found


def _clear(proof: Proof, boundary: Edges, boxes: np.ndarray, play: float) -> np.ndarray:
    y = np.asarray(proof.twists)[boxes]
    terms = -np.asarray(proof.loads)[np.asarray(proof.number)[boxes]] * y
    z = np.zeros_like(y)
    if proof.pairs is not None:
        z, more = _seconds(proof, boxes)
        terms = np.column_stack([terms, more])
    lost = ROUNDING * np.abs(terms).sum(axis=1)
    work = terms.sum(axis=1) - lost
    room = _room(proof, np.abs(y) + np.abs(z)) * (1 + (1 + ROUNDING) * play / ROUNDING)
    told = lost > SMALL
    if proof.max_force is not None or proof.min_normal > 0:
        stretches = _stretches(proof, boxes)
        parts = boundary.roughly_parts(*stretches.at, np.repeat(y, stretches.of_each, axis=0))
        if proof.norm == "squares":  # a and c are forces there
            room *= 1 + room / ROUNDING / max(proof.bound, proof.min_normal)
        found = roughly_excluded(
            proof, work, room + ROUNDING, lambda most: stretches.largest([most(*part) for part in parts])
        )
        return np.asarray(told & found)
    most = _most(proof, boundary, boxes, y, z) + room[:, None]
    if proof.size == "margin":
        return np.asarray(told & (work > most.sum(axis=1)))
    if proof.norm == "sum":
        dual = most.max(axis=1)
    else:
        dual = most.sum(axis=1) if proof.norm == "largest" else np.sqrt((most * most).sum(axis=1))
    return np.asarray(told & (work > proof.bound * dual * (1 + ROUNDING)))


def _room(proof: Proof, sizes: Array) -> Array:
    """(b,) what rounding may add to the most work along twists of which these are the sizes (b, 3).

    No bound where twists are so slow that they lose digits.
    """
    points = np.reshape(proof.vertices if proof.control is None else proof.control, (-1, 2))
    reach = np.hypot(*np.abs(points).max(axis=0)) + np.hypot(*proof.centre_of_mass)
    lost = ROUNDING * (sizes @ [1.0, 1.0, reach])
    times = (1 + proof.friction) * (4 * proof.bound if proof.size == "margin" else 1)
    return np.where(lost > SMALL, lost * times, np.inf)


def clearance(proof: Proof, y: Array, load: np.ndarray) -> tuple[Array, Array, np.ndarray]:
    """(b,) the work of loads less rounding, what it may add to that of a finger, and where it tells."""
    terms = -np.asarray(proof.loads)[load] * y
    lost, room = ROUNDING * np.abs(terms).sum(axis=1), _room(proof, np.abs(y))
    return terms.sum(axis=1) - lost, room, np.minimum(room, lost) > SMALL


def times(proof: Proof) -> float:
    """How often the most work of what a finger can do counts."""
    return 1.0 if proof.size == "margin" else proof.bound * (1 + ROUNDING)


def _clear_of_movers(proof: Proof, boundary: Edges, told: np.ndarray) -> np.ndarray:
    """(n,) whether twists that move with the fingers exclude each box of straight arcs."""
    k, arcs = proof.fingers, np.asarray(proof.arcs)
    box, load = np.asarray(proof.movers).T
    good = (box >= 0) & (box < len(arcs)) & (load >= 0) & (load < len(proof.loads))
    good[good] &= told[box[good]] & on_one_edge(proof)[box[good]]
    corners = np.indices([2] * k).reshape(k, -1).T
    left = np.zeros((len(arcs), len(corners)))
    sure = np.zeros(len(arcs), bool)
    sure[box[good]] = True
    sure[box[~good & (box >= 0) & (box < len(arcs))]] = False
    sure[np.bincount(box[good], minlength=len(arcs)) > _ADDED] = False
    rows = np.flatnonzero(good)
    for some in np.split(rows, range(_AT_ONCE, len(rows), _AT_ONCE)):
        at, motions = box[some], np.asarray(proof.motions)[some]
        adds, w = motions[:, 3:].reshape(-1, 2, k), -np.asarray(proof.loads)[load[some]]
        sizes = np.abs(motions[:, :3])
        sizes[:, :2] += np.abs(adds).sum(axis=2)
        lost, room = ROUNDING * (np.abs(w) * sizes).sum(axis=1), _room(proof, sizes)
        sure[at[~(lost > SMALL)]] = False
        edge = np.asarray(proof.sides)[arcs[at, :, 0], 0].astype(int)
        for c, corner in enumerate(corners):
            y = motions[:, :3].copy()
            y[:, :2] += adds @ corner
            u = (np.asarray(proof.ends)[at][:, range(k), corner] - edge).ravel()
            most = (
                boundary.roughly(edge.ravel(), u, u, np.repeat(y, k, axis=0)).reshape(-1, k) + room[:, None]
            )
            gain = (w * y).sum(axis=1) - lost - times(proof) * most.sum(axis=1)
            np.add.at(left[:, c], at, gain)
    return np.asarray(sure & (left > 0).all(axis=1))


def on_one_edge(proof: Proof) -> np.ndarray:
    """(n,) whether each finger is on one edge."""
    arcs, edges = np.asarray(proof.arcs), np.asarray(proof.sides)[:, 0]
    inside = np.clip(arcs, 0, len(edges) - 1)
    result: np.ndarray = (edges[inside[:, :, 0]] == edges[inside[:, :, 1]]).all(axis=1)
    return result


def _clear_of_groups(proof: Proof, boundary: Edges, told: np.ndarray) -> np.ndarray:
    """(n,) whether twists of all loads that stay exclude each box with an arc of several straight sides."""
    arcs, movers, found = np.asarray(proof.arcs), np.asarray(proof.movers), np.zeros(len(proof.arcs), bool)
    rows = np.argsort(movers[:, 0], kind="stable")
    rows = rows[(movers[rows, 0] >= 0) & (movers[rows, 0] < len(arcs))]
    (box, load), motions = movers[rows].T, np.asarray(proof.motions)
    bad = (load < 0) | (load >= len(proof.loads)) | motions[rows, 3:].any(axis=1) | ~told[box]
    bad |= on_one_edge(proof)[box]
    left = np.ones(len(arcs), bool)
    left[box[bad]] = False
    left[np.bincount(box, minlength=len(arcs)) > _ADDED] = False
    rows = rows[left[box]]
    each, starts, counts = np.unique(movers[rows, 0], return_index=True, return_counts=True)
    sides = (arcs[each, :, 1] - arcs[each, :, 0] + 1).sum(axis=1)
    parts = np.flatnonzero(np.diff(np.cumsum(sides * counts) // _AT_ONCE)) + 1
    for some in np.split(np.arange(len(each)), parts):
        if not len(some):
            continue
        on = rows[starts[some[0]] : starts[some[-1]] + counts[some[-1]]]
        y, w = motions[on, :3], -np.asarray(proof.loads)[movers[on, 1]]
        stretches, own = _stretches(proof, movers[on, 0]), _stretches(proof, each[some])
        # the same stretches once for each load
        first = np.repeat(np.cumsum(own.of_each) - own.of_each, counts[some])
        begins = np.cumsum(stretches.of_each) - stretches.of_each
        at = np.arange(stretches.of_each.sum()) + np.repeat(first - begins, stretches.of_each)
        edges, *ends = stretches.at
        along = np.repeat(y, stretches.of_each, axis=0)
        done = [np.asarray(np.bincount(at, boundary.roughly(edges, u, u, along)), float) for u in ends]
        lost, room = ROUNDING * np.abs(w * y).sum(axis=1), _room(proof, np.abs(y))
        of = np.repeat(np.arange(len(some)), counts[some])
        sure = np.bincount(of, lost <= SMALL) == 0
        most = own.largest(done).sum(axis=1) + proof.fingers * np.bincount(of, room)
        work = np.bincount(of, (w * y).sum(axis=1) - lost)
        found[each[some]] = sure & (work > times(proof) * most)
    return found


def _seconds(proof: Proof, boxes: np.ndarray) -> tuple[Array, Array]:
    """(b, 3) second twists, 0 for none, and the terms of their work."""
    twists, terms = np.zeros((len(proof.children), 3)), np.zeros((len(proof.children), 3))
    box, load = np.asarray(proof.pairs).T
    good = (box >= 0) & (box < len(twists)) & (load >= 0) & (load < len(proof.loads))
    box, second = box[good], np.asarray(proof.seconds)[good]
    twists[box], terms[box] = second, -np.asarray(proof.loads)[load[good]] * second
    return twists[boxes], terms[boxes]


def _most(proof: Proof, boundary: Edges, boxes: np.ndarray, y: Array, z: Array) -> Array:
    """(b, k) the most work on each arc, for all its sides at once, along two twists."""
    stretches = _stretches(proof, boxes)
    edges, lo, hi = stretches.at
    along, also = (np.repeat(twist, stretches.of_each, axis=0) for twist in (y, z))
    values = boundary.roughly(edges, lo, hi, along)
    both = also.any(axis=1)
    each = edges[both]
    low, high = (
        boundary.roughly(each, u, u, along[both]) + boundary.roughly(each, u, u, also[both])
        for u in (lo[both], hi[both])
    )
    values[both] = np.maximum(low, high)
    return stretches.largest([values])


class _Stretches(NamedTuple):
    """Stretches of sides that the arcs of boxes are made of, one arc after the other.

    at: edges, fractions from which and to which. of_each: (b,) how many of a box. starts: first of each arc.
    """

    at: tuple[np.ndarray, Array, Array]
    of_each: np.ndarray
    starts: np.ndarray

    def largest(self, values: list[Array]) -> Array:
        """(b, k) the largest of some values of all stretches of an arc."""
        result: Array = np.maximum.reduceat(np.max(values, axis=0), self.starts)
        return result.reshape(len(self.of_each), -1)


def _stretches(proof: Proof, boxes: np.ndarray) -> _Stretches:
    first, last = np.asarray(proof.arcs)[boxes].reshape(-1, 2).T
    ends = np.asarray(proof.ends)[boxes].reshape(-1, 2)
    count = last - first + 1
    starts = np.concatenate([[0], np.cumsum(count)[:-1]])
    side = np.arange(count.sum()) + np.repeat(first - starts, count)
    edge, least, largest = np.asarray(proof.sides)[side].T
    least[starts], largest[starts + count - 1] = ends.T
    of_each = count.reshape(len(boxes), -1).sum(axis=1)
    return _Stretches((edge.astype(int), least - edge, largest - edge), of_each, starts)

"""Which boxes of a proof doubles show to be excluded, by more than all of their rounding together."""

from typing import Protocol

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.verification.placed.protocol import Proof

_ROUNDING = 1e-13  # of the terms of a sum of a few products: more than a hundred roundings
_SMALL = 1e-140  # squares of less lose digits, and doubles of less than 1e-308 all of them
_AT_ONCE = 20_000  # stretches of sides


class Edges(Protocol):
    """The boundary."""

    def roughly(self, edges: np.ndarray, lo: Array, hi: Array, y: Array) -> Array:
        """(m,) the most work on stretches along twists y (m, 3), but for rounding."""


def clear_boxes(proof: Proof, boundary: Edges) -> np.ndarray:
    """(n,) whether each box is excluded for sure; what is not may be, too, and rationals tell."""
    number, m = np.asarray(proof.number), len(proof.sides)
    arcs = np.asarray(proof.arcs)
    told = (np.asarray(proof.children)[:, 1] == 0) & (number >= 0) & (number < len(proof.loads))
    told &= (arcs >= 0).all(axis=(1, 2)) & (arcs < m).all(axis=(1, 2))
    told &= (arcs[:, :, 0] <= arcs[:, :, 1]).all(axis=1)
    found: np.ndarray = np.zeros(len(arcs), bool)
    boxes = np.flatnonzero(told)
    if not len(boxes):
        return found
    rows = (arcs[boxes, :, 1] - arcs[boxes, :, 0] + 1).sum(axis=1)
    parts = np.flatnonzero(np.diff(np.cumsum(rows) // _AT_ONCE)) + 1
    with np.errstate(all="ignore"):
        for some in np.split(boxes, parts):
            found[some] = _clear(proof, boundary, some)
    return found


def _clear(proof: Proof, boundary: Edges, boxes: np.ndarray) -> np.ndarray:
    y = np.asarray(proof.twists)[boxes]
    terms = -np.asarray(proof.loads)[np.asarray(proof.number)[boxes]] * y
    z = np.zeros_like(y)
    if proof.pairs is not None:
        z, more = _seconds(proof, boxes)
        terms = np.column_stack([terms, more])
    lost = _ROUNDING * np.abs(terms).sum(axis=1)
    work = terms.sum(axis=1) - lost
    points = np.reshape(proof.vertices if proof.control is None else proof.control, (-1, 2))
    reach = np.hypot(*np.abs(points).max(axis=0)) + np.hypot(*proof.centre_of_mass)
    room = _ROUNDING * ((np.abs(y) + np.abs(z)) @ [1.0, 1.0, reach]) * (1 + proof.friction)
    if proof.size == "margin":
        room *= 4 * proof.bound
    most = _most(proof, boundary, boxes, y, z) + room[:, None]
    told = np.minimum(room, lost) > _SMALL
    if proof.size == "margin":
        return np.asarray(told & (work > most.sum(axis=1)))
    if proof.norm == "sum":
        dual = most.max(axis=1)
    else:
        dual = most.sum(axis=1) if proof.norm == "largest" else np.sqrt((most * most).sum(axis=1))
    return np.asarray(told & (work > proof.bound * dual * (1 + _ROUNDING)))


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
    k = proof.fingers
    first, last = np.asarray(proof.arcs)[boxes].reshape(-1, 2).T
    ends = np.asarray(proof.ends)[boxes].reshape(-1, 2)
    count = last - first + 1
    starts = np.concatenate([[0], np.cumsum(count)[:-1]])
    side = np.arange(count.sum()) + np.repeat(first - starts, count)
    sides = np.asarray(proof.sides)
    edge, least, largest = sides[side].T
    least[starts], largest[starts + count - 1] = ends.T
    along, also = (np.repeat(np.repeat(twist, k, axis=0), count, axis=0) for twist in (y, z))
    edge_of, lo, hi = edge.astype(int), least - edge, largest - edge
    values = boundary.roughly(edge_of, lo, hi, along)
    both = also.any(axis=1)
    each = edge_of[both]
    low, high = (
        boundary.roughly(each, u, u, along[both]) + boundary.roughly(each, u, u, also[both])
        for u in (lo[both], hi[both])
    )
    values[both] = np.maximum(low, high)
    result: Array = np.maximum.reduceat(values, starts).reshape(-1, k)
    return result

"""That states beside a curve prove regions on it: chords reach beyond the arcs, and their cones are shared.

A force of a finger at p, h off the chord A B, acts along a line that meets the chord within h tan(gamma) of
the foot of p, gamma the widest angle between forces of the cone at A and B and the chord's normal. Where all
feet are so far from A and from B, mixtures of the forces at A and at B press at each of these places: one of
them is a force of the finger at p. It is in the cone of p if that contains the cone at A and B. Control
points stand for their curve, those of its derivative for its tangents. Doubles are off by a few 2^-53 of the
reach, and tangents by as much of the longest that they are mixed from: 2^-46 is left for both.
"""

from math import atan, tan

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.verification.exact import RESOLUTION
from regrasp.verification.placed.curves.pieces import ROUNDING, Pieces

_WIDEST = 1.5  # [rad] of gamma


def beside(pieces: Pieces, span: Array, ends: Array, normal: Array, inner: float, friction: float) -> bool:
    """Whether fingers at ``ends`` (2, 2), of one normal and friction ``inner``, stand for those of a span.

    span: (2,) number of the piece and fraction of it passed, from and to.
    """
    points, tangents, doubt = pieces.hull(*span.tolist())
    apart = np.abs(np.arctan2(tangents @ normal, tangents @ [normal[1], -normal[0]]))
    if not ((apart + atan(inner) - atan(friction)) * np.hypot(*tangents.T) <= -doubt).all():
        return False
    chord = ends[1] - ends[0]
    length = float(np.hypot(*chord))
    slack = float(RESOLUTION) * pieces.reach
    if length <= slack:
        return bool((np.hypot(*(points - ends[0]).T) <= slack).all())
    t = chord / length
    gamma = abs(float(np.arctan2(normal @ t, t[0] * normal[1] - t[1] * normal[0]))) + atan(inner)
    if gamma > _WIDEST:
        return False
    along, off = (points - ends[0]) @ t, np.abs(points @ [-t[1], t[0]] - ends[0] @ [-t[1], t[0]]).max()
    need = off * tan(gamma) + ROUNDING * pieces.reach * (1 + tan(gamma))
    return bool(along.min() >= need and along.max() + need <= length)


def covered(cells: Array, box: Array) -> bool:
    """Whether cells (c, k, 2) cover a box (k, 2), which can be cut between them, again and again."""
    open_boxes = [(cells, box)]
    while open_boxes:
        some, left = open_boxes.pop()
        if ((some[:, :, 0] <= left[:, 0]) & (some[:, :, 1] >= left[:, 1])).all(axis=1).any():
            continue
        halves = _cut(some, left)
        if not halves:
            return False
        open_boxes += halves
    return True


def _cut(cells: Array, box: Array) -> list[tuple[Array, Array]]:
    """Both parts of a box cut between cells, with the cells in each; empty where each cut meets a cell."""
    for i, (lo, hi) in enumerate(box):
        for cut in cells[:, i, 0]:
            before, after = cells[:, i, 1] <= cut, cells[:, i, 0] >= cut
            if lo < cut < hi and (before | after).all():
                left, right = box.copy(), box.copy()
                left[i, 1] = right[i, 0] = cut
                return [(cells[before], left), (cells[after], right)]
    return []


def chords(pieces: Pieces, span: Array) -> float:
    """The length of a span from below [m], and nearly all of it."""
    at = np.linspace(span[0], span[1], 65)
    return float(np.hypot(*np.diff([pieces.point(u) for u in at], axis=0).T).sum())

"""Pieces of a drawing joined end to end."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array

_MOST_MEETING = 64


@dataclass(frozen=True)
class Chain:
    """Pieces end to end: ``members`` are their numbers, ``points`` (k, 2) run through them all."""

    members: tuple[int, ...]
    points: Array
    closed: bool


def joined(pieces: list[Array], tolerance: float) -> list[Array]:
    """The closed rings that pieces (k, 2), drawn in any order and direction, make together.

    Ends within ``tolerance`` are joined, the nearest first. Raises ``InvalidInput`` where a chain stays open.
    """
    return [closed_ring(chain, tolerance) for chain in chains(pieces, tolerance)]


def closed_ring(chain: Chain, tolerance: float) -> Array:
    """The points of a closed chain, the first not repeated. Raises ``InvalidInput`` for an open one."""
    if not chain.closed:
        head, tail = chain.points[0], chain.points[-1]
        raise InvalidInput(
            f"the outline is open: it ends at ({tail[0]:.6g}, {tail[1]:.6g}), {np.hypot(*(tail - head)):.3g} "
            f"from its start ({head[0]:.6g}, {head[1]:.6g}); ends within {tolerance:.3g} would be joined"
        )
    return chain.points[:-1]


def chains(pieces: list[Array], tolerance: float) -> list[Chain]:
    """Every piece in one chain: it goes on to the nearest free end until it is back at its start."""
    if not pieces:
        return []
    ends = np.array([(piece[0], piece[-1]) for piece in pieces])  # (m, 2, 2)
    used = np.zeros(len(pieces), dtype=bool)
    nearest = _neighbours(ends, tolerance, used)
    result = []
    for first in range(len(pieces)):
        if used[first]:
            continue
        used[first] = True
        members, parts, count = [first], [pieces[first]], len(pieces[first])
        closed, at = False, (first, 1)
        while True:
            gap = float(np.hypot(*(parts[-1][-1] - parts[0][0])))
            away, piece, backwards = nearest(at)
            closed = gap <= tolerance and count > 2 and gap <= away
            if closed or away > tolerance:
                break
            used[piece] = True
            members.append(piece)
            parts.append(pieces[piece][::-1] if backwards else pieces[piece])
            count += len(pieces[piece])
            at = (piece, 1 - backwards)
        points = np.concatenate([*(part[:-1] for part in parts), parts[-1][-1:]])
        result.append(Chain(tuple(members), points, closed))
    return result


def _neighbours(
    ends: Array, tolerance: float, used: np.ndarray
) -> Callable[[tuple[int, int]], tuple[float, int, int]]:
    """A function from an end (piece, 0 or 1) to the distance, piece and end of the nearest unused one."""
    from scipy.spatial import cKDTree

    flat = ends.reshape(-1, 2)
    places, place, meeting = np.unique(flat, axis=0, return_inverse=True, return_counts=True)
    place = place.ravel()
    if meeting.max() > _MOST_MEETING:
        x, y = places[int(np.argmax(meeting))]
        raise InvalidInput(
            f"{meeting.max()} ends of lines meet at ({x:.6g}, {y:.6g}), more than {_MOST_MEETING}: "
            "an outline passes a point once"
        )
    here = np.split(np.argsort(place, kind="stable"), np.cumsum(meeting)[:-1])  # ends at each place
    k = min(_MOST_MEETING, len(places))
    limit = np.nextafter(tolerance, np.inf)
    away, near = cKDTree(places).query(places, k=[*range(1, k + 1)], distance_upper_bound=limit)

    def nearest(at: tuple[int, int]) -> tuple[float, int, int]:
        row = place[2 * at[0] + at[1]]
        for distance, other in zip(away[row], near[row], strict=True):
            if not distance <= tolerance:
                break
            for end in here[other]:
                if not used[end // 2]:
                    return float(distance), int(end // 2), int(end % 2)
        return np.inf, 0, 0

    return nearest

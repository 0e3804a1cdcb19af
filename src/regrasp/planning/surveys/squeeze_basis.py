"""Coordinates of internal forces: squeezes along pairs of contacts, and what no squeeze makes.

A squeeze of 1 N along a pair is u at P_i and -u at P_j, u the unit vector from P_i to P_j: two fingers that
push towards each other. Squeezes along all pairs span the forces with G f = 0 where the complete framework of
the points is infinitesimally rigid (their matrix is the transposed rigidity matrix): where the points span
the space, or are at most d of them and none too many for their flat (three not on one line).

Points that are too many for their flat (three on a line, four in a plane in space) leave forces across it:
+1 N along a unit normal m of the flat at a further contact P_j, borne by the first contacts that span the
flat, at which they are -lambda_k m for r_j = sum lambda_k r_k, sum lambda_k = 1 (the law of the lever).
"""

from itertools import combinations
from typing import NamedTuple

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, read_only
from regrasp.mechanics.grasp import Grasp

# Points thinner than this fraction of their extent lie in a flat.
_FLAT = 1e-10
# A squeeze that is a combination of others to this fraction is no new one: the first of these by which there
# are enough. Rounding grows by the inverse, so that there is nothing to be had below the last.
_SAME = (1e-1, 1e-2, 1e-4, 1e-6, 1e-8)


class SqueezeBasis(NamedTuple):
    """Names of the coordinates (k) and the forces (k, n, d) of one newton of each."""

    names: tuple[str, ...]
    forces: Array


def pair_squeezes(grasp: Grasp) -> tuple[tuple[tuple[int, int], ...], Array]:
    """All pairs i < j of contacts, and the forces (p, n, d) of a squeeze of 1 N along each."""
    pairs = tuple(combinations(range(len(grasp)), 2))
    forces = np.zeros((len(pairs), len(grasp), grasp.dimension))
    for row, (i, j) in zip(forces, pairs, strict=True):
        along = grasp.positions[j] - grasp.positions[i]
        row[i] = along / np.hypot.reduce(along)
        row[j] = -row[i]
    return pairs, forces


def squeeze_basis(grasp: Grasp) -> SqueezeBasis:
    """Coordinates of the internal forces: the first pairs that are clearly independent, then forces across.

    Raises ``InvalidInput`` where contacts are so near to one line or plane that rounding decides.
    """
    pairs, squeezes = pair_squeezes(grasp)
    flat = squeezes.reshape(len(pairs), -1)
    internal = grasp.internal_forces.reshape(-1, grasp.positions.size)
    across = _across(grasp)
    for same in _SAME:
        chosen = _independent(flat, same)
        if len(chosen) + len(across) >= len(internal):
            break
    names = [f"{grasp.names[i]}-{grasp.names[j]}" for i, j in (pairs[p] for p in chosen)]
    names += [name for name, _ in across]
    rows = [*flat[chosen], *(forces for _, forces in across)]
    if len(rows) != len(internal):
        raise InvalidInput(
            f"the contacts {', '.join(grasp.names)} are so near to one line or plane that rounding decides "
            f"whether they lie in it; place them in it or clearly out of it"
        )
    exact = np.array(rows).reshape(internal.shape) @ internal.T @ internal
    return SqueezeBasis(tuple(names), read_only(exact.reshape(-1, *grasp.positions.shape)))


def _independent(rows: Array, same: float) -> list[int]:
    """The first rows that differ from every combination of those before them by more than ``same``."""
    orthonormal, chosen = np.zeros((0, rows.shape[1])), []
    for place, row in enumerate(rows):
        rest = row
        for _ in range(2):
            rest = rest - (orthonormal @ rest) @ orthonormal
        if (left := float(np.linalg.norm(rest))) > same:
            orthonormal = np.vstack([orthonormal, rest / left])
            chosen.append(place)
    return chosen


def _across(grasp: Grasp) -> list[tuple[str, Array]]:
    """Internal forces (n d,) across the line or plane that holds all contacts, by name."""
    n, d = grasp.positions.shape
    arms = grasp.positions - grasp.positions[0]
    frame, directions = [0], np.zeros((0, d))
    extent = float(abs(arms).max())
    for i in range(1, n):
        rest = arms[i] - (directions @ arms[i]) @ directions
        if np.linalg.norm(rest) > _FLAT * extent:
            frame.append(i)
            directions = np.vstack([directions, rest / np.linalg.norm(rest)])
    normals = np.linalg.svd(directions)[2][len(directions) :]
    if d == 3 and len(normals) == 1:  # the side from which the first three contacts turn left
        normals = np.cross(directions[0], directions[1])[None]
    levers = np.vstack([grasp.positions[frame].T / (grasp.size or 1.0), np.ones(len(frame))])
    found = []
    for j in sorted(set(range(n)) - set(frame)):
        shares = np.linalg.lstsq(levers, np.append(grasp.positions[j] / (grasp.size or 1.0), 1.0))[0]
        for count, normal in enumerate(normals, 1):
            forces = np.zeros((n, d))
            forces[j] = normal
            forces[frame] = -shares[:, None] * normal
            which = f" {count}" if len(normals) > 1 else ""
            found.append((f"across{which} at {grasp.names[j]}", forces.ravel()))
    return found

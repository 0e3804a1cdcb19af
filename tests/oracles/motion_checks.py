"""What motions must keep, sampled with lines of their own."""

import numpy as np
from scipy.spatial import cKDTree

import regrasp as rg
from regrasp.motions import Motions


def instants(motions: Motions, apart: float) -> np.ndarray:
    """Times between which no tip moves by more than ``apart`` [m]."""
    times = [np.array([0.0, motions.duration])]
    for m in motions.motions:
        number = int(np.ceil(15 / 8 * m.way.length / apart)) + 1
        times.append(m.start + np.linspace(0, m.duration, number))
    return np.unique(np.concatenate(times))


def to_faces(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """(m,) distances of points from triangles (k, 3, 3), the least of all of them.

    Not more than from their corners; a face is asked where the ball around it comes as near as that.
    """
    best = cKDTree(corners.reshape(-1, 3)).query(points)[0]
    for face in corners:
        middle = face.mean(axis=0)
        radius = np.linalg.norm(face - middle, axis=1).max() * (1 + 1e-9)
        near = np.linalg.norm(points - middle, axis=1) <= best + radius
        best[near] = np.minimum(best[near], to_face(points[near], face))
    return best


def to_face(points: np.ndarray, face: np.ndarray) -> np.ndarray:
    """(m,) distances of points from a triangle (3, 3): its plane above and below it, else its sides."""
    edges, ways = face[1:] - face[0], np.roll(face, -1, axis=0) - face
    weights = np.linalg.lstsq(edges.T, (points - face[0]).T, rcond=None)[0].T
    within = (weights >= 0).all(axis=1) & (weights.sum(axis=1) <= 1)
    off = points[:, None] - face
    along = np.clip((off * ways).sum(axis=2) / (ways**2).sum(axis=1), 0, 1)
    beside = np.linalg.norm(off - along[..., None] * ways, axis=2).min(axis=1)
    return np.where(within, np.linalg.norm(off[:, 0] - weights @ edges, axis=1), beside)


def axes(motions: Motions, at: np.ndarray, apart: float) -> list[np.ndarray]:
    """(m, s, d) of each finger: points of its axis no more than ``apart`` [m] from one another."""
    found = []
    for i, v in enumerate(motions.capsules):
        s = np.linspace(0, 1, int(np.ceil(np.linalg.norm(v) / apart)) + 1 if v.any() else 1)
        found.append(at[:, i, None] + s[:, None] * v)
    return found


def star() -> rg.Outline:
    """Of ten corners, 0.05 and 0.028 from its middle by turns."""
    points = [[(0.05 if k % 2 else 0.028) * f(np.pi * k / 5) for f in (np.cos, np.sin)] for k in range(10)]
    return rg.Outline(points)

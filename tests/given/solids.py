"""Solids in space for the tests of meshes: bumpy balls and pebbles, motions, soups of triangles."""

from dataclasses import dataclass

import numpy as np
from hypothesis import strategies as st

import regrasp as rg

seeds = st.integers(0, 10**6)


def bumpy(seed: int, **options) -> rg.Mesh:
    """A ball with 42 random radii, off the origin."""
    rng = np.random.default_rng(seed)
    ball = rg.Mesh.sphere(1.0, divisions=2)
    radii = rng.uniform(0.7, 1.3, len(ball.vertices))
    return rg.Mesh(ball.vertices * radii[:, None] + rng.normal(size=3), ball.faces, **options)


def pebble(n: int) -> rg.Mesh:
    """2 n (n - 1) flat faces around a bumpy body."""
    turn, down = np.meshgrid(2 * np.pi * np.arange(n) / n, np.pi * np.arange(1, n) / n)
    reach = 1 + 0.12 * np.sin(3 * turn) * np.sin(down) ** 3 + 0.1 * np.cos(2 * down)
    at = [0.03 * np.sin(down) * np.cos(turn), 0.022 * np.sin(down) * np.sin(turn), 0.04 * np.cos(down)]
    points = np.vstack([np.moveaxis(reach * at, 0, 2).reshape(-1, 3), [0, 0, 0.044], [0, 0, -0.044]])
    ring, k = np.arange(n), (np.arange(n) + 1) % n
    top, last = np.full(n, len(points) - 2), (n - 2) * n
    faces = [np.column_stack([top, ring, k]), np.column_stack([top + 1, last + k, last + ring])]
    for i in range(0, last, n):
        faces += [np.column_stack([i + ring, i + n + ring, i + n + k])]
        faces += [np.column_stack([i + ring, i + n + k, i + k])]
    return rg.Mesh(points, np.concatenate(faces))


@dataclass(frozen=True)
class Motion:
    """x -> scale R x + shift."""

    rotation: np.ndarray
    scale: float
    shift: np.ndarray

    def points(self, x: np.ndarray) -> np.ndarray:
        return self.scale * x @ self.rotation.T + self.shift

    def directions(self, n: np.ndarray) -> np.ndarray:
        return n @ self.rotation.T

    def mesh(self, mesh: rg.Mesh) -> rg.Mesh:
        return rg.Mesh(self.points(mesh.vertices), mesh.faces, smooth=mesh.smooth, crease=mesh.crease)


@st.composite
def motions(draw) -> Motion:
    rng = np.random.default_rng(draw(seeds))
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q *= np.sign(np.diag(r))
    if np.linalg.det(q) < 0:
        q[:, 0] *= -1
    scale = 10.0 ** draw(st.integers(-6, 6))
    return Motion(q, scale, 3 * scale * rng.normal(size=3))


def angle(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """[deg] between unit vectors."""
    return np.degrees(2 * np.arcsin(np.clip(np.linalg.norm(a - b, axis=-1) / 2, 0, 1)))


def is_inside(mesh: rg.Mesh, point: np.ndarray) -> bool:
    """By the winding number: solid angles of the faces add up to 4 pi (Van Oosterom and Strackee, 1983)."""
    a, b, c = (mesh.vertices - point)[mesh.faces].transpose(1, 0, 2)
    p, q, r = (np.linalg.norm(v, axis=1) for v in (a, b, c))
    volume = (a * np.cross(b, c)).sum(axis=1)
    rest = p * q * r + (a * b).sum(axis=1) * r + (b * c).sum(axis=1) * p + (c * a).sum(axis=1) * q
    return bool(2 * np.arctan2(volume, rest).sum() > 2 * np.pi)

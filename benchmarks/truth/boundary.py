"""Grasps whose limit is known by construction, and loads on both sides of it; nothing of the project is used.

A motion v comes first, then contacts at random places, each turned so that v is what it must be at a load the
grasp can just hold: u_i = v + omega x r_i, the velocity at contact i, then

    active      n_i . u_i = mu_i |u_i across n_i|: the edge e_i of its cone does no work, v . G e_i = 0
    idle        n_i . u_i > mu_i |u_i across n_i|: whatever it pushes does work along v
    still       u_i = 0: no force of it does any work
    limited     |f_i| <= limit_i and any normal: its force that does the least work along v, f_i

So w = -G f of active, still and limited forces lies on the boundary of what is held, v being the motion along
which the object escapes beyond it. With a load w_in that forces inside all cones hold, w + r (w - w_in) is
beyond the edge by r, and w - r (w - w_in) inside it by r, both for sure: the first does r (v . w - v . w_in)
> 0 of work along v, the second is a mean of two that are held.
"""

from dataclasses import dataclass
from math import atan, cos, inf, pi, sin

import numpy as np

Array = np.ndarray
KINDS = ("sliding", "tipping", "both", "limited", "box tips", "box turns")


@dataclass(frozen=True)
class Boundary:
    """Contacts (n, d) at the edge: loads (3,) or (6,) on it and inside; limits (n,), infinite for none."""

    kind: str
    positions: Array
    normals: Array
    frictions: Array
    limits: Array
    edge: Array
    inside: Array

    def load(self, beyond: float) -> Array:
        """The load beyond the edge by that fraction; inside it if negative."""
        result: Array = self.edge + beyond * (self.edge - self.inside)
        return result


def boundary(rng: np.random.Generator, dimension: int, kind: str) -> Boundary:
    """A random grasp of a kind, of size and forces 1."""
    return _box(rng, dimension, kind) if kind.startswith("box") else _grasp(rng, dimension, kind)


def wrench(positions: Array, forces: Array) -> Array:
    """G f."""
    if positions.shape[1] == 2:
        torque = [float((positions[:, 0] * forces[:, 1] - positions[:, 1] * forces[:, 0]).sum())]
    else:
        torque = np.cross(positions, forces).sum(axis=0)
    return np.concatenate([forces.sum(axis=0), torque])


def _grasp(rng: np.random.Generator, d: int, kind: str) -> Boundary:
    while True:
        n = int(rng.integers(2, 5) if d == 2 else rng.integers(3, 6))
        r, mu = (
            rng.normal(size=(n, d)),
            rng.choice([0.0, 0.1, 0.3, 0.5, 0.8, 1.5], n, p=[0.05, 0.1, 0.2, 0.35, 0.2, 0.1]),
        )
        v, omega = rng.normal(size=d), rng.normal(size=1 if d == 2 else 3)
        still = 0 if kind in ("sliding", "limited") else int(rng.integers(1, d))
        if still:  # the motion turns about the first one or, in space, two contacts
            r[:still] = np.round(r[:still] * 64) / 64
            if still == 2:
                omega = np.round((r[1] - r[0]) * 16) / 16
                r[1] = r[0] + omega
            v = -_spin(omega, r[:1])[0]
        u = v + _spin(omega, r)
        if not (np.linalg.norm(u[still:], axis=1) > 0.1).all():
            continue
        active = (
            still + (0 if kind == "tipping" else int(rng.integers(1, min(d + 1, n - still + 1))))
            if n > still
            else still
        )
        normals, forces, limits = np.zeros((n, d)), np.zeros((n, d)), np.full(n, inf)
        for i in range(n):
            if kind == "limited" and rng.random() < 0.7:
                limits[i] = rng.uniform(0.5, 2)
                normals[i] = _unit(rng.normal(size=d))
                forces[i] = limits[i] * _least_work(u[i], normals[i], mu[i])
            elif i < still:
                normals[i] = _unit(rng.normal(size=d))
                forces[i] = _inside(rng, normals[i], mu[i])
            else:
                along = _unit(u[i])
                least = pi / 2 - atan(mu[i])  # the angle from u to n where the edge does no work
                lean = least if i < active else least * rng.uniform(0, 0.9)
                across = _across(rng, along)
                normals[i] = cos(lean) * along + sin(lean) * across
                if i < active:
                    forces[i] = rng.uniform(0.2, 1) * _edge(u[i], normals[i], mu[i])
        if not forces.any():
            continue
        within = np.array([min(limits[i], 1.0) * 0.5 * _inside(rng, normals[i], mu[i]) for i in range(n)])
        works = float((u * within).sum()) - float((u * forces).sum())
        if works > 0.05:  # otherwise the load inside is at the edge, too
            return Boundary(kind, r, normals, mu, limits, -wrench(r, forces), -wrench(r, within))


def _box(rng: np.random.Generator, d: int, kind: str) -> Boundary:
    """A block on its corners, its weight over an edge of its base, or in space turned about the vertical."""
    mu = rng.uniform(0.1, 1)
    half, high = rng.uniform(0.3, 2, d - 1), rng.uniform(0.2, 2)
    corners = [[s] for s in (-1.0, 1.0)] if d == 2 else [[s, t] for s in (-1.0, 1.0) for t in (-1.0, 1.0)]
    r = np.array([[*(half * corner), -high] for corner in np.array(corners)])
    n = np.zeros_like(r)
    n[:, -1] = 1
    f = n / len(r)
    if kind == "box turns" and d == 3:  # every corner slides about the vertical through the middle
        u = np.cross([0, 0, 1.0], r)
        forces = np.array([_edge(a, b, mu) / len(r) for a, b in zip(u, n, strict=True)])
    else:
        on = r[:, 0] > 0
        forces = np.where(on[:, None], n * 2 / len(r), 0.0)
        forces[:, 0] += np.where(on, rng.uniform(-0.5, 0.5) * mu * 2 / len(r), 0.0)
    turn = _rotation(rng, d)
    return Boundary(kind, r @ turn.T, n @ turn.T, np.full(len(r), mu), np.full(len(r), inf),
                    -wrench(r @ turn.T, forces @ turn.T), -wrench(r @ turn.T, f @ turn.T))  # fmt: skip


def _spin(omega: Array, r: Array) -> Array:
    if r.shape[1] == 2:
        return omega[0] * np.column_stack([-r[:, 1], r[:, 0]])
    return np.cross(omega, r)


def _unit(v: Array) -> Array:
    result: Array = v / np.linalg.norm(v)
    return result


def _across(rng: np.random.Generator, along: Array) -> Array:
    if along.size == 2:
        return rng.choice([-1.0, 1.0]) * np.array([-along[1], along[0]])
    v = rng.normal(size=3)
    return _unit(v - (v @ along) * along)


def _inside(rng: np.random.Generator, normal: Array, mu: float) -> Array:
    return normal + rng.uniform(0, 0.8) * mu * _across(rng, normal)


def _edge(u: Array, normal: Array, mu: float) -> Array:
    """The force on the edge of the cone that does the least work along u, its normal part 1."""
    tangent = u - (u @ normal) * normal
    size = np.linalg.norm(tangent)
    return normal - (mu / size * tangent if size > 0 else 0.0)


def _least_work(u: Array, normal: Array, mu: float) -> Array:
    """Of the forces of length 1 or less in the cone, the one that does the least work along u."""
    normal_speed = float(u @ normal)
    sideways = float(np.linalg.norm(u - normal_speed * normal))
    if normal_speed <= 0 and sideways <= -mu * normal_speed:
        return -_unit(u)
    edge = _edge(u, normal, mu)
    return _unit(edge) if edge @ u < 0 else np.zeros(u.size)


def _rotation(rng: np.random.Generator, d: int) -> Array:
    q, upper = np.linalg.qr(rng.normal(size=(d, d)))
    q = q * np.sign(np.diag(upper))
    q[:, 0] *= np.sign(np.linalg.det(q))
    result: Array = q
    return result

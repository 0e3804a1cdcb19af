"""Pairs of contacts of which one finger alone would carry the load.

Where the load's line passes through a contact, its finger can hold the object by itself, and the widest angle
margin is often the one of which the other finger has no part: a finger without force has no angle. Such a
state is no hold of two fingers. In its place stands the state of the widest force margin, in which both push;
where even that leaves one of them without force there is no hold.
"""

from math import inf

import numpy as np
from numpy.typing import NDArray

from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.planning.states.batch import best_squeezes

# A load that passes a contact nearer than this fraction of its distance from the centre passes through it;
# a force below this fraction of the other one is none.
_THROUGH, _IDLE = 1e-11, 2.0**-39


def held_alone(points: Array, load: Array) -> NDArray[np.int64]:
    """Contacts at (V, 2) points through which a (2,) force through the origin passes."""
    across = abs(points[:, 0] * load[1] - points[:, 1] * load[0])
    return np.flatnonzero(across <= _THROUGH * np.hypot(*points.T) * np.hypot(*load))


def shared_margins(
    contacts: tuple[Contact, ...],
    first: NDArray[np.int32],
    second: NDArray[np.int32],
    load: Array,
    peak_ratio: float,
) -> Array:
    """(m,) margins [rad] of pairs as holds in which both fingers push; -1 where there is none."""
    one, two = (_described(contacts, ends) for ends in (first, second))
    result = np.full(first.shape, -1.0)
    for objective in ("force", "angle"):  # the angle where it leaves no finger idle
        x = best_squeezes(
            *one[:3], *two[:3], load, objective=objective, max_force=(one[3], two[3]), peak_ratio=peak_ratio
        )
        forces = _forces(one[0], two[0], load, x)
        sizes = np.hypot(forces[..., 0], forces[..., 1])  # (2, m); not a number where no state exists
        work = sizes.min(axis=0) > _IDLE * sizes.max(axis=0)
        angles = (_angles(n, mu, f) for (_, n, mu, _), f in zip((one, two), forces, strict=True))
        result[work] = np.maximum(np.minimum(*angles), 0.0)[work]
    return result


def _described(contacts: tuple[Contact, ...], ends: NDArray[np.int32]) -> tuple[Array, Array, Array, Array]:
    """Positions (m, 2), normals (m, 2), frictions (m,) and force limits (m,)."""
    each = [contacts[i] for i in ends.tolist()]
    limits = [inf if c.max_force is None else c.max_force for c in each]
    return (
        np.array([c.position for c in each]),
        np.array([c.normal for c in each]),
        np.array([c.friction for c in each]),
        np.array(limits),
    )


def _forces(r1: Array, r2: Array, load: Array, x: Array) -> Array:
    """(2, m, 2) forces with squeeze x: along the line of both contacts x and -x - w u."""
    line = r2 - r1
    length = np.hypot(*line.T)
    u = line / length[:, None]
    v = np.stack([-u[:, 1], u[:, 0]], axis=1)
    b = (r1[:, 0] * load[1] - r1[:, 1] * load[0]) / length
    a = -(v @ load) - b
    y = -x - u @ load
    return np.stack([x[:, None] * u + a[:, None] * v, y[:, None] * u + b[:, None] * v])


def _angles(normals: Array, mu: Array, forces: Array) -> Array:
    """(m,) angle margins [rad]."""
    normal = (normals * forces).sum(axis=1)
    across = abs(normals[:, 0] * forces[:, 1] - normals[:, 1] * forces[:, 0])
    return np.asarray(np.arctan(mu) - np.arctan2(across, normal))

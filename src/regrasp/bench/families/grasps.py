"""Random grasps that hold their loads by construction, the same for the same seed."""

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.orientation.spiral import even_directions
from regrasp.mechanics.wrench import Wrench, torque

# Forces stay inside their cones by this share of the friction, so that a held load is held with room.
_INSIDE = 0.8


def planar(rng: np.random.Generator, count: int) -> tuple[Grasp, Wrench]:
    """Fingers round a dented disc, and a load that inner forces balance."""
    angles = 2 * np.pi * (np.arange(count) + rng.uniform(-0.3, 0.3, count)) / count
    towards = np.column_stack([np.cos(angles), np.sin(angles)])
    tilt = rng.uniform(-0.3, 0.3, count)
    normals = -np.column_stack([np.cos(angles + tilt), np.sin(angles + tilt)])
    return _held(rng, rng.uniform(0.7, 1.3, count)[:, None] * towards, normals)


def in_space(rng: np.random.Generator, count: int) -> tuple[Grasp, Wrench]:
    """Fingers over a dented ball, spread by the golden angle, and a load that inner forces balance."""
    towards = even_directions(count)
    normals = -towards + 0.2 * rng.normal(size=(count, 3))
    return _held(rng, rng.uniform(0.7, 1.3, count)[:, None] * towards, normals)


def _held(rng: np.random.Generator, points: Array, normals: Array) -> tuple[Grasp, Wrench]:
    grasp = Grasp(
        Contact(p, n, mu)
        for p, n, mu in zip(points, normals, rng.uniform(0.3, 0.8, len(points)), strict=True)
    )
    across = rng.normal(size=points.shape)
    across -= (across * grasp.normals).sum(axis=1)[:, None] * grasp.normals
    across /= np.linalg.norm(across, axis=1)[:, None]
    share = _INSIDE * rng.uniform(0, 1, len(points)) * grasp.frictions
    forces = rng.uniform(0.5, 2, len(points))[:, None] * (grasp.normals + share[:, None] * across)
    total = np.concatenate([forces.sum(axis=0), torque(grasp.positions, forces).sum(axis=0)])
    return grasp, Wrench.from_vector(-total)

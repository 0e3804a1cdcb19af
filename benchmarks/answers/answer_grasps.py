"""Random grasps and loads for ``same_answers.py``: each from a seed of its own, in any units."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

import regrasp as rg

OBJECTIVES = ("angle", "force", "effort", "peak", "peak_normal", "friction_use")


class Draw:
    """A grasp of ``count`` fingers around a dented disc or ball, pushing roughly inwards, and a load.

    The fingers but for the last ``spare`` ones stand evenly around a circle, the others anywhere. soft:
    whether fingers of a solid twist, too. length, force: units, of the points' distances and of the load.
    """

    def __init__(
        self, *seed: int, count: int = 3, dimension: int = 2, spare: int = 0, soft: bool = False
    ) -> None:
        rng = np.random.default_rng(seed)
        self.length, self.force = 10 ** rng.uniform(-2, 1), 10 ** rng.uniform(-1, 2)
        turn = 2 * np.pi * (np.arange(count) + rng.uniform(-0.15, 0.15, count)) / (count - spare)
        out = np.stack([np.cos(turn), np.sin(turn), 0.2 * rng.normal(size=count)], axis=1)[:, :dimension]
        out[count - spare :] = rng.normal(size=(spare, dimension))
        out = out @ np.linalg.qr(rng.normal(size=(dimension, dimension)))[0]
        out /= np.linalg.norm(out, axis=1)[:, None]
        points = self.length * out * rng.uniform(0.6, 1.4, (count, 1))
        normals = -out + 0.2 * rng.normal(size=out.shape)
        torsions = self.length * rng.uniform(0.05, 0.3, count) if soft else [None] * count
        self.rng = rng
        self.grasp = rg.Grasp(
            rg.Contact(r, n, mu, torsion=e)
            for r, n, mu, e in zip(points, normals, rng.uniform(0.3, 1.0, count), torsions, strict=True)
        )
        self.load = self.another_load()

    def another_load(self, torque: float = 0.1) -> rg.Wrench:
        """A load; ``torque`` about the centre of mass beside it, as a fraction of force times length."""
        d = self.grasp.dimension
        moment = torque * self.force * self.length * self.rng.normal(size=2 * d - 3)
        force = self.force * self.rng.normal(size=d)
        return rg.Wrench(force, moment if d == 3 else float(moment[0]))

    def limited(self, ratio: float) -> rg.Grasp:
        """The grasp with force limits of its own on every other finger."""
        limit = ratio * self.force
        return rg.Grasp(c if i % 2 else replace(c, max_force=limit) for i, c in enumerate(self.grasp))


def options_of(k: int, force: float) -> dict[str, float]:
    """Limits of a choice, in turn: none, a force limit, another peak ratio, a reserve of friction."""
    return ({}, {"max_force": 6 * force}, {"peak_ratio": 1.5}, {"reserve": 0.1})[k % 4]


def draws(seed: int, number: int, **what: int | bool) -> Iterator[tuple[int, Draw]]:
    """Numbered draws."""
    return ((k, Draw(seed, k, **what)) for k in range(number))

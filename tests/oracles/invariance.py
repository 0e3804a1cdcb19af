"""Other units, frames and orders of contacts."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, sin

import numpy as np
from hypothesis import strategies as st

import regrasp as rg
from strategies import POWERS, angles


@dataclass(frozen=True)
class Frame:
    """Other units, a turned frame and another order of the contacts."""

    length: float
    force: float
    angle: float

    @property
    def rotation(self) -> np.ndarray:
        c, s = cos(self.angle), sin(self.angle)
        return np.array([[c, -s], [s, c]])

    def grasp(self, grasp: rg.Grasp, order: Sequence[int] | None = None) -> rg.Grasp:
        contacts = [grasp[i] for i in (range(len(grasp)) if order is None else order)]
        return rg.Grasp(
            rg.Contact(
                self.length * self.rotation @ c.position,
                self.rotation @ c.normal,
                c.friction,
                max_force=None if c.max_force is None else c.max_force * self.force,
                name=c.name,
            )
            for c in contacts
        )

    def load(self, load: rg.Wrench) -> rg.Wrench:
        return rg.Wrench(
            self.force * self.rotation @ load.force, float(load.torque[0]) * self.length * self.force
        )

    def value(self, value: float, objective: str) -> float:
        return value * {"angle": 1.0, "friction_use": 1.0, "effort": self.force**2}.get(objective, self.force)


frames = st.builds(Frame, POWERS, POWERS, angles)


def numbered(rng: np.random.Generator) -> Frame:
    length, force = 10.0 ** rng.integers(-6, 7, 2)
    return Frame(float(length), float(force), float(rng.uniform(-3, 3)))

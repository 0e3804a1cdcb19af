"""What free fingers find around an object, and their motions of one pause."""

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from regrasp.errors import Infeasible
from regrasp.mechanics.checks import Array
from regrasp.mesh.mesh import Mesh
from regrasp.motions.apart import apart
from regrasp.motions.planar_space import PlanarSpace
from regrasp.motions.solid_space import SolidSpace
from regrasp.motions.stands import Place, Space, Stand
from regrasp.motions.value import Motion
from regrasp.motions.ways import way_between
from regrasp.outline.outline import Outline
from regrasp.plans.transition import Transition


class Air:
    """Where each finger may be around an object, and where it stands at contacts and off them.

    capsules: (k, d) from each tip's centre to its finger's other end [m].
    """

    def __init__(
        self,
        steps: tuple[Transition, ...],
        shape: Outline | Mesh,
        tip_radius: float,
        clearance: float,
        capsules: Array,
    ) -> None:
        self.capsules = capsules
        self._contacts = {str(c.name): c for step in steps for c in step.grasp}
        spaces: dict[tuple[float, ...], Space] = {}
        for v in capsules:
            if tuple(v) not in spaces:
                spaces[tuple(v)] = (
                    PlanarSpace.around(shape, tip_radius, clearance, v)
                    if isinstance(shape, Outline)
                    else SolidSpace.around(shape, tip_radius, clearance, v)
                )
        self._spaces = [spaces[tuple(v)] for v in capsules]
        self._stands: dict[tuple[tuple[float, ...], str], Stand] = {}

    def stand(self, finger: int, name: str) -> Stand:
        """That of a finger at a contact."""
        key = tuple(self.capsules[finger]), name
        if key not in self._stands:
            self._stands[key] = Stand(name, self._contacts[name], self._spaces[finger])
        return self._stands[key]

    def others(self, finger: int, now: list[Place]) -> Array:
        """(j, 2, d) where all other fingers are, and their capsules."""
        found = [(self.stand(j, n).tip(on), self.capsules[j]) for j, (n, on) in enumerate(now) if j != finger]
        return np.array(found).reshape(-1, 2, self.capsules.shape[1])

    def check_held(self, k: int, stop: tuple[Place, ...]) -> None:
        """Raise ``Infeasible`` where two fingers are in one another during a step."""
        radius = self._spaces[0].tip_radius
        for (i, (a, _)), (j, (b, _)) in combinations([p for p in enumerate(stop) if p[1][1]], 2):
            p, q = self.stand(i, a).tip(True), self.stand(j, b).tip(True)
            away = float(apart(p, self.capsules[i], q, self.capsules[j]))
            if away < 2 * radius * (1 - 1e-9):
                raise Infeasible(
                    f"during step {k + 1} fingers {i + 1} and {j + 1} of radius {radius:g} are in one "
                    f"another, {away:.3g} apart at {a} and {b}"
                )

    def moved(
        self,
        k: int,
        before: tuple[Place, ...],
        after: tuple[Place, ...],
        limits: tuple[float, float],
        clock: float,
    ) -> Iterator[Motion]:
        """The motions of one pause, each finger when its way is free."""
        now = list(before)
        waiting = [i for i, (a, b) in enumerate(zip(before, after, strict=True)) if a != b]
        while waiting:
            for i in waiting:
                a, b = self.stand(i, now[i][0]), self.stand(i, after[i][0])
                found = way_between(a, now[i][1], b, after[i][1], self.others(i, now), self._spaces[i])
                if found is not None:
                    break
            else:
                raise Infeasible(self._shut_in(k, waiting[0], now, after[waiting[0]]))
            way, *gaps = found
            duration = way.shortest_time(*limits)
            yield Motion(k, i, now[i][0], after[i][0], way, duration, clock, *gaps)
            clock += duration
            now[i] = after[i]
            waiting.remove(i)

    def _shut_in(self, k: int, i: int, now: list[Place], target: Place) -> str:
        """Which finger finds no way and where it is shut in."""
        said = f"before step {k + 1} finger {i + 1} finds no way from {now[i][0]} to {target[0]}: "
        for place in (now[i][0], target[0]):
            stand = self.stand(i, place)
            piece = np.array([stand.tip(True), stand.tip(False)])
            for j, other in zip((j for j in range(len(now)) if j != i), self.others(i, now), strict=True):
                if not self._spaces[i].keeps_apart(piece, other[None]):
                    return f"{said}at {place}, {stand.where}, the tip of finger {j + 1} is too near"
        return f"{said}the object and other tips shut {target[0]} in, {stand.where}"

"""What free fingers find around an object, and their motions of one pause."""

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from regrasp.errors import Infeasible
from regrasp.mechanics.checks import Array
from regrasp.mesh.mesh import Mesh
from regrasp.motions.geometry.apart import apart
from regrasp.motions.planar_space import PlanarSpace
from regrasp.motions.shut_in import ShutIn
from regrasp.motions.solid_space import SolidSpace
from regrasp.motions.stands import Place, Space, Stand
from regrasp.motions.traffic import Traffic
from regrasp.motions.value import Motion
from regrasp.motions.ways import Found, Stop, way_between
from regrasp.outline.outline import Outline
from regrasp.plans.transition import Transition

_ASIDE = (1.5, 3.0, 6.0, 12.0)  # heights over contacts where fingers wait, of how far two keep apart


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

    def check_held(self, k: int, stop: tuple[Place, ...]) -> None:
        """Raise ``Infeasible`` where two fingers are in one another during a step."""
        radius = self._spaces[0].tip_radius
        for (i, (a, _)), (j, (b, _)) in combinations([p for p in enumerate(stop) if p[1][1]], 2):
            p, q = self.stand(i, a).tip(True), self.stand(j, b).tip(True)
            away = float(apart(p, self.capsules[i], q, self.capsules[j]))
            if away < 2 * radius * (1 - 1e-9):
                raise Infeasible(
                    f"during step {k + 1} fingers {i + 1} and {j + 1} of radius {radius:g} are in one "
                    f"another, {away:.3g} apart at {a} and {b}",
                    ShutIn(
                        k, i, a, self._contacts[a].position, a, a, (a, b), False, self._contacts[b].position
                    ),
                )

    def moved(
        self,
        k: int,
        before: tuple[Place, ...],
        after: tuple[Place, ...],
        limits: tuple[float, float],
        window: tuple[float, float],
    ) -> list[Motion]:
        """The motions before a step, at once where they keep clear in time, else one after the other.

        limits: speed and acceleration. window: when the step before begins, during which fingers in the air
        may move, and when it ends [s].
        """
        now = [self._stop(i, p) for i, p in enumerate(before)]
        space = self._spaces[0]
        traffic = Traffic([s.point for s in now], self.capsules, space.apart, space.clearance)
        found = []
        for i, target, name, (way, gaps) in self._legs(k, before, after, now):
            lands = target.contact is not None
            duration = way.shortest_time(*limits)
            begun, over = window
            if before[i][1]:
                begun = over  # it holds until the step has ended
            elif lands:
                begun = max(begun, over - duration * way.part_before(way.length - target.landing))
            begun = max([begun, *(leg.end for leg in traffic.lines[i].legs)])
            leg = traffic.add(i, way, duration, begun, max(over, traffic.end))
            found.append((i, name, leg, gaps))
        motions = []
        last = {i: before[i][0] for i in range(len(before))}
        for i, name, leg, (to_object, to_tips) in found:
            near = min(to_tips, traffic.gap(i, leg) - 2 * space.tip_radius)
            motions.append(Motion(k, i, last[i], name, leg.way, leg.duration, leg.start, to_object, near))
            last[i] = name
        return motions

    def _stop(self, finger: int, place: Place) -> Stop:
        name, touches = place
        stand = self.stand(finger, name)
        return Stop(stand.tip(touches), stand if touches else None)

    def _legs(
        self, k: int, before: tuple[Place, ...], after: tuple[Place, ...], now: list[Stop]
    ) -> Iterator[tuple[int, Stop, str, Found]]:
        """The fingers' ways, in an order in which each is clear of where the others are; ``now`` changes.

        Where nobody finds a way, one that is to move waits aside.
        """
        waiting = [i for i, (a, b) in enumerate(zip(before, after, strict=True)) if a != b]
        names = [name for name, _ in before]
        aside: set[int] = set()
        while waiting:
            i, found = self._first(waiting, after, now)
            if found is None:
                i, stop, found = self._aside(waiting, aside, after, now)
                if found is None:
                    raise self._shut_in(k, waiting[0], names[waiting[0]], after[waiting[0]], now)
                aside.add(i)
                now[i] = stop
                yield i, stop, names[i], found
                continue
            now[i] = self._stop(i, after[i])
            names[i] = after[i][0]
            waiting.remove(i)
            yield i, now[i], names[i], found

    def _first(
        self, waiting: list[int], after: tuple[Place, ...], now: list[Stop]
    ) -> tuple[int, Found | None]:
        """The first finger that finds its way."""
        for i in waiting:
            found = way_between(now[i], self._stop(i, after[i]), self._others(i, now), self._spaces[i])
            if found is not None:
                return i, found
        return waiting[0], None

    def _aside(
        self, waiting: list[int], aside: set[int], after: tuple[Place, ...], now: list[Stop]
    ) -> tuple[int, Stop, Found | None]:
        """A finger and where it waits, high over its contact or its next, so that another finds its way."""
        if len(waiting) > 1:
            for i in (i for i in waiting if i not in aside):
                space = self._spaces[i]
                for height in _ASIDE:
                    stand = self.stand(i, after[i][0])
                    for over in (now[i].contact or stand, stand):
                        point = over.tip(False) - height * space.apart * over.contact.normal
                        stop = Stop(point)
                        if (found := way_between(now[i], stop, self._others(i, now), space)) is None:
                            continue
                        then = [*now[:i], stop, *now[i + 1 :]]
                        if self._first([j for j in waiting if j != i], after, then)[1] is not None:
                            return i, stop, found
        return waiting[0], now[waiting[0]], None

    def _others(self, finger: int, now: list[Stop]) -> Array:
        """(j, 2, d) where all other fingers are, and their capsules."""
        found = [(stop.point, v) for stop, v in zip(now, self.capsules, strict=True)]
        return np.array(found[:finger] + found[finger + 1 :]).reshape(-1, 2, self.capsules.shape[1])

    def _shut_in(self, k: int, i: int, origin: str, target: Place, now: list[Stop]) -> Infeasible:
        """Which finger finds no way and where it is shut in."""
        held = tuple(s.contact.name for j, s in enumerate(now) if j != i and s.contact is not None)
        near: str | None = None
        place, why = target[0], "the object and other tips shut {place} in, {where}"
        numbers = [j for j in range(len(now)) if j != i]
        for name in (target[0], origin):
            stand = self.stand(i, name)
            piece = np.array([stand.tip(True), stand.tip(False)])
            for j, other in zip(numbers, self._others(i, now), strict=True):
                if not self._spaces[i].keeps_apart(piece, other[None]):
                    place, why = name, f"at {{place}}, {{where}}, the tip of finger {j + 1} is too near"
                    near = None if (holds := now[j].contact) is None else holds.name
        said = why.format(place=place, where=self.stand(i, place).where)
        return Infeasible(
            f"before step {k + 1} finger {i + 1} finds no way from {origin} to {target[0]}: {said}",
            ShutIn(k, i, place, self._contacts[place].position, origin, target[0], held, False, near=near),
        )

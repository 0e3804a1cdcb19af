"""Whether a plan withstands a set of deviations at every instant.

Forces change by R d, R = -K G' (G K G')^-1 with the stiffnesses K of the fingers that stay: one that leaves
or arrives, or carries none at all, is force-controlled. The forces f with f + R d inside cones and limits for
all d are a convex set, so that both ends prove a straight path, and instants one that is linear between them.
In a turn forces are a f + b g with a, b >= 0 and a + b >= 1: a f + b g + R d = a (f + R d') + b (g + R d')
with d' = d / (a + b), which is a member where zero is one. Limits are kept where f, g and m = (f + g) / (1 +
cos Delta) keep them, in whose triangle the arc lies; or where f and g keep the part cos(Delta / 2) of them,
since 1 / (a + b) is no less. States at which all fingers at work may answer, ends, withstand that, too.

Contacts off by r' - r change the balance by (G' - G) f, and forces by R' of that: linear in f again.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import chain, pairwise
from math import cos

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, finite, number
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.robust.moved import moved
from regrasp.mechanics.robust.stiffness import Stiffness, checked_stiffness, stiffness_matrices
from regrasp.mechanics.value import one_line
from regrasp.mechanics.wrench import Wrench
from regrasp.verification.exact import Vector, dot, exact
from regrasp.verification.protocols import Plan, Withstood
from regrasp.verification.records import deciding_forces
from regrasp.verification.withstood.contacts import Body, Touch
from regrasp.verification.withstood.float_filter import Sized, Sure, doubt, in_doubles, surely_withstood
from regrasp.verification.withstood.matrices import (
    Matrix,
    coarse,
    product,
    rational,
    solved,
    times,
    transposed,
)

_WHOLE = Fraction(1)
_ROUNDING = Fraction(1, 10**12)
"""Of cosines in doubles: more than they are off."""


@dataclass(frozen=True)
class Asked:
    """What a plan must withstand besides its load.

    disturbance: deviations of the load, None for none. friction: the factor on coefficients. positions:
    (m, n, d - 1) contacts off along their tangents [m], each row by itself. surface: (n,) its curvature
    [1/m].
    """

    disturbance: LoadSet | None
    stiffness: Stiffness
    friction: float
    positions: Array | None
    surface: Array | None
    early_loss: bool

    @classmethod
    def of(
        cls,
        grasp: Grasp,
        disturbance: LoadSet | None,
        stiffness: ArrayLike | None,
        friction: float | None,
        position: ArrayLike | None,
        surface: ArrayLike | None,
        early_loss: bool,
    ) -> "Asked | None":
        """What a call asks of the plan of a grasp; None for nothing."""
        if disturbance is not None and (
            not isinstance(disturbance, LoadSet) or disturbance.dimension != grasp.dimension
        ):
            raise InvalidInput(
                f"disturbance must be a LoadSet of dimension {grasp.dimension}, got {shown(disturbance)}"
            )
        if not isinstance(early_loss, bool):
            raise InvalidInput(f"early_loss must be True or False, got {shown(early_loss)}")
        factor = 1.0 if friction is None else number(friction, "friction", least=0)
        n, across = len(grasp), grasp.dimension - 1
        offsets = None
        if position is not None:
            given = finite(position, "position")
            if given.size == 0 or given.size % (n * across) or given.shape[-across:] != (n, across)[:across]:
                wanted = "(n,) or (m, n)" if across == 1 else "(n, 2) or (m, n, 2)"
                raise InvalidInput(f"position must have shape {wanted} with n = {n}, got {given.shape}")
            offsets = given.reshape(-1, n, across)
        curved = finite(np.zeros(n) if surface is None else surface, "surface")
        if curved.shape not in ((), (n,)):
            raise InvalidInput(f"surface must be one curvature or {n}, got shape {curved.shape}")
        springs = checked_stiffness(stiffness)
        if disturbance is None and friction is None and position is None and not early_loss:
            if stiffness is not None or surface is not None:
                raise InvalidInput(
                    "stiffness and surface say how a grasp answers to what is asked of it: give disturbance, "
                    "position, friction or early_loss, too"
                )
            return None
        return cls(disturbance, springs, factor, offsets, np.broadcast_to(curved, n), early_loss)

    @property
    def words(self) -> str:
        """What must be withstood."""
        said = [] if self.disturbance is None else [f"every deviation of the {self.disturbance}"]
        said += [f"{self.friction:.6g} times the friction"] if self.friction != 1 else []
        if self.positions is not None:
            ways = f", in {len(self.positions)} ways" if len(self.positions) > 1 else ""
            said.append(f"contacts off along their tangents{ways}")
        said += ["the early loss of a finger that leaves or arrives"] if self.early_loss else []
        return ", with ".join(said)

    def covers(self, other: "Asked") -> bool:
        """Whether what another asks of a plan's own contacts is asked here, too."""
        return (
            (self.disturbance, self.stiffness) == (other.disturbance, other.stiffness)
            and self.positions is None
            and self.friction <= other.friction
            and self.early_loss >= other.early_loss
        )


def check_promised(plan: Plan, asked: Asked | None) -> tuple[list[str], str]:
    """What a plan does not withstand of what its record says, unless ``asked`` covers that; and in words."""
    said: Withstood | None = getattr(plan.record, "withstands", None)
    if said is None:
        return [], ""
    try:
        promised = Asked.of(
            plan.start.grasp, said.disturbance, said.stiffness, 1.0, None, None, said.early_loss
        )
        assert promised is not None
        if asked is not None and asked.covers(promised):
            return [], ""
        return [f"record: {violation}" for violation in check_withstood(plan, promised)], promised.words
    except InvalidInput as error:
        return [f"record: {error}"], ""


def check_withstood(plan: Plan, asked: Asked) -> list[str]:
    """Which fingers do not withstand what is asked, when and for which member."""
    grasp = plan.start.grasp
    zero = Wrench.from_vector(np.zeros(len(grasp.matrix)))
    loads = LoadSet.hull([zero]) if asked.disturbance is None else asked.disturbance
    if plan.turn is not None and not loads.contains(zero):
        raise InvalidInput("a disturbance of a turn must hold the deviation zero, besides others")
    body, broken = Body(loads), []
    offsets = [None] if asked.positions is None else list(asked.positions)
    for k, offset in enumerate(offsets):
        where = "" if offset is None or len(offsets) == 1 else f", contacts off as in row {k}"
        off = grasp if offset is None else moved(grasp, offset, np.asarray(asked.surface))
        broken += [f"{violation}{where}" for violation in _Judge(plan, asked, body, off).violations()]
    return broken


class _Judge:
    """Judges a plan on the contacts of a grasp that may be a little off the plan's."""

    def __init__(self, plan: Plan, asked: Asked, body: Body, grasp: Grasp) -> None:
        self.plan, self.asked, self.body, self.grasp = plan, asked, body, grasp
        self.matrix = rational(grasp.matrix.tolist())
        planned = plan.start.grasp
        self.off = None if grasp is planned else [
            [a - b for a, b in zip(*rows, strict=True)]
            for rows in zip(self.matrix, rational(planned.matrix.tolist()), strict=True)
        ]  # fmt: skip
        factor = Fraction(asked.friction)
        self.touches = [Touch(c, factor, planned.width) for c in grasp.contacts]
        self.answers: dict[tuple[int, ...], Matrix] = {}

    def violations(self) -> Iterator[str]:
        """One for each contact, state and case that breaks."""
        plan, names = self.plan, self.grasp.names
        leaving, arriving = (
            [names.index(x) for x in some if x in names] for some in (plan.leaving, plan.arriving)
        )
        deciding = deciding_forces(plan)
        idle = [i for i in range(len(names)) if not deciding[:, i].any()]
        moving = tuple(sorted({*leaving, *arriving, *idle}))
        states = [(label, _stacked(forces)) for label, forces in self._states()]
        yield from chain(*self._found(states, moving))
        yield from self._arcs(moving)
        if moving:
            for label, state, away in (("start", plan.start, arriving), ("end", plan.end, leaving)):
                own = tuple(sorted({*away, *idle}))
                if own != moving:
                    said = f"{label}, all fingers at work answering"
                    yield from chain(*self._found([(said, _stacked(state.forces))], own))

    def _states(self) -> Iterator[tuple[str, Array]]:
        """Labels and forces of all states that decide."""
        plan = self.plan
        if plan.turn is not None:
            angles = plan.turn.angles.tolist()
            for angle, forces in zip(angles, plan.turn.forces, strict=True):
                yield f"angle {angle:.6g} rad", forces
            for k, forces in enumerate(() if plan.turn.middles is None else plan.turn.middles):
                yield f"between {angles[k]:.6g} and {angles[k + 1]:.6g} rad", forces
        elif plan.course is not None:
            for k, forces in enumerate(plan.course.forces):
                yield f"instant {k}", forces
        else:
            yield "start", plan.start.forces
            yield "end", plan.end.forces

    def _arcs(self, controlled: tuple[int, ...]) -> Iterator[str]:
        """Limits between the angles of a turn: by where tangents meet, or by a part of them at both."""
        turn = self.plan.turn
        if turn is None or turn.middles is not None:
            return
        states = [_stacked(forces) for forces in turn.forces]
        arcs, met = list(pairwise(zip(turn.angles.tolist(), states, strict=True))), []
        for (a, f), (b, g) in arcs:
            length = max(1 + Fraction(cos(b - a)) - _ROUNDING, _ROUNDING)
            forces = [(x + y) / length for x, y in zip(f, g, strict=True)]
            met.append((f"between {a:.6g} and {b:.6g} rad", forces))
        for ((a, f), (b, g)), found in zip(arcs, self._found(met, controlled), strict=True):
            part = max(Fraction(cos((b - a) / 2)) - _ROUNDING, Fraction(0))
            if found and any(self._found([("", f), ("", g)], controlled, part)):
                yield from found

    def _found(
        self, states: list[tuple[str, Vector]], controlled: tuple[int, ...], share: Fraction = _WHOLE
    ) -> list[list[str]]:
        """What breaks in each state; share: the part of limits that may be used."""
        answer, w = self._answer(controlled), self.grasp.width
        cases: list[tuple[int, ...]] = [()]
        if self.asked.early_loss and controlled:
            cases += [(i,) for i in controlled]
            cases += [controlled] if len(controlled) > 1 else []
        sure, found = self._surely([f for _, f in states], answer, cases, share), []
        for k, (label, stacked) in enumerate(states):
            broken: list[str] = []
            found.append(broken)
            if all(settled[k].all() for settled in sure):
                continue
            if self.off is not None:
                stacked = _added(stacked, answer, times(self.off, stacked))
            for gone, settled in zip(cases, sure, strict=True):
                said, lost = label, stacked
                if gone:
                    who = ", ".join(one_line(self.grasp.names[i]) for i in gone)
                    said = f"{label}, {who} lost"
                    away = [w * i + j for i in gone for j in range(w)]
                    wrench = [-dot([row[j] for j in away], [stacked[j] for j in away]) for row in self.matrix]
                    lost = _added(stacked, answer, wrench)
                broken += self._contacts(said, lost, answer, settled[k], share)
        return found

    @np.errstate(all="ignore")
    def _surely(
        self, states: list[Vector], answer: Matrix, cases: list[tuple[int, ...]], share: Fraction
    ) -> list[Sure]:
        """(states, n) for the fingers gone in each case: which contacts surely withstand all, or are gone."""
        w, n = self.grasp.width, len(self.grasp)
        off = doubt(n * w + len(self.matrix))
        given, response, matrix = in_doubles(states), in_doubles(answer), in_doubles(self.matrix)
        forces, found = Sized(given, abs(given)), []
        if self.off is not None:
            forces = forces.changed(response, in_doubles(self.off))
        for gone in cases:
            columns = np.isin(np.arange(n * w) // w, gone)
            after = forces.changed(response, np.where(columns, -matrix, 0.0)) if gone else forces
            settled = np.ones((len(states), n), dtype=bool)
            for i, touch in enumerate(self.touches):
                rows = slice(w * i, w * i + w)
                if i in gone:
                    continue
                settled[:, i] = surely_withstood(
                    touch, after.part(rows), response[rows], self.body, float(share), off
                )
                if not touch.rows and not any(any(row) for row in answer[rows]):
                    settled[:, i] |= [not any(stacked[rows]) for stacked in states]  # the apex
            found.append(settled)
        return found

    def _contacts(
        self, label: str, forces: Vector, answer: Matrix, settled: Sure, share: Fraction
    ) -> Iterator[str]:
        w = self.grasp.width
        for i, touch in enumerate(self.touches):
            if settled[i]:
                continue
            rows = slice(w * i, w * i + w)
            found = touch.broken(forces[rows], answer[rows], self.body, share)
            if found is None:
                continue
            name = one_line(self.grasp.names[i])
            if found.member is None:
                yield f"{label}: it is not proven that {name} withstands all, nor found what it does not"
            else:
                yield f"{label}: force of {name} {found.how} under the deviation {found.member!r}"

    def _answer(self, controlled: tuple[int, ...]) -> Matrix:
        """R (n w, q), with the stiffness of all fingers but the controlled ones."""
        if controlled in self.answers:
            return self.answers[controlled]
        asked, w, n = self.asked, self.grasp.width, len(self.grasp)
        q = len(self.matrix)
        if asked.disturbance is None and self.off is None and not asked.early_loss:
            answer = [[Fraction(0)] * q for _ in range(n * w)]
        else:
            stiffness = stiffness_matrices(self.grasp, asked.stiffness, controlled)
            pushed: Matrix = []
            for i in range(n):
                block = [row[w * i : w * i + w] for row in self.matrix]
                pushed += product(rational(stiffness[i].tolist()), transposed(block))
            held = solved(
                product(self.matrix, pushed), [[Fraction(-int(a == b)) for b in range(q)] for a in range(q)]
            )
            if held is None:
                raise InvalidInput(
                    "the stiffness of the fingers that stay does not resist every motion of the object, so "
                    "forces under a disturbance are not determined"
                )
            answer = coarse(product(pushed, held))
        self.answers[controlled] = answer
        return answer


def _stacked(forces: Array) -> Vector:
    return exact(forces.ravel().tolist())


def _added(forces: Vector, answer: Matrix, wrench: Vector) -> Vector:
    return [f + x for f, x in zip(forces, times(answer, wrench), strict=True)]

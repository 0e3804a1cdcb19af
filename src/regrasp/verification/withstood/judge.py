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
from fractions import Fraction
from itertools import chain, pairwise
from math import cos

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.robust.stiffness import Stiffness, stiffness_matrices
from regrasp.mechanics.value import one_line
from regrasp.verification.exact import Vector, dot, exact
from regrasp.verification.protocols import Plan
from regrasp.verification.records import deciding_forces
from regrasp.verification.withstood.contacts import Body, Touch
from regrasp.verification.withstood.float_filter import Sized, Sure, doubt, surely_withstood
from regrasp.verification.withstood.matrices import (
    Matrix,
    coarse,
    in_doubles,
    product,
    rational,
    solved,
    times,
    transposed,
)

_ROUNDING = Fraction(1, 10**12)
"""Of cosines in doubles: more than they are off."""


class Judge:
    """Judges a plan on the contacts of a grasp that may be a little off the plan's.

    friction: the factor on coefficients. stiffness: of the fingers, None where nothing asks for their answer.
    """

    def __init__(
        self,
        plan: Plan,
        grasp: Grasp,
        body: Body,
        friction: float,
        stiffness: Stiffness | None,
        early_loss: bool,
    ) -> None:
        self.plan, self.grasp, self.body = plan, grasp, body
        self.stiffness, self.early_loss = stiffness, early_loss
        self.matrix = rational(grasp.matrix.tolist())
        planned = plan.start.grasp
        self.off = None if grasp is planned else [
            [a - b for a, b in zip(*rows, strict=True)]
            for rows in zip(self.matrix, rational(planned.matrix.tolist()), strict=True)
        ]  # fmt: skip
        self.touches = [Touch(c, Fraction(friction), planned.width) for c in grasp.contacts]
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
            length = 1 + Fraction(cos(b - a)) - _ROUNDING
            forces = [(x + y) / length for x, y in zip(f, g, strict=True)]
            met.append((f"between {a:.6g} and {b:.6g} rad", forces))
        for ((a, f), (b, g)), found in zip(arcs, self._found(met, controlled), strict=True):
            part = max(Fraction(cos((b - a) / 2)) - _ROUNDING, Fraction(0))
            if found and any(self._found([("", f), ("", g)], controlled, part)):
                yield from found

    def _found(
        self, states: list[tuple[str, Vector]], controlled: tuple[int, ...], share: Fraction = Fraction(1)
    ) -> list[list[str]]:
        """What breaks in each state; share: the part of limits that may be used."""
        answer, w = self._answer(controlled), self.grasp.width
        losses = [*[(i,) for i in controlled], controlled] if self.early_loss else []
        cases = list(dict.fromkeys([(), *losses]))
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
            after = forces.changed(response, np.where(columns, -matrix, 0.0))
            settled = np.ones((len(states), n), dtype=bool)
            for i, touch in enumerate(self.touches):
                rows = slice(w * i, w * i + w)
                if i in gone:
                    continue
                settled[:, i] = surely_withstood(
                    touch, after.part(rows), response[rows], self.body, float(share), off
                )
                if not any(any(row) for row in answer[rows]):
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
        w, n, q = self.grasp.width, len(self.grasp), len(self.matrix)
        if self.stiffness is None:
            answer = [[Fraction(0)] * q for _ in range(n * w)]
        else:
            stiffness = stiffness_matrices(self.grasp, self.stiffness, controlled)
            pushed: Matrix = []
            for i in range(n):
                block = [row[w * i : w * i + w] for row in self.matrix]
                pushed += product(rational(stiffness[i].tolist()), transposed(block))
            held = solved(product(self.matrix, pushed), rational((-np.eye(q)).tolist()))
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

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
from itertools import pairwise
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
from regrasp.verification.exact import Vector, exact
from regrasp.verification.protocols import Plan, Withstood
from regrasp.verification.records import deciding_forces
from regrasp.verification.withstood.contacts import Body, Touch
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
        for label, forces in self._states():
            yield from self._state(label, _stacked(forces), moving)
        yield from self._arcs(moving)
        if moving:
            for label, state, away in (("start", plan.start, arriving), ("end", plan.end, leaving)):
                own = tuple(sorted({*away, *idle}))
                if own != moving:
                    yield from self._state(
                        f"{label}, all fingers at work answering", _stacked(state.forces), own
                    )

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
        for (a, f), (b, g) in pairwise(zip(turn.angles.tolist(), states, strict=True)):
            length = max(1 + Fraction(cos(b - a)) - _ROUNDING, _ROUNDING)
            met = [(x + y) / length for x, y in zip(f, g, strict=True)]
            found = list(self._state(f"between {a:.6g} and {b:.6g} rad", met, controlled))
            part = max(Fraction(cos((b - a) / 2)) - _ROUNDING, Fraction(0))
            if found and any(any(self._state("", forces, controlled, part)) for forces in (f, g)):
                yield from found

    def _state(
        self, label: str, stacked: Vector, controlled: tuple[int, ...], share: Fraction = _WHOLE
    ) -> Iterator[str]:
        """share: the part of limits that may be used."""
        answer = self._answer(controlled)
        if self.off is not None:
            stacked = _added(stacked, answer, times(self.off, stacked))
        yield from self._contacts(label, stacked, answer, (), share)
        if self.asked.early_loss and controlled:
            some = [(i,) for i in controlled]
            for gone in some if len(some) == 1 else [*some, controlled]:
                who = ", ".join(one_line(self.grasp.names[i]) for i in gone)
                w = self.grasp.width
                lost = list(stacked)
                wrench = [
                    -sum(
                        (row[w * i + k] * stacked[w * i + k] for i in gone for k in range(w)),
                        start=Fraction(0),
                    )
                    for row in self.matrix
                ]
                lost = _added(lost, answer, wrench)
                yield from self._contacts(f"{label}, {who} lost", lost, answer, gone, share)

    def _contacts(
        self, label: str, forces: Vector, answer: Matrix, gone: tuple[int, ...], share: Fraction
    ) -> Iterator[str]:
        w = self.grasp.width
        for i, touch in enumerate(self.touches):
            if i in gone:
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

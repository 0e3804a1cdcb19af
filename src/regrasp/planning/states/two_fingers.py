"""The equilibrium locus of two planar contacts as an object to ask."""

from dataclasses import dataclass
from functools import cached_property
from math import inf, isfinite, isnan
from typing import NamedTuple, Unpack, cast

import numpy as np

from regrasp.closed_form.choice import best_squeeze
from regrasp.closed_form.locus import pair_frame, squeeze_interval
from regrasp.display import table
from regrasp.errors import Infeasible, InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, array, finite, instance, number
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.limits.limit_rows import refuse_limits
from regrasp.mechanics.margins import Margins, margins
from regrasp.mechanics.state import GraspState, check_load
from regrasp.mechanics.value import ArrayValue, kept
from regrasp.mechanics.wrench import Wrench, torque
from regrasp.planning.states.criteria import ChosenForces, ChosenState, Criteria
from regrasp.planning.states.escape import infeasible
from regrasp.planning.states.objectives import Objective
from regrasp.planning.states.options import LimitOptions, criteria_of, takes

ONE_POINT = 1e-13
"""Contacts nearer than this fraction of the largest coordinate are at one point: a load through it is
balanced to rounding by forces at both."""


@dataclass(frozen=True, eq=False, repr=False)
class EquilibriumLocus(ArrayValue):
    """LS_B: all forces of two planar contacts that balance a load inside both friction cones (Section III-B).

    They differ by the squeeze x only, the component of f_1 along the unit vector from P_1 to P_2 [N]. The
    locus is judged with the full friction and without force limits; ``best`` keeps a reserve back.

    Args:
        grasp: two planar contacts.
        load: external wrench on the object about its centre of mass, object frame [N, N m].

    Raises:
        InvalidInput: Unless the grasp has two planar contacts.
    """

    grasp: Grasp
    load: Wrench

    def __post_init__(self) -> None:
        instance(self.grasp, "grasp", Grasp)
        contacts = self.grasp.contacts
        if len(contacts) != 2 or contacts[0].dimension != 2:
            raise InvalidInput(
                f"an equilibrium locus needs two planar contacts, got {len(self.grasp)} of dimension "
                f"{self.grasp.dimension}; use grasp.subset([...]), or a SqueezeLocus"
            )
        if is_one_point(self.grasp):
            raise InvalidInput(
                f"an equilibrium locus needs contacts at two points; {' and '.join(self.grasp.names)} "
                f"are at one"
            )
        check_load(self.grasp, self.load)

    @classmethod
    def given(cls, grasp: Grasp, load: Wrench, contact: str | int, force: ArrayLike) -> "EquilibriumLocus":
        """LS_A: what two of three contacts can do when the third one's ``force`` (2,) is given (III-B).

        The given wrench acts like a part of the load: the locus is that of the other two contacts under
        ``load`` plus w = (f, r x f).

        Args:
            grasp: three planar contacts.
            load: external wrench on the object about its centre of mass, object frame [N, N m].
            contact: name or index of the third.
            force: (2,) of the third finger on the object, object frame [N].
        """
        instance(grasp, "grasp", Grasp)
        check_load(grasp, load)
        if grasp.dimension != 2:
            raise InvalidInput("an equilibrium locus is of planar contacts, got some in space")
        f = array(force, "force", (2,))
        fixed = grasp[contact]
        wrench = Wrench(f, torque=float(torque(fixed.position, f)[0]))
        return cls(grasp.without(contact), load + wrench)

    @cached_property
    def interval(self) -> tuple[float, float]:
        """(lo, hi) of the squeeze [N]; either may be infinite. An empty locus is (inf, -inf)."""
        return squeeze_interval(
            *_plain(self.grasp.contacts[0]), *_plain(self.grasp.contacts[1]), *_load(self.load)
        )

    @property
    def is_empty(self) -> bool:
        """Whether no forces inside the cones balance the load."""
        return self.interval[0] > self.interval[1]

    @property
    def direction(self) -> Array:
        """(2,) unit vector from P_1 to P_2."""
        return np.array(self._frame[:2])

    def forces(self, squeeze: ArrayLike) -> Array:
        """Forces (2, 2) at a squeeze, (m, 2, 2) at m of them [N]; in equilibrium for any squeeze.

        Args:
            squeeze: component of f_1 along the unit vector from P_1 to P_2, a number or (m,) [N].
        """
        ux, uy, phi, a, b, _ = self._frame
        x = finite(squeeze, "squeeze")[..., None]
        u, p = np.array([ux, uy]), np.array([-uy, ux])
        return np.stack([x * u + a * p, -(x + phi) * u + b * p], axis=-2)

    def wrenches(self, squeeze: ArrayLike) -> Array:
        """Wrenches (2, 3) at a squeeze, (m, 2, 3) at m of them [N, N m].

        Args:
            squeeze: component of f_1 along the unit vector from P_1 to P_2, a number or (m,) [N].
        """
        forces = self.forces(squeeze)
        return np.concatenate([forces, torque(self.grasp.positions, forces)], axis=-1)

    def margins(self, squeeze: ArrayLike) -> Margins:
        """Margins of both contacts at a squeeze, or at m of them.

        Args:
            squeeze: component of f_1 along the unit vector from P_1 to P_2, a number or (m,) [N].
        """
        return margins(self.forces(squeeze), self.grasp.normals, self.grasp.frictions)

    def segment(self, reach: float = inf) -> Array:
        """(2, 3) ends of LS_B in wrench space, as values of w_1.

        An infinite end is cut off ``reach`` [N] beyond the finite one; beyond zero if both are infinite.

        Args:
            reach: how far to show an infinite side [N].
        """
        lo, hi = self.interval
        if not (isinstance(reach, float) and reach == inf):
            number(reach, "reach", least=0)
        if self.is_empty:
            raise Infeasible(f"the equilibrium locus of {', '.join(self.grasp.names)} is empty")
        start = lo if isfinite(lo) else (hi if isfinite(hi) else 0.0) - reach
        end = hi if isfinite(hi) else (lo if isfinite(lo) else 0.0) + reach
        if not (isfinite(start) and isfinite(end)):
            raise InvalidInput("this locus has no end on one side; give reach, how far [N] to show it")
        result: Array = self.wrenches(np.array([start, end]))[:, 0]
        return result

    def state(self, squeeze: float) -> GraspState:
        """The state at a squeeze inside the interval; ``InvalidInput`` outside it.

        Args:
            squeeze: inside the interval [N].
        """
        lo, hi = self.interval
        squeeze = number(squeeze, "squeeze")
        if not lo <= squeeze <= hi:
            where = "the locus is empty" if self.is_empty else f"the locus is [{lo:.9g}, {hi:.9g}]"
            raise InvalidInput(f"squeeze {shown(squeeze)} is not on the locus; {where}")
        return GraspState(self.grasp, self.load, self.forces(squeeze))

    def squeeze(self, state: GraspState) -> float:
        """The squeeze of a state of this grasp [N].

        Args:
            state: a state of this grasp.
        """
        instance(state, "state", GraspState)
        if state.grasp != self.grasp:
            raise InvalidInput("state must be of the grasp of this locus, got one of other contacts")
        return float(state.forces[0] @ self.direction)

    @takes(LimitOptions)
    def best(
        self, objective: str | Objective | Criteria = "angle", **options: Unpack[LimitOptions]
    ) -> ChosenState:
        """The best state on the locus for an objective, in closed form; see ``choose_state``.

        Args:
            objective: a word, an objective of one's own, or ``Criteria``.
            options
        """
        criteria = criteria_of(objective, options)
        return ChosenState(self.grasp, self.load, criteria, best_forces(self.grasp, self.load, criteria))

    @cached_property
    def _frame(self) -> tuple[float, float, float, float, float, float]:
        first, second = self.grasp.contacts
        return pair_frame(*_plain(first)[:2], *_plain(second)[:2], *_load(self.load))

    def _repr_html_(self) -> str:
        """Both forces and the margins at the ends and in the middle of the locus, for notebooks."""
        if self.is_empty:
            return table(["locus"], [["empty: no forces inside the cones balance the load"]])
        low, high = self.interval
        places = {"low end": low, "middle": (low + high) / 2, "high end": high}
        first, second = self.grasp.names
        head = ["", "squeeze [N]", f"|f| of {first} [N]", f"|f| of {second} [N]", "least angle margin [deg]"]
        rows: list[list[object]] = []
        for name, x in places.items():
            if not isfinite(x):
                rows.append([name, "without end", "", "", ""])
                continue
            least = float(np.degrees(self.margins(x).least_angle))
            rows.append([name, x, *np.hypot(*self.forces(x).T).tolist(), least])
        return table(head, rows, f"under {self.load!r}")

    def __repr__(self) -> str:
        names = ", ".join(self.grasp.names)
        span = "empty" if self.is_empty else f"squeeze in [{self.interval[0]:.6g}, {self.interval[1]:.6g}]"
        return f"EquilibriumLocus of {names} under {self.load!r}: {span}"


def is_one_point(grasp: Grasp) -> bool:
    """Whether two planar contacts are at one point: the squeeze between them has no direction."""
    one, other = grasp.contacts
    p, q = one.plain, other.plain
    near = ONE_POINT * max(abs(p[0]), abs(p[1]), abs(q[0]), abs(q[1]))
    return abs(q[0] - p[0]) <= near and abs(q[1] - p[1]) <= near


def best_forces(grasp: Grasp, load: Wrench, criteria: Criteria) -> ChosenForces:
    """The best forces of two planar contacts, in closed form. Raises ``Infeasible`` with the escape twist."""
    found = closed_forces(grasp, load, criteria)
    if found is None:
        criteria.refuse_pressing("the closed form")
        refuse_limits(grasp, "the closed form")
        raise InvalidInput(f"objective {shown(criteria.objective.name)} has no closed form; use choose_state")
    return found


def closed_forces(grasp: Grasp, load: Wrench, criteria: Criteria) -> ChosenForces | None:
    """The best forces of two planar contacts at two points; None where the closed form has no answer.

    Raises ``Infeasible`` with the escape twist.
    """
    # Kept with the grasp, since loads change more often.
    question = kept(grasp, criteria, _asked)
    if question is None:
        return None
    if question.needs_load and not any(load.plain):
        criteria.demand_limit(grasp, load)
    x, (f1x, f1y, f2x, f2y), limits = best_squeeze(*question.pair, *_load(load), *question.sought)  # type: ignore[arg-type]
    if isnan(x):
        raise infeasible(grasp, load, criteria)
    return ChosenForces([[f1x, f1y], [f2x, f2y]], limits, "closed-form")


class _Question(NamedTuple):
    """What ``best_squeeze`` is asked, but for the load; whether forces follow from that alone."""

    pair: tuple[float, float, float, float, float, float, float, float, float, float]
    sought: tuple[int, float, float, float]
    needs_load: bool


def _asked(grasp: Grasp, criteria: Criteria) -> _Question | None:
    """None where the closed form has no answer: it knows two planar contacts at two points, and no more."""
    code = criteria.objective.closed_form
    if len(grasp) != 2 or grasp.dimension != 2 or code is None or criteria.presses or criteria.withstands:
        return None
    one, other = grasp.contacts
    if is_one_point(grasp) or one.limits is not None or other.limits is not None:
        return None
    first, second = _plain(one)[:4], _plain(other)[:4]
    mu1, mu2 = criteria.frictions(grasp)
    bound1, bound2 = criteria.limits(grasp)
    sought = code, bound1, bound2, criteria.peak_ratio
    return _Question((*first, mu1, *second, mu2), sought, criteria.unbounded and inf in (bound1, bound2))


def _plain(contact: Contact) -> tuple[float, float, float, float, float]:
    return cast(tuple[float, float, float, float, float], contact.plain)


def _load(load: Wrench) -> tuple[float, float, float]:
    return cast(tuple[float, float, float], load.plain)

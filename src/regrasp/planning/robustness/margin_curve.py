"""What a margin costs: the best margin over a force limit, over friction, over where a contact touches."""

from dataclasses import dataclass, field, replace
from math import nan
from typing import Literal, Unpack, get_args

import numpy as np

from regrasp.display import Pictured
from regrasp.errors import Infeasible, InvalidInput
from regrasp.mechanics.checks import Array, ArrayLike, array, choice, number, read_only, whole
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.robust.moved import moved
from regrasp.mechanics.state import check_load
from regrasp.mechanics.value import ArrayValue
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.choosing import choose_forces
from regrasp.planning.states.criteria import ChosenState, Criteria
from regrasp.planning.states.objectives import Objective
from regrasp.planning.states.options import StateOptions, criteria_of, takes
from regrasp.planning.states.solving import force_unit

Axis = Literal["max_force", "friction", "position"]
AXES = get_args(Axis)
COUNT = 25
_SPAN = 5.0
"""Force limits go from the least peak force, or a thousandth of the load, to so many times it."""
_FACTORS = (0.1, 2.0)
_MOST = 1000


@dataclass(frozen=True, eq=False, repr=False)
class MarginCurve(ArrayValue, Pictured):
    """The best value of an objective over something that is given.

    Args:
        grasp: the contacts that hold.
        load: external wrench on the object about its centre of mass, object frame [N, N m].
        objective: what states are chosen for.
        x: ``max_force`` [N], ``friction``, the factor on all coefficients [-], or ``position``, how far one
            contact is off along its tangent [m].
        contact: the contact that ``position`` moves; None else.
        at: (m,) values of x, rising.
        values: (m,) the best value, in the objective's unit; NaN where the load is not held.
        states: (m,) the states, None where there is none.
    """

    grasp: Grasp
    load: Wrench
    objective: Objective
    x: Axis
    contact: str | None
    at: Array
    values: Array
    states: tuple[ChosenState | None, ...] = field(compare=False)

    _drawn_by = "regrasp.plots.surveys.margin_curve:margin_curve_png"

    def least(self, value: float) -> float:
        """The least x of those looked at from which on the value is reached, between them by chords.

        Over ``max_force`` this is a force limit that surely suffices for ``force`` and ``wrench``: their best
        value is concave in the limit, so chords lie below it. Infinite where it is not reached.

        Args:
            value: of the objective, in its unit.
        """
        wanted = number(value, "value")
        sign = 1.0 if self.objective.maximise else -1.0
        reached = sign * self.values >= sign * wanted
        if not reached.any():
            return float("inf")
        k = int(reached.argmax())
        if k == 0 or np.isnan(self.values[k - 1]):
            return float(self.at[k])
        low, high = self.values[k - 1], self.values[k]
        share = (wanted - low) / (high - low) if high != low else 1.0
        return float(self.at[k - 1] + share * (self.at[k] - self.at[k - 1]))

    def __str__(self) -> str:
        known = np.flatnonzero(~np.isnan(self.values))
        if not known.size:
            return f"{self.objective.words} over {self.x}: the load is held nowhere"
        first, last = int(known[0]), int(known[-1])
        unit = "" if self.objective.unit == "-" else f" {self.objective.unit}"
        return (
            f"{self.objective.words} over {self.x}: {self.values[first]:.6g}{unit} at {self.at[first]:.6g}, "
            f"{self.values[last]:.6g}{unit} at {self.at[last]:.6g}"
        )

    def __repr__(self) -> str:
        return f"MarginCurve({self})"


@takes(StateOptions)
def margin_curve(
    grasp: Grasp,
    load: Wrench,
    x: Axis = "max_force",
    objective: str | Objective | Criteria = "force",
    *,
    at: ArrayLike | None = None,
    contact: str | int | None = None,
    surface: float = 0.0,
    count: int = COUNT,
    **options: Unpack[StateOptions],
) -> MarginCurve:
    """The best margin over a force limit, a factor on friction, or where one contact touches.

    Args:
        grasp: the contacts that hold.
        load: external wrench on the object about its centre of mass, object frame [N, N m].
        x: ``max_force`` [N], ``friction`` [-] or ``position`` [m].
        objective: what states are chosen for, as in ``choose_state``.
        at: (m,) values of x, rising. If not given ``count`` of them: limits from the least peak force to five
            times it, factors from 0.1 to 2, offsets up to half the grasp's size to either side.
        contact: by name or index, the one that ``position`` moves along its (first) tangent.
        surface: curvature there [1/m], positive where the surface bulges out.
        count: how many values of x.
        options

    Raises:
        Infeasible: Where the load is not held at all, over ``max_force``.
        InvalidInput: For bad input.
    """
    check_load(grasp, load)
    choice(x, "x", AXES)
    whole(count, "count", least=2, most=_MOST)
    number(surface, "surface")
    criteria = criteria_of(objective, options)
    if (contact is None) == (x == "position"):
        raise InvalidInput("contact says which one x='position' moves; give it there, and only there")
    place = None if contact is None else grasp.index(contact)
    method, facets = options.get("method", "auto"), options.get("facets")
    places = _asked(grasp, load, x, criteria, at, count)
    states: list[ChosenState | None] = []
    for value in places.tolist():
        given, by = grasp, criteria
        if x == "max_force":
            by = replace(criteria, max_force=value)
        elif x == "friction":
            given = Grasp(c.changed(friction=value * c.friction) for c in grasp)
        elif place is not None:
            offsets = np.zeros((len(grasp), grasp.dimension - 1))
            offsets[place, 0] = value
            given = moved(grasp, offsets, np.full(len(grasp), surface))
        try:
            states.append(ChosenState(given, load, by, choose_forces(given, load, by, method, facets)))
        except Infeasible:
            states.append(None)
    values = read_only(np.array([nan if state is None else state.value for state in states]))
    name = None if place is None else grasp.names[place]
    return MarginCurve(grasp, load, criteria.objective, x, name, places, values, tuple(states))


def _asked(
    grasp: Grasp, load: Wrench, x: Axis, criteria: Criteria, at: ArrayLike | None, count: int
) -> Array:
    if at is not None:
        given = array(at, "at", (None,))
        least = "" if x == "position" else " and greater than 0"
        if given.size < 1 or (np.diff(given) <= 0).any() or (x != "position" and given[0] <= 0):
            raise InvalidInput(f"at must be numbers that rise{least}, got {at!r}")
        return given
    if x == "friction":
        return read_only(np.linspace(*_FACTORS, count))
    if x == "position":
        return read_only(np.linspace(-0.5, 0.5, count) * (grasp.size or 1.0))
    if not load.vector.any():
        raise InvalidInput("limits of forces that hold no load follow from nothing; give at=[...] [N]")
    peak = Criteria("peak", reserve=criteria.reserve, min_normal=criteria.min_normal)
    state = ChosenState(grasp, load, peak, choose_forces(grasp, load, peak))
    least_peak = max(state.value, 1e-3 * force_unit(grasp, load))
    return read_only(least_peak * (1 + 1e-6) * (1 + (_SPAN - 1) * np.linspace(0, 1, count) ** 3))

"""The options of a regrasp, in the plane and in space, and what both ask of them."""

from math import pi
from typing import Any, Required

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, array, choice, number, whole
from regrasp.mechanics.limits.force_limits import ForceLimits
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.planning.holds.pairs import Filter
from regrasp.planning.holds.triples import TripleFilter
from regrasp.planning.holds.weights import RegraspWeights
from regrasp.planning.regrasps.settings.arcs import Arcs
from regrasp.planning.regrasps.settings.regions import Regions
from regrasp.planning.states.criteria import Criteria
from regrasp.planning.states.objectives import Objective
from regrasp.planning.states.options import LimitOptions, criteria_of, described

MOST_CANDIDATES = 100_000
"""Points where fingers may touch; the memory of a graph ends before that."""
MOST_EXTRA = 1000
"""Moves that a sequence may have more than the fewest."""


class RegraspOptions(LimitOptions, total=False):
    """The options of a regrasp; what they mean stands in ``RegraspProblem``."""

    friction: Required[float]
    orientations: int | None
    goal_orientation: float
    candidates: int | ArrayLike | None
    objective: str | Objective | Criteria
    states: str
    max_turn: float | None
    least_margin: float
    min_distance: float
    keep: Filter | TripleFilter | None
    arcs: Arcs | Regions | None
    one_finger: bool
    limits: ForceLimits | None
    disturbance: LoadSet | None
    stiffness: ArrayLike | None
    early_loss: bool
    weights: RegraspWeights | None
    min_normal: float | None
    step_duration: float
    goal_rotation: ArrayLike | None
    facets: int | None
    seed: int


_WITHSTOOD = {"disturbance": None, "stiffness": None, "early_loss": False}


def check_steps(step_duration: float, states: str, max_turn: float, least_margin: float) -> None:
    """Raises ``InvalidInput`` for options of the steps that are not what they must be."""
    number(step_duration, "step_duration", above=0)
    choice(states, "states", ("each", "joint"))
    turn_below_pi(max_turn)
    number(least_margin, "least_margin", least=0)


def checked_candidates(candidates: Any, dimension: int) -> int | Array:
    """How many, or where: arc lengths (k,) in the plane, points (k, 3) in space; or ``InvalidInput``."""
    if not isinstance(candidates, (list, tuple, np.ndarray)):
        return whole(candidates, "candidates", least=1, most=MOST_CANDIDATES)
    places = array(candidates, "candidates", (None,) if dimension == 2 else (None, 3))
    if not 1 <= len(places) <= MOST_CANDIDATES:
        raise InvalidInput(f"candidates must be 1 to {MOST_CANDIDATES:,} places, got {len(places)}")
    return places


def settled(problem: Any) -> Criteria:
    """The criteria of a problem's ``objective``, its limits, and what it withstands.

    Where the objective is ``Criteria``, they hold all of these; the problem's fields then say the same.
    """
    entries = described(LimitOptions)
    given = {name: getattr(problem, name) for name in entries}
    defaults = {name: option.default for name, (_, option) in entries.items()}
    changed = {k: v for k, v in given.items() if not isinstance(v, float | None) or v != defaults[k]}
    asked = problem.min_normal
    if asked is not None and number(asked, "min_normal", least=0):
        changed["min_normal"] = asked
    changed |= {
        name: getattr(problem, name)
        for name, default in _WITHSTOOD.items()
        if getattr(problem, name) is not default
    }
    criteria = criteria_of(problem.objective, changed)
    if criteria.controlled:
        raise InvalidInput("which fingers are controlled follows from their moves; leave controlled out")
    if criteria.demands and problem.states == "joint" and not criteria.withstands:
        raise InvalidInput("states='joint' has one force margin for all states; give another objective")
    for name in _WITHSTOOD:
        if criteria.demands:
            object.__setattr__(problem, name, getattr(criteria, name))
    if asked is not None or isinstance(problem.objective, Criteria):
        object.__setattr__(problem, "min_normal", criteria.least_normal)
    for name in ("objective", *entries):
        object.__setattr__(problem, name, getattr(criteria, name))
    return criteria


def turn_below_pi(max_turn: float) -> float:
    """A checked ``max_turn`` [rad]."""
    if not 0 < number(max_turn, "max_turn") < pi:
        raise InvalidInput(f"max_turn must be above 0 and below pi, got {shown(max_turn)}")
    return max_turn

"""What a state is chosen for, and under which limits."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from math import inf
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import LARGEST, Array, ArrayLike, instance, items, number, read_only, whole
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.reserve import RESERVE, kept_force, kept_friction, reserve_fraction
from regrasp.mechanics.robust.stiffness import Stiffness, checked_stiffness, stiffness_matrices
from regrasp.mechanics.robust.withstood import Withstood
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.objectives import ANGLE, Objective, WithstoodFactor, objective_of

if TYPE_CHECKING:
    from regrasp.planning.states.withstanding.demand import Demand

PEAK_RATIO = 3.0
"""Default limit on every force, as a multiple of the least peak force that holds the load."""


@dataclass(frozen=True)
class Criteria:
    """Objective and limits by which a state is chosen, checked.

    Args:
        objective: a word, or a value (``regrasp.planning.states.objectives``): ``angle`` or ``force``, the
            widest least margin; ``effort``, the least sum of squares; ``peak``, the least largest force;
            ``peak_normal`` and ``sum_normal``, the least largest normal force and the least sum of them;
            ``friction_use``, the least largest fraction of the friction available; or a ``ForceCost`` of
            one's own. Kept as a value.
        max_force: a limit on every force [N] besides the contacts' own, or None.
        peak_ratio: where any contact has no limit, ``angle``, ``force`` and ``friction_use`` limit all of
            them to this multiple (at least 1) of the least peak force with which the grasp holds the load, or
            to a contact's own limit if that is smaller.
        reserve: fraction of every friction coefficient kept back [-].
        min_normal: least normal force of every finger [N], or (n,) one for each contact; 0 for none.
        disturbance: a set of load deviations that the forces must withstand on top of the load: f + R d
            inside cones and limits for each of its members d, R the response of the fingers' stiffness
            (docs/robustness.md); for the objective ``wrench`` the set whose factor is made widest. None for
            none.
        stiffness: of the fingers [N/m]: a number; (n,); (n, 2) along the normal and across it; (n, 3) for
            soft fingers, the last about the normal [N m/rad]; or (n, w, w) matrices in the object's frame;
            all alike if not given.
        controlled: places of fingers whose force is controlled, as of those that leave or arrive: the others
            withstand the set without them, and all of them with them; or several such groups, as of one that
            has arrived and one that leaves next: the set is withstood without either.
        early_loss: whether forces withstand the set, too, after a controlled finger lost contact early;
            without a set the loss alone.

    Raises:
        InvalidInput: For anything else.
    """

    objective: Objective = ANGLE
    max_force: float | None = None
    peak_ratio: float = PEAK_RATIO
    reserve: float = RESERVE
    min_normal: float | tuple[float, ...] = 0.0
    disturbance: LoadSet | None = None
    stiffness: Stiffness = 1.0
    controlled: tuple[int, ...] | tuple[tuple[int, ...], ...] = ()
    early_loss: bool = False

    def __init__(
        self,
        objective: str | Objective = "angle",
        max_force: float | None = None,
        peak_ratio: float = PEAK_RATIO,
        reserve: float = RESERVE,
        min_normal: float | Sequence[float] | Array | None = 0.0,
        disturbance: LoadSet | None = None,
        stiffness: ArrayLike | Stiffness | None = None,
        controlled: Sequence[int] | Sequence[Sequence[int]] = (),
        early_loss: bool = False,
    ) -> None:
        sought = objective_of(objective)
        if disturbance is not None:
            instance(disturbance, "disturbance", LoadSet, "; make one by LoadSet.ball, .hull or another")
        if not isinstance(early_loss, bool):
            raise InvalidInput(f"early_loss must be True or False, got {shown(early_loss)}")
        answered = checked_stiffness(stiffness)
        if isinstance(sought, WithstoodFactor):
            sought = replace(sought, disturbance=disturbance, stiffness=answered)
        object.__setattr__(self, "objective", sought)
        object.__setattr__(self, "disturbance", disturbance)
        object.__setattr__(self, "stiffness", answered)
        object.__setattr__(self, "controlled", _places(controlled))
        object.__setattr__(self, "early_loss", early_loss)
        if max_force is not None:
            _refuse_larger(number(max_force, "max_force", above=0), "max_force")
        number(peak_ratio, "peak_ratio", least=1)
        reserve_fraction(reserve)
        object.__setattr__(self, "max_force", max_force)
        object.__setattr__(self, "peak_ratio", peak_ratio)
        object.__setattr__(self, "reserve", reserve)
        object.__setattr__(self, "min_normal", _least_normal(min_normal))

    @cached_property
    def _hash(self) -> int:
        return hash(tuple(vars(self)[f.name] for f in fields(self)))

    def __repr__(self) -> str:
        given = [(f.name, getattr(self, f.name), f.default) for f in fields(self)]
        other = [f"{name}={value!r}" for name, value, default in given[1:] if value != default]
        return f"Criteria({', '.join([repr(str(self.objective)), *other])})"

    def __hash__(self) -> int:
        return self._hash

    @property
    def unbounded(self) -> bool:
        """Whether the best value may lie at infinite force, so that forces must be limited."""
        return self.objective.unbounded

    def frictions(self, grasp: Grasp) -> list[float]:
        """Friction coefficients that planning may use.

        Args:
            grasp: of n contacts.
        """
        return [kept_friction(c.friction, self.reserve) for c in grasp]

    def limits(self, grasp: Grasp) -> list[float]:
        """Force limits that planning may use, infinite where there is none [N].

        Args:
            grasp: of n contacts.
        """
        general = inf if self.max_force is None else self.max_force
        for contact in grasp:
            if contact.max_force is not None:
                _refuse_larger(contact.max_force, f"max_force of {contact.name}, to plan with,")
        return [
            kept_force(general if c.max_force is None else min(general, c.max_force), self.reserve)
            for c in grasp
        ]

    @cached_property
    def presses(self) -> bool:
        """Whether any finger must push with a least normal force."""
        return bool(self.min_normal) and (not isinstance(self.min_normal, tuple) or any(self.min_normal))

    @cached_property
    def withstands(self) -> bool:
        """Whether forces must withstand a set or an early loss, rather than the widest factor of a set."""
        asked = self.disturbance is not None or self.early_loss
        return asked and not isinstance(self.objective, WithstoodFactor)

    @cached_property
    def demands(self) -> bool:
        """Whether a set or an early loss counts, as it is or by its factor."""
        return self.withstands or isinstance(self.objective, WithstoodFactor)

    @property
    def withstood(self) -> Withstood | None:
        """What a plan by these criteria says of itself: the set and the early loss it withstands, or None."""
        return Withstood(self.disturbance, self.stiffness, self.early_loss) if self.withstands else None

    def of_some(self, grasp: Grasp, at_work: Sequence[int], controlled: Collection[int]) -> "Criteria":
        """The criteria for some contacts of a grasp, with their stiffness.

        Args:
            grasp: the contacts in play, one for each row of the stiffness.
            at_work: the places of those that are asked for.
            controlled: the places of those that are force-controlled.
        """
        stiffness = self.stiffness
        if isinstance(stiffness, tuple):
            stiffness_matrices(grasp, stiffness)  # which says what is wrong
            stiffness = tuple(stiffness[i] for i in at_work)
        places = tuple(k for k, i in enumerate(at_work) if i in controlled)
        return replace(self, stiffness=stiffness, controlled=places)

    def demand(self, grasp: Grasp) -> "Demand | None":
        """What forces must withstand, or the set whose factor is made widest; None for neither.

        Args:
            grasp: the contacts that hold.
        """
        if not self.demands:
            return None
        from regrasp.planning.states.withstanding.demand import Demand

        if isinstance(self.objective, WithstoodFactor):
            factored = self.objective.deviations(grasp)
            return Demand(grasp, factored, self.stiffness, self.controlled, self.early_loss, is_kept=False)
        loads = self.disturbance
        if loads is None:  # no deviation, but the loss of a finger
            loads = LoadSet.hull([Wrench.from_vector([0.0] * len(grasp.matrix))])
        return Demand(grasp, loads, self.stiffness, self.controlled, self.early_loss)

    def least_normals(self, grasp: Grasp) -> list[float]:
        """Least normal force of each finger [N].

        Args:
            grasp: the contacts that push.
        """
        if not isinstance(self.min_normal, tuple):
            return [self.min_normal] * len(grasp)
        if len(self.min_normal) != len(grasp):
            raise InvalidInput(
                f"min_normal must be one number or {len(grasp)}, one for each contact, got "
                f"{len(self.min_normal)}"
            )
        return list(self.min_normal)

    @property
    def least_normal(self) -> float:
        """Least normal force of all fingers [N]; raises ``InvalidInput`` where each has its own."""
        if isinstance(self.min_normal, tuple):
            raise InvalidInput("a plan takes one min_normal for all fingers that stay, not one for each")
        return self.min_normal

    def refuse_pressing(self, what: str) -> None:
        """Raise ``InvalidInput`` where least normal forces are asked for and not kept.

        Args:
            what: what does not keep them, in words.
        """
        if self.presses:
            raise InvalidInput(f"{what} keeps no least normal force; leave min_normal out of the Criteria")
        if self.demands:
            raise InvalidInput(
                f"{what} withstands no disturbance; leave it out, and objective 'wrench' with it"
            )

    def demand_limit(self, grasp: Grasp, load: Wrench) -> None:
        """Raise ``InvalidInput`` where a multiple of the least peak force says nothing: the load is zero.

        Args:
            grasp: the contacts that hold.
            load: external wrench on the object about its centre of mass, object frame [N, N m].
        """
        if self.unbounded and not any(load.plain) and inf in self.limits(grasp):
            raise InvalidInput(
                f"objective {shown(self.objective.name)} under a zero load needs max_force: any "
                "squeeze holds it, "
                f"so no force follows from the load"
            )


def _refuse_larger(value: float, what: str) -> None:
    if value > LARGEST:
        raise InvalidInput(f"{what} must be at most {LARGEST:g} N, got {shown(value)}")


def _places(controlled: Sequence[int] | Sequence[Sequence[int]]) -> tuple[Any, ...]:
    """Places, or groups of places; none is left out of several groups."""
    given = items(controlled, "controlled")
    if not any(isinstance(some, Sequence) and not isinstance(some, str | bytes) for some in given):
        return tuple(whole(i, "each of controlled", least=0) for i in given)
    groups = [
        tuple(
            whole(i, "each of a group of controlled", least=0) for i in items(some, "a group of controlled")
        )
        for some in given
    ]
    return tuple(group for group in dict.fromkeys(groups) if group)


def _least_normal(given: float | Sequence[float] | Array | None) -> float | tuple[float, ...]:
    if given is None:
        return 0.0
    if isinstance(given, float | int):
        _refuse_larger(given, "min_normal")
    if not isinstance(given, Sequence | np.ndarray) or isinstance(given, str | bytes) or np.ndim(given) == 0:
        return number(given, "min_normal", least=0)
    several = [number(value, "each min_normal", least=0) for value in given]
    for value in several:
        _refuse_larger(value, "each min_normal")
    if not several:
        raise InvalidInput("min_normal must be a number or one for each contact [N], got none")
    return tuple(several)


class ChosenForces(NamedTuple):
    """Forces (n, d) of a choice [N]; limits, method and gap as in ``ChosenState``."""

    forces: Array | list[list[float]]
    force_limits: tuple[float, ...]
    method: str
    gap: float | None = None


@dataclass(frozen=True, eq=False, repr=False)
class ChosenState(GraspState):
    """A state with the record of its choice.

    Args:
        grasp: the contacts that hold.
        load: external wrench on the object about its centre of mass, object frame [N, N m].
        criteria: objective and limits of the choice.
        chosen: its forces (n, d) [N], force limits (n,) [N], method and gap.
    """

    criteria: Criteria
    force_limits: tuple[float, ...]
    """(n,) limits the choice was made under [N], those set by ``peak_ratio`` included."""
    method: str
    """``closed-form`` or the back end's name."""
    gap: float | None
    """How much better the best value can be at most, by duality; None for the closed form, which is exact.

    For ``angle`` [rad] and ``friction_use`` mostly 1e-7, and never more than 1e-5 unless rounding hides what
    is between; infinite where a solver failed next to the edge and forces were found without one. With
    ``min_normal`` it is a bound, too, and often far above what is left: no twist proves more. Of ``wrench``
    with a ball or an ellipsoid it holds what polytopes in the place of these leave open.
    """

    def __init__(
        self,
        grasp: Grasp,
        load: Wrench,
        criteria: Criteria,
        chosen: ChosenForces,
    ) -> None:
        forces, force_limits, method, gap = chosen  # of forces chosen for this grasp nothing is to be checked
        given = read_only(np.array(forces, dtype=float))
        vars(self).update(
            grasp=grasp, load=load, forces=given, criteria=criteria, force_limits=force_limits, method=method,
            gap=gap,
        )  # fmt: skip

    @cached_property
    def value(self) -> float:
        """The objective reached, in its unit."""
        return self.criteria.objective.value(self)

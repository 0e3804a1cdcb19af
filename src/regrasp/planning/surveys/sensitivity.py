"""What the best forces of a grasp are sensitive to."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import nan
from typing import TYPE_CHECKING, Unpack

import numpy as np

from regrasp.display import Pictured
from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, instance, number, read_only
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.state import GraspState, check_load
from regrasp.mechanics.value import ArrayValue
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.choosing import choose_state
from regrasp.planning.states.criteria import ChosenState, Criteria
from regrasp.planning.states.objectives import Objective
from regrasp.planning.states.options import LimitOptions, criteria_of, takes

if TYPE_CHECKING:
    import pandas

"""Units of the objectives' values; the others are forces [N]."""

# What is less than this fraction of the largest effect prints as 0.
_ROUNDING = 1e-6
_PER = {"friction": "", "position": "m", "normal": "rad", "limit": "N", "torsion": "m"}
_LOADS = {
    2: {"force x": "N", "force y": "N", "torque": "(N m)"},
    3: {f"{what} {axis}": per for what, per in (("force", "N"), ("torque", "(N m)")) for axis in "xyz"},
}


@dataclass(frozen=True, eq=False, repr=False)
class Sensitivity(ArrayValue, Pictured):
    """How the best value of ``choose_state`` changes, per unit of each number of the grasp and the load.

    Each is the value's unit (``angle`` [rad], ``effort`` [N^2], ``friction_use`` [-], others [N]) per the
    parameter's.

    Args:
        state: the best state.
        value: its objective, margins measured within the friction that planning may use.
        friction: (n,) per unit of mu_i; NaN where mu_i = 0, which can change to one side only.
        position: (n,) per metre along the contact's tangent, the normal turned left by a right angle; in
            space (n, 2) along both of ``Grasp.tangents``. The normal stays as it is: along a boundary of
            curvature kappa, positive where convex, the value changes by ``position`` - kappa ``normal`` (1 /
            R on a disc).
        normal: (n,) per radian that the normal turns counter-clockwise; in space (n, 2) towards both
            tangents.
        limit: (n,) per newton of the contact's force limit, its own or ``max_force``; 0 where it does not
            bind, NaN where none is given.
        load: (3,) or (6,) per newton and newton metre of the load.
        torsion: (n,) per metre of a soft finger's torsion, its friction staying; NaN of point contacts.
    """

    state: ChosenState
    value: float
    friction: Array
    position: Array
    normal: Array
    limit: Array
    load: Array
    torsion: Array

    _drawn_by = "regrasp.plots.surveys.sensitivity:sensitivity_png"

    @property
    def grasp(self) -> Grasp:
        """The contacts."""
        return self.state.grasp

    @property
    def objective(self) -> Objective:
        """What the state was chosen for."""
        return self.state.criteria.objective

    @property
    def unit(self) -> str:
        """Of the value."""
        return self.objective.unit

    @property
    def larger_is_better(self) -> bool:
        """Whether the value is a margin; effort, forces and friction use are better small."""
        return self.objective.maximise

    def steps(self, fraction: float = 0.01) -> dict[str, Array]:
        """Comparable changes of all parameters, in the shapes of the rates, whatever the units.

        That fraction of the friction, the torsion, the force limit and the magnitude of the load's force (of
        the largest finger force if it is zero); of the grasp's size along the tangent; of a radian. The
        load's torque changes as if its force moved by the grasp's size.

        Args:
            fraction: of friction, limits, sizes and a radian [-].
        """
        share = number(fraction, "fraction", above=0)
        size, criteria = self.grasp.size, self.state.criteria
        force = float(np.linalg.norm(self.state.load.force)) or float(self.state.magnitudes.max())
        limits = np.array(criteria.limits(self.grasp))
        return {
            "friction": share * self.grasp.frictions,
            "position": np.full(self.position.shape, share * size),
            "normal": np.full(self.normal.shape, share),
            "limit": share * np.where(np.isfinite(limits), limits, nan),
            "torsion": share * np.array([nan if c.torsion is None else c.torsion for c in self.grasp]),
            "load": share * force * np.where(np.arange(self.load.size) < self.grasp.dimension, 1.0, size),
        }

    def effects(self, fraction: float = 0.01) -> dict[str, Array]:
        """The change of the value, to first order, by each of ``steps(fraction)``; in the value's unit.

        Args:
            fraction: as of ``steps`` [-].
        """
        return {name: step * getattr(self, name) for name, step in self.steps(fraction).items()}

    def to_dataframe(self) -> "pandas.DataFrame":
        """A table with a row for each number: of (a contact's name or ``load``), parameter, rate and unit."""
        try:
            import pandas
        except ImportError:
            raise ImportError("to_dataframe needs pandas: pip install 'regrasp[pandas]'") from None
        rows = [
            (name, parameter, rates[i], self._unit_per(per))
            for i, name in enumerate(self.grasp.names)
            for parameter, (rates, per) in self._columns(vars(self)).items()
            if parameter != "torsion" or self.grasp.is_soft
        ]
        rows += [
            ("load", parameter, rate, self._unit_per(per))
            for (parameter, per), rate in zip(self._loads.items(), self.load, strict=True)
        ]
        return pandas.DataFrame(rows, columns=["of", "parameter", "rate", "unit"])

    @property
    def _loads(self) -> dict[str, str]:
        """The load's components and their units."""
        return _LOADS[self.grasp.dimension]

    def _columns(self, values: Mapping[str, Array]) -> dict[str, tuple[Array, str]]:
        """(n,) numbers of the contacts and their units, those of both tangents one after the other."""
        columns = {}
        for name, per in _PER.items():
            if values[name].ndim == 1:
                columns[name] = values[name], per
            else:
                columns |= {f"{name} {k + 1}": (part, per) for k, part in enumerate(values[name].T)}
        return columns

    def _unit_per(self, per: str) -> str:
        unit = "1" if self.unit == "-" and per else self.unit
        return f"{unit}/{per}" if per else unit

    def __str__(self) -> str:
        columns = self._columns(vars(self))
        shown = {name: per for name, (rates, per) in columns.items() if not np.isnan(rates).all()}
        width = max(8, *(len(name) for name in self.grasp.names))
        lines = [
            f"{self.objective} {self.value:.5g} {self.unit} under {self.state.load!r}; it changes by",
            f"{'':{width}}" + "".join(f"{parameter:>14}" for parameter in shown),
            f"{'':{width}}" + "".join(f"{'[' + self._unit_per(per) + ']':>14}" for per in shown.values()),
        ]
        cells = self._cells()
        for i, name in enumerate(self.grasp.names):
            lines.append(f"{name:{width}}" + "".join(cells[p][i] for p in shown))
        lines.append(f"{'load':{width}}" + "".join(f"{name:>14}" for name in self._loads))
        lines.append(
            f"{'':{width}}" + "".join(f"{'[' + self._unit_per(p) + ']':>14}" for p in self._loads.values())
        )
        lines.append(f"{'':{width}}" + "".join(cells["load"]))
        return "\n".join(lines)

    def _cells(self) -> dict[str, list[str]]:
        """The rates, 14 characters each; a dash where there is none, 0 where the effect is rounding."""
        effects = self.effects()
        columns, of_columns = self._columns(vars(self)), self._columns(effects)
        pairs = {name: (rates, of_columns[name][0]) for name, (rates, _) in columns.items()}
        pairs["load"] = self.load, effects["load"]
        rounding = _ROUNDING * max(float(np.nanmax(abs(e), initial=0.0)) for e in effects.values())
        return {
            name: [
                f"{'-':>14}" if np.isnan(effect) else f"{rate if abs(effect) > rounding else 0.0:14.4g}"
                for effect, rate in zip(effect_of, rates, strict=True)
            ]
            for name, (rates, effect_of) in pairs.items()
        }

    __repr__ = __str__


@takes(LimitOptions)
def sensitivity(
    grasp: Grasp,
    load: Wrench,
    objective: str | Objective | Criteria = "angle",
    **options: Unpack[LimitOptions],
) -> Sensitivity:
    """How much the best margin or the least effort changes per unit of friction, position, normal and load.

    The arguments are those of ``choose_state``, for grasps of two contacts or more, in space with exact cones
    and soft fingers.

    Linear limits of contacts are kept and turn with their normals; their bounds have no rates here.

    By the envelope theorem, from the duals of the programs that Clarabel solves (docs/sensitivity.md); a
    force limit set by ``peak_ratio`` moves with the least peak force.

    Rates hold to first order. Where the constraints that decide change (two fingers equally near their limit
    by symmetry, say) the value has a kink: its rates differ to the two sides, the duals are not unique, and
    what is returned is a mixture. Nothing warns of it: where it matters, choose again after a small change.

    Args:
        grasp: two contacts or more.
        load: external wrench on the object about its centre of mass, object frame [N, N m].
        objective: as for ``choose_state``.
        options

    Raises:
        Infeasible: When no forces hold the load.
        InvalidInput: For a state without forces and a ``peak_ratio`` of 1, which leaves nothing to choose.
        SolverFailed: Where there are no duals, at the very limit of what can be held.
    """
    instance(grasp, "grasp", Grasp)
    check_load(grasp, load)
    if len(grasp) < 2:
        raise InvalidInput("a sensitivity needs two contacts or more: one holds a load along its line alone")
    criteria = criteria_of(objective, options)
    criteria.refuse_pressing("a sensitivity")
    if criteria.peak_ratio == 1:
        raise InvalidInput("peak_ratio must be greater than 1 for a sensitivity: 1 leaves nothing to choose")
    state = choose_state(grasp, load, criteria)
    if not state.forces.any():
        raise InvalidInput(
            f"no finger pushes in the state best for {shown(criteria.objective.name)}, so its "
            "value has no rates; "
            f"give a load"
        )
    from regrasp.planning.surveys.value_rates import value_rates

    frictions, limits = state.criteria.frictions(grasp), np.array(state.criteria.limits(grasp))
    kept = Grasp(_with_friction(c, mu) for c, mu in zip(grasp, frictions, strict=True))
    best = GraspState(kept, load, state.forces)
    rates = {
        name: rate + 0.0  # no -0.0
        for name, rate in value_rates(best, state.criteria, np.array(state.force_limits)).items()
    }
    # a cone's friction moves a soft finger's torsion along, the contact's does not
    arms = np.array([(c.torsion or 0.0) / (c.friction or 1.0) for c in grasp])
    share, shape = 1 - criteria.reserve, (len(grasp), 2) if grasp.dimension == 3 else (len(grasp),)
    friction = share * (rates["friction"] - arms * rates["torsion"])
    soft = np.array([c.torsion is not None for c in grasp])
    return Sensitivity(
        state,
        criteria.objective.value(best),
        read_only(np.where(grasp.frictions > 0, friction, nan)),
        read_only(rates["position"].reshape(shape)),
        read_only(rates["normal"].reshape(shape)),
        read_only(np.where(np.isfinite(limits), rates["limit"], nan)),
        read_only(rates["load"]),
        read_only(np.where(soft, share * rates["torsion"], nan)),
    )


def _with_friction(contact: Contact, friction: float) -> Contact:
    """The contact with what planning may use of its friction, and as much of its torsion."""
    if contact.torsion is None:
        return contact.changed(friction=friction)
    return contact.changed(friction=friction, torsion=contact.torsion * friction / contact.friction)

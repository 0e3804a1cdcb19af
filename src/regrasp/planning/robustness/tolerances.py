"""How far everything may be off: of a state, a transition or a whole regrasp."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import degrees, inf, pi
from types import MappingProxyType
from typing import TYPE_CHECKING, cast

import numpy as np

from regrasp.display import table
from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, ArrayLike, finite, instance, not_huge, number, read_only
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.robust.stiffness import Stiffness, checked_stiffness
from regrasp.mechanics.value import ArrayValue
from regrasp.planning.robustness.answered import Answered, some
from regrasp.planning.robustness.least_stiffness import least_stiffness
from regrasp.planning.robustness.planar import PlanarForces, planar_forces
from regrasp.planning.robustness.views import Subject, View, names_of, views_of
from regrasp.planning.robustness.withstood import (
    Failure,
    centre_distance,
    friction_factor,
    load_factor,
    offsets,
    tilt_angle,
)

if TYPE_CHECKING:
    import pandas

_REACH = 2.0
"""Positions are looked at within so many sizes of the grasp."""
_UNITS = {"friction": "-", "load": "-", "tilt": "rad", "centre": "m", "position": "m", "stiffness": "-"}


@dataclass(frozen=True, eq=False)
class Tolerated(ArrayValue):
    """How far each thing may be off by itself.

    Args:
        friction: the least factor on all coefficients, of soft fingers on their torsions, too [-].
        load: the largest factor of the load [-]; infinite where it has none.
        tilt: how far the load's force may turn, any way, its torque staying [rad]; pi for any direction.
        centre: how far the centre of mass may be off, across the load [m]; infinite without a force.
        position: (n,) how far each contact alone may be off along its tangents [m]; infinite where it never
            matters.
    """

    friction: float
    load: float
    tilt: float
    centre: float
    position: Array


@dataclass(frozen=True, eq=False, repr=False)
class Tolerances(ArrayValue):
    """What forces withstand, and what some forces could answer.

    Args:
        names: of the contacts that ``position`` counts.
        withstood: with set-points as they are, fingers answering with their stiffness.
        stiffness: the least factor of the stiffness given with which the object stays in its fingers; all
            alike at 1 N/m unless given otherwise, so the stiffness itself [N/m].
        first: by quantity, the finger that fails first, how and when.
        asked: what was asked, for the side that is worked out later.
    """

    names: tuple[str, ...]
    withstood: Tolerated
    stiffness: float
    first: Mapping[str, Failure]
    asked: "Asked" = field(compare=False)

    @cached_property
    def answered(self) -> Tolerated:
        """With forces chosen anew for whatever comes: an upper bound of what any controller can do.

        Worked out when it is asked for, by programs. Of a plan over at most 12 states; tilts, centres and
        positions in space in eight directions; of a disturbance over a hull's vertices, others are left out.
        """
        asked = self.asked
        found = [Answered(view, asked.base) for view in some(asked.views)]
        position = np.full(len(self.names), inf)
        for one in found:
            curvatures = asked.surface[[self.names.index(name) for name in one.names]]
            for i, name in enumerate(one.names):
                k = self.names.index(name)
                position[k] = min(position[k], one.position(i, curvatures, asked.reach))
        return Tolerated(
            max(one.friction() for one in found),
            min(one.load_factor() for one in found),
            min(one.tilt() for one in found),
            min(one.centre() for one in found),
            read_only(position),
        )

    def to_dataframe(self) -> "pandas.DataFrame":
        """A row for each quantity: withstood, answered, unit, and what fails first."""
        try:
            import pandas
        except ImportError:
            raise ImportError("to_dataframe needs pandas: pip install 'regrasp[pandas]'") from None
        rows = [
            (label, value, other, _UNITS[key], *self._failure(key))
            for key, label, value, other in self._rows()
        ]
        columns = ["quantity", "withstood", "answered", "unit", "finger", "how", "when"]
        return pandas.DataFrame(rows, columns=columns).set_index("quantity")

    def _repr_html_(self) -> str:
        """What is withstood, as a table for notebooks; ``answered`` is left out, since it takes seconds."""
        rows: list[list[object]] = []
        for key, unit in _UNITS.items():
            if key == "stiffness":
                rows.append([key, self.stiffness, unit, *self._failure(key)])
                continue
            values = np.ravel(getattr(self.withstood, key)).tolist()
            for name, value in zip(self.names if key == "position" else ("",), values, strict=True):
                words = f"{key} of {name}" if name else key
                rows.append([words, value if value < inf else "any", unit, *self._failure(key)])
        return table(["may be off", "withstood", "unit", "fails first", "how", "when"], rows)

    def _rows(self) -> list[tuple[str, str, float, float]]:
        mine, other = self.withstood, self.answered
        rows = [
            (key, key, getattr(mine, key), getattr(other, key))
            for key in ("friction", "load", "tilt", "centre")
        ]
        for k, name in enumerate(self.names):
            rows.append(
                ("position", f"position of {name}", float(mine.position[k]), float(other.position[k]))
            )
        return [*rows, ("stiffness", "stiffness", self.stiffness, float("nan"))]

    def _failure(self, key: str) -> tuple[str, str, str]:
        found = self.first.get(key)
        return ("", "", "") if found is None else (found.finger, found.how, found.when)

    def __str__(self) -> str:
        mine = self.withstood
        positions = ", ".join(
            f"{name} {length:.4g}" for name, length in zip(self.names, mine.position.tolist(), strict=True)
        )
        tilt = "any" if mine.tilt == pi else f"{degrees(mine.tilt):.4g} deg"
        lines = [
            ("friction", f"down to {mine.friction:.4g} times"),
            ("load", f"up to {mine.load:.4g} times"),
            ("tilt", tilt),
            ("centre", f"off by {mine.centre:.4g} m"),
            ("position", f"off by {positions} m"),
            ("stiffness", f"down to {self.stiffness:.4g}"),
        ]
        return "\n".join(
            ["withstood with stiffness:"]
            + [
                f"  {key:10}{words}" + (f"; {self.first[key]}" if key in self.first else "")
                for key, words in lines
            ]
        )

    def __repr__(self) -> str:
        return str(self)


@dataclass(frozen=True, eq=False)
class Asked(ArrayValue):
    """What was asked, for the side that is worked out later."""

    views: tuple[View, ...]
    base: LoadSet | None
    surface: Array
    reach: float


def tolerances(
    state_or_plan: Subject,
    *,
    disturbance: LoadSet | None = None,
    stiffness: ArrayLike | None = None,
    surface: ArrayLike | None = None,
    max_force: float | None = None,
    tip_radius: float = 0.0,
) -> Tolerances:
    """How far friction, load, contacts, centre of mass and stiffness may be off, each by itself.

    Of a plan the least of the states between which all others are combinations: forces that withstand one
    deviation are a convex set. Fingers that leave or arrive are force-controlled, as in docs/robustness.md.

    Args:
        state_or_plan: a ``GraspState``, a ``Transition`` or a regrasp.
        disturbance: load deviations that are withstood besides.
        stiffness: of the fingers that answer, as in ``Criteria``, by the contacts in play [N/m]; all alike if
            not given. Of a regrasp by the fingers in the order of the start.
        surface: curvature at the contacts [1/m], a number or (n,), positive where it bulges out: normals turn
            as a contact moves. Flat if not given.
        max_force: limit on every force besides the contacts' own [N]; that of a state's choice if not given.
        tip_radius: of fingertips that roll, for ``stiffness`` alone [m].

    Raises:
        InvalidInput: For bad input, and for a state that does not withstand the disturbance.
    """
    springs: Stiffness = checked_stiffness(stiffness)
    if disturbance is not None:
        instance(disturbance, "disturbance", LoadSet)
    not_huge(number(tip_radius, "tip_radius", least=0), "tip_radius")
    views = tuple(views_of(state_or_plan, springs, max_force))
    names = names_of(views)
    grasp = views[0].grasp
    if disturbance is not None and disturbance.dimension != grasp.dimension:
        raise InvalidInput(f"disturbance must have dimension {grasp.dimension}, got {disturbance.dimension}")
    curved = finite(0.0 if surface is None else surface, "surface")
    if curved.shape not in ((), (len(names),)):
        raise InvalidInput(f"surface must be one curvature or {len(names)}, got shape {curved.shape}")
    asked = Asked(
        views,
        disturbance,
        np.broadcast_to(curved, len(names)),
        _REACH * max(view.grasp.size for view in views),
    )
    if disturbance is None and not curved.any():
        forces = [planar_forces(view) for view in views]
        if None not in forces:
            return _in_closed_form(asked, names, cast(list[PlanarForces], forces), tip_radius)
    _refuse_what_gives(asked)
    parts = {
        "friction": friction_factor(views, disturbance),
        "load": load_factor(views, disturbance),
        "tilt": tilt_angle(views, disturbance),
        "centre": centre_distance(views, disturbance),
    }
    position, failing = offsets(views, names, disturbance, asked.surface, asked.reach)
    first = {key: failure for key, (_, failure) in parts.items() if failure is not None}
    if failing is not None:
        first["position"] = failing
    values = {key: value for key, (value, _) in parts.items()}
    kept = least_stiffness(state_or_plan, tip_radius, stiffness=stiffness)
    return Tolerances(
        names, Tolerated(**values, position=read_only(position)), kept, MappingProxyType(first), asked
    )


def _in_closed_form(
    asked: "Asked", names: tuple[str, ...], forces: Sequence[PlanarForces], tip_radius: float
) -> Tolerances:
    """The same of planar fingers on flat surfaces."""
    friction, others = (0.0, "", "", ""), dict.fromkeys(("load", "tilt", "centre"), (inf, "", "", ""))
    position, off = [inf] * len(names), (inf, "", "", "")
    for view, each in zip(asked.views, forces, strict=True):
        own = view.grasp.names
        used, k, how = each.friction()
        if used > friction[0]:
            friction = used, own[k], how, view.label
        for key, (value, k, how) in (
            ("load", each.largest_load()), ("tilt", each.tilt()), ("centre", each.centre()),
        ):  # fmt: skip
            if value < others[key][0]:
                others[key] = value, own[k], how, view.label
        for i, name in enumerate(own):
            finger = each.fingers[i]
            value, k, how = each.position(i) if finger.fx or finger.fy else (inf, 0, "")
            at = names.index(name)
            position[at] = min(position[at], value if value <= asked.reach else inf)
            if value <= asked.reach and value < off[0]:
                off = value, own[k], how, view.label
    found = {"friction": friction, **others, "position": off}
    first = {key: Failure(*rest) for key, (_, *rest) in found.items() if rest[1]}
    kept = max(each.least_stiffness(tip_radius) for each in forces)
    load, tilt, centre = (others[key][0] for key in ("load", "tilt", "centre"))
    withstood = Tolerated(friction[0], load, tilt, centre, read_only(np.array(position)))
    return Tolerances(names, withstood, kept, MappingProxyType(first), asked)


def _refuse_what_gives(asked: Asked) -> None:
    for view in asked.views:
        spare = view.withstanding(asked.base).spare()
        i = int(spare.argmin())
        size = float(np.abs(view.state.forces).max())
        if spare[i] < -1e-9 * size:
            at = f"{view.label}: " if view.label else ""
            what = "" if asked.base is None else ", disturbance included,"
            raise InvalidInput(
                f"{at}the force of {view.grasp.names[i]} is outside its cone or limit{what} by "
                f"{-spare[i]:.3g} N, so nothing may be off; balance the state, or give a smaller disturbance"
            )

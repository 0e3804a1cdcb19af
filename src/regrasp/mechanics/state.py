"""Forces of a grasp under a load."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from math import dist, hypot, isfinite
from operator import mul
from typing import Any

import numpy as np

from regrasp.display import table
from regrasp.errors import Infeasible, InvalidInput, shown
from regrasp.mechanics.balance import EQUILIBRIUM, nearest_equilibrium
from regrasp.mechanics.checks import LARGEST, Array, ArrayLike, array, not_huge, read_only
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.margins import COLUMNS, IDLE, Margins, margins
from regrasp.mechanics.plain import entries
from regrasp.mechanics.reserve import RESERVE, kept_force, kept_friction, reserve_fraction
from regrasp.mechanics.value import ArrayValue, numbers
from regrasp.mechanics.wrench import Wrench

# Rounding of a tangential force, as a fraction of the force.
_ROUNDING = 2.0**-50


@dataclass(frozen=True, eq=False, repr=False)
class GraspState(ArrayValue):
    """A grasp, the load on the object and the finger forces, taken as they are.

    Nothing is corrected: ``residual`` says how far G f + w_ext is from zero and ``margins`` how far each
    force is inside its cone; ``balanced()`` is the nearest state in equilibrium inside the cones.

    Args:
        grasp: the n contacts.
        load: external wrench on the object about its centre of mass, object frame [N, N m].
        forces: (n, d) [N], force of each finger **on the object**, object frame; (n, 4) where a finger is
            soft, the last number its torque about the normal [N m], 0 for point contacts.
    """

    grasp: Grasp
    load: Wrench
    forces: Array

    def __init__(self, grasp: Grasp, load: Wrench, forces: ArrayLike) -> None:
        if not isinstance(grasp, Grasp):
            raise InvalidInput(f"grasp must be a Grasp, got {shown(grasp)}")
        _check_dimension(grasp, load)
        object.__setattr__(self, "grasp", grasp)
        object.__setattr__(self, "load", load)
        given = array(forces, "forces", (len(grasp), grasp.width))
        if grasp.torsions is not None and given[grasp.torsions == 0, 3].any():
            raise InvalidInput(
                f"forces: point contacts make no torque about their normals, got {shown(forces)}"
            )
        object.__setattr__(self, "forces", given)

    def to_dict(self) -> dict[str, Any]:
        """The state as plain data, which JSON can hold; ``from_dict`` gives back the equal state.

        Of a state that was chosen it is the state, without the record of its choice.
        """
        return {
            "grasp": self.grasp.to_dict(),
            "load": self.load.to_dict(),
            "forces": self.forces.tolist(),
        }

    @staticmethod
    def from_dict(data: Mapping[str, Any]) -> "GraspState":
        """The state of plain data.

        Args:
            data: what ``to_dict`` returned, or JSON made of it.

        Raises:
            InvalidInput: For other keys and as ``GraspState`` does.
        """
        given = entries(data, "a state", ("grasp", "load", "forces"))
        return GraspState(Grasp.from_dict(given["grasp"]), Wrench.from_dict(given["load"]), given["forces"])

    @cached_property
    def wrenches(self) -> Array:
        """w_i = (f_i, r_i x f_i), (n, 3) in the plane, (n, 6) in space [N, N m]."""
        return read_only(self.grasp.wrenches(self.forces))

    @cached_property
    def imbalance(self) -> Array:
        """G f + w_ext, (3,) or (6,) [N, N m]; zero in equilibrium."""
        grasp, forces, load = self.grasp, self.forces.ravel(), self.load
        given = (*forces.tolist(), *load.plain)
        if min(given) >= -LARGEST and max(given) <= LARGEST and not grasp.out_of_range:
            return read_only(grasp.matrix.dot(forces) + load.vector)
        with np.errstate(over="ignore", invalid="ignore"):  # which takes longer than the rest
            return read_only(grasp.matrix.dot(forces) + load.vector)

    @property
    def residual(self) -> float:
        """Norm of G f + w_ext, force and torque in the units given."""
        return hypot(*self.imbalance.tolist())

    @cached_property
    def margins(self) -> Margins:
        """Margins of each contact, arrays of shape (n,)."""
        unit = float(np.abs(self.forces).max())
        unit = unit if unit > LARGEST else 1.0
        with np.errstate(over="ignore", invalid="ignore"):
            cones = self.grasp.cones
            found = margins(cones.measured(self.forces / unit), cones.normals, self.grasp.frictions)
        return found if unit == 1 else replace(found, force=read_only(unit * found.force))

    @property
    def magnitudes(self) -> Array:
        """|f_i|, (n,) [N]."""
        result: Array = np.sqrt((self.forces[:, : self.grasp.dimension] ** 2).sum(axis=1))
        return result

    @property
    def in_use(self) -> tuple[str, ...]:
        """Names of the contacts that carry force."""
        magnitudes = self.magnitudes
        used = magnitudes > IDLE * magnitudes.max()
        return tuple(name for name, yes in zip(self.grasp.names, used, strict=True) if yes)

    def force(self, contact: str | int) -> Array:
        """(d,) force of one finger, by name or index [N]; (4,) in a grasp with soft fingers.

        Args:
            contact: name or index.
        """
        force: Array = self.forces[self.grasp.index(contact)]
        return force

    def without(self, contact: str | int) -> "GraspState":
        """The state seen without one contact and its force.

        Args:
            contact: name or index.
        """
        gone = self.grasp.index(contact)
        return GraspState(self.grasp.without(gone), self.load, np.delete(self.forces, gone, axis=0))

    def is_balanced(self, *, reserve: float = RESERVE) -> bool:
        """Whether this is an equilibrium to rounding, inside the cones and limits less the reserve.

        Judged once for each reserve, so that many plans may start from one state.

        Args:
            reserve: fraction of every friction coefficient that is kept back [-].
        """
        verdicts = self._verdicts
        if type(reserve) is float and reserve in verdicts:  # checked before
            return verdicts[reserve]
        reserve = reserve_fraction(reserve)
        verdicts[reserve] = self._judged(reserve)
        return verdicts[reserve]

    @cached_property
    def _verdicts(self) -> dict[float, bool]:
        return {}

    def _judged(self, reserve: float) -> bool:
        d, contacts, load = self.grasp.dimension, self.grasp.contacts, self.load.plain
        rows, total = self.grasp.cones.measured(self.forces).tolist(), self.imbalance.tolist()
        more = [0.0] * (self.grasp.width - d)
        magnitudes = [hypot(*f) for f in rows]
        largest = max(*magnitudes, hypot(*load[:d]))
        torques = max(largest * self.grasp.size, hypot(*load[d:]))
        if not (hypot(*total[:d]) <= EQUILIBRIUM * largest and hypot(*total[d:]) <= EQUILIBRIUM * torques):
            return False
        for contact, f, magnitude in zip(contacts, rows, magnitudes, strict=True):
            n = contact.plain[d : 2 * d]
            normal = sum(map(mul, f, n))
            tangential = dist(f, [*[normal * along for along in n], *more])
            edge = kept_friction(contact.friction, reserve) * normal + _ROUNDING * magnitude
            if normal < 0 or tangential > edge:
                return False
            if contact.max_force is not None and magnitude > contact.max_force:
                return False
        return self.grasp.limit_rows is None or self.grasp.limit_rows.kept(np.array(rows))

    def balanced(self, *, reserve: float = RESERVE) -> "GraspState":
        """The nearest state in equilibrium inside the cones and force limits.

        Least change of all forces together, sum |f_i - f_i given|^2. ``reserve`` is the fraction of every
        friction coefficient kept back. A state that is balanced already is returned as it is. Where the
        nearest state breaks linear limits of contacts it is refused: ``choose_state`` keeps them.

        Args:
            reserve: fraction of every friction coefficient that is kept back [-].

        Raises:
            Infeasible: When none is found; it proves nothing. ``choose_state`` finds some state, or a proof.
        """
        if self.is_balanced(reserve=reserve):  # checks it
            return self
        not_huge(self.forces, "forces to be balanced")
        not_huge(self.load.vector, "load")
        grasp = self.grasp
        forces = nearest_equilibrium(
            grasp.cones.measured(self.forces),
            grasp.cones.matrix,
            self.load.vector,
            grasp.cones.normals,
            np.array([kept_friction(c.friction, reserve) for c in grasp]),
            np.array([kept_force(limit, reserve) for limit in grasp.max_forces]),
            grasp.size or 1.0,
        )
        if forces is None:
            raise Infeasible(
                f"no forces of {', '.join(grasp.names)} inside their friction cones and force limits "
                f"that balance {shown(self.load)} were found near these, which is no proof that there are "
                f"none; choose_state finds some forces, or proves that there are none"
            )
        if grasp.limit_rows is not None and not grasp.limit_rows.kept(forces):
            i = int(grasp.limit_rows.spare(forces).argmin())
            raise Infeasible(
                f"the nearest forces inside the friction cones and force limits break the linear limits of "
                f"{grasp.names[i]}, and others are not looked for; choose_state finds forces that keep them"
            )
        return GraspState(grasp, self.load, grasp.cones.forces(forces))

    def _repr_html_(self) -> str:
        """The forces and margins of every contact as a table, for notebooks."""
        axes = [f"f{axis} [N]" for axis in "xyz"[: self.grasp.dimension]]
        if self.forces.shape[1] > self.grasp.dimension:
            axes.append("torque about the normal [N m]")
        head = ["finger", *axes, *COLUMNS]
        rows = [
            [name, *force, *margin]
            for name, force, margin in zip(
                self.grasp.names, self.forces.tolist(), self.margins.rows(), strict=True
            )
        ]
        return table(head, rows, f"under {self.load!r}, residual {self.residual:.2g}")

    def __repr__(self) -> str:
        rows = "".join(
            f"\n  {name}: force {numbers(force)}"
            for name, force in zip(self.grasp.names, self.forces, strict=True)
        )
        free = self.grasp.freedom
        note = "" if free is None else f"\n  no force of these contacts resists {free}"
        return f"GraspState under {self.load!r}, residual {self.residual:.2g}:{rows}{note}"


def state_of(grasp: Grasp, load: Wrench, rows: list[list[float]]) -> GraspState:
    """The state of forces worked out for this grasp and load; all that is checked is that they are finite."""
    if not isfinite(sum(map(sum, rows))):
        return GraspState(grasp, load, rows)
    state = object.__new__(GraspState)
    vars(state).update(grasp=grasp, load=load, forces=read_only(np.array(rows, dtype=float)))
    return state


def check_load(grasp: Grasp, load: Wrench) -> None:
    """Raise ``InvalidInput`` unless ``load`` is a wrench of the grasp's dimension that can be worked with."""
    _check_dimension(grasp, load)
    if beyond := grasp.out_of_range:
        raise InvalidInput(beyond)
    if max(map(abs, load.plain)) > LARGEST:
        not_huge(max(load.plain, key=abs), "load")


def _check_dimension(grasp: Grasp, load: Wrench) -> None:
    if not isinstance(grasp, Grasp):
        raise InvalidInput(f"grasp must be a Grasp, got {shown(grasp)}")
    if not isinstance(load, Wrench):
        raise InvalidInput(f"load must be a Wrench, got {shown(load)}; write Wrench(force=[...])")
    if load.dimension != grasp.dimension:
        raise InvalidInput(f"load must have the grasp's dimension {grasp.dimension}, got {load.dimension}")

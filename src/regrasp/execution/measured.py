"""What physics made of a plan."""

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from regrasp.display import Pictured
from regrasp.execution.setup import Setup
from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.margins import Margins, margins
from regrasp.mechanics.value import ArrayValue
from regrasp.plans.regrasp_plan import RegraspPlan
from regrasp.plans.transition import Transition

if TYPE_CHECKING:
    import pandas

IN_USE = 0.01
"""A finger with less than this part of the largest force holds nothing: it may slip, and has no margins."""
SLIPPED = 3e-4
"""A contact that slid by more than this part of the object's size has slipped."""


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Execution(ArrayValue, Pictured):
    """A plan as MuJoCo carried it out: m samples, n contacts, k fingers; measured against planned.

    times: (m,) of the run, from its start [s]. clock: (m,) the plan's own time, which stands while fingers
    change places [s]. frictions: (n,) the true coefficients.
    planned, forces: (m, n, d) of the fingers on the object, each in the object's own frame [N].
    planned_torques, torques: (m, n) about the normals, of soft fingers [N m].
    touching: (m, n). slip: (m, n) how far the finger at a contact has slid since it touched, rolling apart;
    a soft finger's spin counts by torsion over friction [m].
    positions: (m, d) of the centre of mass, planned at rest [m]. rotations, turned: (m, d, d) of the object,
    measured and planned. tips: (m, k, d) centres of the fingertips [m]. mass, stiffness: of the object and of
    each finger, as given or derived. complete: whether the run came to its
    end; one that drops the object stops there.
    """

    plan: Transition | RegraspPlan
    setup: Setup
    contacts: tuple[Contact, ...]
    frictions: Array
    times: Array
    clock: Array
    planned: Array
    forces: Array
    planned_torques: Array
    torques: Array
    touching: NDArray[np.bool_]
    positions: Array
    rotations: Array
    turned: Array
    slip: Array
    tips: Array
    mass: float
    stiffness: float
    complete: bool

    _drawn_by = "regrasp.plots.over_time.execution:execution_png"

    @property
    def names(self) -> tuple[str, ...]:
        """Of the contacts, in the order of their first use."""
        return tuple(str(c.name) for c in self.contacts)

    @property
    def dropped(self) -> bool:
        """Whether the object moved by half its size."""
        return not self.complete

    @property
    def held(self) -> bool:
        """Whether nothing was dropped, no contact in use was lost, and none slipped."""
        return self.complete and not self.slipped and not self.lost

    @cached_property
    def slipped(self) -> tuple[str, ...]:
        """Contacts that slid by more than 3e-4 of the object's size while they carried force."""
        far = self.slip.max(axis=0) > SLIPPED * self._size
        return tuple(name for name, slid in zip(self.names, far, strict=True) if slid)

    @cached_property
    def lost(self) -> tuple[str, ...]:
        """Contacts that did not touch while the plan has a force for them."""
        gone = np.any(self._in_use(self.planned) & ~self.touching, axis=0).tolist()
        return tuple(name for name, was in zip(self.names, gone, strict=True) if was)

    @cached_property
    def drift(self) -> Array:
        """(m,) how far the centre of mass is from where it should be [m]."""
        result: Array = np.linalg.norm(self.positions, axis=1)
        return result

    @cached_property
    def tilt(self) -> Array:
        """(m,) the angle between the object and its planned orientation [rad]."""
        R = np.einsum("mij,mkj->mik", self.rotations, self.turned)
        if R.shape[1] == 2:
            return abs(np.arctan2(R[:, 1, 0], R[:, 0, 0]))
        sine = np.stack([R[:, 2, 1] - R[:, 1, 2], R[:, 0, 2] - R[:, 2, 0], R[:, 1, 0] - R[:, 0, 1]], axis=1)
        result: Array = np.arctan2(np.linalg.norm(sine, axis=1), np.trace(R, axis1=1, axis2=2) - 1)
        return result

    @property
    def error(self) -> float:
        """Root mean square of measured less planned forces, over the largest planned force [-]."""
        away = np.linalg.norm(self.forces - self.planned, axis=2)
        return float(np.sqrt((away**2).mean()) / self._peak)

    @cached_property
    def margins(self) -> Margins:
        """(m, n) of the measured forces under the true friction; NaN for contacts that hold nothing."""
        return self._margins(self.forces, self.torques)

    @cached_property
    def planned_margins(self) -> Margins:
        """(m, n) of the planned forces under the true friction."""
        return self._margins(self.planned, self.planned_torques)

    def to_dataframe(self) -> "pandas.DataFrame":
        """A row for each sample: clock, motion, and for each contact planned and measured force, and slip."""
        try:
            import pandas
        except ImportError:
            raise ImportError("to_dataframe needs pandas: pip install 'regrasp[pandas]'") from None
        return pandas.DataFrame(self.columns(), index=pandas.Index(self.times, name="t"))

    def columns(self) -> dict[str, Array]:
        """The table by columns: clock [s], drift [m], tilt [rad]; of each contact forces [N], slip [m]."""
        axes = "xyz"[: self.positions.shape[1]]
        columns: dict[str, Array] = {"clock": self.clock, "drift": self.drift, "tilt": self.tilt}
        for i, name in enumerate(self.names):
            for a, axis in enumerate(axes):
                columns[f"{name}_planned_f{axis}"] = self.planned[:, i, a]
                columns[f"{name}_f{axis}"] = self.forces[:, i, a]
            if self.contacts[i].torsion is not None:
                columns[f"{name}_planned_mn"] = self.planned_torques[:, i]
                columns[f"{name}_mn"] = self.torques[:, i]
            columns[f"{name}_slip"] = self.slip[:, i]
        return columns

    @cached_property
    def _size(self) -> float:
        return float(max(np.linalg.norm(c.position) for c in self.contacts))

    @cached_property
    def _peak(self) -> float:
        return float(np.linalg.norm(self.planned, axis=2).max())

    def _in_use(self, forces: Array) -> NDArray[np.bool_]:
        carried: NDArray[np.bool_] = np.linalg.norm(forces, axis=2) > IN_USE * self._peak
        return carried

    def _margins(self, forces: Array, torques: Array) -> Margins:
        cones = Grasp(self.contacts).cones
        whole = forces if cones.normals.shape[1] < 4 else np.concatenate([forces, torques[..., None]], axis=2)
        in_use = np.where(self._in_use(forces)[..., None], whole, 0.0)
        return margins(cones.measured(in_use), cones.normals, self.frictions)

    def __str__(self) -> str:
        if self.dropped:
            verdict = f"dropped after {self.times[-1]:.4g} s"
        elif self.slipped or self.lost:
            said = [("slips at", self.slipped), ("loses", self.lost)]
            verdict = ", ".join(f"{what} {', '.join(names)}" for what, names in said if names)
        else:
            verdict = "holds"
        lines = [
            f"{verdict}, true friction {', '.join(f'{mu:.4g}' for mu in np.unique(self.frictions))}, "
            f"the plan needs {self.plan.friction_needed:.4g}; mass {self.mass:.4g}, "
            f"stiffness {self.stiffness:.4g}",
            f"drift {self.drift.max():.2g}, tilt {np.degrees(self.tilt.max()):.2g} deg, forces off by "
            f"{100 * self.error:.2g} % of the largest (root mean square)",
            f"{'':8}{'largest slip':>14}{'planned margin':>16}{'measured margin':>17}",
        ]
        planned, measured = (np.degrees(m.angle) for m in (self.planned_margins, self.margins))
        for i, name in enumerate(self.names):
            angles = [np.fmin.reduce(a[:, i]) for a in (planned, measured)]
            shown = ["" if np.isnan(a) else f"{a:.2f} deg" for a in angles]
            lines.append(f"{name:8}{self.slip[:, i].max():>14.2g}{shown[0]:>16}{shown[1]:>17}")
        return "\n".join(lines)

    __repr__ = __str__

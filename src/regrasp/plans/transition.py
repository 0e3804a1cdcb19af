"""A transition between two equilibria: Eq. 1-3 as a value."""

from dataclasses import dataclass, field, replace
from math import degrees
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from regrasp.closed_form.straight_path import straight_path
from regrasp.display import Pictured
from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, instance, number
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.margins import Margins, margins
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.value import ArrayValue
from regrasp.plans.course import Course
from regrasp.plans.document import Documented
from regrasp.plans.timing import TimeScaling
from regrasp.plans.turn import Turn

if TYPE_CHECKING:
    import pandas


_BACKWARDS: dict[str, Any] = {
    "removal": "addition",
    "addition": "removal",
    "rotation": "rotation",
    "exchange": "exchange",
}


# Whether a kind names the finger of ``contact``, and that of ``arrival``.
_FINGERS = {
    "removal": (True, False),
    "addition": (True, False),
    "rotation": (False, False),
    "exchange": (True, True),
}


@dataclass(frozen=True)
class Choice:
    """How one end of a plan was chosen.

    end: which one. objective: what for. method: ``closed-form`` or the back end.
    force_limits: one per contact in use [N], those set by ``peak_ratio`` included; infinite for none.
    """

    end: Literal["start", "end"]
    objective: str
    method: str
    force_limits: tuple[float, ...]


@dataclass(frozen=True)
class Record:
    """What a plan decided by itself.

    reserve: fraction of every friction coefficient kept back. choices: the ends that were not given.
    balancing: largest change of a given force to reach exact equilibrium [N].
    path: ``closed-form`` for Eq. 1-3, or the back end that planned the instants; path_objective: what for.
    rate_limits [N/s] of a path through instants, least_normals [N]: one for each contact; empty for none.
    """

    reserve: float
    choices: tuple[Choice, ...] = ()
    balancing: float = 0.0
    path: str = "closed-form"
    path_objective: str | None = None
    rate_limits: tuple[float, ...] = ()
    least_normals: tuple[float, ...] = ()


@dataclass(frozen=True, eq=False, repr=False)
class Transition(ArrayValue, Documented, Pictured):
    """Finger forces that carry a grasp from one equilibrium to another while one finger leaves or arrives.

        f(t) = f_end + (f_start - f_end) T(t)

    With fixed contacts and load the equilibrium forces inside the cones are a convex set, so both ends
    being in it proves every instant (fact 1); ``regrasp.verify`` checks them in exact arithmetic.

    A path that is not straight is a ``SampledTransition``, which answers the same questions.

    kind: ``removal``, ``addition``, ``rotation`` or ``exchange``. contact: the finger that leaves or arrives,
    idle at that end; of an exchange the one that leaves; None for a rotation. arrival: of an exchange, the
    finger that arrives.
    start, end: states of one grasp, every contact in play, under one load. course: None.
    """

    kind: Literal["removal", "addition", "rotation", "exchange"]
    contact: str | None
    start: GraspState
    end: GraspState
    scaling: TimeScaling
    record: Record
    course: Course | None = field(default=None, kw_only=True)
    arrival: str | None = field(default=None, kw_only=True)
    turn: Turn | None = field(default=None, kw_only=True)

    _drawn_by = "regrasp.plots.pages.overview:transition_png"

    def __post_init__(self) -> None:
        if self.start.grasp != self.end.grasp:
            raise InvalidInput("both ends of a transition must have the same grasp")
        wanted = _FINGERS.get(self.kind)
        if wanted is None:
            raise InvalidInput(f"kind must be one of {', '.join(_FINGERS)}, got {self.kind!r}")
        if wanted != (self.contact is not None, self.arrival is not None):
            article = "an" if self.kind[0] in "ae" else "a"
            raise InvalidInput(
                f"{article} {self.kind} names the wrong fingers: {self.contact!r} and {self.arrival!r}"
            )
        if self.contact is not None:
            self.grasp.index(self.contact)
        if self.arrival is not None:
            self.grasp.index(self.arrival)
        self._check()

    @property
    def idle_at_start(self) -> tuple[str, ...]:
        """Names of the fingers that carry no force at the start: the one that arrives."""
        name = {"addition": self.contact, "exchange": self.arrival}.get(self.kind)
        return () if name is None else (name,)

    @property
    def idle_at_end(self) -> tuple[str, ...]:
        """Names of the fingers that carry no force at the end: the one that leaves."""
        name = self.contact if self.kind in ("removal", "exchange") else None
        return () if name is None else (name,)

    def _check(self) -> None:
        if self.start.load != self.end.load:
            raise InvalidInput("both ends of a straight path must have the same load")
        if self.course is not None or self.turn is not None:
            raise InvalidInput("a straight path has no course and no turn; those are of other transitions")

    @property
    def grasp(self) -> Grasp:
        """Every contact in play."""
        return self.start.grasp

    @property
    def duration(self) -> float:
        """[s]."""
        return self.scaling.duration

    def forces(self, t: ArrayLike) -> Array:
        """Finger forces (n, d) at a time, (m, n, d) at m times [N]; times in [0, duration] [s]."""
        return straight_path(self.start.forces, self.end.forces, self.scaling(t))

    def wrenches(self, t: ArrayLike) -> Array:
        """Finger wrenches (n, 3) or (m, n, 3), Eq. 1-3 [N, N m]; (…, 6) in space."""
        return straight_path(self.start.wrenches, self.end.wrenches, self.scaling(t))

    def rates(self, t: ArrayLike) -> Array:
        """Force rates f'(t) = (f_start - f_end) T'(t), (n, d) or (m, n, d) [N/s]."""
        slope = self.scaling.velocity(t)
        result: Array = slope[..., None, None] * (self.start.forces - self.end.forces)
        return result

    @property
    def load_varies(self) -> bool:
        """Whether the load is not the same at every instant."""
        return False

    @property
    def steepest(self) -> Array:
        """(n,) the fastest change of each force over the whole path, max |f_i'(t)| [N/s]."""
        moved: Array = np.linalg.norm(self._change, axis=1)
        return self.scaling.steepest * moved

    @property
    def _change(self) -> Array:
        """(n, d) from the end to the start, forces alone [N]."""
        change: Array = (self.start.forces - self.end.forces)[:, : self.grasp.dimension]
        return change

    def load(self, t: ArrayLike) -> Array:
        """The load (3,) or (m, 3) in the object frame, constant here [N, N m]; (…, 6) in space."""
        times = self.scaling(t)  # checks the times
        return np.broadcast_to(self.start.load.vector, (*times.shape, self.start.load.vector.size))

    def orientation(self, t: ArrayLike) -> Array:
        """The object's angle from the start [rad], counter-clockwise; zero here."""
        return np.zeros_like(self.scaling(t))

    def margins(self, t: ArrayLike) -> Margins:
        """Margins of every contact, (n,) or (m, n); NaN where a contact carries no force."""
        cones = self.grasp.cones
        return margins(cones.measured(self.forces(t)), cones.normals, self.grasp.frictions)

    def times(self, rate: float) -> Array:
        """Sampling times [s] at ``rate`` per second, both ends included."""
        # Less a little, so that rounding of the product adds no second sample at the end.
        count = max(1, int(np.ceil(self.duration * number(rate, "rate", above=0) * (1 - 1e-12))))
        times = np.arange(count + 1) / rate
        times[-1] = self.duration
        return times

    def reversed(self) -> "Transition":
        """The same path run backwards: a removal becomes an addition."""
        choices = tuple(replace(c, end="end" if c.end == "start" else "start") for c in self.record.choices)
        return self._reversed(
            kind=_BACKWARDS[self.kind],
            contact=self.contact if self.arrival is None else self.arrival,
            arrival=None if self.arrival is None else self.contact,
            start=self.end,
            end=self.start,
            scaling=self.scaling.reversed(),
            record=replace(self.record, choices=choices),
        )

    def _reversed(self, **changes: Any) -> "Transition":
        return replace(self, **changes)

    def retimed(self, scaling: TimeScaling) -> "Transition":
        """The same path under another time function."""
        instance(scaling, "scaling", TimeScaling)
        return replace(self, scaling=scaling)

    def fastest(self, rate_limit: ArrayLike) -> "Transition":
        """The same path and shape in the least time with |f_i'(t)| <= rate_limit, a number or (n,) [N/s]."""
        return self.retimed(TimeScaling.fastest(self._change, rate_limit, self.scaling))

    def to_dataframe(self, rate: float = 1000.0) -> "pandas.DataFrame":
        """Set-points as a table: index t [s], a column ``<name>_fx`` ... per contact and axis [N]."""
        try:
            import pandas
        except ImportError:
            raise ImportError("to_dataframe needs pandas: pip install 'regrasp[pandas]'") from None
        t = self.times(rate)
        columns = setpoint_columns(self.grasp)
        return pandas.DataFrame(
            self.forces(t).reshape(t.size, -1), index=pandas.Index(t, name="t"), columns=columns
        )

    def __str__(self) -> str:
        lines = [
            f"{self._kind_in_words()} in {self.duration:g} s under {self._load_in_words()}",
            f"{'':8}{'start force':>24}{'end force':>24}{'least margin':>14}",
        ]
        cones, forces = self.grasp.cones, self._deciding_forces()
        angles = margins(cones.measured(forces), cones.normals, self.grasp.frictions).angle
        largest = max(self.start.magnitudes.max(), self.end.magnitudes.max())
        form = "10.4f" if 0.1 <= largest < 1e5 or largest == 0 else "11.3e"  # any units, readable in newtons
        for i, name in enumerate(self.grasp.names):
            start, end = (
                " ".join(format(x + 0.0, form) for x in s.forces[i]) for s in (self.start, self.end)
            )
            margin = np.fmin.reduce(angles[:, i])
            shown = "" if np.isnan(margin) else f"{degrees(margin):8.2f} deg"
            lines.append(f"{name:8}{start:>24}{end:>24}{shown:>14}")
        for c in self.record.choices:
            limits = ", ".join(f"{limit:.4g}" for limit in c.force_limits)
            lines.append(f"{c.end} chosen for {c.objective} by {c.method}, force limits {limits}")
        for label, idle in (("start", self.idle_at_start), ("end", self.idle_at_end)):
            held = [name for name in self.grasp.names if name not in idle]
            free = self.grasp.subset(held).freedom
            if free is not None:
                lines.append(f"at the {label} no force of {', '.join(held)} resists {free}")
        lines += self._path_in_words()
        if self.record.balancing:
            lines.append(f"given forces were balanced; largest change {self.record.balancing:.2g}")
        return "\n".join(lines)

    __repr__ = __str__

    def _deciding_forces(self) -> Array:
        """(m, n, d) forces whose least margins are those of the whole path: of a straight one both ends'."""
        return np.stack([self.start.forces, self.end.forces])

    def _kind_in_words(self) -> str:
        if self.kind == "rotation":
            return self.kind
        return f"{self.kind} of {self.contact}" + (f" for {self.arrival}" if self.arrival else "")

    def _load_in_words(self) -> str:
        return repr(self.start.load)

    def _path_in_words(self) -> list[str]:
        return []


def setpoint_columns(grasp: Grasp) -> list[str]:
    """Column names of set-points: ``<name>_fx``, ``<name>_fy``[, ``<name>_fz``] per contact.

    With soft fingers ``<name>_mn``, too, the torque about the normal.
    """
    kinds = ("fx", "fy", "fz", "mn")[: grasp.width]
    return [f"{name}_{kind}" for name in grasp.names for kind in kinds]

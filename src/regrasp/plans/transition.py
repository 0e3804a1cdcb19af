"""A transition between two equilibria: Eq. 1-3 as a value."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from regrasp.display import Pictured
from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, instance, limits, number
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.margins import Margins, margins
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.value import ArrayValue
from regrasp.plans.document import Documented
from regrasp.plans.path import Path
from regrasp.plans.record import Record
from regrasp.plans.sampled import SampledPath
from regrasp.plans.straight import STRAIGHT
from regrasp.plans.timing import TimeScaling
from regrasp.plans.turning import TurningPath

if TYPE_CHECKING:
    import pandas

_LARGEST = float(np.finfo(float).max)
_SHORT = 1e-3  # [s]: forces above 1e300 N apart, no rate is too large in more time


@dataclass(frozen=True, eq=False, repr=False)
class Transition(ArrayValue, Documented, Pictured):
    """Finger forces that carry a grasp from one equilibrium to another while fingers leave or arrive.

        f(t) = f_end + (f_start - f_end) T(t)

    With fixed contacts and load the equilibrium forces inside the cones are a convex set, so both ends
    being in it proves every instant (fact 1); ``regrasp.verify`` checks them in exact arithmetic.

    Args:
        start: the state at the start, of every contact in play.
        end: the state at the end, of the same grasp.
        scaling: the clock T(t).
        record: what the ends were chosen for, and under which limits.
        leaving: names of the fingers that carry no force at the end.
        arriving: names of the fingers that carry no force at the start. With neither the object turns in its
            hold, or only the forces change.
        path: what lies between the ends: a ``StraightPath``, a ``SampledPath`` through instants, or a
            ``TurningPath`` of the object.
    """

    start: GraspState
    end: GraspState
    scaling: TimeScaling
    record: Record
    leaving: tuple[str, ...] = ()
    arriving: tuple[str, ...] = ()
    path: Path = STRAIGHT

    _drawn_by = "regrasp.plots.pages.overview:transition_png"

    def __post_init__(self) -> None:
        one, other = self.start.grasp, self.end.grasp
        if one is not other and one != other:
            raise InvalidInput("both ends of a transition must have the same grasp")
        for label, names in (("leaving", self.leaving), ("arriving", self.arriving)):
            if not isinstance(names, tuple) or len(set(names)) != len(names):
                raise InvalidInput(f"{label} must be a tuple of different contact names, got {shown(names)}")
            for name in names:
                self.start.grasp.index(name)
        both = [name for name in self.leaving if name in self.arriving]
        if both:
            raise InvalidInput(f"a finger leaves or arrives, not both: {', '.join(both)}")
        if self.path is not STRAIGHT and not isinstance(self.path, Path):
            raise InvalidInput(
                f"path must be a StraightPath, a SampledPath or a TurningPath, got {shown(self.path)}"
            )
        self.path.check(self.start, self.end, self.scaling)
        if self.duration < _SHORT:
            self._refuse_endless_rates()

    def _refuse_endless_rates(self) -> None:
        """|T'| of a B-spline is at most (number of control values)^2 over the duration."""
        largest = max(1.0, float(abs(self.start.forces).max()), float(abs(self.end.forces).max()))
        if self.duration * (_LARGEST / largest) < len(self.scaling.control) ** 2:
            raise InvalidInput(
                f"forces up to {largest:.3g} N cannot change within {self.duration:.3g} s at a finite rate; "
                f"give a longer duration"
            )

    @property
    def kind(self) -> str:
        """``removal``, ``addition``, ``exchange``, ``rotation`` (of the object alone) or ``hold``."""
        if self.leaving:
            return "exchange" if self.arriving else "removal"
        if self.arriving:
            return "addition"
        return "rotation" if self.turn is not None else "hold"

    @property
    def contact(self) -> str | None:
        """The finger that leaves, the first of several; the one that arrives where none leaves; or None."""
        return next(iter((*self.leaving, *self.arriving)), None)

    @property
    def arrival(self) -> str | None:
        """Of an exchange, the finger that arrives, the first of several; or None."""
        return self.arriving[0] if self.leaving and self.arriving else None

    @property
    def course(self) -> SampledPath | None:
        """The path through instants, if it is one."""
        return self.path if isinstance(self.path, SampledPath) else None

    @property
    def turn(self) -> TurningPath | None:
        """The turn of the object, if it turns."""
        return self.path if isinstance(self.path, TurningPath) else None

    @property
    def idle_at_start(self) -> tuple[str, ...]:
        """Names of the fingers that carry no force at the start: those that arrive."""
        return self.arriving

    @property
    def idle_at_end(self) -> tuple[str, ...]:
        """Names of the fingers that carry no force at the end: those that leave."""
        return self.leaving

    @property
    def grasp(self) -> Grasp:
        """Every contact in play."""
        return self.start.grasp

    @property
    def duration(self) -> float:
        """[s]."""
        return self.scaling.duration

    def _place(self, t: ArrayLike) -> Array:
        """The path's parameter at times in [0, duration] [s]."""
        clock = self.scaling(t)  # checks the times
        return np.asarray(t, dtype=float) if self.path.timed else clock

    def forces(self, t: ArrayLike) -> Array:
        """Finger forces (n, d) at a time, (m, n, d) at m times in [0, duration] [s]; object frame [N].

        Args:
            t: a time or (m,) times in [0, duration] [s].
        """
        return self.path.forces_at(self.start, self.end, self._place(t))

    def wrenches(self, t: ArrayLike) -> Array:
        """Finger wrenches (n, 3) or (m, n, 3), object frame, Eq. 1-3 [N, N m]; (…, 6) in space.

        Args:
            t: a time or (m,) times in [0, duration] [s].
        """
        return self.path.wrenches_at(self.start, self.end, self._place(t))

    def rates(self, t: ArrayLike) -> Array:
        """Force rates f'(t), (n, d) or (m, n, d) [N/s]; at an instant of a path that of the stretch after.

        Args:
            t: a time or (m,) times in [0, duration] [s].
        """
        rates = self.path.rates_at(self.start, self.end, self._place(t))
        return rates if self.path.timed else self.scaling.velocity(t)[..., None, None] * rates

    @property
    def load_varies(self) -> bool:
        """Whether the load, seen from the object, is not the same at every instant."""
        return self.path.load_varies

    @property
    def steepest(self) -> Array:
        """(n,) at least the fastest change of each force over the whole path, max |f_i'(t)| [N/s]."""
        return self._steepest if self.path.timed else self.scaling.steepest * self._steepest

    @cached_property
    def _steepest(self) -> Array:
        return self.path.steepest(self.start, self.end)

    @cached_property
    def peaks(self) -> Array:
        """(n,) the largest |f_i| of each finger on the way, exact [N]; of soft ones |(f, mu m / torsion)|."""
        return self.path.peaks(self.start, self.end)

    @property
    def peak(self) -> float:
        """The largest |f_i| of all fingers on the way, exact [N]."""
        return float(self.peaks.max())

    @property
    def friction_needed(self) -> float:
        """The least coefficient of all contacts under which the forces, as they are, stay in their cones [-].

        |f_t| / f_n at its highest over the whole way; of soft fingers |f_t| / sqrt(f_n^2 - (m / torsion)^2).
        """
        return float(self.path.friction_needed(self.start, self.end).max())

    def load(self, t: ArrayLike) -> Array:
        """The load (3,) or (m, 3) in the object frame [N, N m]; (…, 6) in space.

        Args:
            t: a time or (m,) times in [0, duration] [s].
        """
        return self.path.load_at(self.start, self._place(t))

    def orientation(self, t: ArrayLike) -> Array:
        """The object's angle from the start [rad], counter-clockwise or about the axis; of the shape of t.

        Args:
            t: a time or (m,) times in [0, duration] [s].
        """
        return self.path.orientation_at(self._place(t))

    def rotations(self, t: ArrayLike) -> Array:
        """(3, 3) or (m, 3, 3) matrices from the object's frame to its frame at the start; in space.

        Args:
            t: a time or (m,) times in [0, duration] [s].
        """
        if self.grasp.dimension == 2:
            raise InvalidInput("an object in the plane turns by an angle; ask for orientation(t)")
        return self.path.rotations_at(self._place(t))

    def margins(self, t: ArrayLike) -> Margins:
        """Margins of every contact, (n,) or (m, n); NaN where a contact carries no force.

        Args:
            t: a time or (m,) times in [0, duration] [s].
        """
        cones = self.grasp.cones
        return margins(cones.measured(self.forces(t)), cones.normals, self.grasp.frictions)

    def times(self, rate: float) -> Array:
        """Sampling times [s] at ``rate`` per second, both ends included.

        Args:
            rate: samples per second [1/s].
        """
        # Less a little, so that rounding of the product adds no second sample at the end.
        count = max(1, int(np.ceil(self.duration * number(rate, "rate", above=0) * (1 - 1e-12))))
        times = np.arange(count + 1) / rate
        times[-1] = self.duration
        return times

    def reversed(self) -> "Transition":
        """The same path run backwards: a removal becomes an addition."""
        return Transition(
            self.end,
            self.start,
            self.scaling.reversed(),
            self.record.reversed(),
            leaving=self.arriving,
            arriving=self.leaving,
            path=self.path.reversed(),
        )

    def retimed(self, scaling: TimeScaling) -> "Transition":
        """The same path under another time function; refused where the load is tied to the clock.

        Args:
            scaling: the new clock, of any duration.
        """
        instance(scaling, "scaling", TimeScaling)
        if self.path.timed:
            raise InvalidInput(
                "a path planned through instants keeps its times; plan it with another duration"
            )
        kept = replace(self.record, rate_limits=()) if self.record.rate_limits else self.record
        return replace(self, scaling=scaling, record=kept)

    def fastest(self, rate_limit: ArrayLike) -> "Transition":
        """The same path and shape in the least time with |f_i'(t)| <= rate_limit, a number or (n,) [N/s].

        Of a turn to the bound that ``steepest`` is. The record of a straight path keeps the limits.

        Args:
            rate_limit: a number or (n,), greater than 0 [N/s].
        """
        plan = self.retimed(TimeScaling.fastest(self._steepest[:, None], rate_limit, self.scaling))
        if self.turn is not None:
            return plan
        kept = limits(rate_limit, "rate_limit", len(self.grasp))
        return replace(plan, record=replace(plan.record, rate_limits=tuple(kept.tolist())))

    def to_dataframe(self, rate: float = 1000.0) -> "pandas.DataFrame":
        """Set-points as a table: index t [s], a column ``<name>_fx`` ... per contact and axis [N].

        Args:
            rate: samples per second [1/s].
        """
        try:
            import pandas
        except ImportError:
            raise ImportError("to_dataframe needs pandas: pip install 'regrasp[pandas]'") from None
        t = self.times(rate)
        columns = setpoint_columns(self.grasp)
        return pandas.DataFrame(
            self.forces(t).reshape(t.size, -1), index=pandas.Index(t, name="t"), columns=columns
        )

    @property
    def in_words(self) -> str:
        """What happens: ``removal of P3``, ``exchange of P1 for P4``, ``rotation``."""
        who = ", ".join(self.leaving or self.arriving)
        for_whom = f" for {', '.join(self.arriving)}" if self.leaving and self.arriving else ""
        return f"{self.kind} of {who}{for_whom}" if who else self.kind

    def __str__(self) -> str:
        from regrasp.plans.transition_words import told

        return told(self)

    __repr__ = __str__


def setpoint_columns(grasp: Grasp) -> list[str]:
    """Column names of set-points: ``<name>_fx``, ``<name>_fy``[, ``<name>_fz``] per contact.

    With soft fingers ``<name>_mn``, too, the torque about the normal.
    """
    kinds = ("fx", "fy", "fz", "mn")[: grasp.width]
    return [f"{name}_{kind}" for name in grasp.names for kind in kinds]

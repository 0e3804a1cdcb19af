"""What inner pyramids cost against exact friction cones."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf, isnan, nan
from types import MappingProxyType
from typing import TYPE_CHECKING, Unpack

from regrasp.errors import Infeasible, InvalidInput, shown
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.value import ArrayValue
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.choosing import check_facets, choose_state
from regrasp.planning.states.criteria import PEAK_RATIO, Criteria
from regrasp.planning.states.objectives import Objective
from regrasp.planning.states.options import LimitOptions, criteria_of, takes

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True, eq=False)
class PyramidLosses(ArrayValue):
    """A value of ``choose_state`` with exact cones, and with inner pyramids of some numbers of facets.

    Args:
        objective: what the states were chosen for.
        exact: the objective reached with exact cones, as ``ChosenState.value`` [unit].
        values: the same by number of facets, measured at the state chosen inside the pyramids; NaN where
            these do not hold the load although the cones do.
        dimension: of the grasp. In the plane two half-planes are the friction cone, so that facets cost
            nothing there but for force limits and ``peak``, where they stand for the circle |f| = r.
    """

    objective: Objective
    exact: float
    values: Mapping[int, float]
    dimension: int

    @property
    def unit(self) -> str:
        """Of the values."""
        return self.objective.unit

    @property
    def losses(self) -> dict[int, float]:
        """By number of facets, how much worse than the exact value, as a fraction of it; NaN: not held."""
        better = -1.0 if self.objective.maximise else 1.0
        return {m: _share(better * (v - self.exact), abs(self.exact)) for m, v in self.values.items()}

    @property
    def lost(self) -> tuple[int, ...]:
        """The numbers of facets whose pyramids do not hold the load."""
        return tuple(m for m, value in self.values.items() if isnan(value))

    def to_dataframe(self) -> "pandas.DataFrame":
        """A table with a row for each pyramid: facets, holds, value and loss."""
        try:
            import pandas
        except ImportError:
            raise ImportError("to_dataframe needs pandas: pip install 'regrasp[pandas]'") from None
        rows = [(m, not isnan(v), v, self.losses[m]) for m, v in self.values.items()]
        return pandas.DataFrame(rows, columns=["facets", "holds", "value", "loss"])

    def __str__(self) -> str:
        unit = "" if self.unit == "-" else f" {self.unit}"
        lines = [f"{self.objective} {self.exact:.6g}{unit} with exact cones; with inner pyramids:"]
        for m, loss in self.losses.items():
            held = "does not hold" if isnan(loss) else f"{self.values[m]:<12.6g} {loss:.3%} worse"
            lines.append(f"{m:>6} facets  {held}")
        if self.dimension == 2:
            lines.append("in the plane two half-planes are the cone: facets stand for |f| = r only")
        return "\n".join(lines)


@takes(LimitOptions)
def pyramid_losses(
    grasp: Grasp,
    load: Wrench,
    objective: str | Objective | Criteria = "peak",
    facets: Sequence[int] = (4, 8, 16, 32),
    **options: Unpack[LimitOptions],
) -> PyramidLosses:
    """The value of ``choose_state`` with exact cones and with inner pyramids of each number of ``facets``.

    All are chosen under the same force limits, those of the exact choice. A pyramid's first vertex lies along
    the first tangent, so that its loss depends on the frame; the exact value does not.

    Args:
        grasp: two contacts or more, in the plane or in space.
        load: external wrench on the object about its centre of mass, object frame [N, N m].
        objective: as for ``choose_state``.
        facets: numbers of faces, each at least 3.
        options

    Raises:
        Infeasible: Where exact cones do not hold the load.
        InvalidInput: As ``choose_state`` does.
    """
    if not isinstance(facets, Sequence) or isinstance(facets, (str, bytes)) or not facets:
        raise InvalidInput(f"facets must be whole numbers, such as (4, 8, 16), got {shown(facets)}")
    for m in facets:
        check_facets(m)
        if m is None:
            raise InvalidInput("facets must be whole numbers of at least 3, got None")
    criteria = criteria_of(objective, options)
    exact = choose_state(grasp, load, criteria)
    if criteria.unbounded:  # pyramids have a larger least peak force, which would loosen the limits
        criteria = replace(criteria, max_force=max(exact.force_limits), peak_ratio=PEAK_RATIO)
    values = {}
    for m in facets:
        try:
            values[m] = choose_state(grasp, load, criteria, facets=m).value
        except Infeasible:
            values[m] = nan
    return PyramidLosses(criteria.objective, exact.value, MappingProxyType(values), grasp.dimension)


def _share(amount: float, whole: float) -> float:
    return amount / whole if whole else (0.0 if amount == 0 else nan if isnan(amount) else inf)

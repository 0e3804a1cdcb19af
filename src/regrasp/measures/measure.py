"""One measure of a grasp, with what has to be known to read it, and a table of them."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.value import ArrayValue

if TYPE_CHECKING:
    import pandas

BY_LENGTH, UNMOVED = "by length", "none"
"""Of what the origin does."""

ROA = "Roa and Suarez 2015"
"""M. A. Roa and R. Suarez, Grasp quality measures: review and performance, Autonomous Robots 38, 65-88."""


@dataclass(frozen=True)
class Measure:
    """A number that says how good a grasp is.

    Args:
        name: how to address it in a table.
        value: the measure itself, in ``unit``.
        unit: ``-`` for none; N and m stand for the units of the input.
        range: of the values it can have.
        larger_is_better: which way.
        formula: what it is.
        source: who says so.
        length_unit: what another unit of length does to it.
        how: ``closed form``, ``program`` or ``search``.
        bounds: (lower, upper), proven, of what was searched for; None where the value is exact but for
            rounding.
        origin: what another centre of mass, the origin, does to it, all else staying: ``changes it``, ``by
            length`` alone if that is not given, or ``none``.
    """

    name: str
    value: float
    unit: str
    range: str
    larger_is_better: bool
    formula: str
    source: str
    length_unit: str
    how: str = "closed form"
    bounds: tuple[float, float] | None = None
    origin: str = "changes it"

    @property
    def better(self) -> str:
        """``larger`` or ``smaller``."""
        return "larger" if self.larger_is_better else "smaller"

    def __float__(self) -> float:
        return float(self.value)


@dataclass(frozen=True, eq=False, repr=False)
class Quality(ArrayValue):
    """The measures of a grasp, by name.

    Args:
        grasp: the contacts that hold.
        length: by which torques were divided [m].
        measures: one entry for each measure, in order.
    """

    grasp: Grasp
    length: float
    measures: tuple[Measure, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Of the measures, in order."""
        return tuple(measure.name for measure in self.measures)

    def __getitem__(self, name: str) -> Measure:
        for measure in self.measures:
            if measure.name == name:
                return measure
        raise InvalidInput(f"no measure {shown(name)} of this grasp; it has {', '.join(self.names)}")

    def __contains__(self, name: object) -> bool:
        return name in self.names

    def __len__(self) -> int:
        return len(self.measures)

    def __iter__(self) -> Iterator[Measure]:
        return iter(self.measures)

    def to_dataframe(self) -> "pandas.DataFrame":
        """A table with a row for each measure, its fields as columns."""
        try:
            import pandas
        except ImportError:
            raise ImportError("to_dataframe needs pandas: pip install 'regrasp[pandas]'") from None
        return pandas.DataFrame(
            [
                {
                    "measure": m.name,
                    "value": m.value,
                    "lower": m.value if m.bounds is None else m.bounds[0],
                    "upper": m.value if m.bounds is None else m.bounds[1],
                    "unit": m.unit,
                    "range": m.range,
                    "better": m.better,
                    "formula": m.formula,
                    "source": m.source,
                    "length unit": m.length_unit,
                    "origin": m.origin,
                    "how": m.how,
                }
                for m in self.measures
            ]
        )

    def __str__(self) -> str:
        wide = max(len(name) for name in self.names)
        units = max(len(m.unit) for m in self.measures)
        ranges = max(len(m.range) for m in self.measures)
        lines = [f"{', '.join(self.grasp.names)}; torques divided by {self.length:.6g} m"]
        for m in self.measures:
            said = f"{m.unit:{units}}  {m.range:{ranges}}  {m.better:7}  {m.formula}"
            lines.append(f"{m.name:{wide}}  {m.value:10.5g} {said}")
        return "\n".join(lines)

    __repr__ = __str__

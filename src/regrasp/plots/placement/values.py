"""Units and colours of values of placements, read from the objective, whoever adds one."""

from typing import Any, NamedTuple

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import FuncNorm, Normalize
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from regrasp.mechanics.checks import Array
from regrasp.planning.states.objectives import OBJECTIVES
from regrasp.plots.look.style import SMALL, TEXT
from regrasp.plots.look.units import Units

# Of a placement as a whole, which no state has: in terms of N.
_WHOLE = {"wrench_ball": "N", "answered": "-"}
_FORCES = {"N": 1, "N^2": 2}
_TIMES = 5  # the forces of the best placement, up to which colours tell others apart: they grow without end
_TICKS = 6  # of a colour bar, about


def unit_of(word: str) -> str:
    """The unit of an objective, in terms of N and rad."""
    found = OBJECTIVES.get(word)
    return _WHOLE.get(word, "N") if found is None else found.unit


def drawn_in(word: str) -> str:
    """The unit in which it is drawn: angles in degrees."""
    return {"rad": "deg"}.get(unit_of(word), unit_of(word))


def as_drawn(word: str, values: Array) -> Array:
    """Values in ``drawn_in``."""
    return np.degrees(values) if unit_of(word) == "rad" else values


class Scale(NamedTuple):
    """Colours of values, yellow for the best.

    beyond: what values are that have the colour of the last one told apart; empty where there are none.
    """

    cmap: Any
    norm: Normalize
    beyond: str

    def key(self) -> list[Line2D]:
        """What the legend says of values beyond."""
        last = self.norm.vmax
        if not self.beyond or last is None:
            return []
        colour = ScalarMappable(self.norm, self.cmap).to_rgba(np.array([last]))[0]
        return [Line2D([], [], color=colour, linewidth=5, label=self.beyond)]


def scale_of(word: str, values: Array, more: bool) -> Scale:
    """The colours of values as drawn, of which NaN are none.

    Of what is largest at best from 0 on; of forces up to some times the best, squares by their roots.
    """
    held, cmap = values[~np.isnan(values)], "viridis" if more else "viridis_r"
    if not held.size:
        return Scale(cmap, Normalize(0.0, 1.0), "")
    low, high = (0.0 if more else float(held.min())), float(held.max())
    power = 0 if more else _FORCES.get(unit_of(word), 0)
    last = low * _TIMES**power if power and low > 0 else high
    beyond = f"over {_TIMES**power} times the best" if high > last else ""
    last = min(last, high) if high > low else low + (abs(low) or 1.0)
    if power > 1:
        return Scale(cmap, FuncNorm((np.sqrt, np.square), low, last, clip=True), beyond)
    return Scale(cmap, Normalize(low, last, clip=True), beyond)


def colour_bar(drawn: ScalarMappable, scale: Scale, word: str, units: Units, **places: Any) -> None:
    """Beside axes, with the objective and its unit; an arrow where values go on.

    places: of the figure's ``colorbar``.
    """
    figure = places["ax"].figure
    ticks = MaxNLocator(_TICKS)
    bar = figure.colorbar(drawn, extend="max" if scale.beyond else "neither", ticks=ticks, **places)
    bar.ax.tick_params(labelsize=SMALL, length=2.5, width=0.6)
    bar.outline.set_linewidth(0.6)
    bar.set_label(f"{word.replace('_', ' ')} [{units.of(drawn_in(word))}]", fontsize=TEXT)

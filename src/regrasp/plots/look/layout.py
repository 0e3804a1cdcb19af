"""Where the panels of a figure stand: as large as the words around them let them be."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.layout_engine import LayoutEngine
from matplotlib.transforms import Bbox

from regrasp.mechanics.checks import Array

_PAD = 3 / 72  # around a panel and its words [in]
_BETWEEN = 0.02  # of the figure, from panel to panel
# What words mostly take before and after a panel, from the left and from the top [in].
_USUAL = ((0.42, 0.04), (0.2, 0.36))


class OnePass(LayoutEngine):
    """What constrained layout makes of one grid of panels, with every word measured once.

    Matplotlib's own measures all of them twice, since ticks may change with a panel's size: a good part of
    the time of a figure. Here panels have nearly their size when they are measured. A figure with a colour
    bar asks for ``"constrained"`` instead.
    """

    _adjust_compatible = False
    _colorbar_gridspec = False

    def execute(self, fig: Figure) -> None:
        """Move the panels of a figure."""
        panels: list[Any] = [ax for ax in fig.axes if ax.get_subplotspec() and ax.get_in_layout()]
        if not panels:
            return
        grid = _Grid(fig, panels)
        for before, after, (first, last) in zip(grid.before, grid.after, _USUAL, strict=True):
            before[:], after[:] = first * fig.dpi, last * fig.dpi
        grid.place()
        grid.measure()
        grid.place()


class _Grid:
    """Panels of a grid, and the room before and after those of each column and each row from the top [px]."""

    def __init__(self, figure: Figure, panels: list[Any]) -> None:
        grid = panels[0].get_subplotspec().get_gridspec()
        self.panels, self.dpi = panels, figure.dpi
        self.cells = [(ax.get_subplotspec().colspan, ax.get_subplotspec().rowspan) for ax in panels]
        self.size = np.array([figure.bbox.width, figure.bbox.height])
        self.ratios = [np.array(grid.get_width_ratios()), np.array(grid.get_height_ratios())]
        self.before = [np.zeros(len(ratios)) for ratios in self.ratios]
        self.after = [np.zeros(len(ratios)) for ratios in self.ratios]

    def measure(self) -> None:
        """What the words of the panels take, as they stand."""
        for room in (*self.before, *self.after):
            room[:] = 0.0
        for ax, cells in zip(self.panels, self.cells, strict=True):
            words = ax.get_tightbbox(for_layout_only=True)
            if words is None:
                continue
            left, bottom, right, top = ax.get_position(original=True).extents * np.tile(self.size, 2)
            ahead = left - words.x0, words.y1 - top
            behind = words.x1 - right, bottom - words.y0
            for axis, cell in enumerate(cells):
                before, after, first, last = self.before[axis], self.after[axis], cell.start, cell.stop - 1
                before[first], after[last] = max(before[first], ahead[axis]), max(after[last], behind[axis])

    def place(self) -> None:
        """Panels into what is left of the figure."""
        x, y = self._edges(0), 1 - self._edges(1)
        for ax, (columns, rows) in zip(self.panels, self.cells, strict=True):
            corners = (x[0, columns.start], y[1, rows.stop - 1]), (x[1, columns.stop - 1], y[0, rows.start])
            ax.set_position(Bbox(corners))
            ax.set_in_layout(True)  # which a position that was set ends

    def _edges(self, axis: int) -> Array:
        """(2, n) beginnings and ends of cells along an axis, as fractions of the figure."""
        size, ratios = self.size[axis], self.ratios[axis]
        pad = _PAD * self.dpi
        gap = max(pad, _BETWEEN * size / len(ratios) / 2)
        before, after = self.before[axis] + gap, self.after[axis] + gap
        before[0] += pad - gap
        after[-1] += pad - gap
        inside = ratios / ratios.sum() * max(size - before.sum() - after.sum(), 0.1 * size)
        ends = np.cumsum(before + inside + after) - after
        result: Array = np.array([ends - inside, ends]) / size
        return result

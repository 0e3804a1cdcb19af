"""Draws the comparison from its results: ``python benchmarks/execution/execution_picture.py``."""

import json
from pathlib import Path

from regrasp.execution.measured import SLIPPED
from regrasp.plots.look.style import GREY, PALETTE, WIDTH, legend, new_figure, tidy

HERE = Path(__file__).parents[1]


def main() -> None:
    rows = json.loads((HERE / "results" / "execution.json").read_text(encoding="utf-8"))["rows"]
    figure = new_figure(2 * WIDTH, 3.2)
    ax = tidy(figure.add_subplot())
    names = list(dict.fromkeys(row["rival"] for row in rows))
    for name, colour in zip(names, PALETTE, strict=True):
        slips = [row for row in rows if row["part"] == "slip" and row["rival"] == name]
        needed = next(r["needs"] for r in rows if r["part"] == "critical" and r["rival"] == name)
        friction = [row["amount"] for row in slips]
        ax.semilogy(friction, [max(1e3 * row["slip"], 1e-4) for row in slips], "o-", color=colour,
                    markersize=3, linewidth=1.4, label=name)  # fmt: skip
        if needed <= max(friction) and not name.startswith("ramp"):  # its forces balance nothing
            ax.axvline(needed, color=colour, linewidth=0.9, linestyle=":")
    ax.axhline(1e3 * SLIPPED * 0.08, color=GREY, linewidth=0.9, linestyle="--")
    ax.set_xlabel("true friction (planned with 0.3); dotted: needed by computation", fontsize=8)
    ax.set_ylabel("largest slip [mm]", fontsize=8)
    ax.set_ylim(1e-4, 300)
    legend(ax, ncols=3)
    figure.savefig(HERE.parent / "docs" / "images" / "slip.png", dpi=160, metadata={"Software": None})


if __name__ == "__main__":
    main()

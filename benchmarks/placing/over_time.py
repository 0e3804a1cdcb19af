"""Draws bounds and best values over time, of the certified search and of rivals, from results/placement.json.

python benchmarks/placing/over_time.py [-o docs/images/placement-over-time.png]
"""

import argparse
import json
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

ROOT = Path(__file__).parents[2]
VALUE, BOUND = "#d55e00", "#0072b2"
RIVALS = {
    "random search": ("#009e73", "v"),
    "all of some points": ("#cc79a7", "^"),
    "multi-start Nelder-Mead": ("#222222", "x"),
    "integer program": ("#e69f00", "D"),
}
BELOW, ABOVE = -4.0, 16.0  # of the bound [%]
SHORTEST = 1e-3  # [s]


def main() -> None:
    """One panel for each outline and number of fingers."""
    parser = argparse.ArgumentParser(description=__doc__)
    image = ROOT / "docs" / "images" / "placement-over-time.png"
    parser.add_argument("-o", "--output", type=Path, default=image)
    parser.add_argument("--results", type=Path, default=ROOT / "benchmarks" / "results" / "placement.json")
    given = parser.parse_args()
    report = json.loads(given.results.read_text())
    figure, axes = plt.subplots(2, 2, figsize=(6.8, 5.0), layout="constrained", sharex=True, sharey=True)
    for ax, (name, rows) in zip(axes.flat, report.items(), strict=True):
        last = max(row["seconds"] for rival, row in rows.items() if rival in RIVALS)
        found = rows["certified"]
        seconds, bound, value = np.array(found["over_time"]).T
        look = {"where": "post", "markersize": 4}
        for rival, (colour, marker) in RIVALS.items():
            end = (rows[rival]["seconds"], rows[rival]["value"])
            times, best = np.array([*rows[rival].get("over_time", []), end]).T
            ax.step(times, above(best, found), color=colour, marker=marker, lw=1, label=rival, **look)
        ax.step(seconds, above(value, found), color=VALUE, marker="o", label="certified: best so far", **look)
        ax.step(seconds, above(bound, found), "--", color=BOUND, marker="s", label="its bound", **look)
        ax.set_title(name, fontsize=8)
        ax.set(xscale="log", xlim=(SHORTEST, 1.2 * last), ylim=(BELOW, ABOVE))
        ax.axhline(0, color="0.8", lw=0.8, zorder=0)
        ax.tick_params(labelsize=7)
    for ax in axes[1]:
        ax.set_xlabel("time [s]", fontsize=8)
    for ax in axes[:, 0]:
        ax.set_ylabel("above the last bound [%]", fontsize=8)
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, fontsize=7, ncols=3, loc="outside upper center", frameon=False)
    figure.savefig(given.output, dpi=110)


def above(values: np.ndarray, found: dict[str, float]) -> np.ndarray:
    """By how much values are above the last bound, in percent."""
    return 100 * (values / found["bound"] - 1)


if __name__ == "__main__":
    main()

"""Draws bounds and incumbents over time of the certified search, from results/placement.json.

python benchmarks/placing/over_time.py [-o docs/images/placement-over-time.png]
"""

import argparse
import json
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

ROOT = Path(__file__).parents[2]
BOUND, VALUE = "#0072b2", "#d55e00"


def main() -> None:
    """One panel for each outline and number of fingers."""
    parser = argparse.ArgumentParser(description=__doc__)
    image = ROOT / "docs" / "images" / "placement-over-time.png"
    parser.add_argument("-o", "--output", type=Path, default=image)
    given = parser.parse_args()
    report = json.loads((ROOT / "benchmarks" / "results" / "placement.json").read_text())
    figure, axes = plt.subplots(2, 2, figsize=(6.8, 4.6), layout="constrained")
    for ax, (name, rows) in zip(axes.flat, report.items(), strict=True):
        found = rows["certified"]
        seconds, bound, value = np.array(found["over_time"]).T
        ax.step(
            1e3 * seconds, value, color=VALUE, where="post", marker="o", markersize=3, label="best so far"
        )
        ax.step(
            1e3 * seconds, bound, "--", color=BOUND, where="post", marker="s", markersize=3, label="bound"
        )
        ax.fill_between(1e3 * seconds, bound, value, step="post", color="0.92")
        ax.set_title(f"{name}: gap {found['gap']:.2%}", fontsize=8)
        ax.set_xlim(left=0)
        ax.tick_params(labelsize=7)
        ax.set_xlabel("time [ms]", fontsize=8)
        ax.set_ylabel("sum of normal forces [N]", fontsize=8)
    axes[0, 0].legend(fontsize=8)
    figure.savefig(given.output, dpi=110)


if __name__ == "__main__":
    main()

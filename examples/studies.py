"""Three studies, each with a figure.

    python examples/studies.py regrasps -o DIR    margin and moves of regrasps, over friction and part
    python examples/studies.py removals -o DIR    how often a finger can leave, over friction
    python examples/studies.py solvers -o DIR     back ends beside each other on random states

Rows and figure are in DIR. A run that was ended goes on with the same line; ``--cases`` says how many.
"""

import argparse
from functools import cache
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

import regrasp as rg
from regrasp.outline import parts
from regrasp.plots.look.style import PALETTE, new_figure, tidy

FRICTIONS = {"from": 0.1, "to": 1.0, "count": 10}
PARTS = ("wrench", "cam", "bracket", "bottle")
MARKERS = "osd^vP"
WEIGHT = rg.Wrench([0.0, -2.0])


@cache
def shape(part: str) -> rg.Outline:
    """A part, made once in each process."""
    return rg.Outline.ellipse(0.06, 0.03) if part == "ellipse" else parts.PARTS[part]()


# -- regrasps over friction and part ---------------------------------------------------------------------


def regrasp(part: str, friction: float, seed: int) -> rg.RegraspPlan:
    """Three fingers get from random places on a part to others, under its weight; it may turn."""
    outline, rng = shape(part), np.random.default_rng(seed)
    start, goal = (
        rg.Grasp(outline.contact_at(s, friction=friction) for s in rng.uniform(0, outline.length, 3))
        for _ in range(2)
    )
    return rg.plan_regrasp(outline, start, goal, WEIGHT, friction=friction, orientations=12, candidates=60)


def regrasps(folder: Path, cases: int) -> plt.Figure:
    """How often there is a regrasp, and how wide its margin is."""
    frictions = {"from": 0.2, "to": 1.0, "count": 5}
    grid = {"part": PARTS, "friction": frictions, "seed": range(max(1, cases // (5 * len(PARTS))))}
    rg.sweep("studies:regrasp", grid, out=folder, keep=["margin", "moves"], time_limit=120)
    data = rg.read_study(folder)
    groups = data.assign(done=data["verdict"] == "answered").groupby(["part", "friction"])
    shares, margins, moves = groups["done"].mean(), groups["margin"].median(), groups["moves"].mean()
    figure = new_figure(7.0, 2.5)
    for ax, values, label in zip(
        figure.subplots(1, 3),
        (100 * shares, np.degrees(margins), moves),
        ("can be regrasped [%]", "median margin [deg]", "mean finger moves"),
        strict=True,
    ):
        for part, colour, marker in zip(PARTS, PALETTE, MARKERS, strict=False):
            line = values[part]
            ax.plot(line.index, line, marker=marker, color=colour, label=part, markersize=4)
        ax.set(xlabel="friction", ylabel=label, ylim=(0, None))
        tidy(ax)
    figure.axes[0].legend(frameon=False, fontsize=7)
    return figure


# -- removals over friction ------------------------------------------------------------------------------


def places(seed: int) -> np.ndarray:
    """Three arc lengths on the ellipse."""
    return np.random.default_rng(seed).uniform(0, shape("ellipse").length, 3)


def removal(friction: float, seed: int) -> rg.Transition:
    """The first of three fingers at random places leaves."""
    ellipse = shape("ellipse")
    grasp = rg.Grasp(ellipse.contact_at(s, friction=friction) for s in places(seed))
    return rg.plan_removal(grasp, 0, load=WEIGHT)


def removals(folder: Path, cases: int) -> plt.Figure:
    """The share that can leave: each case planned, as a row, and all of them by arrays in this process."""
    count = max(1, cases // 10)
    grid = {"friction": FRICTIONS, "seed": range(count)}
    rg.sweep("studies:removal", grid, out=folder, keep=["friction_needed"], time_limit=60)
    data = rg.read_study(folder)
    data = data.assign(can=data["verdict"] == "answered")
    ellipse = shape("ellipse")
    s = np.array([places(seed) for seed in range(count)])
    points, normals = ellipse.points(s), ellipse.normals(s)
    share = {}
    for friction, rows in data.groupby("friction"):
        low, high = rg.locus_intervals(
            points[:, 1], normals[:, 1], friction, points[:, 2], normals[:, 2], friction, force=WEIGHT.force
        )
        can = low <= high
        share[friction] = can.mean()
        planned = rows.set_index("seed")["can"].sort_index()
        differ = int((planned != can[planned.index]).sum())
        assert not differ, f"arrays and plans disagree on {differ} cases of friction {friction}"
    plans = data.groupby("friction")["can"].mean()
    ax = new_figure(3.4, 2.5).subplots()
    ax.plot(share.keys(), 100 * np.array([*share.values()]), color=PALETTE[0], label="by locus_intervals")
    ax.plot(plans.index, 100 * plans, "o", color=PALETTE[1], label=f"{len(data):,} planned", markersize=4)
    ax.set(xlabel="friction", ylabel="finger can leave [%]", ylim=(0, None))
    ax.legend(frameon=False, fontsize=7)
    tidy(ax)
    return ax.figure


# -- back ends on random states --------------------------------------------------------------------------

BACK_ENDS = ("clarabel", "daqp", "quadprog", "highs", "piqp", "proxqp", "osqp", "scs")


def state(method: str, fingers: int, seed: int) -> dict[str, float]:
    """Least effort of a random grasp by a back end, and the processor time it takes when asked again."""
    from time import process_time

    angles = np.random.default_rng(seed).uniform(0, 2 * np.pi, fingers)
    grasp = rg.Grasp(rg.Contact([np.cos(a), np.sin(a)], [-np.cos(a), -np.sin(a)], 0.6) for a in angles)
    rg.choose_state(grasp, WEIGHT, "effort", method=method)
    began = process_time()
    found = rg.choose_state(grasp, WEIGHT, "effort", method=method)
    return {"effort": found.value, "took": process_time() - began}


def solvers(folder: Path, cases: int) -> plt.Figure:
    """Time by number of fingers; how far efforts are from the least that any back end found is printed."""
    sizes = [3, 5, 10, 20]
    seeds = range(max(1, cases // (len(BACK_ENDS) * len(sizes))))
    rg.sweep(
        "studies:state", {"method": BACK_ENDS, "fingers": sizes, "seed": seeds}, out=folder, time_limit=60
    )
    data: Any = rg.read_study(folder)
    data = data[data["verdict"] == "answered"]
    least = data.groupby(["fingers", "seed"])["effort"].transform("min")
    data = data.assign(off=data["effort"] / least - 1)
    print(f"largest excess of effort over the least that was found: {data['off'].max():.1e}")
    ax = (figure := new_figure(4.6, 2.8)).subplots()
    for method, colour, marker in zip(BACK_ENDS, PALETTE * 2, "osd^vPx*", strict=False):
        times = 1e3 * data[data["method"] == method].groupby("fingers")["took"].median()
        ax.plot(times, color=colour, marker=marker, markersize=4, label=method)
    ax.set(xlabel="fingers", ylabel="median processor time [ms]", xscale="log", yscale="log")
    ax.set_xticks(sizes, map(str, sizes))
    ax.set_yticks([0.5, 1, 2, 4], ["0.5", "1", "2", "4"])
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_minor_locator(plt.NullLocator())
    tidy(ax)
    figure.legend(loc="outside right center", frameon=False, fontsize=7)
    return figure


STUDIES = {"regrasps": (regrasps, 1000), "removals": (removals, 100_000), "solvers": (solvers, 640)}

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("study", choices=STUDIES)
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="DIR")
    parser.add_argument("--cases", type=int)
    given = parser.parse_args()
    draw, usual = STUDIES[given.study]
    figure = draw(given.output / given.study, given.cases or usual)
    figure.savefig(given.output / f"study-{given.study}.png", dpi=160, metadata={"Software": None})

"""Three studies, each with a figure.

    python examples/studies.py regrasps -o DIR    margin and moves of regrasps, over friction and part
    python examples/studies.py removals -o DIR    how often a finger can leave, over friction
    python examples/studies.py solvers -o DIR     back ends at several accuracies on random states

Rows and figure are in DIR. A run that was ended goes on with the same line; ``--cases`` says how many.
"""

import argparse
from functools import cache
from pathlib import Path
from time import process_time
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

import regrasp as rg
from regrasp.bench.families.grasps import planar
from regrasp.bench.families.states import state_problem
from regrasp.bench.judging.judgement import judged
from regrasp.bench.problems.answer import understood
from regrasp.bench.problems.settings import options, right_within
from regrasp.bench.running.solvers import chosen_solvers
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


# -- back ends at several accuracies on random states -----------------------------------------------------

BACK_ENDS = ("clarabel", "daqp", "quadprog", "highs", "piqp", "proxqp", "osqp", "scs")
ASKED = {"low": 1e-3, "mid": 1e-6, "high": 1e-9}


@cache
def solver(method: str) -> Any:
    """How a back end is called bare, without the polish and audit of ``choose_state``."""
    return chosen_solvers([method])[0].load()


def state(method: str, settings: str, fingers: int, seed: int) -> dict[str, Any]:
    """Least effort of a random grasp by a back end at an accuracy: how far off it is, and the time."""
    grasp, load = planar(np.random.default_rng([seed, fingers]), fingers)
    problem = state_problem("states", "state", grasp, load, "effort")
    call, given = solver(method), options(method, settings)
    for _ in range(2):
        data = call.layout(problem.program)
        began = process_time()
        answer = call.solve(data, **given)
        took = process_time() - began
    found = judged(problem, understood(answer, problem.program), right_within(settings))
    return {"off": found.distance, "breaks": found.primal_residual, "right": found.correct, "took": took}


def solvers(folder: Path, cases: int) -> plt.Figure:
    """How far from the optimum, over the accuracy that was asked for, and the time that it takes."""
    sizes = [3, 5, 10, 20]
    seeds = range(max(1, cases // (len(BACK_ENDS) * len(ASKED) * len(sizes))))
    grid = {"method": BACK_ENDS, "settings": [*ASKED], "fingers": sizes, "seed": seeds}
    rg.sweep("studies:state", grid, out=folder, time_limit=60)
    data: Any = rg.read_study(folder)
    known = 1e-10  # to which the reference knows the optimum
    data = data.assign(asked=data["settings"].map(ASKED), off=data["off"].clip(lower=known))
    print(data.groupby(["method", "settings"])["right"].mean().unstack()[[*ASKED]])
    figure = new_figure(6.4, 2.8)
    panels = (("off", "distance from the optimum [-]", 1.0), ("took", "processor time [ms]", 1e3))
    for ax, (column, label, unit) in zip(figure.subplots(1, 2), panels, strict=True):
        for k, (method, marker) in enumerate(zip(BACK_ENDS, "osd^vPx*", strict=True)):
            medians = unit * data[data["method"] == method].groupby("asked")[column].median()
            look = {"color": PALETTE[k % len(PALETTE)], "linestyle": "-" if k < len(PALETTE) else "--"}
            ax.plot(medians, marker=marker, markersize=4, label=method, **look)
        ax.set(xlabel="accuracy asked for [-]", ylabel=label, xscale="log", yscale="log")
        ax.set_xticks([*ASKED.values()])
        ax.invert_xaxis()
        tidy(ax)
    figure.axes[0].axhline(known, color="0.6", linewidth=0.8, linestyle=":")
    ax.set_yticks([0.02, 0.05, 0.1, 0.2, 0.5], ["0.02", "0.05", "0.1", "0.2", "0.5"])
    ax.yaxis.set_minor_locator(plt.NullLocator())
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside right center", frameon=False, fontsize=7)
    return figure


STUDIES = {"regrasps": (regrasps, 1000), "removals": (removals, 100_000), "solvers": (solvers, 960)}

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("study", choices=STUDIES)
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="DIR")
    parser.add_argument("--cases", type=int)
    given = parser.parse_args()
    draw, usual = STUDIES[given.study]
    figure = draw(given.output / given.study, given.cases or usual)
    figure.savefig(given.output / f"study-{given.study}.png", dpi=160, metadata={"Software": None})

"""Draws the pictures of the README and the docs: python docs/pictures.py."""

from importlib.resources import files
from pathlib import Path

import matplotlib.pyplot as plt

import regrasp as rg
from regrasp.execution import simulate
from regrasp.files import parse_scenario, plan_scenario
from regrasp.motions import plan_motions
from regrasp.outline import parts
from regrasp.plots import (
    execution_figure,
    plot_escape,
    plot_motions,
    plot_outline,
    plot_outline_map,
    plot_sensitivity,
    plot_tolerances,
    transition_figure,
)

IMAGES = Path(__file__).parent / "images"

if __name__ == "__main__":
    scenario = parse_scenario((files("regrasp.files.scenarios") / "paper.toml").read_text(encoding="utf-8"))
    removal = plan_scenario(scenario)
    IMAGES.mkdir(exist_ok=True)
    transition_figure(removal).savefig(IMAGES / "overview.png", dpi=160, metadata={"Software": None})
    try:
        rg.plan_removal(removal.start, "P1")
    except rg.Infeasible as reason:
        figure = plot_escape(reason.certificate).figure
        figure.savefig(IMAGES / "escape.png", dpi=160, metadata={"Software": None})
    found = rg.sensitivity(removal.grasp, removal.start.load, "force", max_force=8)
    figure = plot_sensitivity(found).figure
    figure.savefig(IMAGES / "sensitivity.png", dpi=160, metadata={"Software": None})
    state = rg.choose_state(removal.grasp, removal.start.load, "force", max_force=12)
    figure = plot_tolerances(rg.tolerances(state)).figure
    figure.savefig(IMAGES / "tolerances.png", dpi=160, metadata={"Software": None})
    metres = rg.Grasp(rg.Contact(0.01 * c.position, c.normal, c.friction, name=c.name) for c in removal.grasp)
    moved = rg.GraspState(metres, removal.start.load, removal.start.forces)
    figure = execution_figure(simulate(rg.plan_removal(moved, "P3")))
    figure.savefig(IMAGES / "execution.png", dpi=120, metadata={"Software": None})
    ellipse = rg.Outline.ellipse(0.04, 0.02)
    first, last = (
        rg.Grasp(ellipse.contact_at(s * ellipse.length, friction=0.5) for s in places)
        for places in ((0.02, 0.35, 0.7), (0.2, 0.5, 0.85))
    )
    plan = rg.plan_regrasp(ellipse, first, last, rg.Wrench([0, -3.0]), friction=0.5)
    figure = plot_motions(plan_motions(plan, ellipse, tip_radius=0.003, clearance=0.002), ellipse).figure
    figure.savefig(IMAGES / "motions.png", dpi=120, metadata={"Software": None})
    bowl = rg.Outline([[0, 0], [4, 0], [6, 4], [5, 4], [2, 1], [-1, 4], [-2, 4]])
    figure = plt.figure(figsize=(6.8, 3.75), layout="constrained")
    for ax, friction in zip(figure.subplots(1, 2), (0.2, 0.4), strict=True):
        ends = (
            rg.Grasp(bowl.contact_at(s, friction=friction) for s in places)
            for places in ((3.39, 9.01, 12.0), (0.44, 18.46, 12.0))
        )
        found = rg.regrasps_on_outline(bowl, *ends, rg.Wrench([-1.0, -3.0]), friction=friction)
        plot_outline_map(found, ax, plan=found.plan() if found.exists else None)
        ax.tick_params(labelsize=7)
    figure.savefig(IMAGES / "outline-map.png", dpi=120, metadata={"Software": None})
    part = parts.bracket()
    figure = plot_outline(part, arc_lengths=part.sample(40)).figure
    figure.savefig(IMAGES / "outline.png", dpi=160, metadata={"Software": None})

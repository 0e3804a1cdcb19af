"""Draws the pictures of the README and the docs: python docs/pictures.py."""

from importlib.resources import files
from pathlib import Path

from regrasp.files import parse_scenario, plan_scenario
from regrasp.plots import transition_figure

IMAGES = Path(__file__).parent / "images"

if __name__ == "__main__":
    scenario = parse_scenario((files("regrasp.files") / "paper.toml").read_text(encoding="utf-8"))
    figure = transition_figure(plan_scenario(scenario))
    IMAGES.mkdir(exist_ok=True)
    figure.savefig(IMAGES / "overview.png", dpi=160, metadata={"Software": None})

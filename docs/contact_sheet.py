"""Draws figures on one sheet, at a column's width and at 400 px in grey: python docs/contact_sheet.py."""

from importlib.resources import files
from io import BytesIO
from pathlib import Path
from typing import Any

from PIL import Image

import regrasp as rg
from regrasp import plots
from regrasp.files import parse_scenario, plan_scenario
from regrasp.outline import parts

SHEET = Path(__file__).parent / "images" / "contact-sheet"
COLUMN, SMALL, COLUMNS = 510, 400, 4  # [px]: a column at 150 dpi


def drawn() -> dict[str, Any]:
    """Every figure of the paper's removal, of a regrasp, an escape, maps and rates, by name."""
    text = (files("regrasp.files.scenarios") / "paper.toml").read_text(encoding="utf-8")
    removal = plan_scenario(parse_scenario(text))
    found = dict(plots.figures(removal))
    grasp, load = removal.grasp, removal.start.load
    try:
        rg.plan_removal(removal.start, "P1")
    except rg.Infeasible as reason:
        found["escape"] = plots.plot_escape(reason.certificate).figure
    found["sensitivity"] = plots.plot_sensitivity(rg.sensitivity(grasp, load, "force", max_force=8)).figure
    state = rg.choose_state(grasp, load, "force", max_force=12)
    found["tolerances"] = plots.plot_tolerances(rg.tolerances(state)).figure
    found["directions"] = plots.plot_directions(grasp.without("P3"), load_size=3.8).figure
    spanner = parts.wrench()
    on = rg.Grasp(spanner.contact_at(s * spanner.length, friction=0.6) for s in (0.2, 0.33, 0.8))
    found["outline"] = plots.plot_outline(parts.bracket()).figure
    held = rg.choose_state(on, rg.Wrench([0, -2.0]), "effort")
    found["slender"] = plots.plot_state(held, outline=spanner).figure
    ellipse = rg.Outline.ellipse(2, 1)
    ends = (
        rg.Grasp(ellipse.contact_at(s * ellipse.length, friction=0.5) for s in places)
        for places in ((0.02, 0.35, 0.7), (0.2, 0.5, 0.85))
    )
    plan = rg.plan_regrasp(ellipse, *ends, rg.Wrench([0, -3.0]), friction=0.5, goal_orientation=1.5)
    found["regrasp"] = plots.plot_regrasp(plan, ellipse)
    found["rates"] = plots.plot_rates(removal, rate_limit=8.0).figure
    found["components"] = plots.plot_force_components(removal).figure
    return found


def image_of(figure: Any) -> Image.Image:
    """A figure as it is saved."""
    buffer = BytesIO()
    figure.savefig(buffer, dpi=150)
    return Image.open(buffer).convert("RGB")


def sheet(images: list[Image.Image], column: int) -> Image.Image:
    """Images in columns of a width, wide ones over two of them, each put where it comes highest."""
    heights = [0] * COLUMNS
    places = []
    for im in images:
        over = 2 if im.width > 1.5 * COLUMN else 1
        scaled = im.resize(
            (over * column, round(im.height * over * column / im.width)), Image.Resampling.LANCZOS
        )
        first = min(range(COLUMNS - over + 1), key=lambda k: max(heights[k : k + over]))
        top = max(heights[first : first + over])
        heights[first : first + over] = [top + scaled.height] * over
        places.append((scaled, (first * column, top)))
    whole = Image.new("RGB", (COLUMNS * column, max(heights)), "white")
    for scaled, place in places:
        whole.paste(scaled, place)
    return whole


if __name__ == "__main__":
    pictures = [image_of(figure) for figure in drawn().values()]
    for name, width in (("", COLUMN), ("-small-grey", SMALL)):
        whole = sheet(pictures, width)
        whole = whole.convert("L") if name else whole.quantize(128)
        whole.save(f"{SHEET}{name}.png", optimize=True)

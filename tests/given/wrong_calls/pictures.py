"""Pictures: what each draws, and how; the first need not be right where the rest is seen before it."""

import inspect

import numpy as np

import regrasp as rg
import regrasp.plots as plots
from paper import GRASP, LOAD, STATE
from values import PAIR, VALUES, ellipse, regrasp, removal
from wrong_calls.row import Row

PICTURES = {
    "ax": "value", "units": "value", "label": "text of a label", "colour": "colour", "colours": "colours",
    "force_scale": "positive", "reach": "positive", "control": "flag", "shadow": "flag", "absent": "names",
    "order": "names", "o": "orientation", "torques": "row", "arc_lengths": "row",
    "force_limits": "two limits", "objective": "word", "at_value": "number", "title": "text of a label",
    "caption": "text of a label", "path": "path", "frames_per_second": "positive",
    "move_time": "not negative", "chosen": "value", "load_size": "positive", "force": "planar vector",
    "contact": "contact of", "mesh": "value", "outline": "value", "plan": "value", "shape": "value",
    "components": "two components", "rate_limit": "limits of three", "values": "row",
    "graph": "value", "level": "not negative", "regions": "value",
}  # fmt: skip
"""Of parameters of pictures."""


def rows() -> dict[str, Row]:
    firsts = {
        "transition": removal, "plan": removal, "value": removal, "grasp": lambda: GRASP,
        "state": lambda: STATE, "locus": lambda: rg.EquilibriumLocus(PAIR, LOAD),
        "contact": lambda: GRASP["P1"],
        "loads": VALUES["LoadSet"], "curve": VALUES["MarginCurve"], "graph": VALUES["HoldGraph"],
        "directions": lambda: np.eye(3),
    }  # fmt: skip
    more = {
        "load_size": 1.0, "outline": ellipse(), "values": [1.0] * 3, "contact": "P1", "shape": ellipse(),
        "path": "none/film.gif", "graph": VALUES["HoldGraph"](),
    }  # fmt: skip
    found = {}
    for name in plots.__all__:
        draw = getattr(plots, name)
        if not inspect.isfunction(draw) or name == "png":
            continue
        first, *others = inspect.signature(draw).parameters
        drawn = regrasp() if name == "plot_regrasp" else firsts.get(first, lambda: None)()
        needed = {first: drawn} | {key: more[key] for key in others if key in more}
        kinds = {key: PICTURES[key] for key in others}
        kinds[first] = "table" if first == "directions" else "value"
        found[f"plots.{name}"] = Row(draw, needed, kinds)
    return found

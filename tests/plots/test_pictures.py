"""A dozen figures look as they did: small grey copies are compared, with a tolerance.

``python tests/plots/test_pictures.py`` draws the copies anew; look at them before they are committed.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from PIL import Image

import regrasp as rg
from regrasp import plots
from regrasp.mesh.parts import bracket
from regrasp.outline import parts

pytestmark = pytest.mark.golden

KEPT = Path(__file__).parents[1] / "data" / "pictures"
DPI, BLOCK = 96, 4  # pixels of four by four are compared by their mean, so that a shift of a fraction passes
GRASP = rg.Grasp(
    [
        rg.Contact([-4, -4], normal=[1, 1], friction=0.3, name="P1"),
        rg.Contact([4, -5], normal=[-1, 2], friction=0.3, name="P2"),
        rg.Contact([0, 8], normal=[0, -1], friction=0.3, name="P3"),
    ]
)
LOAD = rg.Wrench([-1.5, -3.5])


def removal() -> rg.Transition:
    return rg.plan_removal(GRASP, "P3", load=LOAD, duration=1.0)


def escape() -> Any:
    with pytest.raises(rg.Infeasible) as refused:
        rg.plan_removal(GRASP, "P1", load=LOAD)
    return plots.plot_escape(refused.value.certificate)


def held() -> Any:
    spanner = parts.wrench()
    on = rg.Grasp(spanner.contact_at(s * spanner.length, friction=0.6) for s in (0.2, 0.33, 0.8))
    return plots.plot_state(rg.choose_state(on, rg.Wrench([0, -2.0]), "effort"), outline=spanner)


def in_space() -> Any:
    mesh = bracket()
    at = ([0.02, 0.02, -0.0105], [-0.0156, 0.02, 0.015], [-0.005, -0.02, -0.0105])
    grasp = rg.Grasp(mesh.contact_at(np.add(p, mesh.centre_of_mass), friction=0.8) for p in at)
    return plots.plot_state(rg.choose_state(grasp, rg.Wrench([0, 0, -1.8]), "effort"), mesh=mesh)


DRAWN: dict[str, Callable[[], Any]] = {
    "object": lambda: plots.plot_transition(removal()),
    "state": lambda: plots.plot_state(removal().end),
    "magnitudes": lambda: plots.plot_magnitudes(removal()),
    "rates": lambda: plots.plot_rates(removal(), rate_limit=18.0),
    "angles": lambda: plots.plot_angles(removal()),
    "components": lambda: plots.plot_force_components(removal()),
    "time-scaling": lambda: plots.plot_scaling(removal().scaling, control=True),
    "iso-torque": lambda: plots.plot_iso_torque(GRASP["P2"]),
    "wrench-loop": lambda: plots.plot_wrench_loop(removal().end),
    "locus": lambda: plots.plot_locus(rg.EquilibriumLocus(GRASP.without("P3"), LOAD)),
    "escape": escape,
    "outline": held,
    "space": in_space,
}


def grey(name: str) -> np.ndarray:
    """A figure in grey, in blocks, with the fonts that come with matplotlib."""
    with mpl.rc_context({**mpl.rcParamsDefault, "backend": "agg", "font.sans-serif": ["DejaVu Sans"]}):
        figure = DRAWN[name]().figure
        figure.set_dpi(DPI)
        canvas = FigureCanvasAgg(figure)
        canvas.draw()
        pixels = np.asarray(canvas.buffer_rgba())[..., :3].astype(float).mean(axis=2)
    rows, columns = (n // BLOCK for n in pixels.shape)
    blocks = pixels[: rows * BLOCK, : columns * BLOCK].reshape(rows, BLOCK, columns, BLOCK)
    result: np.ndarray = blocks.mean(axis=(1, 3))
    return result


def unlike(a: np.ndarray, b: np.ndarray) -> float:
    """The mean difference of shades where either is drawn on, 0 to 255."""
    if a.shape != b.shape:
        return 255.0
    drawn = np.minimum(a, b) < 250
    return float(np.abs(a - b)[drawn].mean()) if drawn.any() else 0.0


@pytest.mark.parametrize("name", DRAWN)
def test_it_looks_as_it_did(name: str) -> None:
    kept = np.asarray(Image.open(KEPT / f"{name}.png"), dtype=float)
    assert unlike(grey(name), kept) < 6, f"look at it, then: python {Path(__file__).name}"


def test_what_differs_is_seen() -> None:
    before = grey("magnitudes")
    for change in (
        lambda: plots.plot_magnitudes(rg.plan_removal(GRASP, "P3", load=LOAD, objective="effort")),
        lambda: plots.plot_angles(removal()),
    ):
        DRAWN["other"] = change
        assert unlike(grey("other"), before) > 12
    del DRAWN["other"]


if __name__ == "__main__":
    KEPT.mkdir(parents=True, exist_ok=True)
    for drawn in DRAWN:
        Image.fromarray(grey(drawn).round().astype(np.uint8)).save(KEPT / f"{drawn}.png", optimize=True)

"""The exact map of holds on an outline: what is drawn is what was found."""

import numpy as np
import pytest

from regrasp import plots
from values import on_outline

pytestmark = pytest.mark.laws


@pytest.mark.parametrize(("friction", "words"), [(0.5, "a regrasp exists"), (0.01, "no regrasp exists")])
def test_regions_their_mirror_images_and_the_walk_are_drawn(friction, words):
    found = on_outline(friction)
    ax = plots.plot_outline_map(found)
    drawn = [path.vertices[:-1] for c in ax.collections if c.get_gid() == "holds" for path in c.get_paths()]
    assert len(drawn) == 2 * len(found.regions)
    for region in found.regions:
        for polygon in (region, region[:, ::-1]):
            assert any(p.shape == polygon.shape and np.allclose(p, polygon) for p in drawn)
    assert ax.get_title(loc="left") == words
    paths = [line for line in ax.lines if line.get_gid() == "path"]
    assert len(paths) == bool(found.exists)
    for line in paths:
        steps = np.diff(line.get_xydata(), axis=0)
        assert (abs(steps).min(axis=1) == 0).all()  # one finger stays on its axis
    if found.exists:
        plan = found.plan()
        ax = plots.plot_outline_map(found, plan=plan)
        (planned,) = (line for line in ax.lines if line.get_gid() == "path")
        held = [set(s.grasp.names) - set(s.idle_at_end) for s in plan.steps[:-1]]
        for at, names, step in zip(planned.get_xydata(), held, plan.steps[:-1], strict=True):
            points = {tuple(step.grasp[name].position.round(6)) for name in names}
            assert {tuple(p) for p in found.outline.points(at).round(6)} == points
        assert "a plan of" in ax.get_legend().get_texts()[-1].get_text()
    assert found._repr_png_()

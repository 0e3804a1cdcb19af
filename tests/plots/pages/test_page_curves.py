"""Curves of a page in space: the plan's numbers, its limits, and rates where it keeps some."""

from itertools import pairwise

import numpy as np
import pytest

import regrasp as rg
from regrasp.plots.look.style import GREY
from regrasp.plots.look.units import SI
from regrasp.plots.pages.histories import histories
from regrasp.plots.pages.page_curves import axes_over_time
from regrasp.plots.pages.page_scene import curve_traces, now_traces
from regrasp.plots.regrasps.moments import as_regrasp

pytestmark = pytest.mark.contract

_PLACES = ([1, 0, 0], [-1, 0.6, 0], [-1, -0.6, 0], [0, 0, -0.8])
_NORMALS = ([-1, 0, 0], [1, 0, 0], [1, 0, 0], [0, 0, 1])
COLOURS = ["red", "green", "blue", "black"]


def removal(limits=(9, None, None, None), **options) -> rg.Transition:
    contacts = [
        rg.Contact(r, normal=n, friction=0.6, name=name, max_force=most)
        for r, n, name, most in zip(_PLACES, _NORMALS, "ABCD", limits, strict=True)
    ]
    return rg.plan_removal(rg.Grasp(contacts), "D", load=rg.Wrench([0, 0, -5], [0, 0, 0]), **options)


def curves_of(plan):
    return curve_traces(histories(as_regrasp(plan)), COLOURS, SI)


def test_lines_are_the_plans_and_only_limits_that_are_near_are_drawn():
    plan = removal()
    lines = curves_of(plan)
    solid = [line for line in lines if "dash" not in line["line"]]
    assert [(line["name"], line["yaxis"]) for line in solid] == [(n, a) for a in ("y", "y2") for n in "ABCD"]
    sizes = np.linalg.norm(plan.forces(np.array(solid[4]["x"])), axis=-1)
    np.testing.assert_allclose(np.array([line["y"] for line in solid[4:]]).T, sizes, rtol=1e-5, atol=1e-9)
    (limit,) = [line for line in lines if "dash" in line["line"]]
    assert (limit["name"], limit["y"], limit["yaxis"]) == ("limit of A", [9.0, 9.0], "y2")
    assert limit["line"]["color"] == "red"
    assert not [line for line in curves_of(removal((900, None, None, None))) if "dash" in line["line"]]


def test_a_plan_under_rate_limits_shows_its_rates_and_what_all_share_once_in_grey():
    plan = removal(rate_limit=4.0, path_objective="peak", duration=2.0, instants=21)
    lines = [line for line in curves_of(plan) if line["yaxis"] == "y3"]
    assert [line["name"] for line in lines] == [*"ABCD", "limit of all"]
    assert lines[-1]["y"] == [4.0, 4.0]
    assert lines[-1]["line"]["color"] == GREY
    assert max(max(line["y"]) for line in lines[:-1]) <= 4.0 * (1 + 1e-5)
    dots = now_traces(histories(as_regrasp(plan)), 1.0, SI)
    assert [dot["yaxis"] for dot in dots] == ["y", "y2", "y3"]
    np.testing.assert_allclose(dots[1]["y"], np.linalg.norm(plan.forces(1.0), axis=1), rtol=1e-5)


@pytest.mark.parametrize("rates", [False, True])
def test_axes_lie_below_one_another_and_the_lowest_names_the_time(rates):
    axes = axes_over_time(2.0, SI, rates)
    domains = [axes[key]["domain"] for key in sorted(axes) if key.startswith("yaxis")]
    assert len(domains) == 2 + rates
    assert all(below[1] < above[0] for above, below in pairwise(domains))
    assert [key for key in axes if key.startswith("xaxis") and "title" in axes[key]] == [f"xaxis{2 + rates}"]

"""Polygons in the place of circles, and options that are refused."""

import numpy as np
import pytest

import regrasp as rg
from agreement import chosen, random_cases

pytestmark = pytest.mark.contract


def test_polygons_are_inside_the_circle_and_close_in_on_it():
    case = next(c for c in random_cases(50, seed=3) if not c.options and chosen(c, "peak", "clarabel"))
    exact = chosen(case, "peak", "clarabel").value
    least = []
    for facets in (8, 32, 128):
        value = chosen(case, "peak", "clarabel", facets).value
        assert value >= exact * (1 - 1e-9)
        assert value <= exact / np.cos(np.pi / facets) * (1 + 1e-9)
        least.append(value)
    assert least[2] == pytest.approx(exact, rel=1e-3)


def test_the_default_limit_with_polygons_does_not_hang_on_the_back_end():
    """Many forces share the least polygon; the limit is a multiple of its radius, not of one of them."""
    pytest.importorskip("highspy")
    tried = 0
    for case in random_cases(30, seed=4):
        if case.limits.max() < np.inf or (state := chosen(case, "force", "clarabel", 6)) is None:
            continue
        tried += 1
        assert chosen(case, "force", "highs", 6).force_limits == pytest.approx(state.force_limits, rel=1e-8)
    assert tried > 5


def test_second_order_rows_on_a_qp_back_end_name_the_way():
    case = next(random_cases(1, seed=4))
    with pytest.raises(rg.InvalidInput, match="use linearised cones"):
        rg.choose_state(case.grasp, case.load, "peak", method="osqp")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"facets": 2}, "facets must be a whole number of at least 3, got 2"),
        ({"facets": 8.0}, "facets must be a whole number of at least 3, got 8.0"),
        ({"facets": 8, "method": "closed-form"}, "leave facets out"),
        ({"method": "simplex"}, "method must be one of auto, closed-form, clarabel"),
    ],
)
def test_bad_options_are_refused(options, message):
    grasp = rg.Grasp([rg.Contact([-1, 0], [1, 0], 0.5), rg.Contact([1, 0], [-1, 0], 0.5)])
    with pytest.raises(rg.InvalidInput, match=message):
        rg.choose_state(grasp, rg.Wrench([0, -1]), **options)

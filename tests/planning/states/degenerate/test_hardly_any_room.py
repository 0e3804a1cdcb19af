"""Limits at the least peak force: an answer that keeps them all, or a refusal; no solver fails."""

from itertools import product

import numpy as np
import pytest

import regrasp as rg

pytestmark = pytest.mark.laws

OBJECTIVES = ("angle", "force", "friction_use", "effort", "peak", "peak_normal", "sum_normal")


def random_case(seed):
    rng = np.random.default_rng(seed)
    d = 2 + seed % 2
    n = int(rng.integers(d, d + 3))
    places = rng.normal(size=(n, d))
    places /= np.linalg.norm(places, axis=1)[:, None]
    grasp = rg.Grasp(
        rg.Contact(p, -p + rng.normal(0, 0.15, d), friction=mu)
        for p, mu in zip(places, rng.uniform(0.3, 1, n), strict=True)
    )
    return grasp, rg.Wrench(rng.normal(size=d))


@pytest.mark.parametrize("seed", [6, 15])
def test_limits_at_the_least_peak(seed) -> None:
    grasp, load = random_case(seed)
    try:
        peak = rg.choose_state(grasp, load, "peak").value
    except rg.Infeasible:
        return
    seen = 0
    for objective, ratio, least, limit in product(
        OBJECTIVES, (1.0, 1 + 1e-9), (0.0, 0.02 * peak, 0.2 * peak), (None, peak * (1 + 1e-9), 1.2 * peak)
    ):
        try:
            state = rg.choose_state(
                grasp, load, objective, peak_ratio=ratio, min_normal=least, max_force=limit
            )
        except rg.Infeasible:
            assert least > 0 or limit is not None  # without either the state of the least peak is there
            continue
        seen += 1
        assert state.residual < 1e-12
        assert (grasp.cones.normal(state.forces) >= least * (1 - 1e-12)).all()
        if limit is not None:
            assert state.magnitudes.max() <= limit
        assert state.margins.least_angle >= -1e-12
    assert seen


def test_the_smallest_forces_are_the_only_ones_left() -> None:
    """Two fingers squeeze, and the third must push with 1: at the least peak there is one state."""
    grasp = rg.Grasp(
        rg.Contact([np.cos(a), np.sin(a)], [-np.cos(a), -np.sin(a)], friction=0.5) for a in (0.1, 2.2, 4.4)
    )
    load = rg.Wrench([0.3, -1.0])
    smallest = rg.choose_state(grasp, load, "peak", min_normal=1.0)
    for objective in ("angle", "force", "friction_use"):
        state = rg.choose_state(grasp, load, objective, min_normal=1.0, peak_ratio=1)
        assert state.magnitudes.max() <= smallest.value * (1 + 1e-6)
        assert state.forces == pytest.approx(smallest.forces, abs=1e-3)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("size", [1e90, 1e100, 1.01e100, 1e155, 1e308])
def test_limits_without_end_are_kept_or_refused(size) -> None:
    grasp, load = random_case(6)
    for objective in OBJECTIVES:
        for held, options in (
            (grasp, {"max_force": size}),
            (rg.Grasp(c.changed(max_force=size) for c in grasp), {}),
        ):
            if size > 1e100:
                with pytest.raises(rg.InvalidInput, match=r"max_force.* must be at most 1e\+100 N, got"):
                    rg.choose_state(held, load, objective, **options)
            else:
                assert rg.choose_state(held, load, objective, **options).residual < 1e-12


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("size", [5e-324, 1e-300, 1e-99, 1e99, 1e200, 1e308])
def test_costs_of_any_size_have_a_meaning_or_are_refused(size) -> None:
    grasp, load = random_case(6)
    n, w = len(grasp), grasp.width
    kinds = [
        {"weights": size},
        {"weights": [size, *[1.0] * (n - 1)]},
        {"towards": [[size] * w] * n},
        {"prices": [[size] * w] * n},
        {"prices": [[-size, *[1.0] * (w - 1)]] * n, "weights": 1e-90},
    ]
    answered = 0
    for kind in kinds:
        try:
            cost = rg.ForceCost("dear", **kind)
        except rg.InvalidInput:
            assert not 1e-100 < size < 1e10
            continue
        try:
            state = rg.choose_state(grasp, load, cost)
        except rg.RegraspError:  # forces so large that no solver tells them apart
            assert size > 1
            continue
        answered += 1
        assert state.residual < 1e-9
        assert np.isfinite(state.value)
    assert answered or size > 1e100

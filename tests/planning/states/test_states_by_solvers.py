"""The best state against solvers: Clarabel through regrasp's programs, and cvxpy without any of it."""

import warnings
from math import inf

import numpy as np
import pytest

import regrasp as rg
from models import LIMITED, OBJECTIVES, ConvexChoice
from strategies import comfortable_pair, comfortable_triple

pytestmark = pytest.mark.oracle


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_closed_form_and_clarabel_agree(objective: str) -> None:
    """To 1e-6 relative; effort reaches 1e-9 because Clarabel's answer is moved into exact equilibrium."""
    rng = np.random.default_rng(10)
    for case in range(12 if objective == "angle" else 40):
        grasp, load = comfortable_pair(rng)
        options = {"max_force": 20.0} if case % 3 == 0 else {"peak_ratio": 2.0} if case % 3 == 1 else {}
        try:
            ours = rg.choose_state(grasp, load, objective, **options)
        except rg.Infeasible:  # the limit
            with pytest.raises(rg.Infeasible):
                rg.choose_state(grasp, load, objective, method="clarabel", **options)
            continue
        solved = rg.choose_state(grasp, load, objective, method="clarabel", **options)
        assert solved.method == "clarabel"
        assert ours.method == "closed-form"
        assert ours.value == pytest.approx(solved.value, rel=1e-6, abs=1e-7)
        assert rg.choose_state(grasp, load, objective, method="auto", **options) == ours


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize("fingers", [2, 3])
def test_cvxpy_finds_no_better(fingers: int, objective: str) -> None:
    rng = np.random.default_rng(20 + fingers)
    for case in range(3 if objective in ("angle", "friction_use") else 6):
        grasp, load = comfortable_pair(rng) if fingers == 2 else comfortable_triple(rng)
        model = ConvexChoice(
            grasp.positions, grasp.normals, grasp.frictions, load.vector, float(abs(load.vector).max())
        )
        state = rg.choose_state(grasp, load, objective, max_force=50.0 if case % 2 else None)
        limits = [50.0 if case % 2 else inf] * fingers
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # cvxpy's, of an answer it calls inaccurate
            if objective in LIMITED and inf in limits:
                limits = [3.0 * model.best("peak", limits)] * fingers
            assert state.value == pytest.approx(model.best(objective, limits), rel=1e-6, abs=1e-7)

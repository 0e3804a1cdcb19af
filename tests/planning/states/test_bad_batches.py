"""What batches of two contacts refuse, to the word."""

from collections.abc import Callable
from math import inf, isnan, nan

import numpy as np
import pytest

import regrasp as rg
from models import OBJECTIVES
from regrasp.closed_form.compiled.two_fingers import BLOCK

pytestmark = pytest.mark.oracle

PAPER = {
    "r1": [-4, -4], "n1": [1, 1], "mu1": 0.3, "r2": [4, -5], "n2": [-1, 2], "mu2": 0.3, "force": [-1.5, -3.5],
    "torque": 0.0,
}  # fmt: skip


def spoiled(name: str, value: float | list[float], count: int = 3 * BLOCK, at: int = 2 * BLOCK + 5) -> dict:
    """The paper's pair many times over, with one entry of one argument replaced, far inside a block."""
    base = np.array(PAPER[name], float)
    values = np.tile(base, (count,) + (1,) * base.ndim)
    values[at] = value
    return PAPER | {name: values}


BAD_ARGUMENTS = [
    ({"r1": [1, 2, 3]}, "r1 must have shape (..., 2), got (3,)"),
    ({"n2": 1.0}, "n2 must have shape (..., 2), got ()"),
    ({"mu1": "rough"}, "mu1 must be an array of numbers, got str"),
    ({"force": None}, "force must be an array of numbers, got NoneType"),
    (
        {"r1": np.ones((3, 2)), "mu2": np.ones(4)},
        "leading shapes must broadcast, got "
        "r1 (3,), n1 (), mu1 (), r2 (), n2 (), mu2 (4,), force (), torque ()",
    ),
    (spoiled("r1", [nan, 0]), "r1 must be finite, got 1 entries that are not"),
    (spoiled("r2", [inf, -inf]), "r2 must be finite, got 2 entries that are not"),
    (spoiled("force", [0, nan]), "force must be finite, got 1 entries that are not"),
    (spoiled("torque", inf), "torque must be finite, got 1 entries that are not"),
    (spoiled("mu1", nan), "mu1 must be finite, got 1 entries that are not"),
    (spoiled("mu2", -1e-300), "mu2 must be at least 0 everywhere"),
    (spoiled("n1", [0, 0]), "n1 must not be zero; give the direction that points into the object"),
    (spoiled("n2", [0, 0]), "n2 must not be zero; give the direction that points into the object"),
    (
        spoiled("r2", PAPER["r1"]),
        "r1 and r2 coincide in at least one pair; place contacts at different points",
    ),
    ({"n1": [0, 0]}, "n1 must not be zero; give the direction that points into the object"),
    ({"mu1": -0.1}, "mu1 must be at least 0 everywhere"),
]  # fmt: skip


@pytest.mark.parametrize("function", [rg.locus_intervals, rg.best_squeezes])
@pytest.mark.parametrize(("changes", "message"), BAD_ARGUMENTS, ids=[m for _, m in BAD_ARGUMENTS])
def test_bad_contacts_and_loads_are_refused(function: Callable, changes: dict, message: str) -> None:
    if function is rg.best_squeezes and message.startswith("leading"):
        message += ", limit1 (), limit2 ()"
    with pytest.raises(rg.InvalidInput) as refused:
        function(**PAPER | changes)
    assert str(refused.value) == message


def one_limit_of_zero() -> np.ndarray:
    limits = np.ones(2 * BLOCK)
    limits[BLOCK + 1] = 0
    return limits


BAD_OPTIONS = [
    (
        {"objective": "speed"},
        f"objective must be one of {', '.join(OBJECTIVES)}, sum_normal, wrench; got 'speed'",
    ),
    ({"peak_ratio": 0.5}, "peak_ratio must be at least 1, got 0.5"),
    ({"peak_ratio": nan}, "peak_ratio must be finite, got nan"),
    ({"max_force": 0.0}, "max_force must be greater than 0 everywhere"),
    ({"max_force": nan}, "max_force must be greater than 0 everywhere"),
    ({"max_force": (1.0, -1.0)}, "max_force must be greater than 0 everywhere"),
    ({"max_force": one_limit_of_zero()}, "max_force must be greater than 0 everywhere"),
    ({"max_force": (1.0, 2.0, 3.0)}, "max_force must be one limit or a tuple of two, got a tuple of 3"),
    ({"max_force": "none"}, "limit1 must be an array of numbers, got str"),
    ({"force": [0, 0]}, "objective 'angle' under a zero load needs max_force"),
    ({"force": [0, 0], "objective": "force"}, "objective 'force' under a zero load needs max_force"),
    ({"force": [0, 0], "max_force": (1.0, None)}, "objective 'angle' under a zero load needs max_force"),
    (spoiled("force", [0, 0]), "objective 'angle' under a zero load needs max_force"),
]


@pytest.mark.parametrize(("changes", "message"), BAD_OPTIONS, ids=[m for _, m in BAD_OPTIONS])
def test_bad_options_are_refused(changes: dict, message: str) -> None:
    with pytest.raises(rg.InvalidInput) as refused:
        rg.best_squeezes(**PAPER | changes)
    assert str(refused.value) == message


@pytest.mark.parametrize("changes", [{"objective": "peak"}, {"max_force": 1.0}, {"torque": 0.1}])
def test_what_is_no_zero_load_or_needs_no_limit_is_not_refused(changes: dict) -> None:
    rg.best_squeezes(**PAPER | {"force": [0, 0]} | changes)


def test_no_state_is_nan_and_no_error() -> None:
    data = PAPER | {"n1": [[1, 1], [-1, -1]]}
    lo, hi = rg.locus_intervals(**data)
    assert (lo[1], hi[1]) == (inf, -inf)
    assert [isnan(x) for x in rg.best_squeezes(**data)] == [False, True]

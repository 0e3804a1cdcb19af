"""Arc lengths by verify on cubics that stop: by hand, (s^2, s^3) has a cusp at 0."""

import numpy as np
import pytest

from regrasp.verification.placed.arc_lengths import lengths_to

pytestmark = pytest.mark.oracle


def cusp(lo: float, hi: float) -> np.ndarray:
    """(4, 2) control points from s to s."""
    each = [(lo, lo, lo), (lo, lo, hi), (lo, hi, hi), (hi, hi, hi)]
    return np.array([((a * b + b * c + c * a) / 3, a * b * c) for a, b, c in each])


def length(s: float) -> float:
    """From the cusp: the integral of s root(4 + 9 s^2)."""
    return ((4 + 9 * s * s) ** 1.5 - 8) / 27


def test_lengths_past_a_cusp() -> None:
    control, ends = np.array([cusp(-0.3, 0.7), cusp(-0.61, 0.4)]), np.array([1.0, 0.9])
    past = [0.7, -0.61 + 0.9 * 1.01]
    wanted = [length(0.3) + length(past[0]), length(0.61) + length(past[1])]
    assert lengths_to(control, ends) == pytest.approx(wanted, rel=1e-13)

"""The margin of a turning load under limits of either finger, against the formula of one grasp."""

from collections import Counter
from dataclasses import replace
from math import atan, inf, isnan

import numpy as np
import pytest

from regrasp.closed_form.best import margin_tangent
from regrasp.closed_form.choice import ANGLE, best_squeeze
from regrasp.closed_form.load_cone import own_reach, pair_for_turning
from regrasp.closed_form.turning_margin import NO_HOLD, UNSURE, turning_margin
from strategies import random_pair

pytestmark = pytest.mark.oracle


@pytest.mark.parametrize("swapped", [False, True])
def test_each_finger_s_limit_binds(swapped: bool) -> None:
    """Below what goes across the line of contacts no squeeze helps, whichever finger it is."""
    rng, seen = np.random.default_rng(6), Counter()
    while seen.total() < 600:
        pair = random_pair(rng, facing=1.0)
        pair = pair.swapped() if swapped else pair
        pair = pair.loaded_through((0.0, 0.0), pair.force)
        if rng.random() < 0.5:  # so wide that a force straight across the line is inside a cone
            pair = replace(pair, mu1=float(rng.uniform(2, 8)), mu2=float(rng.uniform(2, 8)))
        if min(pair.mu1, pair.mu2) < 0.05 or not any(pair.force):
            continue
        scale1, scale2 = 1 / np.hypot(*pair.n1), 1 / np.hypot(*pair.n2)
        pair = pair.scaled(normals=(float(scale1), float(scale2)))
        if isnan(best_squeeze(*pair.plain, ANGLE, inf, inf, 3.0)[0]):
            continue
        turned, along1, along2, _ = pair_for_turning(*pair.r1, *pair.n1, *pair.r2, *pair.n2)
        one, two = (tuple(map(np.float64, (*c, mu))) for c, mu in ((along1, pair.mu1), (along2, pair.mu2)))
        _, _, ax, ay, bx, by = turned
        across = [abs(ax * pair.force[0] + ay * pair.force[1]), abs(bx * pair.force[0] + by * pair.force[1])]
        limits = [inf if rng.random() < 0.3 else c * float(rng.uniform(0.5, 4)) + 1e-3 for c in across]
        ratio = 3.0 if inf in limits else inf
        with np.errstate(
            divide="ignore", invalid="ignore"
        ):  # as compiled: an edge along the line bounds nothing
            reaches = own_reach(one), own_reach(two)
            force = tuple(map(np.float64, pair.force))
            limited = min(limits) < inf
            margin = turning_margin(*force, turned, one, two, *reaches, limited, *limits, ratio, 1e-9)
        if margin == UNSURE:
            continue
        x, f, _ = best_squeeze(*pair.plain, ANGLE, *limits, 3.0)
        assert (margin == NO_HOLD) == isnan(x), (pair, limits)
        if not isnan(x):
            tangents = [
                margin_tangent(n[0] * fx + n[1] * fy, abs(n[0] * fy - n[1] * fx), mu)
                for n, mu, fx, fy in ((pair.n1, pair.mu1, *f[:2]), (pair.n2, pair.mu2, *f[2:]))
            ]
            assert margin == pytest.approx(max(atan(min(tangents)), 0.0), abs=1e-7)
        low = [limit < c for limit, c in zip(limits, across, strict=True)]
        seen["first" if low == [True, False] else "second" if low == [False, True] else "other"] += 1
    assert min(seen["first"], seen["second"]) > 20

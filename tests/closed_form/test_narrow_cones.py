"""Loci of cones that are nearly rays, against membership in rational arithmetic: no finger pulls."""

from math import inf

import numpy as np
import pytest

import regrasp as rg
from exact_judge import is_held, state_faults
from regrasp.closed_form.locus import cone_interval

pytestmark = pytest.mark.oracle

FRICTIONS = (0.0, 1e-16, 1e-13, 1e-11, 1e-9, 1e-6, 1e-3, 0.5, 1.5)


def held(grasp: rg.Grasp, load: np.ndarray) -> bool:
    return is_held(grasp.positions, grasp.normals, grasp.frictions, load)


@pytest.mark.parametrize("friction", [0.0, 1e-16, 1e-13, 1e-11, 1e-9, 1e-6, 1e-3, 1.9e-3])
def test_a_finger_above_would_have_to_pull(friction: float) -> None:
    """The weight passes beside the support by 1e-6; the finger facing down would have to pull by as much."""
    grasp = rg.Grasp(
        [
            rg.Contact([0, 0], [0, 1], 1.5),
            rg.Contact([-1, 3], [0, -1], friction),
            rg.Contact([-1, 0], [0, 1], 0.8),
        ]
    )
    load = rg.Wrench([0, -1], 1e-6)
    for reserve in (0.0, 1e-9, 0.1):
        for objective in ("effort", "angle"):
            with pytest.raises(rg.Infeasible) as error:
                rg.plan_removal(grasp, 2, load=load, objective=objective, reserve=reserve)
            assert error.value.certificate.is_proof
    first, second = grasp[0], grasp[1]
    lo, hi = rg.locus_intervals(
        first.position, first.normal, 1.5, second.position, second.normal, friction, [0, -1], 1e-6
    )
    assert (lo, hi) == (inf, -inf)


@pytest.mark.parametrize("seed", range(3))
def test_both_nappes_of_narrow_cones(seed: int) -> None:
    """The load that a force along an edge or a ray holds, and the one that its negative would."""
    rng, seen = np.random.default_rng(seed), {True: 0, False: 0}
    for _ in range(250):
        r, n = rng.normal(size=(2, 2, 2))
        n /= np.linalg.norm(n, axis=1)[:, None]
        mu = rng.choice(FRICTIONS, 2)
        size = 10.0 ** rng.uniform(-7, 0, 2) * rng.choice([-1.0, 1.0], 2, p=[0.3, 0.7])
        f = size[:, None] * n
        load = -np.array([*f.sum(axis=0), (r[:, 0] * f[:, 1] - r[:, 1] * f[:, 0]).sum()])
        lo, hi = rg.locus_intervals(r[0], n[0], mu[0], r[1], n[1], mu[1], load[:2], load[2])
        grasp = rg.Grasp(rg.Contact(*c) for c in zip(r, n, mu.tolist(), strict=True))
        rays = bool((mu < 1e-12).any())  # of rays rounding of the load decides, in rational arithmetic, too
        if not rays:
            assert (lo <= hi) == held(grasp, load)
        if (size < 0).all() or (rays and (size[mu < 1e-12] < 0).any() and held(grasp, load) is False):
            assert lo > hi
        if (size > 0).all():
            assert lo <= hi
        seen[bool(lo <= hi)] += 1
        try:
            state = rg.choose_state(grasp, rg.Wrench.from_vector(load), "effort", reserve=0.0)
        except rg.Infeasible:
            assert not (size > 0).all()
            continue
        faults = state_faults(r, grasp.normals, np.maximum(mu, 0), np.full(2, inf), load, state.forces)
        assert faults == [] or all("cone" in fault for fault in faults)  # by the last bit, without a reserve
        assert not any("pulls" in fault for fault in faults)
    assert min(seen.values()) > 50


def test_the_interval_of_one_cone_is_empty_exactly_on_its_negative() -> None:
    rng = np.random.default_rng(4)
    for _ in range(2000):
        angle, mu, across = (
            rng.uniform(-3.1, 3.1),
            10.0 ** rng.uniform(-18, 0),
            rng.choice([-1, 1]) * 10.0 ** rng.uniform(-12, 3),
        )
        c, s = float(np.cos(angle)), float(np.sin(angle))
        if abs(s) < 1e-6:
            continue
        lo, hi = cone_interval(c, s, mu, across, 1e-12)
        if mu * abs(c) < abs(s):  # neither edge is beyond the line: each bounds one side
            assert (lo <= hi) == (across * s > 0), (c, s, mu, across)
            if lo <= hi:
                middle = (lo + hi) / 2
                assert c * middle + s * across > 0


def test_what_is_lost_in_rounding_is_no_force() -> None:
    """Across the line of contacts 32 units of rounding of the other force, and no more, are nothing."""
    for lost, empty in ((1e-16, False), (6e-15, False), (1e-14, True), (1e-12, True)):
        lo, hi = rg.locus_intervals([0, 0], [1, 0], 0.5, [1, 0], [1, 0], 0.5, [-1, 0], -lost)
        alone = rg.locus_intervals([0, 0], [0, 1], 0.5, [1, 0], [0, 1], 0.5, [0, -1], lost)
        assert (alone[0] > alone[1]) == empty, lost
        assert lo <= hi or empty

"""Forces that a solver leaves at fingers that need not push: idle, or they push."""

import numpy as np
import pytest

import regrasp as rg
from space import random_grasp, random_load, random_rotation
from strategies import comfortable_triple

pytestmark = pytest.mark.laws

OBJECTIVES = ("angle", "friction_use", "effort", "peak", "peak_normal", "force")


@pytest.mark.parametrize("kind", ["triples", "in a row", "towards the load", "space"])
def test_no_finger_carries_a_trace(kind: str) -> None:
    rng, chosen = np.random.default_rng(11), 0
    for _ in range(25):
        if kind == "triples":
            grasp, load = comfortable_triple(rng)
        elif kind == "space":
            grasp, load = random_grasp(rng, 4), random_load(rng)
        elif kind == "in a row":  # nearly on a line
            places = rng.integers(-3, 4, (3, 2)) + 1e-3 * rng.integers(0, 2, (3, 2))
            if len({tuple(p) for p in places.tolist()}) < 3:
                continue
            grasp = rg.Grasp(
                rg.Contact(p, 0.3 * rng.normal(size=2) - p if p.any() else [1, 0], 0.5) for p in places
            )
            load = rg.Wrench([0, -1])
        else:  # one finger can hold it alone
            angles = np.array([0.5, 1.2, 4.7]) + 0.1 * rng.normal(size=3)
            around = np.column_stack([np.cos(angles), np.sin(angles)])
            grasp = rg.Grasp(rg.Contact(p, -p, 0.5) for p in around)
            load = rg.Wrench(-grasp[0].normal)
        for objective in OBJECTIVES[: 2 if kind == "space" else 6]:
            try:
                state = rg.choose_state(grasp, load, objective)
            except rg.Infeasible:
                continue
            share = state.magnitudes / state.magnitudes.max()
            assert ((share == 0) | (share > 1e-5)).all(), (grasp, load, objective, share)
            chosen += 1
    assert chosen > 15


@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("objective", ["peak", "effort", "peak_normal"])
def test_a_smooth_finger_between_two_rough_ones(seed: int, objective: str) -> None:
    """The smooth one could push against both; the least of everything leaves it alone, to the last digit."""
    rng = np.random.default_rng(seed)
    turn, length, force = random_rotation(rng), 10.0 ** rng.integers(-3, 4), 10.0 ** rng.integers(-3, 4)
    reach, mu = (1.0, 1.0) if seed == 0 else (rng.uniform(0.3, 3), rng.uniform(0.9, 2))
    places = (((-reach, 0, 0), (1, 0, 0), 0.0), ((0, 0, -1), (0, 0, 1), mu), ((0, 0, 1), (0, 0, -1), mu))
    grasp = rg.Grasp(rg.Contact(length * turn @ r, turn @ n, m) for r, n, m in places)
    state = rg.choose_state(grasp, rg.Wrench(force * turn @ [0, -1, 0]), objective)
    assert state.magnitudes[0] <= 1e-9 * state.magnitudes.max()
    assert state.value == pytest.approx(
        {"peak": force * np.hypot(0.5, 0.5 / mu), "effort": 2 * force**2 * (0.25 + 0.25 / mu**2),
         "peak_normal": force * 0.5 / mu}[objective], rel=1e-8,
    )  # fmt: skip


def test_levels_of_next_to_no_friction_end() -> None:
    """Margins of frictions of 6e-10 are read to a millionth of them; the search gets on all the same."""
    grasp = rg.Grasp(
        [
            rg.Contact([0, 0], [1.56, -1.03], 6e-10),
            rg.Contact([2.7, -2.69], [-0.525, 0.527], 6e-10),
            rg.Contact([3.71, -3.11], [-0.836, 0.682], 6e-10),
        ]
    )
    for objective in OBJECTIVES:
        assert rg.choose_state(grasp, rg.Wrench([-1.35, -1.57]), objective).is_balanced()
    rng = np.random.default_rng(5)
    for power in (-10, -9, -8, -7, -6):
        for _ in range(3):
            slippery = rg.Grasp(
                c.changed(friction=10.0**power * rng.uniform(1, 9)) for c in comfortable_triple(rng)[0]
            )
            for objective in ("angle", "friction_use"):
                try:
                    state = rg.choose_state(slippery, rg.Wrench(rng.normal(size=2)), objective)
                except (rg.Infeasible, rg.SolverFailed):
                    continue
                assert state.is_balanced()

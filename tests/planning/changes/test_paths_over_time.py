"""Paths of least change by the band of their program: those of the whole program, or none."""

import numpy as np
import pytest

import regrasp as rg
from regrasp.planning.changes import banded_path
from regrasp.planning.changes.banded_path import least_change
from regrasp.planning.changes.path_program import PathTask, path_program
from regrasp.planning.changes.time_banded import solved_over_time
from regrasp.programs import solve

pytestmark = pytest.mark.oracle


def task(rng: np.random.Generator, instants: int, least: float = 0.0, sway: float = 0.2) -> PathTask:
    """A load that swings, three or four fingers, one of them perhaps without friction."""
    while True:
        n = int(rng.integers(3, 5))
        angles = 2 * np.pi * (np.arange(n) + rng.uniform(-0.2, 0.2, n)) / n
        mu = rng.uniform(0.4, 1.0, n)
        mu[0] = rng.choice([0.0, 0.6])
        points = np.column_stack([np.cos(angles), np.sin(angles)])
        grasp = rg.Grasp(rg.Contact(p, -p, m) for p, m in zip(points, mu, strict=True))
        load = rng.normal(size=3) * [1, 1, 0.1]
        try:
            ends = [
                rg.choose_state(grasp, rg.Wrench.from_vector(load), word, min_normal=1.5 * least)
                for word in ("effort", "force")
            ]
        except rg.Infeasible:
            continue
        t = np.linspace(0, 1, instants)
        loads = load + sway * np.linalg.norm(load) * np.sin(2 * np.pi * t)[:, None] * rng.normal(size=3)
        none = np.full(n, np.inf)
        return PathTask(
            grasp, t, loads, ends[0].forces, ends[1].forces, np.ones((instants, n), dtype=bool), t,
            grasp.frictions, none, none, np.full(n, least), np.ones(n, dtype=bool), float(abs(load).max()),
        )  # fmt: skip


@pytest.mark.parametrize("least", [0.0, 0.05])
def test_the_cost_and_the_forces_are_those_of_the_whole_program(monkeypatch, least) -> None:
    monkeypatch.setattr(banded_path, "_MANY", 3)
    rng, seen = np.random.default_rng(3), 0
    for _ in range(6):
        asked = task(rng, 30, least)
        found = least_change(asked)
        whole = solve(path_program(asked, "change"), "clarabel", throw=False)
        if found is None:
            assert whole.status.name != "SOLVED"
            continue
        seen += 1
        forces = asked.reference[1:-1] + asked.unit * whole.value.reshape(found.shape)
        assert abs(found - forces).max() <= 1e-4 * asked.unit
        costs = [
            (np.diff(np.concatenate([asked.start[None], f, asked.end[None]]), axis=0) ** 2).sum()
            for f in (found, forces)
        ]
        assert costs[0] == pytest.approx(costs[1], rel=1e-7)
        balance = np.einsum("rj,kj->kr", asked.grasp.matrix, found.reshape(len(found), -1))
        assert abs(balance + asked.loads[1:-1]).max() <= 1e-12 * asked.unit
    assert seen > 2


def test_limits_rates_and_idle_fingers_are_left_to_the_whole_program() -> None:
    asked = task(np.random.default_rng(4), 210, sway=0.0)
    assert least_change(asked) is not None
    some = np.where(np.arange(len(asked.grasp)) == 0, 5.0, np.inf)
    idle = asked.active.copy()
    idle[5, 1] = False
    from dataclasses import replace

    for other in (replace(asked, limits=some), replace(asked, rates=some), replace(asked, active=idle)):
        assert least_change(other) is None


@pytest.mark.parametrize(("instants", "method"), [(41, "clarabel"), (241, "time-banded")])
def test_the_record_names_what_found_the_path(instants: int, method: str) -> None:
    grasp = rg.Grasp(rg.Contact(r, [0, s], 0.5) for r, s in (([-1, -1], 1), ([1, -1], 1), ([0, 1], -1)))
    plan = rg.plan_hold(
        grasp, lambda t: rg.Wrench([0.1 * np.sin(6 * t), -1]), objective="effort", instants=instants
    )
    assert plan.record.path == method
    assert rg.verify(plan).ok


def test_a_program_without_a_point_has_no_answer() -> None:
    A, h = np.array([[1.0], [-1.0]]), np.full((50, 2), -0.5)
    assert solved_over_time(A, h, np.full(51, 51.0), np.zeros((50, 1))) is None
    h[:] = [0.5, -0.2]  # u between -0.5 and -0.2
    found = solved_over_time(A, h, np.full(51, 51.0), np.zeros((50, 1)))
    assert found is not None
    assert found[25, 0] == pytest.approx(-0.2, abs=1e-5)

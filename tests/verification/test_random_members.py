"""A hundred thousand members of the sets of fifty plans, at random instants: none leaves a cone."""

import numpy as np
import pytest

import regrasp as rg
from robust import answers, random_stiffness
from space import random_grasp, random_load
from strategies import comfortable_triple

pytestmark = pytest.mark.oracle

PLANS, MEMBERS, LIMIT = 50, 2000, 3.0


def least_slack(grasp: rg.Grasp, forces: np.ndarray) -> float:
    """The least distance of forces (m, n, d) to leaving cones and limits, by their definition."""
    normal = (forces * grasp.normals).sum(axis=-1)
    across = np.linalg.norm(forces - normal[..., None] * grasp.normals, axis=-1)
    room = grasp.frictions * normal - across
    return float(np.minimum(room, grasp.max_forces - np.linalg.norm(forces, axis=-1)).min())


def members(loads: rg.LoadSet, rng: np.random.Generator, count: int) -> np.ndarray:
    """Random members, half of them on the edge."""
    axes, corners = loads.half_axes, loads.vertices
    if axes is not None:
        z = rng.normal(size=(count, axes.shape[1]))
        z /= np.linalg.norm(z, axis=1)[:, None]
        z[::2] *= rng.random((len(z[::2]), 1))
        return loads.center.vector + z @ axes.T
    weights = rng.dirichlet(np.full(len(corners), 0.3), count)
    return weights @ corners


def plans(rng: np.random.Generator):
    """Plans of one change of random grasps, and the sets that they withstand."""
    found = 0
    while found < PLANS:
        plane = found % 5 != 4
        grasp, load = comfortable_triple(rng) if plane else (random_grasp(rng, 4, 0.8), random_load(rng))
        stiffness = random_stiffness(rng, len(grasp))
        rest = None if stiffness is None else stiffness[:-1]
        zero = 0.0 * load
        if rng.random() < 0.5:
            unit = rg.LoadSet.ball(zero, force=1.0, torque=0.4)
        else:
            spread = 0.7 * rng.normal(size=(4, load.vector.size))
            unit = rg.LoadSet.hull([zero, *map(rg.Wrench.from_vector, spread)], center=zero)
        asked = {"max_force": LIMIT * np.linalg.norm(load.force)}
        try:
            less = grasp.without(len(grasp) - 1)
            widest = rg.choose_state(less, load, "wrench", disturbance=unit, stiffness=rest, **asked)
            loads = unit.scaled(0.9 * widest.value)
            plan = rg.plan_removal(
                grasp,
                len(grasp) - 1,
                load=load,
                disturbance=loads,
                stiffness=stiffness,
                objective="force",
                **asked,
            )
        except (rg.Infeasible, rg.InvalidInput):  # a set too wide for the state with all fingers, or no hold
            continue
        if widest.value < 1e-3:
            continue
        found += 1
        yield plan, loads, stiffness


def test_no_member_breaks_a_plan() -> None:
    rng, tried, close = np.random.default_rng(0), 0, 0
    for plan, loads, stiffness in plans(rng):
        assert rg.verify(plan, disturbance=loads, stiffness=stiffness).ok
        grasp, gone = plan.grasp, len(plan.grasp) - 1
        deviations = members(loads, rng, MEMBERS)
        forces = plan.forces(rng.choice([0.0, 1.0, *rng.random(18)], MEMBERS))
        change = deviations @ answers(grasp, stiffness, (gone,)).T
        assert least_slack(grasp, forces + change.reshape(forces.shape)) >= 0
        own = deviations @ answers(grasp, stiffness).T
        assert least_slack(grasp, plan.start.forces + own.reshape(forces.shape)) >= 0
        wider = 1.3 * change
        close += least_slack(grasp, forces + wider.reshape(forces.shape)) < 0
        tried += MEMBERS
    assert tried >= 100_000
    assert close > 10  # sets are near the widest, so that the test can fail

"""Random planar grasps, what each back end is asked of them, and how well it must agree."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from math import cos, inf, pi

import numpy as np
import pytest

import regrasp as rg
from regrasp.programs import available_backends

FACETS = 24
"""Sides of the polygons that stand for circles, where a back end takes no second-order cones."""


@dataclass(frozen=True)
class Agreement:
    """relative: largest difference from Clarabel's optimum. grasps: how many are tried, fewer by slow ones.

    refused: the share of held grasps, over all objectives, that it may refuse without an answer.
    """

    relative: float
    grasps: int
    refused: float
    facets: int | None = FACETS


# Active-set and interior-point methods, first-order methods, and cvxpy, whose default is one of the latter.
AGREEMENT = {
    "daqp": Agreement(1e-8, 90, 0.0),
    "quadprog": Agreement(1e-8, 90, 0.0),
    "highs": Agreement(1e-8, 90, 0.01),
    "piqp": Agreement(1e-6, 90, 0.0),
    "proxqp": Agreement(1e-6, 20, 0.2),
    "qpalm": Agreement(1e-6, 40, 0.05),
    "osqp": Agreement(1e-5, 8, 0.3),
    "scs": Agreement(1e-5, 20, 0.1),
    "cvxpy": Agreement(1e-6, 20, 0.1, None),
    "cvxpy:CLARABEL": Agreement(1e-6, 20, 0.0, None),
}
LEVELS = ("angle", "friction_use")
LEVEL = 3e-7
"""Levels are searched to 1e-7 [rad or -], whatever their size."""


def installed() -> list[str]:
    return [name for name in AGREEMENT if name.partition(":")[0] in available_backends()]


@dataclass(frozen=True)
class Case:
    """A grasp and a load; limits of the choice besides the contacts' own."""

    grasp: rg.Grasp
    load: rg.Wrench
    options: dict[str, float] = field(default_factory=dict)

    @property
    def limits(self) -> np.ndarray:
        """(n,) force limits, infinite where there is none."""
        return np.minimum(self.grasp.max_forces, self.options.get("max_force", inf))


def random_cases(count: int, seed: int) -> Iterator[Case]:
    """Two to six contacts, roughly facing the middle; some limited, some that cannot hold."""
    rng = np.random.default_rng(seed)
    for k in range(count):
        contacts = []
        kind = rng.integers(4)
        for point in rng.normal(size=(2 + k % 5, 2)):
            limit = rng.uniform(1, 6) if kind == 0 and rng.random() < 0.6 else None
            normal = rng.normal(size=2) - (2 if k % 5 == 0 else 1) * point
            contacts.append(rg.Contact(point, normal, rng.uniform(0.05, 1.0), max_force=limit))
        options = {"max_force": rng.uniform(1, 20)} if kind == 1 else {}
        yield Case(rg.Grasp(contacts), rg.Wrench(rng.normal(size=2), 0.3 * rng.normal()), options)


def chosen(case: Case, objective: str, method: str, facets: int | None = None) -> rg.GraspState | None:
    """The best state, checked; None with a proof that there is none. Refusals pass through."""
    try:
        state = rg.choose_state(
            case.grasp, case.load, objective, method=method, facets=facets, **case.options
        )
    except rg.Infeasible as reason:
        if reason.certificate is None or not reason.certificate.is_proof:
            pytest.fail(f"infeasible without a proof: {reason}")
        return None
    assert state.is_balanced()
    assert (state.magnitudes <= case.limits).all()
    return state


def value(state: rg.GraspState, objective: str, facets: int | None) -> float:
    """The optimum; of ``peak`` over polygons their radius, since forces of many sizes share the least one."""
    if objective != "peak" or facets is None:
        return state.value
    angles = 2 * pi * np.arange(facets) / facets
    return (state.forces @ np.array([np.cos(angles), np.sin(angles)])).max() / cos(pi / facets)


def difference(found: float, expected: float, objective: str, size: float) -> float:
    """Relative difference of two optima, ``size`` the largest force; levels are 1 in size."""
    if objective in LEVELS:
        return max(abs(found - expected) - LEVEL, 0.0)
    return abs(found - expected) / max(
        abs(expected), 1e-2 * size**2 if objective == "effort" else 1e-2 * size
    )

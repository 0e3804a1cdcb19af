"""Functions of a case for the benchmark and the examples of studies, where workers find them."""

import time

import numpy as np

import regrasp as rg
from regrasp.outline import parts


def spun(number: int, milliseconds: float) -> float:
    """Work of a known length that no memory disturbs."""
    end = time.perf_counter() + 1e-3 * milliseconds
    while time.perf_counter() < end:
        pass
    return float(number) ** 0.5


def counted(number: int, loops: int) -> float:
    """Work of a known amount."""
    total = 0.0
    for k in range(loops):
        total += k % 7
    return total + number


def regrasp(seed: int, friction: float, part: str) -> dict[str, float]:
    """A regrasp between two random grasps of three fingers on a part, under its weight."""
    rng = np.random.default_rng(seed)
    outline = _outline(part)
    start, goal = (
        rg.Grasp(outline.contact_at(s, friction=friction) for s in np.sort(rng.uniform(0, outline.length, 3)))
        for _ in range(2)
    )
    plan = rg.plan_regrasp(
        outline, start, goal, rg.Wrench([0, -2.0]), friction=friction, orientations=12, candidates=60
    )
    return {"margin": plan.margin, "moves": len(plan.moves)}


def removal(seed: int, friction: float) -> dict[str, float]:
    """The first of three random fingers of an ellipse leaves."""
    rng = np.random.default_rng(seed)
    ellipse = _ellipse()
    grasp = rg.Grasp(ellipse.contact_at(s, friction=friction) for s in rng.uniform(0, ellipse.length, 3))
    plan = rg.plan_removal(grasp, 0, load=rg.Wrench([0, -2.0]))
    return {"margin": float(np.nanmin(plan.margins([0.0, plan.duration]).angle))}


_SHAPES: dict[str, rg.Outline] = {}


def _outline(part: str) -> rg.Outline:
    if part not in _SHAPES:
        _SHAPES[part] = parts.PARTS[part]()
    return _SHAPES[part]


def _ellipse() -> rg.Outline:
    if "ellipse" not in _SHAPES:
        _SHAPES["ellipse"] = rg.Outline.ellipse(0.06, 0.03)
    return _SHAPES["ellipse"]

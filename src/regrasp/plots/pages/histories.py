"""Margins and forces of every finger over a plan's time, as plain lists for pages."""

from math import inf, isfinite
from typing import Any, NamedTuple

import numpy as np

from regrasp.plans.regrasp_plan import RegraspPlan

_SAMPLES, _MOST = 41, 1200  # of a step, and of a plan
_ALONE = 201  # of a plan of one step


class Histories(NamedTuple):
    """times [s], and for each finger its ``name``, ``margins`` [deg], ``forces`` [N] and ``limit`` [N].

    Where any step was planned under rate limits ``rates`` and ``rate_limit`` [N/s], too. None where a finger
    is in the air, has no force and so no angle, or has no limit.
    """

    times: list[float]
    lines: list[dict[str, Any]]

    @property
    def has_rates(self) -> bool:
        """Whether any step was planned under rate limits."""
        return "rates" in self.lines[0]


def histories(plan: RegraspPlan) -> Histories:
    """Angle margins and forces of every finger, and the limits of their contacts."""
    count = len(plan.fingers[0])
    margins: list[list[float | None]] = [[] for _ in range(count)]
    forces: list[list[float | None]] = [[] for _ in range(count)]
    rates: list[list[float | None]] = [[] for _ in range(count)]
    limits, fastest, times, elapsed = [inf] * count, [inf] * count, [], 0.0
    samples = _ALONE if len(plan.steps) == 1 else min(_SAMPLES, max(2, _MOST // len(plan.steps)))
    for step, names in zip(plan.steps, plan.fingers, strict=True):
        t = np.linspace(0, step.duration, samples)
        times += [rounded(elapsed + x) for x in t.tolist()]
        angle = np.degrees(step.margins(t).angle)
        size = np.linalg.norm(step.forces(t)[..., : step.grasp.dimension], axis=-1)
        speed = np.linalg.norm(step.rates(t)[..., : step.grasp.dimension], axis=-1)
        for i, name in enumerate(names):
            j = None if name is None else step.grasp.index(name)
            margins[i] += [None] * samples if j is None else _gaps(angle[:, j])
            forces[i] += [None] * samples if j is None else _gaps(size[:, j])
            most = None if j is None else step.grasp[j].max_force
            limits[i] = min(limits[i], inf if most is None else float(most))
            rates[i] += [None] * samples if j is None else _gaps(speed[:, j])
            if j is not None and step.record.rate_limits:
                fastest[i] = min(fastest[i], step.record.rate_limits[j])
        elapsed += step.duration
    own = len(plan.steps) == 1
    shown = [str(name) if own else str(i) for i, name in enumerate(plan.fingers[0], 1)]
    lines = [
        {"name": name, "margins": m, "forces": f, "limit": limit if isfinite(limit) else None}
        for name, m, f, limit in zip(shown, margins, forces, limits, strict=True)
    ]
    if min(fastest) < inf:
        for line, r, limit in zip(lines, rates, fastest, strict=True):
            line |= {"rates": r, "rate_limit": limit if isfinite(limit) else None}
    return Histories(times, lines)


def finger_names(plan: RegraspPlan) -> list[str]:
    """For each finger the contacts it makes, in order."""
    return [
        ", then ".join(dict.fromkeys(name for name in names if name is not None))
        for names in zip(*plan.fingers, strict=True)
    ]


def rounded(value: float) -> float:
    """To six digits, which a picture does not show; no -0."""
    return float(f"{value:.6g}") + 0.0


def _gaps(values: Any) -> list[float | None]:
    return [rounded(v) if isfinite(v) else None for v in values.tolist()]

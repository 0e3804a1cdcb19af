"""What a transition says of itself: both ends, how they were chosen, and what the way needs."""

from math import degrees
from typing import Any

import numpy as np

from regrasp.mechanics.margins import margins


def told(plan: Any) -> str:
    """The transition in words and numbers."""
    record, width = plan.record, max(8, *(len(name) + 1 for name in plan.grasp.names))
    lines = [
        f"{plan.in_words} in {plan.duration:g} s under {plan.path.load_in_words(plan.start, plan.end)}",
        f"{'':{width}}{'start force':>24}{'end force':>24}{'least margin':>14}",
        *_rows(plan, width),
    ]
    for c in record.choices:
        limits = ", ".join(f"{limit:.4g}" for limit in c.force_limits)
        lines.append(f"{c.end} chosen for {c.objective} by {c.method}, force limits {limits}")
    for label, idle in (("start", plan.idle_at_start), ("end", plan.idle_at_end)):
        held = [name for name in plan.grasp.names if name not in idle]
        free = plan.grasp.subset(held).freedom
        if free is not None:
            lines.append(f"at the {label} no force of {', '.join(held)} resists {free}")
    lines += plan.path.in_words(plan.start, plan.end, record.path, record.path_objective)
    if record.rate_limits:
        lines.append(f"rates below {', '.join(f'{r:.4g}' for r in record.rate_limits)}")
    if record.withstands is not None:
        lines.append(f"withstands {record.withstands}")
    if record.balancing:
        lines.append(f"given forces were balanced; largest change {record.balancing:.2g}")
    return "\n".join(lines)


def _rows(plan: Any, width: int) -> list[str]:
    """A line for each contact: its forces at both ends and its least margin on the way."""
    cones, forces = plan.grasp.cones, plan.path.deciding(plan.start, plan.end)
    angles = margins(cones.measured(forces), cones.normals, plan.grasp.frictions).angle
    largest = max(plan.start.magnitudes.max(), plan.end.magnitudes.max())
    form = "10.4f" if 0.1 <= largest < 1e5 or largest == 0 else "11.3e"  # any units, readable in newtons
    lines = []
    for i, name in enumerate(plan.grasp.names):
        start, end = (" ".join(format(x + 0.0, form) for x in s.forces[i]) for s in (plan.start, plan.end))
        margin = np.fmin.reduce(angles[:, i])
        shown = "" if np.isnan(margin) else f"{degrees(margin):8.2f} deg"
        lines.append(f"{name:{width}}{start:>24}{end:>24}{shown:>14}")
    return lines

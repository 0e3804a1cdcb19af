"""Answers are compared before their times are."""

import numpy as np

from pairs import Array, Quadratic, chosen
from regrasp.mechanics.margins import margins

TOLERANCE = 1e-5
"""A few times what DAQP allows a constraint by default, 1e-6."""


def check_agreement(pairs: list[tuple[float, ...]], programs: list[list[Quadratic]], objective: str) -> None:
    """Raise unless DAQP reaches the same value of the objective as the closed form on every pair.

    For a bisection the last program that held is the answer.
    """
    for pair, tried in zip(pairs, programs, strict=True):
        answers = [x[:4] for x, flag in (program.solve() for program in tried) if flag == 1]
        ours, theirs = (_value(pair, f, objective) for f in (chosen(pair, objective)[0], answers[-1]))
        # A cone of little friction makes a use of 1 of a tangential force within DAQP's tolerance.
        allowed = 10 * TOLERANCE if objective == "friction_use" else TOLERANCE
        close(np.array(ours), np.array(theirs), allowed, f"DAQP for {objective}")


def close(ours: Array, theirs: Array, tolerance: float, what: str) -> None:
    """Raise unless two answers agree to a fraction ``tolerance`` of the largest number."""
    finite = theirs[np.isfinite(theirs)]
    scale = float(abs(finite).max(initial=0.0))
    if not np.allclose(ours, theirs, rtol=0.0, atol=tolerance * scale):
        raise RuntimeError(f"{what}: answers differ, {ours} and {theirs}")


def _value(pair: tuple[float, ...], forces: Array, objective: str) -> float:
    f = forces.reshape(2, 2)
    normals, frictions = np.array([pair[2:4], pair[7:9]]), np.array([pair[4], pair[9]])
    if objective == "effort":
        return float((f**2).sum())
    if objective == "peak_normal":
        return float((f * normals).sum(axis=1).max())
    found = margins(f, normals, frictions)
    if objective == "friction_use":
        return 1 - float(found.friction_use.max())  # of the whole friction
    return float((found.angle if objective == "angle" else found.force).min())

"""Which pairs of fingers hold a load at a level of an objective, for arrays of them, by their squeeze.

Forces of two fingers that balance a load differ by a squeeze x along the line e between them: f_1 = a + x e,
f_2 = -F - f_1. Cones, least margins and sums of normal forces bound x linearly, a largest force by the roots
of a quadratic: a level is reached if and only if something is left. Nothing of regrasp is used.
"""

import numpy as np

Array = np.ndarray


def pairs_hold(
    positions: Array, normals: Array, friction: float, load: Array, objective: str, level: float | None,
    limit: float,
) -> Array:  # fmt: skip
    """(m,) for positions and inward unit normals (m, 2, 2) about the centre of mass and a load (3,).

    level: of ``sum_normal``, ``peak_normal``, ``peak``, ``friction_use`` or ``force``; None for none.
    limit: of every force.
    """
    apart = positions[:, 1] - positions[:, 0]
    far = np.hypot(*apart.T)
    with np.errstate(all="ignore"):
        e = apart / far[:, None]
        across = np.stack([-e[:, 1], e[:, 0]], axis=1)
        p = positions[:, 1]
        # (p_1 - p_2) x f_1 = p_2 x F - torque
        y = -(p[:, 0] * load[1] - p[:, 1] * load[0] - load[2]) / far
        first = y[:, None] * across
        still = np.stack([first, -load[:2] - first], axis=1)
        moving = np.stack([e, -e], axis=1)
        room = _Room(len(e))
        mu = friction * level if objective == "friction_use" and level is not None else friction
        margin = level if objective == "force" and level is not None else 0.0
        for i in range(2):
            n = normals[:, i]
            t = np.stack([-n[:, 1], n[:, 0]], axis=1)
            for edge in (mu * n - t, mu * n + t):
                room.at_least(edge, still[:, i], moving[:, i], margin * np.sqrt(1 + mu**2))
            most = min(limit, level) if objective == "peak" and level is not None else limit
            if np.isfinite(most):
                room.within(still[:, i], moving[:, i], most)
            if objective == "peak_normal" and level is not None:
                room.at_least(-n, still[:, i], moving[:, i], -level)
        if objective == "sum_normal" and level is not None:
            room.sum_at_most(normals, still, moving, level)
    result: Array = (room.lo <= room.hi) & (far > 0)
    return result


class _Room:
    """The squeezes that are left."""

    def __init__(self, count: int) -> None:
        self.lo, self.hi = np.full(count, -np.inf), np.full(count, np.inf)

    def _linear(self, slope: Array, rest: Array) -> None:
        """Slope x + rest >= 0."""
        end = -rest / slope
        self.lo = np.where(slope > 0, np.maximum(self.lo, end), self.lo)
        self.hi = np.where(slope < 0, np.minimum(self.hi, end), self.hi)
        self.hi = np.where((slope == 0) & (rest < 0), -np.inf, self.hi)

    def at_least(self, g: Array, still: Array, moving: Array, least: float) -> None:
        """G . (still + x moving) >= least."""
        self._linear((g * moving).sum(axis=1), (g * still).sum(axis=1) - least)

    def sum_at_most(self, normals: Array, still: Array, moving: Array, most: float) -> None:
        """The sum of the normal forces."""
        self._linear(-(normals * moving).sum(axis=(1, 2)), most - (normals * still).sum(axis=(1, 2)))

    def within(self, still: Array, moving: Array, most: float) -> None:
        """|still + x moving| <= most, of unit ``moving``."""
        along = (still * moving).sum(axis=1)
        half = np.sqrt(most**2 - ((still**2).sum(axis=1) - along**2))
        self.lo = np.where(half >= 0, np.maximum(self.lo, -along - half), np.inf)
        self.hi = np.where(half >= 0, np.minimum(self.hi, -along + half), -np.inf)

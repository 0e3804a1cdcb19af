"""Random pairs of planar contacts that hold their load, and their choices written as QPs for DAQP.

    effort        minimise |f_1|^2 + |f_2|^2
    peak_normal   minimise t,    f_i.n_i <= t
    force         maximise t,    mu f.n -+ f.t >= t sqrt(1 + mu^2)
    angle         bisection on a margin m: do cones narrowed by m still hold the load?

all subject to G f = -w and, in the plane exactly, mu f.n -+ f.t >= 0. Force limits are discs, so the last two
get the bounds that the discs put on the squeeze. ``peak`` minimises the largest |f_i|, which is no QP.
"""

from dataclasses import dataclass
from math import atan, hypot, inf, sqrt, tan

import daqp
import numpy as np
from numpy.typing import NDArray

from regrasp import locus_intervals
from regrasp.closed_form.choice import OBJECTIVES, best_squeeze
from regrasp.planning.states.criteria import PEAK_RATIO

Array = NDArray[np.float64]

FREE = 1e30
"""DAQP's infinity."""


@dataclass(frozen=True)
class Pairs:
    """Arguments of a batch: r1, n1 (N, 2), mu1 (N,), r2, n2 (N, 2), mu2 (N,), force (N, 2), torque (N,)."""

    arguments: tuple[Array, ...]

    @classmethod
    def random(cls, count: int, seed: int = 1) -> "Pairs":
        """Roughly opposite contacts with normals roughly towards each other; all hold their load."""
        rng = np.random.default_rng(seed)
        kept: list[tuple[Array, ...]] = []
        found = 0
        while found < count:
            n = max(1000, count)
            turn = rng.uniform(0, 2 * np.pi, n)
            along = np.stack([np.cos(turn), np.sin(turn)], axis=1)
            r1, r2 = -along + rng.normal(0, 0.2, (n, 2)), along + rng.normal(0, 0.2, (n, 2))
            n1, n2 = (s * along + rng.normal(0, 0.2, (n, 2)) for s in (1, -1))
            n1, n2 = (v / np.linalg.norm(v, axis=1, keepdims=True) for v in (n1, n2))
            mu1, mu2 = rng.uniform(0.3, 1.0, (2, n))
            given = (r1, n1, mu1, r2, n2, mu2, rng.normal(size=(n, 2)), rng.normal(0, 0.1, n))
            lo, hi = locus_intervals(*given)
            holds = hi > lo
            kept.append(tuple(a[holds] for a in given))
            found += int(holds.sum())
        return cls(tuple(np.concatenate(parts)[:count] for parts in zip(*kept, strict=True)))

    def first(self, count: int) -> list[tuple[float, ...]]:
        """The first pairs as plain floats, the way ``best_squeeze`` takes them."""
        columns = [a[:count].reshape(min(count, len(a)), -1) for a in self.arguments]
        return [tuple(row) for row in np.hstack(columns).tolist()]


def chosen(pair: tuple[float, ...], objective: str) -> tuple[Array, float, float]:
    """The closed form's forces (4,) and the limits they were chosen under."""
    _, forces, limits = best_squeeze(*pair, OBJECTIVES.index(objective), inf, inf, PEAK_RATIO)
    return np.array(forces), *limits


def _frame(pair: tuple[float, ...]) -> tuple[Array, float, float, float]:
    """u, phi, a, b of f_1 = x u + a p and f_2 = -(x + phi) u + b p (regrasp.closed_form)."""
    (x1, y1), (x2, y2), (fx, fy, tau) = pair[:2], pair[5:7], pair[10:]
    length = hypot(x2 - x1, y2 - y1)
    ux, uy = (x2 - x1) / length, (y2 - y1) / length
    a, b = (tau - x2 * fy + y2 * fx) / length, -(tau - x1 * fy + y1 * fx) / length
    return np.array([ux, uy]), fx * ux + fy * uy, a, b


@dataclass(frozen=True)
class Quadratic:
    """A QP as ``daqp.solve`` takes it, equality rows first."""

    data: tuple[Array, ...]
    settings: dict[str, float]

    def solve(self) -> tuple[Array, int]:
        """The unknowns and DAQP's exit flag, 1 for an optimum."""
        x, _, flag, _ = daqp.solve(*self.data, **self.settings)
        return x, flag


def eliminated(pair: tuple[float, ...]) -> tuple[Array, ...]:
    """The effort QP in the squeeze alone, as ``daqp.solve`` takes it: one unknown, four cone edges."""
    (ux, uy), phi, a, b = _frame(pair)
    along = np.array([ux, uy, -ux, -uy])
    fixed = np.array([-a * uy, a * ux, -phi * ux - b * uy, b * ux - phi * uy])
    edges = _cones(pair)
    lower = -(edges @ fixed)
    return (
        np.array([[2 * along @ along]]), np.array([2 * fixed @ along]), (edges @ along)[:, None],
        np.full(4, FREE), lower, np.zeros(4, dtype=np.int32),
    )  # fmt: skip


def quadratics(pair: tuple[float, ...], objective: str) -> list[Quadratic]:
    """The QPs whose solution is the choice: one, or as many as the bisection of a level takes."""
    if objective == "effort":
        return [_program(pair, _cones(pair), squares=True)]
    if objective == "peak_normal":
        n1, n2 = (np.array([*pair[i : i + 2]]) for i in (2, 7))
        under = np.vstack([np.r_[-n1, 0, 0, 1], np.r_[0, 0, -n2, 1]])
        return [_program(pair, np.vstack([np.pad(_cones(pair), ((0, 0), (0, 1))), under]), cost=1.0)]
    _, limit1, limit2 = chosen(pair, objective)
    squeeze = _squeeze_bounds(pair, limit1, limit2)
    if objective == "force":
        return [_program(pair, _cones(pair, distance=True), cost=-1.0, squeeze=squeeze)]
    if objective not in ("angle", "friction_use"):
        raise ValueError(f"{objective} is no QP")
    narrowed, top = _at_margin, min(atan(pair[4]), atan(pair[9]))
    if objective == "friction_use":
        narrowed, top = _at_use, 1.0
    programs, held, lost = [], 0.0, top
    while lost - held > 1e-8:
        level = (held + lost) / 2
        cones = _cones((*pair[:4], narrowed(pair[4], level), *pair[5:9], narrowed(pair[9], level)))
        programs.append(_program(pair, cones, squares=True, squeeze=squeeze))
        if programs[-1].solve()[1] == 1:
            held = level
        else:
            lost = level
    return programs


def _at_margin(mu: float, margin: float) -> float:
    return tan(atan(mu) - margin)


def _at_use(mu: float, spared: float) -> float:
    return mu * (1 - spared)


def _program(
    pair: tuple[float, ...],
    cones: Array,
    *,
    squares: bool = False,
    cost: float = 0.0,
    squeeze: tuple[Array, float, float] | None = None,
) -> Quadratic:
    size = cones.shape[1]
    (x1, y1), (x2, y2), (fx, fy, tau) = pair[:2], pair[5:7], pair[10:]
    rows = [np.pad([[1, 0, 1, 0], [0, 1, 0, 1], [-y1, x1, -y2, x2]], ((0, 0), (0, size - 4))), cones]
    lower = [-np.array([fx, fy, tau]), np.zeros(len(cones))]
    upper = [lower[0], np.full(len(cones), FREE)]
    if squeeze is not None:
        row, lo, hi = squeeze
        rows.append(np.pad(row[None], ((0, 0), (0, size - 4))))
        lower.append(np.array([lo]))
        upper.append(np.array([hi]))
    A = np.vstack(rows)
    sense = np.zeros(len(A), dtype=np.int32)
    sense[:3] = 5  # equalities
    f = np.zeros(size)
    if size == 5:
        f[4] = cost
    H = 2 * np.eye(size) if squares else np.zeros((size, size))
    # A linear program needs DAQP's proximal steps; this weight was the fastest of 1e-3 ... 1.
    settings = {} if squares else {"eps_prox": 1e-2}
    return Quadratic((H, f, A, np.concatenate(upper), np.concatenate(lower), sense), settings)


def _cones(pair: tuple[float, ...], distance: bool = False) -> Array:
    """Rows mu f.n -+ f.t of the cones, (4, 4); or these less t sqrt(1 + mu^2), (4, 5)."""
    rows = []
    for i, (nx, ny, mu) in enumerate((pair[2:5], pair[7:10])):
        for sign in (-1.0, 1.0):
            row = np.zeros(5)
            row[2 * i : 2 * i + 2] = mu * nx - sign * ny, mu * ny + sign * nx
            row[4] = -sqrt(1 + mu * mu)
            rows.append(row)
    return np.array(rows) if distance else np.array(rows)[:, :4]


def _squeeze_bounds(pair: tuple[float, ...], limit1: float, limit2: float) -> tuple[Array, float, float]:
    """The row u.f_1 (4,) and its bounds under the force limits."""
    u, phi, a, b = _frame(pair)
    reach1, reach2 = sqrt(limit1**2 - a**2), sqrt(limit2**2 - b**2)
    return np.array([*u, 0.0, 0.0]), max(-reach1, -phi - reach2), min(reach1, reach2 - phi)

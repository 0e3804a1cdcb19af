"""What planar point fingers withstand, in closed form on plain numbers: on flat surfaces.

With q = (-y, x) the motion of a contact as the object turns, A = sum K, b = sum K q and c = sum q' K q, the
springs answer a unit of torque with the turn 1 / s about -A^-1 b, s = c - b' A^-1 b, and a force F with more.

A contact i that is off by x along its tangent t leaves the torque x (t x f_i), so that forces change by
-x (t x f_i) K_j (q_j - A^-1 b) / s. There b is linear in x and s is quadratic, so that each cone edge

    (g . f_j) s(x) - x (t x f_i) g . K_j (q_j(x) - A^-1 b(x)) >= 0

is a quadratic in x. What is withstood of loads are the ratios of ``mechanics.robust.withstanding``. A linear
limit b - a . f >= 0 is one more edge; a limit |f| <= L is in ``planar_limits``.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import acos, copysign, cos, hypot, inf, pi, sin, sqrt

from regrasp.mechanics.robust.stiffness import Stiffness, stiffness_matrices
from regrasp.mechanics.robust.withstanding import EXCEEDS, OPENS, SLIPS
from regrasp.planning.robustness.planar_limits import line_out, shift_out, turn_out
from regrasp.planning.robustness.views import View

_OPEN = 1e-6
_NOTHING = 1e-14
_SINGULAR = 1e-9
_OUTSIDE = 1e-9

Least = tuple[float, int, str]
"""A measure, the finger that fails there by its place, and how."""


@dataclass(frozen=True)
class Finger:
    """A contact: where, its normal, coefficient and force [N], and its stiffness [N/m] by xx, xy, yy.

    limit: of its force [N]. rows: (a_x, a_y, b) of its linear limits a . f <= b.
    """

    x: float
    y: float
    nx: float
    ny: float
    mu: float
    fx: float
    fy: float
    stiffness: tuple[float, float, float]
    limit: float = inf
    rows: list[tuple[float, float, float]] = field(default_factory=list)

    def pushed(self, ux: float, uy: float) -> tuple[float, float]:
        """K u."""
        xx, xy, yy = self.stiffness
        return xx * ux + xy * uy, xy * ux + yy * uy

    @property
    def edges(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """The inward normals of both edges of the cone, mu n -+ t."""
        return (
            (self.mu * self.nx + self.ny, self.mu * self.ny - self.nx),
            (self.mu * self.nx - self.ny, self.mu * self.ny + self.nx),
        )


class PlanarForces:
    """Forces of planar fingers that answer with springs."""

    def __init__(self, fingers: Sequence[Finger], load: tuple[float, float, float], size: float) -> None:
        self.fingers, self.load = fingers, load
        axx = axy = ayy = bx = by = turning = 0.0
        for f in fingers:
            xx, xy, yy = f.stiffness
            kx, ky = f.pushed(-f.y, f.x)
            axx, axy, ayy = axx + xx, axy + xy, ayy + yy
            bx, by, turning = bx + kx, by + ky, turning - f.y * kx + f.x * ky
        det = axx * ayy - axy * axy
        self.sound = det > _SINGULAR * (axx + ayy) ** 2
        if not self.sound:
            return
        self.inverse = ayy / det, -axy / det, axx / det
        self.off = self._moved(bx, by)  # A^-1 b
        self.against = turning - bx * self.off[0] - by * self.off[1]
        self.sound = self.against > _SINGULAR * max(turning, size * size * (axx + ayy))
        if not self.sound:
            return
        self.rows = [
            (k, f, g, g[0] * f.fx + g[1] * f.fy, self._twist(f, g), SLIPS)
            for k, f in enumerate(fingers)
            for g in f.edges
        ]
        self.rows += [
            (k, f, (-ax, -ay), b - ax * f.fx - ay * f.fy, self._twist(f, (-ax, -ay)), EXCEEDS)
            for k, f in enumerate(fingers)
            for ax, ay, b in f.rows
        ]
        self.discs = [
            (k, f, self._twist(f, (-1.0, 0.0)), self._twist(f, (0.0, -1.0)))  # rows of R
            for k, f in enumerate(fingers)
            if f.limit < inf
        ]

    def _moved(self, fx: float, fy: float) -> tuple[float, float]:
        xx, xy, yy = self.inverse
        return xx * fx + xy * fy, xy * fx + yy * fy

    def _twist(self, f: Finger, g: tuple[float, float]) -> tuple[float, float, float]:
        """-R' g: how much work along g a unit of each deviation takes."""
        kx, ky = f.pushed(*g)
        ux, uy = self._moved(kx, ky)
        turn = (f.x * ky - f.y * kx - self.off[0] * kx - self.off[1] * ky) / self.against
        return ux - turn * self.off[0], uy - turn * self.off[1], turn

    @property
    def is_inside(self) -> bool:
        """Whether forces are in their cones, but for rounding."""
        size = max(hypot(f.fx, f.fy) for f in self.fingers)
        return all(room >= -_OUTSIDE * size * hypot(*g) for _, _, g, room, *_ in self.rows) and all(
            hypot(f.fx, f.fy) <= f.limit * (1 + _OUTSIDE) for f in self.fingers
        )

    def friction(self) -> Least:
        """The least factor on all coefficients."""
        worst: Least = (0.0, 0, SLIPS)
        for k, f in enumerate(self.fingers):
            across, along = abs(f.nx * f.fy - f.ny * f.fx), f.nx * f.fx + f.ny * f.fy
            if across:
                used = across / (f.mu * along) if along > 0 else inf
                worst = max(worst, (used, k, SLIPS), key=lambda found: found[0])
        return worst

    def largest_load(self) -> Least:
        """The largest factor of the load."""
        fx, fy, torque = self.load
        best: Least = (inf, 0, "")
        for k, f, _, room, (tx, ty, tw), how in self.rows:
            work = tx * fx + ty * fy + tw * torque
            if work > _NOTHING * (abs(tx * fx) + abs(ty * fy) + abs(tw * torque)):
                more = max(room, 0.0) / work
                if more + 1 < best[0]:
                    best = more + 1, k, self._how(f, more * fx, more * fy, more * torque, how)
        for k, f, x, y in self.discs:
            change = x[0] * fx + x[1] * fy + x[2] * torque, y[0] * fx + y[1] * fy + y[2] * torque
            more = line_out((f.fx, f.fy), change, f.limit)
            if more + 1 < best[0]:
                best = more + 1, k, self._how(f, more * fx, more * fy, more * torque, EXCEEDS)
        return best

    def centre(self) -> Least:
        """How far the load may act off the centre of mass [m]."""
        size = hypot(self.load[0], self.load[1])
        best: Least = (inf, 0, "")
        for k, f, _, room, (_, _, tw), how in self.rows:
            if size * abs(tw) > 0:
                off = max(room, 0.0) / (size * abs(tw))
                if off < best[0]:
                    best = off, k, self._how(f, 0.0, 0.0, copysign(off * size, tw), how)
        for k, f, x, y in self.discs:
            outwards = copysign(size, f.fx * x[2] + f.fy * y[2])
            off = line_out((f.fx, f.fy), (outwards * x[2], outwards * y[2]), f.limit)
            if off < best[0]:
                best = off, k, self._how(f, 0.0, 0.0, off * outwards, EXCEEDS)
        return best

    def tilt(self) -> Least:
        """How far the load's force may turn [rad]."""
        fx, fy, _ = self.load
        size = hypot(fx, fy)
        best: Least = (pi, 0, "")
        for k, f, _, room, (tx, ty, _), how in self.rows:
            length = size * hypot(tx, ty)
            if not length > _NOTHING * abs(room):
                continue
            ahead = tx * fx + ty * fy
            needed = (max(room, 0.0) + ahead) / length
            if needed < 1:
                angle = acos(max(min(ahead / length, 1.0), -1.0)) - acos(needed)
                if angle < best[0]:
                    turn = copysign(angle, fx * ty - fy * tx)
                    c, s = cos(turn) - 1, sin(turn)
                    best = angle, k, self._how(f, c * fx - s * fy, s * fx + c * fy, 0.0, how)
        for k, f, x, y in self.discs:
            start = x[0] * fx + x[1] * fy, y[0] * fx + y[1] * fy
            quarter = x[1] * fx - x[0] * fy, y[1] * fx - y[0] * fy
            turn = turn_out((f.fx - start[0], f.fy - start[1]), start, quarter, f.limit, best[0])
            if abs(turn) < best[0]:
                c, s = cos(turn) - 1, sin(turn)
                best = abs(turn), k, self._how(f, c * fx - s * fy, s * fx + c * fy, 0.0, EXCEEDS)
        return best

    def _how(self, f: Finger, fx: float, fy: float, torque: float, how: str) -> str:
        """Whether a finger opens under a deviation, or fails as it would else."""
        tx, ty, tw = self._twist(f, (f.nx, f.ny))
        before = f.nx * f.fx + f.ny * f.fy
        after = before - tx * fx - ty * fy - tw * torque
        return OPENS if after <= _OPEN * abs(before) else how

    def position(self, i: int) -> Least:
        """How far one contact may be off along its tangent, either way [m]."""
        me = self.fingers[i]
        tx, ty = -me.ny, me.nx
        torque = tx * me.fy - ty * me.fx
        px, py = -ty, tx  # of q, for a unit of the offset
        kx, ky = me.pushed(px, py)
        mx, my = self._moved(kx, ky)
        s0, (ox, oy) = self.against, self.off
        s1 = 2 * (-me.y * kx + me.x * ky - kx * ox - ky * oy)
        s2 = px * kx + py * ky - kx * mx - ky * my
        best: Least = (inf, 0, "")

        def moved(k: int, f: Finger) -> tuple[float, float, float, float]:
            """How a finger moves as the object turns, and more for each unit of the offset."""
            return -f.y - ox, f.x - oy, (k == i) * px - mx, (k == i) * py - my

        def failing(k: int, f: Finger, off: float, how: str) -> Least:
            hx, hy = f.pushed(f.nx, f.ny)
            before = f.nx * f.fx + f.ny * f.fy
            s = s0 + off * (s1 + off * s2)
            ux, uy, vx, vy = moved(k, f)
            work = hx * (ux + off * vx) + hy * (uy + off * vy)
            after = before - off * torque * work / s if s > 0 else 0.0
            return abs(off), k, OPENS if after <= _OPEN * abs(before) else how

        for k, f, g, room, _, how in self.rows:
            hx, hy = f.pushed(*g)
            ux, uy, vx, vy = moved(k, f)
            a0 = max(room, 0.0) * s0
            a1 = room * s1 - torque * (hx * ux + hy * uy)
            a2 = room * s2 - torque * (hx * vx + hy * vy)
            off = _first_root(a0, a1, a2)
            if abs(off) < best[0]:
                best = failing(k, f, off, how)
        for k, f, _, _ in self.discs:
            ux, uy, vx, vy = moved(k, f)
            ways = zip((f.fx, f.fy), f.pushed(ux, uy), f.pushed(vx, vy), strict=True)
            force = [(p * s0, p * s1 - torque * u, p * s2 - torque * v) for p, u, v in ways]
            off = shift_out((s0, s1, s2), force, f.limit, best[0])
            if abs(off) < best[0]:
                best = failing(k, f, off, EXCEEDS)
        return best

    def least_stiffness(self, tip_radius: float) -> float:
        """The least factor on the stiffness that keeps the object from turning out (docs/robustness.md)."""
        squeeze = sum(
            (f.x + tip_radius * f.nx) * f.fx + (f.y + tip_radius * f.ny) * f.fy for f in self.fingers
        )
        return max(-squeeze / self.against, 0.0)


def _first_root(a0: float, a1: float, a2: float) -> float:
    """The x nearest to 0 beyond which a0 + a1 x + a2 x^2 is negative, a0 at least 0; infinite if never."""
    square = a1 * a1 - 4 * a0 * a2
    if a0 == 0:
        return 0.0 if a1 or a2 < 0 else inf
    if square <= 0:
        return inf
    root = -(a1 + copysign(sqrt(square), a1)) / 2
    return a0 / root if root else inf


def planar_forces(view: View) -> PlanarForces | None:
    """The forces of a view, where the closed forms know them; None for all others."""
    grasp = view.grasp
    if grasp.dimension == 3:
        return None
    rows: list[list[tuple[float, float, float]]] = [[] for _ in grasp]
    if grasp.limit_rows is not None:
        limits = grasp.limit_rows.scaled(view.share)
        for i, (ax, ay), b in zip(
            limits.contacts.tolist(), limits.rows.tolist(), limits.bounds.tolist(), strict=True
        ):
            rows[i].append((ax, ay, b))
    forces = view.state.forces.tolist()
    springs = _springs(view, view.stiffness)
    given = zip(
        grasp.positions.tolist(),
        grasp.normals.tolist(),
        grasp.frictions.tolist(),
        forces,
        springs,
        view.limits.tolist(),
        rows,
        strict=True,
    )
    fingers = [
        Finger(x, y, nx, ny, mu, fx, fy, k, most, own)
        for (x, y), (nx, ny), mu, (fx, fy), k, most, own in given
    ]
    if min(f.mu for f in fingers) <= 0:
        return None
    fx, fy, torque = view.state.load.vector.tolist()
    found = PlanarForces(fingers, (fx, fy, torque), grasp.size)
    return found if found.sound and found.is_inside else None


def _springs(view: View, stiffness: Stiffness) -> list[tuple[float, float, float]]:
    n, gone = len(view.grasp), view.controlled
    if not isinstance(stiffness, tuple):
        return [(0.0, 0.0, 0.0) if i in gone else (stiffness, 0.0, stiffness) for i in range(n)]
    matrices = stiffness_matrices(view.grasp, stiffness, gone)
    return [(a, (b + c) / 2, d) for (a, b), (c, d) in matrices.tolist()]

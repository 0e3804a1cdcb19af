"""What planar point fingers withstand, in closed form on plain numbers: by cones alone, on flat surfaces.

With q = (-y, x) the motion of a contact as the object turns, A = sum K, b = sum K q and c = sum q' K q, the
springs answer a unit of torque with the turn 1 / s about -A^-1 b, s = c - b' A^-1 b, and a force F with more.

A contact i that is off by x along its tangent t leaves the torque x (t x f_i), so that forces change by
-x (t x f_i) K_j (q_j - A^-1 b) / s. There b is linear in x and s is quadratic, so that each cone edge

    (g . f_j) s(x) - x (t x f_i) g . K_j (q_j(x) - A^-1 b(x)) >= 0

is a quadratic in x. What is withstood of loads are the ratios of ``mechanics.robust.withstanding``.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import acos, copysign, cos, hypot, inf, pi, sin, sqrt

from regrasp.mechanics.robust.stiffness import Stiffness, stiffness_matrices
from regrasp.mechanics.robust.withstanding import OPENS, SLIPS
from regrasp.planning.robustness.views import View

_OPEN = 1e-6
_NOTHING = 1e-14
_SINGULAR = 1e-9
_OUTSIDE = 1e-9

Least = tuple[float, int, str]
"""A measure, the finger that fails there by its place, and how."""


@dataclass(frozen=True)
class Finger:
    """A contact: where, its normal, coefficient and force [N], and its stiffness [N/m] by xx, xy, yy."""

    x: float
    y: float
    nx: float
    ny: float
    mu: float
    fx: float
    fy: float
    stiffness: tuple[float, float, float]

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
            (k, f, g, g[0] * f.fx + g[1] * f.fy, self._twist(f, g))
            for k, f in enumerate(fingers)
            for g in f.edges
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
        return all(room >= -_OUTSIDE * size * hypot(*g) for _, _, g, room, _ in self.rows)

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
        for k, f, _, room, (tx, ty, tw) in self.rows:
            work = tx * fx + ty * fy + tw * torque
            if work > _NOTHING * (abs(tx * fx) + abs(ty * fy) + abs(tw * torque)):
                more = max(room, 0.0) / work
                if more + 1 < best[0]:
                    best = more + 1, k, self._how(f, more * fx, more * fy, more * torque)
        return best

    def centre(self) -> Least:
        """How far the load may act off the centre of mass [m]."""
        size = hypot(self.load[0], self.load[1])
        best: Least = (inf, 0, "")
        for k, f, _, room, (_, _, tw) in self.rows:
            if size * abs(tw) > 0:
                off = max(room, 0.0) / (size * abs(tw))
                if off < best[0]:
                    best = off, k, self._how(f, 0.0, 0.0, copysign(off * size, tw))
        return best

    def tilt(self) -> Least:
        """How far the load's force may turn [rad]."""
        fx, fy, _ = self.load
        size = hypot(fx, fy)
        best: Least = (pi, 0, "")
        for k, f, _, room, (tx, ty, _) in self.rows:
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
                    best = angle, k, self._how(f, c * fx - s * fy, s * fx + c * fy, 0.0)
        return best

    def _how(self, f: Finger, fx: float, fy: float, torque: float) -> str:
        """Whether a finger opens or slips under a deviation."""
        tx, ty, tw = self._twist(f, (f.nx, f.ny))
        before = f.nx * f.fx + f.ny * f.fy
        after = before - tx * fx - ty * fy - tw * torque
        return OPENS if after <= _OPEN * abs(before) else SLIPS

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
        for k, f, g, room, _ in self.rows:
            hx, hy = f.pushed(*g)
            a0 = max(room, 0.0) * s0
            a1 = room * s1 - torque * (hx * (-f.y - ox) + hy * (f.x - oy))
            a2 = room * s2 - torque * (hx * ((k == i) * px - mx) + hy * ((k == i) * py - my))
            off = _first_root(a0, a1, a2)
            if abs(off) < best[0]:
                hx, hy = f.pushed(f.nx, f.ny)
                before = f.nx * f.fx + f.ny * f.fy
                s = s0 + off * (s1 + off * s2)
                ux, uy = -f.y - ox + off * ((k == i) * px - mx), f.x - oy + off * ((k == i) * py - my)
                after = before - off * torque * (hx * ux + hy * uy) / s if s > 0 else 0.0
                best = abs(off), k, OPENS if after <= _OPEN * abs(before) else SLIPS
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
    if grasp.dimension == 3 or grasp.limit_rows is not None or min(view.limits.tolist()) < inf:
        return None
    forces = view.state.forces.tolist()
    springs = _springs(view, view.stiffness)
    given = zip(
        grasp.positions.tolist(),
        grasp.normals.tolist(),
        grasp.frictions.tolist(),
        forces,
        springs,
        strict=True,
    )
    fingers = [Finger(x, y, nx, ny, mu, fx, fy, k) for (x, y), (nx, ny), mu, (fx, fy), k in given]
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

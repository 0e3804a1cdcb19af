"""What a run measures: forces at contacts, motion, slip."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from regrasp.execution.measured import IN_USE, Execution
from regrasp.execution.scene import Scene
from regrasp.execution.schedule import Schedule
from regrasp.execution.setup import Setup
from regrasp.execution.units import PEAK, Units
from regrasp.mechanics.checks import Array, read_only
from regrasp.mechanics.wrench import torque
from regrasp.plans.regrasp_plan import RegraspPlan
from regrasp.plans.transition import Transition

_BLOCK = 4096  # steps whose slip is summed at once
_QUARTER = np.array([-1.0, 1.0])  # (x, y) turned by a quarter is (-y, x)


class Recorder:
    """Samples of a run in the simulation's units, and the slip summed over every step of it.

    Slip is the motion of the tip's material against the object's at the contact, along the surface: rolling,
    where both move alike, does not count. It is summed in the object's frame while a finger carries force,
    from the moment it touches.
    """

    def __init__(self, scene: Scene, wanted: Schedule, units: Units, apart: int) -> None:
        self._scene, self._wanted, self._units, self._apart = scene, wanted, units, apart
        n, d = len(wanted.contacts), wanted.targets.shape[2]
        self._d = d
        self._normals = np.array([c.normal for c in wanted.contacts])
        self._slip = np.zeros((n, d + 1))  # the last is a soft finger's spin about the normal, by its arm
        arms = ((c.torsion or 0.0) / (c.friction or 1.0) for c in wanted.contacts)
        self._arms = np.fromiter(arms, dtype=float) / units.length
        loaded = np.linalg.norm(wanted.forces, axis=2) > IN_USE * PEAK * units.force
        self._slides = loaded & (wanted.at >= 0)
        self._slides[: wanted.gripping] = False
        self._touched = np.full(wanted.at.shape[1], -1)
        self._six = np.zeros(6)
        self._rows: list[tuple[Any, ...]] = []
        self._slips: list[Array] = []
        self._geoms = {geom: i for i, geom in enumerate(scene.tips)}
        self._first = 0  # step of the block's first row
        self._at_steps: list[int] = []  # of samples in the block
        model = scene.model
        self._places, self._speeds = np.empty((_BLOCK, model.nq)), np.empty((_BLOCK, model.nv))

    def place(self, data: Any) -> Array:
        """(d,) the object's centre of mass."""
        result: Array = data.qpos[: self._d]
        return result

    def step(self, mujoco: Any, data: Any, j: int, *, over: bool) -> None:
        """Keep the motion of a step, and every so often, and when it is over, take a sample."""
        row = j - self._first
        self._places[row], self._speeds[row] = data.qpos, data.qvel
        since = j + 1 - self._wanted.gripping
        if since == 0 or (since > 0 and since % self._apart == 0) or over:
            R = self._rotation(mujoco, data)
            forces, twists, touching = self._forces(mujoco, data, R, self._wanted.at[j].tolist())
            tips = data.qpos[self._scene.slides.places].copy()
            self._rows.append((since, forces, twists, touching, self.place(data).copy(), R, tips))
            self._at_steps.append(row)
        if over or row + 1 == _BLOCK:
            self._sum_slip(row + 1)

    def _sum_slip(self, count: int) -> None:
        """Sum the slip over the steps of a block, from zero where a finger touches anew."""
        rows = slice(self._first, self._first + count)
        at = self._wanted.at[rows]
        moved = self._slid(self._places[:count], self._speeds[:count], at, self._slides[rows])
        summed = self._slip + np.cumsum(moved, axis=0)
        before = np.vstack([self._touched, at[:-1]])
        for row, finger in np.argwhere((at >= 0) & (at != before)).tolist():
            contact = at[row, finger]
            summed[row:, contact] -= summed[row, contact] - moved[row, contact]
        self._slips.append(np.linalg.norm(summed[self._at_steps], axis=2))
        self._slip, self._touched = summed[-1], at[-1]
        self._first, self._at_steps = self._first + count, []

    def _rotation(self, mujoco: Any, data: Any) -> Array:
        if self._d == 2:
            c, s = np.cos(data.qpos[2]), np.sin(data.qpos[2])
            return np.array([[c, -s], [s, c]])
        flat = np.zeros(9)
        mujoco.mju_quat2Mat(flat, data.qpos[3:7])
        return flat.reshape(3, 3)

    def _slid(self, q: Array, v: Array, at: NDArray[np.intp], slides: NDArray[np.bool_]) -> Array:
        """(m, n, d + 1) sliding at contacts in m steps, in the object's frame, and spin of soft fingers.

        The velocities of a step are those of its middle: q_j+1 = q_j + v_j+1 dt. With arms of its end a turn
        by omega would count as sliding by omega^2 |arm| dt / 2 a second.
        """
        d, scene, dt = self._d, self._scene, self._units.timestep
        result = np.zeros((len(q), *self._slip.shape))
        R = _turned(q[:, 2]) if d == 2 else _matrices(q[:, 3:7])
        for finger, (slide, own) in enumerate(zip(slides.T, at.T, strict=True)):
            rows = np.flatnonzero(slide)
            contacts, turned = own[rows], R[rows]
            normals = self._normals[contacts]
            spin = v[rows, 2:3] if d == 2 else _times(turned, v[rows, 3:6])
            reach = self._units.tip_radius * _times(turned, normals)  # from tips' centres to where they touch
            reach = reach - dt / 2 * _cross(spin, reach)
            tips, speeds = (
                q[rows[:, None], scene.slides.places[finger]],
                v[rows[:, None], scene.slides.speeds[finger]],
            )
            arm = tips + reach - q[rows, :d] - dt / 2 * (speeds - v[rows, :d])
            relative = speeds - v[rows, :d] - _cross(spin, arm)
            if scene.joints is not None:
                turning = v[rows[:, None], scene.joints.speeds[finger]]
                if d == 3:  # in each tip's own frame
                    turning = _rotated(q[rows[:, None], scene.joints.places[finger]], turning)
                    spinning = (_times(turned, turning - spin, back=True) * normals).sum(axis=1)
                    result[rows, contacts, d] = self._arms[contacts] * spinning * dt
                relative = relative + _cross(turning, reach)
            inside = _times(turned, relative, back=True)
            inside -= (inside * normals).sum(axis=1, keepdims=True) * normals
            result[rows, contacts, :d] = inside * dt
        return result

    def _forces(self, mujoco: Any, data: Any, R: Array, at: list[int]) -> tuple[Array, Array, Array]:
        """(n, d) forces of the fingers on the object, its frame; (n,) torques about normals; what touches."""
        forces, touching = np.zeros((len(self._normals), 3)), np.zeros(len(self._normals), dtype=bool)
        twists = np.zeros(len(self._normals))
        six, geoms = self._six, self._geoms
        for number in range(data.ncon):
            contact = data.contact[number]
            first, second = contact.geom
            mujoco.mj_contactForce(self._scene.model, data, number, six)
            force = contact.frame.reshape(3, 3).T @ six[:3]  # of the first geom on the second
            place = at[geoms[first]] if first in geoms else at[geoms[second]]
            if place >= 0:
                forces[place] += force if first in geoms else -force
                twists[place] += six[3]  # of one sign on both bodies, as axis and torque turn over together
                touching[place] |= six[0] > 0
        return forces[:, : self._d] @ R, twists, touching

    def execution(
        self, plan: Transition | RegraspPlan, setup: Setup, frictions: Array, *, complete: bool
    ) -> Execution:
        """The samples as a value, in the plan's units."""
        units, wanted = self._units, self._wanted
        since, forces, twists, touching, places, turned, tips = (
            np.array(column) for column in zip(*self._rows, strict=True)
        )
        slip = np.concatenate(self._slips)
        steps = since + wanted.gripping - 1
        return Execution(
            plan=plan,
            setup=setup,
            contacts=wanted.contacts,
            frictions=read_only(np.array(frictions)),
            times=read_only(since * units.timestep * units.time),
            clock=read_only(wanted.clock[steps]),
            planned=read_only(wanted.planned[steps]),
            forces=read_only(forces * units.force),
            planned_torques=read_only(wanted.twists[steps]),
            torques=read_only(twists * units.force * units.length),
            touching=touching,
            positions=read_only(places * units.length),
            rotations=read_only(turned),
            turned=read_only(wanted.rotations[steps]),
            slip=read_only(slip * units.length),
            tips=read_only(tips * units.length),
            mass=units.mass * units.force * units.time**2 / units.length,
            stiffness=units.stiffness * units.force / units.length,
            complete=complete,
        )


def _times(R: Array, vectors: Array, *, back: bool = False) -> Array:
    """Vectors (m, d) turned by matrices (m, d, d), or back."""
    return np.asarray(np.einsum("mji,mj->mi" if back else "mij,mj->mi", R, vectors))


def _turned(angles: Array) -> Array:
    """(m, 2, 2) rotations."""
    c, s = np.cos(angles), np.sin(angles)
    return np.stack([np.stack([c, -s], axis=-1), np.stack([s, c], axis=-1)], axis=-2)


def _matrices(quaternions: Array) -> Array:
    """(m, 3, 3) rotations of unit quaternions (w, x, y, z)."""
    axes = (_rotated(quaternions, np.broadcast_to(axis, (len(quaternions), 3))) for axis in np.eye(3))
    return np.stack(list(axes), axis=-1)


def _cross(spin: Array, arm: Array) -> Array:
    """Omega x r; in the plane omega is one number."""
    if arm.shape[1] == 2:
        return np.asarray(spin.reshape(-1, 1) * (arm[:, ::-1] * _QUARTER))
    return torque(np.broadcast_to(spin, arm.shape), arm)


def _rotated(quaternions: Array, vectors: Array) -> Array:
    """Vectors turned by unit quaternions (w, x, y, z), row by row."""
    w, u = quaternions[:, :1], quaternions[:, 1:]
    return vectors + 2 * np.cross(u, np.cross(u, vectors) + w * vectors)

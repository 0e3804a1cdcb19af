"""Tips that turn along with the object, each by a stiff drive of its own."""

from typing import Any

import numpy as np

from regrasp.execution.scene import Joints, turn_gains
from regrasp.execution.schedule import Schedule
from regrasp.execution.units import Units


class TurningTips:
    """Orientation set-points of tips that turn as the object is planned to."""

    def __init__(self, mujoco: Any, joints: Joints, wanted: Schedule, units: Units) -> None:
        self._mujoco, self._turns, self._wheels = mujoco, joints.places, joints.speeds
        self._stiffness, self._damping = turn_gains()
        R, dt = wanted.rotations, units.timestep
        self._spins = wanted.spins / (units.force * units.length)  # in the tips' frames, which turn along
        if R.shape[1] == 2:
            angles = np.unwrap(np.arctan2(R[:, 1, 0], R[:, 0, 0]))
            self._wanted = angles[:, None]
            self._speeds = np.diff(self._wanted, axis=0, prepend=self._wanted[:1]) / dt
        else:
            from scipy.spatial.transform import Rotation

            turns = Rotation.from_matrix(R)
            self._wanted = turns.as_quat(scalar_first=True)
            self._speeds = np.zeros((len(R), 3))
            self._speeds[1:] = (turns[:-1].inv() * turns[1:]).as_rotvec() / dt

    def start(self, data: Any) -> None:
        """Turn the tips to where they begin."""
        data.qpos[self._turns] = self._wanted[0]

    def drive(self, data: Any, j: int) -> None:
        """Apply the torques of a step; the joints' own damping takes the tips' speed from what is added."""
        ahead = self._damping * self._speeds[j]
        if self._wanted.shape[1] == 1:
            error = self._wanted[j] - data.qpos[self._turns]
        else:
            error = np.zeros((len(self._turns), 3))
            for row, numbers in zip(error, self._turns, strict=True):
                self._mujoco.mju_subQuat(row, self._wanted[j], data.qpos[numbers])
        push = self._stiffness * error + ahead
        data.qfrc_applied[self._wheels] = push if push.shape[1] == 1 else push + self._spins[j]

"""Plans carried out in physics: MuJoCo moves the object by what the fingers do, and says whether it holds.

Nothing here imports MuJoCo before a simulation is asked for; it comes with ``regrasp[mujoco]``.
"""

from regrasp.execution.critical import critical_friction
from regrasp.execution.from_mujoco import grasp_from_mujoco
from regrasp.execution.measured import Execution
from regrasp.execution.setup import Setup
from regrasp.execution.simulation import simulate

__all__ = ["Execution", "Setup", "critical_friction", "grasp_from_mujoco", "simulate"]

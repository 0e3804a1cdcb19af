"""A plan carried out: forces fed forward, with stiffness and damping around the set-points."""

from typing import Any

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.execution.engine import engine
from regrasp.execution.measured import Execution
from regrasp.execution.recorder import Recorder
from regrasp.execution.scene import Scene, group, loaded, mjcf
from regrasp.execution.schedule import Schedule, contacts_of, schedule
from regrasp.execution.setup import Setup
from regrasp.execution.turning_tips import TurningTips
from regrasp.execution.units import SIZE, Units, steps_of, units_of
from regrasp.mechanics.checks import Array
from regrasp.plans.regrasp_plan import RegraspPlan
from regrasp.plans.transition import Transition

# An object that has moved by half its size is dropped; what follows says nothing.
_GONE = 0.5 * SIZE
_SAMPLES_APART = 5


def simulate(plan: Transition | RegraspPlan, setup: Setup | None = None, **options: Any) -> Execution:
    """Carry out a plan in MuJoCo and measure what the contacts do.

    Every finger pushes with u = f(t) + K (p(t) - p) + D (p'(t) - p'), the plan's force fed forward, with
    stiffness and damping around its set-point; the load acts on the object's centre of mass as the plan says.
    Fingers change places before the step that needs them. Nothing is drawn by chance: runs repeat to the bit.

    setup: the body, the hand and its errors; options: fields of ``Setup``, which change those given.
    Soft fingers hold their tips' orientations and feed the torques about normals forward, too.
    Raises ``InvalidInput`` for plans without forces, ``ImportError`` without MuJoCo.
    """
    mujoco = engine("simulate")
    setup = changed(setup, options)
    units = units_of(plan, setup)
    contacts, wanted = contacts_of(plan), schedule(plan, setup, units)
    frictions = true_frictions(plan, setup)
    d, k = steps_of(plan)[0].grasp.dimension, wanted.at.shape[1]
    turns = any(step.turn is not None or step.grasp.is_soft for step in steps_of(plan))
    turning = not setup.rolling and turns
    size = max(step.grasp.size for step in steps_of(plan))
    mass = units.mass * units.force * units.time**2 / units.length
    inertia = setup.inertia(mass, size, d) * units.mass / (mass * units.length**2)
    xml = mjcf(contacts, frictions, wanted.targets[0] / units.length, units, inertia, turning=turning)
    scene = loaded(mujoco, xml, k, len(contacts), d, turning=turning)
    recorder = Recorder(scene, wanted, units, _SAMPLES_APART)
    complete = _run(mujoco, scene, wanted, units, setup, recorder)
    return recorder.execution(plan, setup, frictions, complete=complete)


def changed(setup: Setup | None, options: dict[str, Any]) -> Setup:
    """The setup with options in place of its fields."""
    known = set(Setup.__dataclass_fields__)
    for name in options:
        if name not in known:
            raise InvalidInput(f"no option {shown(name)}; there are {', '.join(sorted(known))}")
    given = {} if setup is None else {name: getattr(setup, name) for name in known}
    return Setup(**(given | options))


def true_frictions(plan: Transition | RegraspPlan, setup: Setup) -> Array:
    """(n,) the coefficient of every contact in the simulation."""
    contacts = contacts_of(plan)
    if setup.friction is None:
        return np.array([c.friction for c in contacts])
    if np.ndim(setup.friction) == 1 and np.shape(setup.friction) != (len(contacts),):
        raise InvalidInput(
            f"friction must be a number or have shape ({len(contacts)},), got {shown(setup.friction)}"
        )
    return np.broadcast_to(np.asarray(setup.friction, dtype=float), len(contacts))


def _run(mujoco: Any, scene: Scene, wanted: Schedule, units: Units, setup: Setup, recorder: Recorder) -> bool:
    """Step after step; whether the end came before the object was gone."""
    model, d = scene.model, wanted.targets.shape[2]
    data = mujoco.MjData(model)
    targets, speeds = wanted.targets / units.length, wanted.velocities * units.time / units.length
    forces = wanted.forces / units.force
    loads = _six(wanted.loads / units.force, d, units.length)
    turned = None if scene.joints is None else TurningTips(mujoco, scene.joints, wanted, units)
    data.qpos[scene.slides.places] = targets[0]
    if turned is not None:
        turned.start(data)
    groups = [[group(i) if i >= 0 else 0 for i in row] for row in wanted.at.tolist()]
    meets: list[int] = []
    for j in range(len(targets)):
        if groups[j] != meets:
            meets = groups[j]
            model.geom_conaffinity[list(scene.tips)] = meets
        push = forces[j] + units.stiffness * (targets[j] - data.qpos[scene.slides.places])
        data.qfrc_applied[scene.slides.speeds] = (
            push + units.damping * speeds[j]
        )  # less damping times velocity: joints
        if turned is not None:
            turned.drive(data, j)
        data.xfrc_applied[scene.body] = loads[j]
        if setup.disturbance is not None and j >= wanted.gripping:
            more = setup.disturbed((j - wanted.gripping) * units.timestep * units.time, d).vector
            data.xfrc_applied[scene.body] += _six(more[None] / units.force, d, units.length)[0]
        mujoco.mj_step(model, data)
        gone = not abs(recorder.place(data)).max() < _GONE
        recorder.step(mujoco, data, j, over=gone or j + 1 == len(targets))
        if gone:
            return False
    return True


def _six(loads: Array, d: int, length: float) -> Array:
    """(m, 6) forces and torques about the centre of mass in the simulation's units."""
    if d == 3:
        return np.asarray(loads / np.repeat([1.0, length], 3))
    result = np.zeros((len(loads), 6))
    result[:, :2], result[:, 5] = loads[:, :2], loads[:, 2] / length
    return result

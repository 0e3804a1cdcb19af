"""Whose force it is, in which frame and order: each line of the table in docs/conventions.md, run."""

import numpy as np
import pytest

pytestmark = pytest.mark.oracle

TILT = 0.3
R = np.array([[np.cos(TILT), 0, np.sin(TILT)], [0, 1, 0], [-np.sin(TILT), 0, np.cos(TILT)]])  # about y


def test_mujoco() -> None:
    """A ball at rest on the floor, the first geom of its contact; its weight partly lifted."""
    mujoco = pytest.importorskip("mujoco")
    floor = '<geom name="floor" type="box" size="1 1 .1" pos="0 0 -.1"/>'
    ball = '<geom name="b" type="sphere" size=".05" mass="1"/>'
    box = f'<body name="box" pos=".2 0 .05"><freejoint/>{ball}</body>'
    weight = 9.81 * np.array([0, 0, -1.0])
    model = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{floor}{box}</worldbody></mujoco>")
    data = mujoco.MjData(model)
    body = model.body("box").id
    data.xfrc_applied[body] = [0, 0, 1.0, 0, 0, 0]  # the world frame, at the centre of mass: lifts
    for _ in range(3000):
        mujoco.mj_step(model, data)
    c = np.zeros(6)
    mujoco.mj_contactForce(model, data, 0, c)
    contact = data.contact[0]
    assert [model.geom(int(g)).name for g in contact.geom] == ["b", "floor"]  # spheres come first
    assert contact.frame[:3] == pytest.approx([0, 0, -1], abs=1e-6)  # from geom 0 to geom 1
    on_second = contact.frame.reshape(3, 3).T @ c[:3]
    assert -on_second == pytest.approx(-weight - [0, 0, 1.0], abs=1e-3)
    mujoco.mj_rnePostConstraint(model, data)
    about_tree = data.cfrc_ext[body]  # torque first; external forces, what is applied included
    assert about_tree[3:] == pytest.approx([0, 0, 9.81], abs=1e-3)


def test_ros() -> None:
    """A Wrench is force, then torque; the frame is in the header."""
    typesys = pytest.importorskip("rosbags.typesys")
    types = typesys.get_typestore(typesys.Stores.ROS2_JAZZY).types
    assert list(types["geometry_msgs/msg/Wrench"].__annotations__)[:2] == ["force", "torque"]
    assert list(types["geometry_msgs/msg/WrenchStamped"].__annotations__)[:2] == ["header", "wrench"]


def test_pinocchio() -> None:
    """Linear first; fext acts on the joint's body, in the joint's own frame."""
    pin = pytest.importorskip("pinocchio")
    force = pin.Force(np.array([1.0, 2, 3]), np.array([4.0, 5, 6]))
    assert force.vector.tolist() == [1, 2, 3, 4, 5, 6]
    model = pin.Model()
    joint = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "object")
    model.appendBodyToJoint(joint, pin.Inertia(2.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
    data = model.createData()
    q = pin.neutral(model)
    q[3:7] = pin.Quaternion(R).coeffs()
    up = R.T @ [0, 0, 2.0 * 9.81]  # what holds the body, in its own frame
    forces = pin.StdVec_Force()
    for f in (pin.Force.Zero(), pin.Force(up, np.zeros(3))):
        forces.append(f)
    assert pin.rnea(model, data, q, np.zeros(6), np.zeros(6), forces) == pytest.approx(np.zeros(6), abs=1e-9)
    pin.forwardKinematics(model, data, q)
    assert data.oMi[joint].act(forces[joint]).linear == pytest.approx([0, 0, 19.62])


def test_drake() -> None:
    """Spatial forces are torque first; a contact's force acts on body B, in the world frame."""
    plant_module = pytest.importorskip("pydrake.multibody.plant")
    from pydrake.geometry import HalfSpace, Sphere
    from pydrake.math import RigidTransform
    from pydrake.multibody.math import SpatialForce
    from pydrake.multibody.tree import SpatialInertia, UnitInertia
    from pydrake.systems.analysis import Simulator
    from pydrake.systems.framework import DiagramBuilder

    assert SpatialForce(tau=[1, 2, 3], f=[4, 5, 6]).get_coeffs().tolist() == [1, 2, 3, 4, 5, 6]
    builder = DiagramBuilder()
    plant, _ = plant_module.AddMultibodyPlantSceneGraph(builder, time_step=1e-3)
    rough = plant_module.CoulombFriction(0.7, 0.7)
    inertia = SpatialInertia(2.0, np.zeros(3), UnitInertia.SolidSphere(0.05))
    ball = plant.AddRigidBody("ball", inertia)
    plant.RegisterCollisionGeometry(ball, RigidTransform(), Sphere(0.05), "ball", rough)
    plant.RegisterCollisionGeometry(plant.world_body(), RigidTransform(), HalfSpace(), "floor", rough)
    plant.Finalize()
    diagram = builder.Build()
    simulator = Simulator(diagram)
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    plant.SetFreeBodyPose(context, ball, RigidTransform([0, 0, 0.05]))
    simulator.AdvanceTo(1.0)
    results = plant.get_contact_results_output_port().Eval(context)
    info = results.point_pair_contact_info(0)
    sign = 1.0 if info.bodyB_index() == ball.index() else -1.0
    assert sign * info.contact_force() == pytest.approx([0, 0, 2 * 9.81], abs=1e-3)

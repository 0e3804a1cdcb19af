"""A plan as a ROS 2 bag in MCAP, which RViz, Foxglove and rosbag2 read; written without ROS."""

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.files.plans.motions_table import motion_times
from regrasp.files.plans.setpoints import setpoint_blocks
from regrasp.mechanics.checks import Array, file_path, number
from regrasp.mechanics.contact import Contact
from regrasp.motions.value import Motions
from regrasp.plans.regrasp_plan import RegraspPlan, rotation_before
from regrasp.plans.transition import Transition

OBJECT, WORLD = "object", "world"
"""Frames: the object's, at its centre of mass; the one in which the plan counts its orientation."""
_COLOURS = ((0.0, 0.45, 0.7), (0.84, 0.37, 0.0), (0.0, 0.62, 0.45), (0.8, 0.47, 0.65), (0.9, 0.62, 0.0))
_ARROW, _DELETE = 0, 2  # of visualization_msgs/Marker: its type, and the action that takes it away


def write_mcap(
    plan: Transition | RegraspPlan | Motions,
    path: str | Path,
    rate: float = 200.0,
    *,
    start: float = 0.0,
    metres_per_newton: float | None = None,
) -> None:
    """Write a plan as messages of ROS 2 in one MCAP file. Needs the extra ``regrasp[ros]``, not ROS.

    ``/fingers/<name>/wrench`` (geometry_msgs/WrenchStamped): what the finger does to the object, force and
    torque about the centre of mass, in the frame ``object``; in the plane z is up. Each number is the plan's
    own double.
    ``/fingers/<name>/pose`` (PoseStamped, frame ``object``): the contact point, x along the normal.
    ``/object/pose`` (PoseStamped) and ``/tf``: how the object is turned in ``world``, as the plan counts it.
    ``/forces`` (visualization_msgs/MarkerArray): an arrow for each force that ends at its contact.
    Names keep letters and digits, all else becomes ``_``. Fingers that are not in a step are silent then.
    With motions the clock is theirs, and ``/tips/F1/pose`` (PoseStamped, frame ``object``) and
    ``/tips/F1/velocity`` (TwistStamped) follow the centre of every finger's tip through the air.

    Args:
        plan: a transition or a whole regrasp, or the motions of one.
        path: of the file, which ends in ``.mcap``.
        rate: messages per second; both ends of every step have one.
        start: stamp of the first [s].
        metres_per_newton: length of the arrows; half the size of the grasp for the largest force by default.

    Raises:
        InvalidInput: For another ending than ``.mcap``.
        ImportError: Without rosbags.
    """
    motions, plan = (plan, plan.plan) if isinstance(plan, Motions) else (None, plan)
    if not isinstance(plan, Transition | RegraspPlan):
        raise InvalidInput(f"plan must be a Transition, a RegraspPlan or Motions, got {shown(plan)}")
    target = Path(file_path(path))
    number(rate, "rate", above=0)
    number(start, "start")
    if metres_per_newton is not None:
        number(metres_per_newton, "metres_per_newton", above=0)
    if target.suffix != ".mcap":
        raise InvalidInput(f"path must end in .mcap, got {shown(str(path))}")
    try:
        from rosbags.rosbag2 import StoragePlugin, Writer
        from rosbags.typesys import Stores, get_typestore
    except ImportError:
        raise ImportError("write_mcap needs rosbags: pip install 'regrasp[ros]'") from None
    store = get_typestore(Stores.ROS2_JAZZY)
    steps = (plan,) if isinstance(plan, Transition) else plan.steps
    if metres_per_newton is None:
        largest = max(step.peak for step in steps)
        metres_per_newton = 0.5 * max(step.grasp.size for step in steps) / (largest or 1.0)
    with TemporaryDirectory(prefix=".regrasp-", dir=target.parent) as temporary:
        folder = Path(temporary, "bag")
        with Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP) as bag:
            connections: dict[str, Any] = {}
            for topic, stamp, message in _messages(
                _blocks(plan, motions, rate), plan, start, metres_per_newton, store.types
            ):
                kind = message.__msgtype__
                if topic not in connections:
                    connections[topic] = bag.add_connection(topic, kind, typestore=store)
                bag.write(connections[topic], stamp, store.serialize_cdr(message, kind))
        (made,) = folder.glob("*.mcap")
        made.replace(target)


def topics_of(plan: Transition | RegraspPlan) -> dict[str, str]:
    """The name of every contact as part of a topic; those that would be equal get a number."""
    steps = (plan,) if isinstance(plan, Transition) else plan.steps
    topics: dict[str, str] = {}
    for name in (name for step in steps for name in step.grasp.names):
        if name in topics:
            continue
        base = re.sub(r"[^A-Za-z0-9]", "_", name)
        base = base if not base[0].isdigit() else f"_{base}"
        candidates = (base, *(f"{base}_{k}" for k in range(2, len(topics) + 3)))
        topics[name] = next(c for c in candidates if c not in topics.values())
    return topics


class _Block(NamedTuple):
    """Instants of a step: times (m,) in it and of the bag [s]; tips' centres and velocities (m, k, d)."""

    step: int
    times: Array
    clock: Array
    tips: Array | None
    velocities: Array | None


def _blocks(plan: Transition | RegraspPlan, motions: Motions | None, rate: float) -> Iterator[_Block]:
    """All instants in order."""
    if motions is None:
        steps = (plan,) if isinstance(plan, Transition) else plan.steps
        begins = np.cumsum([0.0, *(step.duration for step in steps)])
        for rows in setpoint_blocks(plan, rate):
            yield _Block(rows.step, rows.times, begins[rows.step] + rows.times, None, None)
        return
    t = motion_times(motions, rate)
    k, local = motions.step_times(t)
    at, velocity = motions.positions(t), motions.velocities(t)
    for step in range(len(motions.steps)):
        here = k == step
        yield _Block(step, local[here], t[here], at[here], velocity[here])


def _messages(
    blocks: Iterator[_Block], plan: Transition | RegraspPlan, start: float, scale: float, types: Any
) -> Iterator[tuple[str, int, Any]]:
    """(topic, stamp [ns], message) in order of time."""
    make = _Maker(types)
    steps = (plan,) if isinstance(plan, Transition) else plan.steps
    topics, numbers = topics_of(plan), {name: i for i, name in enumerate(topics_of(plan))}
    pose_kind = "geometry_msgs/msg/PoseStamped"
    for block in blocks:
        step = steps[block.step]
        wrenches, forces = step.wrenches(block.times), step.forces(block.times)
        poses = {c.name: make.pose(c.position, _along(c)) for c in step.grasp}
        turned = _quaternions(plan, block.step, step, block.times)
        for k, t in enumerate((start + block.clock).tolist()):
            stamp = round(t * 1e9)
            here, there = make.header(stamp, OBJECT), make.header(stamp, WORLD)
            at = make.pose(np.zeros(3), turned[k])
            yield "/object/pose", stamp, make(pose_kind, there, at)
            yield "/tf", stamp, make.transform(there, turned[k])
            for i, contact in enumerate(step.grasp):
                topic = f"/fingers/{topics[str(contact.name)]}"
                wrench = make.wrench(wrenches[k, i])
                yield f"{topic}/wrench", stamp, make("geometry_msgs/msg/WrenchStamped", here, wrench)
                yield f"{topic}/pose", stamp, make(pose_kind, here, poses[contact.name])
            if block.tips is not None and block.velocities is not None:
                for i, (tip, speed) in enumerate(zip(block.tips[k], block.velocities[k], strict=True), 1):
                    straight = make.pose(tip, np.array([1.0, 0.0, 0.0, 0.0]))
                    yield f"/tips/F{i}/pose", stamp, make(pose_kind, here, straight)
                    twist = make("geometry_msgs/msg/TwistStamped", here, make.twist(speed))
                    yield f"/tips/F{i}/velocity", stamp, twist
            pushed = zip(step.grasp, scale * forces[k], strict=True)
            shown = {numbers[str(c.name)]: (c, along) for c, along in pushed}
            arrows = [make.arrow(here, i, *shown.get(i, (None, None))) for i in range(len(topics))]
            yield "/forces", stamp, make("visualization_msgs/msg/MarkerArray", arrows)


class _Maker:
    """Messages from numbers."""

    def __init__(self, types: Any) -> None:
        self._types = types

    def __call__(self, kind: str, *fields: Any) -> Any:
        return self._types[kind](*fields)

    def header(self, stamp: int, frame: str) -> Any:
        time = self("builtin_interfaces/msg/Time", stamp // 10**9, stamp % 10**9)
        return self("std_msgs/msg/Header", time, frame)

    def wrench(self, vector: Array) -> Any:
        vector3 = self._vector
        if vector.size == 3:
            fx, fy, torque = vector.tolist()
            return self("geometry_msgs/msg/Wrench", vector3(fx, fy, 0.0), vector3(0.0, 0.0, torque))
        f, torques = vector[:3].tolist(), vector[3:].tolist()
        return self("geometry_msgs/msg/Wrench", vector3(*f), vector3(*torques))

    def pose(self, at: Array, quaternion: Array) -> Any:
        return self("geometry_msgs/msg/Pose", self._point(at), self._turn(quaternion))

    def twist(self, velocity: Array) -> Any:
        x, y, *z = velocity.tolist()
        still = self._vector(0.0, 0.0, 0.0)
        return self("geometry_msgs/msg/Twist", self._vector(x, y, z[0] if z else 0.0), still)

    def transform(self, header: Any, quaternion: Array) -> Any:
        kind = "geometry_msgs/msg/Transform"
        moved = self(kind, self._vector(0.0, 0.0, 0.0), self._turn(quaternion))
        stamped = self("geometry_msgs/msg/TransformStamped", header, OBJECT, moved)
        return self("tf2_msgs/msg/TFMessage", [stamped])

    def arrow(self, header: Any, number: int, contact: Contact | None, along: Array | None) -> Any:
        marker: Callable[..., Any] = self._types["visualization_msgs/msg/Marker"]
        zero = self.pose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
        absent = contact is None or along is None or not along.any()
        points, width = [], 0.0
        if contact is not None and along is not None:
            f = along[: contact.dimension]
            points = [self._point(contact.position - f), self._point(contact.position)]
            width = 0.06 * float(np.linalg.norm(f))
        r, g, b = _COLOURS[number % len(_COLOURS)]
        image = self("sensor_msgs/msg/CompressedImage", header, "", np.zeros(0, dtype=np.uint8))
        return marker(
            header=header,
            ns="forces",
            id=number,
            type=_ARROW,
            action=_DELETE if absent else 0,
            pose=zero,
            scale=self._vector(width, 2 * width, 0.0),
            color=self("std_msgs/msg/ColorRGBA", r, g, b, 1.0),
            lifetime=self("builtin_interfaces/msg/Duration", 0, 0),
            frame_locked=True,
            points=[] if absent else points,
            colors=[],
            texture_resource="",
            texture=image,
            uv_coordinates=[],
            text="",
            mesh_resource="",
            mesh_file=self("visualization_msgs/msg/MeshFile", "", np.zeros(0, dtype=np.uint8)),
            mesh_use_embedded_materials=False,
        )

    def _vector(self, x: float, y: float, z: float) -> Any:
        return self("geometry_msgs/msg/Vector3", x, y, z)

    def _point(self, at: Array) -> Any:
        x, y, *z = at.tolist()
        return self("geometry_msgs/msg/Point", x, y, z[0] if z else 0.0)

    def _turn(self, quaternion: Array) -> Any:
        w, x, y, z = quaternion.tolist()
        return self("geometry_msgs/msg/Quaternion", x, y, z, w)


def _along(contact: Contact) -> Array:
    """The unit quaternion (w, x, y, z) that turns the x axis into the contact's normal, the shortest way."""
    n = np.append(contact.normal, 0.0)[:3]
    if n[0] < -1 + 1e-12:
        return np.array([0.0, 0.0, 0.0, 1.0])
    q = np.array([1 + n[0], 0.0, -n[2], n[1]])
    return np.asarray(q / np.linalg.norm(q))


def _quaternions(plan: Transition | RegraspPlan, k: int, step: Transition, times: Array) -> Array:
    """(m, 4) unit quaternions (w, x, y, z) of the object in the world."""
    if step.grasp.dimension == 2:
        begun = plan.orientations[k] if isinstance(plan, RegraspPlan) else 0.0
        half = (begun + step.orientation(times)) / 2
        zero = np.zeros_like(half)
        return np.stack([np.cos(half), zero, zero, np.sin(half)], axis=1)
    from scipy.spatial.transform import Rotation

    before = rotation_before(plan, k)
    result: Array = Rotation.from_matrix(before @ step.rotations(times)).as_quat(scalar_first=True)
    return result

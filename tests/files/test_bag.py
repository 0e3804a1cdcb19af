"""A plan in MCAP reads back as it is."""

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import regrasp as rg
from executed_plans import LOAD, ellipse, lifted, removal, tipped, turned
from regrasp.files import write_mcap
from regrasp.files.plans.bag import topics_of

pytestmark = pytest.mark.contract

pytest.importorskip("rosbags")


def messages(path: Path) -> dict[str, list[tuple[int, Any]]]:
    """Topic -> stamps [ns] and messages, in order."""
    from rosbags.rosbag2 import Reader
    from rosbags.typesys import Stores, get_typestore

    store, found = get_typestore(Stores.ROS2_JAZZY), dict[str, list[tuple[int, Any]]]()
    with Reader(path) as bag:
        for connection, stamp, raw in bag.messages():
            message = store.deserialize_cdr(raw, connection.msgtype)
            found.setdefault(connection.topic, []).append((stamp, message))
    return found


def numbers(vector: Any) -> list[float]:
    return [vector.x, vector.y, vector.z]


@pytest.mark.parametrize(
    "plan", [removal(), turned(), lifted(), tipped()], ids=["plane", "turn", "space", "tip"]
)
def test_wrenches_read_back_bit_equal(plan: rg.Transition, tmp_path: Path) -> None:
    write_mcap(plan, tmp_path / "plan.mcap", rate=50.0)
    found, t = messages(tmp_path / "plan.mcap"), plan.times(50.0)
    wrenches = plan.wrenches(t)
    for i, name in enumerate(plan.grasp.names):
        rows = found[f"/fingers/{name}/wrench"]
        read = np.array([[*numbers(m.wrench.force), *numbers(m.wrench.torque)] for _, m in rows])
        planar = plan.grasp.dimension == 2
        kept = read[:, [0, 1, 5]] if planar else read
        assert np.array_equal(kept, wrenches[:, i])
        assert not planar or not read[:, [2, 3, 4]].any()
        assert [stamp for stamp, _ in rows] == [round(x * 1e9) for x in t.tolist()]
        first = rows[1][1].header
        assert (first.frame_id, first.stamp.nanosec) == ("object", 20_000_000)


def test_poses_say_where_contacts_and_object_are(tmp_path: Path) -> None:
    plan = tipped()
    write_mcap(plan, tmp_path / "plan.mcap", rate=20.0)
    found, t = messages(tmp_path / "plan.mcap"), plan.times(20.0)
    for k, (_, message) in enumerate(found["/object/pose"]):
        assert message.header.frame_id == "world"
        assert turn(message.pose.orientation) == pytest.approx(plan.rotations(t[k]), abs=1e-12)
    for contact in plan.grasp:
        pose = found[f"/fingers/{contact.name}/pose"][0][1].pose
        assert numbers(pose.position) == contact.position.tolist()
        assert turn(pose.orientation)[:, 0] == pytest.approx(contact.normal, abs=1e-12)
    (transform,) = found["/tf"][-1][1].transforms
    assert (transform.header.frame_id, transform.child_frame_id) == ("world", "object")
    assert turn(transform.transform.rotation) == pytest.approx(plan.rotations(t[-1]), abs=1e-12)


def turn(q: Any) -> np.ndarray[Any, Any]:
    from scipy.spatial.transform import Rotation

    return Rotation.from_quat([q.x, q.y, q.z, q.w]).as_matrix()


def test_arrows_end_at_their_contacts_and_go_with_their_forces(tmp_path: Path) -> None:
    plan = removal()
    write_mcap(plan, tmp_path / "plan.mcap", rate=10.0, metres_per_newton=0.01)
    found = messages(tmp_path / "plan.mcap")["/forces"]
    for i, marker in enumerate(found[0][1].markers):
        tail, head = (np.array(numbers(p))[:2] for p in marker.points)
        assert head.tolist() == plan.grasp[i].position.tolist()
        assert head - tail == pytest.approx(0.01 * plan.start.forces[i])
        assert (marker.type, marker.action) == (0, 0)
    assert [m.action for m in found[-1][1].markers] == [0, 0, 2]  # P3 has left


def test_a_regrasp_is_one_bag(tmp_path: Path) -> None:
    outline = rg.Outline.ellipse(0.04, 0.02)
    plan = rg.plan_regrasp(
        outline, ellipse(0.02, 0.35, 0.7), ellipse(0.2, 0.5, 0.85), rg.Wrench([0, -3.0]), friction=0.5
    )
    write_mcap(plan, tmp_path / "plan.mcap", rate=20.0)
    found = messages(tmp_path / "plan.mcap")
    assert topics_of(plan)["start P1"] == "start_P1"
    assert set(found) == {"/object/pose", "/tf", "/forces"} | {
        f"/fingers/{topic}/{kind}" for topic in topics_of(plan).values() for kind in ("wrench", "pose")
    }
    stamps = [stamp for stamp, _ in found["/object/pose"]]
    assert stamps == sorted(stamps)
    assert stamps[-1] == round(plan.duration * 1e9)


def test_names_become_topics_that_differ() -> None:
    contacts = [
        rg.Contact(c.position, c.normal, c.friction, name=name)
        for c, name in zip(removal().grasp, ("a b", "a-b", "7"), strict=True)
    ]
    start = rg.GraspState(rg.Grasp(contacts), LOAD, removal().start.forces)
    assert topics_of(rg.plan_removal(start, "7")) == {"a b": "a_b", "a-b": "a_b_2", "7": "_7"}


def test_another_ending_is_refused(tmp_path: Path) -> None:
    with pytest.raises(rg.InvalidInput, match=r"path must end in \.mcap, got"):
        write_mcap(removal(), tmp_path / "plan.bag")


def test_without_rosbags_one_line_names_the_extra(tmp_path: Path) -> None:
    code = (
        "import sys; sys.modules['rosbags.rosbag2'] = None\n"
        "from executed_plans import removal\nfrom regrasp.files import write_mcap\n"
        f"try:\n    write_mcap(removal(), {str(tmp_path / 'plan.mcap')!r})\n"
        "except ImportError as error:\n    print(error)"
    )
    here = {"PYTHONPATH": ":".join(p for p in sys.path if p)}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=here)
    assert done.stdout.strip() == "write_mcap needs rosbags: pip install 'regrasp[ros]'"

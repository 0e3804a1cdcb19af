"""Set-points of motions as a table and as a bag read back bit-equal."""

import csv
from pathlib import Path

import numpy as np
import pytest

import regrasp as rg
from executed_plans import ellipse, lifted
from regrasp.files import parse_scenario, plan_scenario_motions, write_mcap, write_motions
from regrasp.mesh import parts
from regrasp.motions import Motions, plan_motions

pytestmark = pytest.mark.contract

ELLIPSE = rg.Outline.ellipse(0.04, 0.02)
WITHOUT = """
[load]
force = [0.0, 0.0, -1.0]
[[contacts]]
name = "A"
position = [0.0, 0.03, 0.0]
normal = [0.0, -1.0, 0.0]
friction = 0.5
[[contacts]]
name = "B"
position = [0.02, -0.03, 0.0]
normal = [0.0, 1.0, 0.0]
friction = 0.5
[[contacts]]
name = "C"
position = [-0.02, -0.03, 0.0]
normal = [0.0, 1.0, 0.0]
friction = 0.5
[[contacts]]
name = "D"
position = [0.0, -0.03, 0.02]
normal = [0.0, 1.0, 0.0]
friction = 0.5
[task]
kind = "removal"
contact = "D"
"""


def planar() -> Motions:
    plan = rg.plan_regrasp(
        ELLIPSE, ellipse(0.02, 0.35, 0.7), ellipse(0.2, 0.5, 0.85), rg.Wrench([0, -3.0]), friction=0.5
    )
    return plan_motions(plan, ELLIPSE, tip_radius=0.003, clearance=0.002)


def spatial() -> Motions:
    return plan_motions(lifted(), parts.bracket(), tip_radius=0.002, clearance=0.001)


@pytest.mark.parametrize("made", [planar, spatial])
def test_a_table_reads_back_bit_equal(made, tmp_path: Path) -> None:
    motions = made()
    write_motions(motions, tmp_path / "motions.csv", rate=50.0)
    with (tmp_path / "motions.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    t = np.array([float(row["t"]) for row in rows])
    assert (t[0], t[-1]) == (0.0, motions.duration)
    assert (np.diff(t) > 0).all()
    assert set(motions.starts) <= set(t)
    d = motions.tips.shape[2]
    for what, values in (
        ("", motions.positions(t)),
        ("v", motions.velocities(t)),
        ("f", motions.forces(t)),
    ):
        for i in range(motions.tips.shape[1]):
            for k, axis in enumerate("xyz"[:d]):
                assert [float(row[f"F{i + 1}_{what}{axis}"]) for row in rows] == values[:, i, k].tolist()
    touching = [[int(row[f"F{i + 1}_touching"]) for i in range(motions.tips.shape[1])] for row in rows]
    assert touching == motions.touching(t).astype(int).tolist()
    assert [float(row["plan_t"]) for row in rows] == motions.plan_time(t).tolist()
    free = ~motions.touching(t)
    assert free.any()
    assert not motions.forces(t)[free].any()


def test_forces_of_motions_are_those_of_the_plan() -> None:
    motions = planar()
    t = np.linspace(0, motions.duration, 500)
    forces, clock = motions.forces(t), motions.plan_time(t)
    inside = (clock > 0.2) & (clock < 0.8)
    assert forces[inside] == pytest.approx(motions.steps[0].forces(clock[inside]))


def test_a_bag_follows_the_tips(tmp_path: Path) -> None:
    pytest.importorskip("rosbags")
    from test_bag import messages

    motions = planar()
    write_mcap(motions, tmp_path / "plan.mcap", rate=20.0)
    found = messages(tmp_path / "plan.mcap")
    for i in range(3):
        poses, speeds = found[f"/tips/F{i + 1}/pose"], found[f"/tips/F{i + 1}/velocity"]
        stamps = np.array([stamp for stamp, _ in poses]) / 1e9
        read = np.array([[m.pose.position.x, m.pose.position.y] for _, m in poses])
        assert read == pytest.approx(motions.positions(np.minimum(stamps, motions.duration))[:, i], abs=1e-9)
        assert speeds[0][1].twist.linear.x == 0.0
        assert max(abs(m.twist.linear.x) for _, m in speeds) > 0
    assert len(found["/object/pose"]) == len(found["/tips/F1/pose"])


def test_scenarios_without_what_ways_need_are_refused() -> None:
    with pytest.raises(rg.InvalidInput, match=r"ways of fingers need a table \[motions\] with tip_radius"):
        plan_scenario_motions(parse_scenario(WITHOUT))
    more = f"{WITHOUT}\n[motions]\ntip_radius = 0.003\nclearance = 0.002\n"
    with pytest.raises(rg.InvalidInput, match=r"ways go around a shape: give an \[object\]"):
        plan_scenario_motions(parse_scenario(more))
    with pytest.raises(
        rg.InvalidInput, match=r"motions\.clearance: expected a number greater than 0, got -1"
    ):
        parse_scenario(more.replace("clearance = 0.002", "clearance = -1.0"))


def test_what_is_no_motions_and_too_many_rows_are_refused(tmp_path: Path) -> None:
    with pytest.raises(rg.InvalidInput, match="write_motions needs motions, got 3"):
        write_motions(3, tmp_path / "x.csv")  # type: ignore[arg-type]
    with pytest.raises(rg.InvalidInput, match=r"set-points; at most 1e\+06 are made"):
        write_motions(spatial(), tmp_path / "x.csv", rate=1e9)

"""What newcomers ran into."""

from pathlib import Path

import numpy as np
import pytest

import regrasp as rg
from regrasp.files.plans.setpoints import read_setpoints, write_setpoints
from scenarios import edited, regrasp

pytestmark = pytest.mark.contract

THREE = [
    rg.Contact([-4, -4], [1, 1], 0.3),
    rg.Contact([4, -5], [-1, 2], 0.3),
    rg.Contact([0, 8], [0, -1], 0.3),
]
LOAD = rg.Wrench([-1.5, -3.5])


def removal(**options: object) -> rg.Transition:
    return rg.plan_removal(rg.Grasp(THREE), "P3", load=LOAD, **options)


def test_unnamed_contacts_get_names_that_are_free() -> None:
    named = rg.Contact([4, -5], [-1, 2], 0.3, name="P2")
    assert rg.Grasp([named, THREE[0]]).names == ("P2", "P3")
    assert rg.Grasp(THREE).without("P2").with_contact(THREE[1]).names == ("P1", "P3", "P4")


@pytest.mark.parametrize("objective", ["effort", "peak", "peak_normal"])
@pytest.mark.parametrize("max_force", [None, 3.0])
def test_nothing_to_hold_needs_no_force(objective: str, max_force: float | None) -> None:
    state = rg.choose_state(rg.Grasp(THREE), rg.Wrench([0, 0]), objective, max_force=max_force)
    assert not state.forces.any()


def test_times_may_be_an_ulp_beyond_the_end() -> None:
    plan = removal(duration=0.3)
    assert 3 * 0.1 > 0.3
    np.testing.assert_array_equal(plan.forces(3 * 0.1), plan.end.forces)
    with pytest.raises(rg.InvalidInput, match=r"t must lie in \[0, 0.3\] s"):
        plan.forces(0.3 * (1 + 1e-12))


def test_a_duration_is_given_once() -> None:
    with pytest.raises(rg.InvalidInput, match="give one of duration and scaling"):
        removal(duration=2.0, scaling=rg.TimeScaling.linear(1.0))
    assert removal(scaling=rg.TimeScaling.linear(2.0)).duration == 2
    assert removal().duration == 1


def test_set_points_are_read_back_and_checked(tmp_path: Path) -> None:
    plan, file = removal(), tmp_path / "setpoints.csv"
    write_setpoints(plan, file, 50.0)
    ((_, times, _, forces),) = read_setpoints(file, plan)
    np.testing.assert_array_equal(times, plan.times(50.0))
    np.testing.assert_array_equal(forces, plan.forces(times))
    text = file.read_text()
    for wrong, message in [
        (text.replace("P1_fx", "P1_x"), "expected the columns t,P1_fx"),
        (text.replace("\n0.02,", "\n0.02,nan,"), "expected rows of 7"),
        (text.replace("\n0.02,", "\n2.0,"), r"times must rise from 0 to 1.0 s"),
        (text.replace("\n0.02,", "\nsoon,"), "could not convert string to float"),
        ("", "expected the columns"),
    ]:
        file.write_text(wrong)
        with pytest.raises(rg.InvalidInput, match=message):
            read_setpoints(file, plan)


def test_a_changed_set_point_is_refused_by_the_command_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scenario, out = tmp_path / "scenario.toml", tmp_path / "out"
    scenario.write_text(edited())
    assert regrasp(capsys, "plan", scenario, "-o", out, "--no-figures")[0] == 0
    status, printed, _ = regrasp(capsys, "verify", out)
    assert status == 0
    assert "each of 1001 set-points" in printed
    table = out / "setpoints.csv"
    rows = table.read_text().splitlines()
    rows[6] = ",".join([*rows[6].split(",")[:-1], "9.9"])
    table.write_text("\n".join(rows) + "\n")
    status, _, complaint = regrasp(capsys, "verify", out)
    assert status == 1
    assert "set-point 5: force of P3 pulls" in complaint

"""Set-points of positions and forces are judged from the file and the plan alone."""

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import regrasp as rg
from executed_plans import ellipse, lifted
from regrasp.files import read_motions, write_motions
from regrasp.mesh import parts
from regrasp.motions import Motions, plan_motions
from regrasp.verification import verify_motion_rows

pytestmark = pytest.mark.contract


@cache
def made(kind: str) -> Motions:
    if kind == "space":
        return plan_motions(lifted(), parts.bracket(), tip_radius=0.002, clearance=0.001)
    outline = rg.Outline.ellipse(0.04, 0.02)
    plan = rg.plan_regrasp(
        outline, ellipse(0.02, 0.35, 0.7), ellipse(0.2, 0.5, 0.85), rg.Wrench([0, -3.0]), friction=0.5
    )
    return plan_motions(plan, outline, tip_radius=0.003, clearance=0.002)


def written(kind: str, folder: Path, rate: float = 200.0) -> tuple[Path, Any]:
    path = folder / "motions.csv"
    write_motions(made(kind), path, rate=rate)
    return path, made(kind).plan


@pytest.mark.parametrize(("kind", "touching", "radius"), [("plane", 2, 0.003), ("space", 3, 0.002)])
def test_what_was_planned_verifies(kind: str, touching: int, radius: float, tmp_path: Path) -> None:
    path, plan = written(kind, tmp_path)
    verdict = verify_motion_rows(plan, read_motions(path, plan))
    assert verdict.ok, str(verdict)
    assert (verdict.touching, verdict.tip_radius) == (touching, pytest.approx(radius))
    assert verdict.to_fingers >= made(kind).clearance * 0.999


def changed(path: Path, change: Callable[[dict[str, np.ndarray]], None]) -> None:
    header, *lines = path.read_text().splitlines()
    table = np.array([[float(x) for x in line.split(",")] for line in lines])
    columns = dict(zip(header.split(","), table.T, strict=True))
    change(columns)
    rows = (",".join(map(repr, row)) for row in np.column_stack(list(columns.values())).tolist())
    path.write_text("\n".join([header, *rows]) + "\n")


def moved(c: dict[str, np.ndarray]) -> None:
    c["F1_x"][len(c["t"]) // 2] += 1e-4


def slower(c: dict[str, np.ndarray]) -> None:
    for i in (1, 2, 3):
        c[f"F{i}_vx"] *= 0.9


def let_go(c: dict[str, np.ndarray]) -> None:
    c["F2_touching"][:] = 0


def said_to_touch(c: dict[str, np.ndarray]) -> None:
    c["F1_touching"][:] = c["F2_touching"][:] = c["F3_touching"][:] = 1


def pushed(c: dict[str, np.ndarray]) -> None:
    c["F1_fy"] += 1e-6


def pushed_in_the_air(c: dict[str, np.ndarray]) -> None:
    c["F1_fx"][c["F1_touching"] == 0] = 1.0


def through(c: dict[str, np.ndarray]) -> None:
    for axis in "xy":
        c[f"F1_{axis}"][:] = c[f"F2_{axis}"]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (moved, "finger 1 moves otherwise than its velocity says at"),
        (slower, "moves otherwise than its velocity says"),
        (let_go, "during step 1 no finger is at"),
        (let_go, "fewer than 2 fingers touch at"),
        (said_to_touch, "is said to touch off every contact at"),
        (pushed, "step 1: set-point "),
        (pushed_in_the_air, "finger 1 has a force in the air at"),
        (through, "two tips are in one another by 0.006"),
    ],
)
def test_what_is_wrong_is_seen(change: Any, said: str, tmp_path: Path) -> None:
    path, plan = written("plane", tmp_path)
    changed(path, change)
    verdict = verify_motion_rows(plan, read_motions(path, plan))
    assert any(said in violation for violation in verdict.violations), str(verdict)


@pytest.mark.parametrize(
    ("column", "value", "said"),
    [
        ("t", 5.0, "times t must rise from 0"),
        ("plan_t", 0.9, "plan's time plan_t must go from 0"),
        ("step", 9.0, "steps must rise from 1 to"),
        ("angle", 0.1, "angles must be the plan's at these times"),
        ("F1_touching", 0.5, "whether a finger touches must be 0 or 1"),
    ],
)
def test_rows_of_another_plan_are_refused(column: str, value: float, said: str, tmp_path: Path) -> None:
    path, plan = written("plane", tmp_path)
    changed(path, lambda c: c[column].__setitem__(1, value))
    with pytest.raises(rg.InvalidInput, match=said):
        read_motions(path, plan)
    path.write_text("t,x\n0,1\n")
    with pytest.raises(rg.InvalidInput, match="expected the columns t,plan_t,step,angle,F1_x"):
        read_motions(path, plan)


def test_a_row_that_is_missing_is_named(tmp_path: Path) -> None:
    path, plan = written("plane", tmp_path)
    assert read_motions(path, plan, 200.0).times.size == read_motions(path, plan, 100.0).times.size
    with pytest.raises(rg.InvalidInput, match=r"rows must come every 0\.004 s; one is missing after"):
        read_motions(path, plan, 250.0)
    lines = path.read_text().splitlines()
    path.write_text("\n".join([*lines[:50], *lines[51:]]))
    with pytest.raises(rg.InvalidInput, match=r"rows must come every 0\.005 s; one is missing after 0\.24 s"):
        read_motions(path, plan)


@pytest.mark.parametrize(("share", "fine"), [(1e-7, True), (2e-6, False), (0.5, False)])
def test_rows_come_evenly_to_a_millionth(share: float, fine: bool, tmp_path: Path) -> None:
    """A row in the middle of a pause comes late by a share of what is between rows."""
    path, plan = written("plane", tmp_path)

    def late(c: dict[str, np.ndarray]) -> None:
        k = len(c["t"]) // 2
        gap = c["t"][k + 1] - c["t"][k]
        for name in ("t", "plan_t") if c["plan_t"][k] > c["plan_t"][k - 1] else ("t",):
            c[name][k] += share * gap

    changed(path, late)
    if fine:
        assert read_motions(path, plan).times.size > 9
    else:
        with pytest.raises(rg.InvalidInput, match=r"one is missing after|angles must be the plan's"):
            read_motions(path, plan)


def test_clocks_that_are_sums_end_where_the_plan_does(tmp_path: Path) -> None:
    """Ten steps of a tenth of a second end at 0.9999999999999999 s."""
    for share, fine in (1e-15, True), (1e-8, False):
        path, plan = written("plane", tmp_path, rate=20.0)

        def early(c: dict[str, np.ndarray], by: float = share) -> None:
            c["plan_t"][-1] *= 1 - by

        changed(path, early)
        if fine:
            assert verify_motion_rows(plan, read_motions(path, plan)).ok
        else:
            with pytest.raises(rg.InvalidInput, match="must go from 0 to"):
                read_motions(path, plan)

"""What ways hide: fingers that begin in a mesh, steps between two samples, grasps of several sizes."""

from types import SimpleNamespace

import numpy as np
import pytest

import regrasp as rg
from regrasp.plans.record import Record
from regrasp.verification import verify_motion_rows, verify_motions
from regrasp.verification.ways.distances import to_boundary, within
from regrasp.verification.ways.rows import _radius

pytestmark = pytest.mark.oracle

RADIUS, KEEP = 0.1, 0.2
BOX = rg.Mesh.box(2, 2, 2)
AT = {"A": [-1, 0, 0], "B": [1, 0, 0], "C": [0, 1, 0], "D": [0, 0, 1]}


def step(*names: str, duration: float = 1.0) -> SimpleNamespace:
    contacts = [rg.Contact(AT[n], np.negative(AT[n]), 0.5, name=n) for n in names]
    return SimpleNamespace(grasp=rg.Grasp(contacts), duration=duration)


def ways(tip, capsule=(0.0, 0, 0), speed=(0.0, 0, 0), **changes) -> SimpleNamespace:
    """Three fingers rest at A, B and C, one second; a fourth is in the air."""
    rest = np.array([np.multiply(AT[n], 1 + RADIUS) for n in "ABC"])

    def positions(t):
        moved = np.array(tip, dtype=float) + np.asarray(t)[:, None] * speed
        return np.concatenate([np.tile(rest, (len(t), 1, 1)), moved[:, None]], axis=1)

    given = {
        "tip_radius": RADIUS, "clearance": KEEP, "steps": (step("A", "B", "C"),), "starts": np.zeros(1),
        "duration": 1.0, "positions": positions,
        "capsules": np.array([[0, 0, 0]] * 3 + [capsule], dtype=float),
        "velocities": lambda t: np.tile([[0.0] * 3] * 3 + [speed], (len(t), 1, 1)),
        "touching": lambda t: np.tile([True, True, True, False], (len(t), 1)),
    }  # fmt: skip
    return SimpleNamespace(**given | changes)


def test_a_finger_that_begins_in_a_mesh_is_in_it() -> None:
    """Far from all its faces, or with its other end."""
    for tip, capsule, depth in (
        ((0, 0, 0), (0, 0, 0), 1.1), ((0, -0.5, 0), (0, 0, 0), 0.6), ((0, 0, 1.5), (0, 0, 0), None),
        ((0, 0, 3.0), (0, 0, -2.5), 0.6), ((0, 0, -0.5), (0, 0, -2.5), 0.6), ((0, 0, 3.0), (0, 0, 2.5), None),
    ):  # fmt: skip
        for speed in (0.0, 0, 0), (1e-3, 0, 0):
            verdict = verify_motions(ways(tip, capsule, speed), BOX)
            if depth is None:
                assert verdict.ok, str(verdict)
                assert verdict.to_object == pytest.approx(tip[2] - 1 - RADIUS)
            else:
                assert verdict.to_object == pytest.approx(-depth, abs=2e-3)
                assert verdict.violations[0].startswith(f"finger 4 is in the object by {depth:.3g} at")


def test_an_instant_alone_is_looked_at() -> None:
    """A finger is nearer at one sample, and where it was before and after."""
    rest = ways((0, 0, 1.5)).positions

    def positions(t):
        at = rest(t)
        at[abs(t - 0.25) < 1e-6, 3, 2] -= 0.015
        return at

    assert verify_motions(ways((0, 0, 1.5)), BOX).to_object == pytest.approx(0.4)
    assert verify_motions(ways((0, 0, 1.5), positions=positions), BOX).to_object == pytest.approx(0.385)


def test_what_is_within_closed_triangles() -> None:
    vertices, faces = BOX.surface()
    corners = vertices[faces]
    points = [(x, y, z) for x in (-3, -0.999, 0.2, 0.999, 1.001, 9) for y in (0.1, -1.01) for z in (0.3, 0.9)]
    inside = [abs(x) < 1 and abs(y) < 1 for x, y, _ in points]
    for unit, off in (1e-6, (0, 0, 0)), (1.0, (5, -3, 9)), (1e6, (0, 0.75, 0)):
        for turned in corners, corners[:, ::-1]:
            assert within(unit * (np.array(points) + off), unit * (turned + off)).tolist() == inside
    hollow = np.concatenate([corners, 0.5 * corners[:, ::-1]])  # a void in it is air
    assert within(np.array([[0, 0, 0.0], [0, 0, 0.75], [0, 0, 1.5]]), hollow).tolist() == [False, True, False]


def test_points_beside_a_corner_of_a_polygon() -> None:
    """On its level, where sides meet: one of both counts where they go on, both or none where they turn."""
    diamond = np.array([[-1.0, 0], [0, -1], [1, 0], [0, 1]])
    points = np.array(
        [[-2.0, 0], [-0.5, 0], [0.0, 0], [0.5, 0], [2.0, 0], [-2, 1.0], [2, 1.0], [-2, -1], [2, -1.0]]
    )
    for ring in diamond, diamond[::-1], np.roll(diamond, 1, axis=0):
        inside = to_boundary(points, ring) < 0
        assert inside.tolist() == [False, True, True, True, False, False, False, False, False]


def test_steps_between_two_samples_are_looked_at() -> None:
    """They are a thousandth of a second apart, and no finger is ever at D."""
    for start in 0.50026, 0.9999, 1e-5:
        steps = (step("A", "B", "C"), step("A", "B", "D", duration=1e-5))
        first = steps[0]
        first.duration = 1e-9
        made = ways((0, 0, 1.5), steps=steps, starts=np.array([0.0, start]))
        assert "during step 2 no finger is at D" in verify_motions(made, BOX).violations
        made.steps = (first, step("A", "B", "C", duration=1e-5))
        assert verify_motions(made, BOX).ok
        made.starts = made.starts[:1]
        with pytest.raises(rg.InvalidInput, match="2 steps need as many starts, got 1"):
            verify_motions(made, BOX)


def test_samples_are_the_middles_of_steps_and_even() -> None:
    for steps, starts, more in (
        ([1.0], [0.0], 0), ([0.3], [0.0], 1), ([0.3, 0.3], [0.0, 0.35], 2), ([0.5, 0.25], [0.0, 0.5], 0),
        ([0.3], [-0.15], 0), ([0.3], [0.85], 0), ([0.3], [2.0], 0),
    ):  # fmt: skip
        made = ways((0, 0, 1.5), steps=tuple(step("A", "B", "C", duration=d) for d in steps))
        made.starts = np.array(starts)
        assert verify_motions(made, BOX).samples == 1025 + more


# -- rows -----------------------------------------------------------------------------------------------


def pair(scale=1.0, second=1.0, **changes):
    """Two fingers at rest for two steps, in the second of contacts that are farther off."""

    def transition(size):
        contacts = [
            rg.Contact([-size, 0], [1, 0], 0.5, name="A"),
            rg.Contact([size, 0], [-1, 0], 0.5, name="B"),
        ]
        state = rg.GraspState(rg.Grasp(contacts), rg.Wrench([0, 0]), [[2.0, 0], [-2.0, 0]])
        return rg.Transition(state, state, rg.TimeScaling.spline(1.0), Record(0.0))

    at = scale * np.array([[-1.1, 0], [1.1, 0]])
    given = {
        "times": np.r_[np.linspace(0, 1, 11), np.linspace(1, 2, 11)],
        "local": np.tile(np.linspace(0, 1, 11), 2), "steps": np.repeat([0, 1], 11),
        "positions": np.tile(at, (22, 1, 1)), "velocities": np.zeros((22, 2, 2)),
        "touching": np.ones((22, 2), dtype=bool), "forces": np.tile([[2.0, 0], [-2.0, 0]], (22, 1, 1)),
    }  # fmt: skip
    steps = transition(scale), transition(second * scale)
    return SimpleNamespace(steps=steps), SimpleNamespace(**given | changes)


def jumps(plan, rows, off) -> bool:
    rows.positions = rows.positions.copy()
    rows.positions[5, 0, 1] += off
    return any(
        "moves otherwise than its velocity" in words for words in verify_motion_rows(plan, rows).violations
    )


def test_places_are_one_to_a_part_of_the_largest_grasp() -> None:
    size = pair()[0].steps[0].grasp.size
    for scale, second in (1.0, 1.0), (64.0, 1.0), (1.0, 64.0), (2.0**-6, 1.0), (64.0, 2.0**-6):
        near = 1e-9 * size * scale * max(second, 1)
        assert not jumps(*pair(scale, second), 0.9999 * near)
        assert jumps(*pair(scale, second), 1.0001 * near)


def test_the_least_that_touch_and_how_long_ways_last() -> None:
    plan, rows = pair()
    assert verify_motion_rows(plan, rows).touching == 2
    rows.touching[15, 1] = False
    assert verify_motion_rows(plan, rows).touching == 1
    for scale in 1.0, 8.0:
        for part, good in (0.9e-12, True), (1.1e-12, False), (-0.9e-12, True), (-1.1e-12, False):
            plan, rows = pair()
            made = SimpleNamespace(
                duration=2 * scale, positions=lambda t: np.tile([[-1.1, 0], [1.1, 0]], (len(t), 1, 1))
            )
            rows.times = rows.times * scale
            rows.times[-1] += 2 * scale * part
            found = "; ".join(verify_motion_rows(plan, rows, made).violations)
            assert ("rows last" not in found) == good, (scale, part)


def test_the_radius_is_of_the_first_tip_that_touches() -> None:
    steps = pair()[0].steps
    for off, wanted in ((0.1, 0.05), 0.1), ((0.05, 0.1), 0.05):
        tips = [[[-1 - off[0], 0], [1 + off[1], 0]], [[-1.02, 0], [1.02, 0]]]
        rows = SimpleNamespace(positions=np.array(tips), touching=np.ones((2, 2), dtype=bool))
        assert _radius(steps, rows, 1e-9) == pytest.approx(wanted)


def said_of(name, at, value) -> str:
    plan, rows = pair()
    found = np.array(getattr(rows, name), dtype=int if name == "steps" else float)
    found[at] = value
    setattr(rows, name, found)
    return "; ".join(verify_motion_rows(plan, rows).violations)


def test_clocks_of_rows_go_through_the_plan() -> None:
    """Rows a tenth of a second apart: 0 to 10 of step 1, 11 to 21 of step 2, both a second long."""
    clock = "rows must go through every step from its start to its end, no faster than the plan"
    room = 2e-9
    for name, at, value, words in (
        ("times", 0, 1e-12, "times of rows must rise"), ("times", 0, -1.0, "times of rows must rise"),
        ("times", 5, 0.3999, "times of rows must rise"), ("times", 5, np.nan, "times of rows must rise"),
        ("times", 21, np.inf, "times of rows must rise"), ("times", 5, 0.4, clock), ("times", 21, 9.0, ""),
        ("steps", slice(11, 22), 0, "steps of rows must rise from 1 to 2"),
        ("steps", slice(0, 11), 1, "steps of rows must rise from 1 to 2"),
        ("steps", 21, 2, "steps of rows must rise from 1 to 2"), ("steps", 0, -1, "steps of rows must rise"),
        ("steps", 3, 1, "steps of rows must rise from 1 to 2"),
        ("local", 0, 0.9 * room, ""), ("local", 0, 1.1 * room, clock), ("local", 0, -1e-15, clock),
        ("local", 21, 1 + 1e-15, clock),
        ("local", 10, 1 - 0.9 * room, ""), ("local", 10, 1 - 1.1 * room, clock), ("local", 10, 1.1, clock),
        ("local", 21, 1 - 0.9 * room, ""), ("local", 21, 1 - 1.1 * room, clock), ("local", 11, -0.1, clock),
        ("local", 5, 0.5 + 1.1 * room, clock), ("local", 5, 0.5 - 1.1 * room, clock),
        ("local", 5, np.nan, clock),
        ("local", 5, 0.4, clock), ("local", 6, 0.5, clock), ("local", 11, 0.1, clock),
    ):  # fmt: skip
        found = said_of(name, at, value)
        assert found.startswith(words), (name, at, value, found)
        assert bool(found) == bool(words) or "must" not in found, (name, at, value, found)


def test_clocks_may_stand_and_go_slower() -> None:
    plan, rows = pair()
    rows.times = 3 * rows.times
    assert verify_motion_rows(plan, rows).ok
    rows.times[11:] += 5.0  # a pause between the steps
    assert verify_motion_rows(plan, rows).ok
    long = rg.TimeScaling.spline(2.0)
    for slow in (1, 0), (0, 1):  # one of the steps is twice as long
        steps = [
            rg.Transition(p.start, p.end, long, p.record) if s else p
            for p, s in zip(plan.steps, slow, strict=True)
        ]
        other, more = SimpleNamespace(steps=tuple(steps)), pair()[1]
        more.local[rows.steps == slow.index(1)] *= 2
        more.times = np.append(0, np.cumsum(np.where(np.diff(more.times) > 0, 0.2, 0)))
        assert verify_motion_rows(other, more).ok
    rows.local[14] = rows.local[13] - 1.9e-9
    assert "go through every step" not in str(verify_motion_rows(plan, rows))
    rows.local[14] = rows.local[13] - 2.1e-9
    assert "go through every step" in str(verify_motion_rows(plan, rows))


def test_rows_of_shapes_that_do_not_go_together() -> None:
    for name, value in (
        ("times", np.zeros(21)), ("steps", np.zeros(21, dtype=int)), ("local", np.zeros(21)),
        ("velocities", np.zeros((22, 3, 2))), ("touching", np.zeros((22, 3), dtype=bool)),
        ("forces", np.zeros((22, 3, 2))), ("forces", np.zeros((22, 2))), ("forces", np.zeros((21, 2, 2))),
        ("forces", 0.0),
    ):  # fmt: skip
        plan, rows = pair()
        setattr(rows, name, value)
        verdict = verify_motion_rows(plan, rows)
        assert verdict.violations == (f"{name} of rows do not go with positions of shape (22, 2, 2)",)
        assert (verdict.touching, verdict.rows) == (0, len(rows.times))
    for shape in (0, 2, 2), (22, 2), (22, 0, 2), (22, 2, 0):
        plan, rows = pair()
        rows.positions = rows.velocities = np.zeros(shape)
        rows.touching = np.zeros(shape[:2], dtype=bool)
        rows.forces = np.zeros((*shape[:2], 2))
        for name in "times", "steps", "local":
            setattr(rows, name, getattr(rows, name)[: shape[0]])
        assert "do not go with positions of shape" in str(verify_motion_rows(plan, rows))

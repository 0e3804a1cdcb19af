"""Ways and rows by hand: who touches when, how finely is sampled, distances on slanted sides and of faces."""

from math import cos, nan
from types import SimpleNamespace

import numpy as np
import pytest

import regrasp as rg
from regrasp.plans.record import Record
from regrasp.verification import verify_motion_rows, verify_motions
from regrasp.verification.ways.distances import points_of_axis, to_boundary, to_faces
from regrasp.verification.ways.held import jumps, lost, touched
from regrasp.verification.ways.rows import _during, _radius
from regrasp.verification.ways.verdict import _away, _depth, _late

pytestmark = pytest.mark.oracle

RADIUS, KEEP = 0.1, 0.2
SQUARE = SimpleNamespace(polygon=lambda slack: np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1]]))


def contact(name: str, place, normal) -> rg.Contact:
    return rg.Contact(place, normal, 0.5, name=name)


A, B = contact("A", [-1, 0], [1, 0]), contact("B", [1, 0], [-1, 0])
ON = np.array([[-1 - RADIUS, 0], [1 + RADIUS, 0]])  # tips that touch there


def step(*contacts: rg.Contact, duration: float = 1.0) -> SimpleNamespace:
    return SimpleNamespace(grasp=rg.Grasp(contacts), duration=duration)


def ways(path, rest=((-1.1, 0), (1.1, 0)), at=2, **changes) -> SimpleNamespace:
    """A finger ``at`` a place among the others, at rest at A and B; ``path(t)``: place, velocity."""

    def tips(t, k):
        t = np.asarray(t, dtype=float)
        still = [np.tile(r if k == 0 else [0.0, 0], (len(t), 1)) for r in rest]
        still.insert(at, np.stack(path(t)[k], axis=1))
        return np.stack(still, axis=1)

    on = np.ones(len(rest) + 1, dtype=bool)
    on[at] = False
    given = {
        "tip_radius": RADIUS, "clearance": KEEP, "capsules": np.zeros((len(rest) + 1, 2)),
        "steps": (step(A, B),),
        "starts": np.array([0.0]), "duration": 4.0, "positions": lambda t: tips(t, 0),
        "velocities": lambda t: tips(t, 1), "touching": lambda t: np.tile(on, (len(t), 1)),
    }  # fmt: skip
    return SimpleNamespace(**given | changes)


def passing(gap: float = 0.5, length: float = 0.4):
    """Along the upper side."""
    y = 1 + RADIUS + gap
    return lambda t: ((length * t / 4, 0 * t + y), (0 * t + length / 4, 0 * t))


def said(made) -> str:
    return "; ".join(verify_motions(made, SQUARE).violations)


@pytest.mark.parametrize("at", [0, 1, 2])
def test_whichever_finger_comes_nearest(at) -> None:
    for gap, good in (KEEP, True), (KEEP * 0.9985, False):
        verdict = verify_motions(ways(passing(gap), at=at), SQUARE)
        assert verdict.ok == good
        assert verdict.to_object == pytest.approx(gap)
    assert verify_motions(ways(passing(0.7), at=at), SQUARE).to_fingers == pytest.approx(
        np.hypot(1.1 - 0.4, 1.8) - 2 * RADIUS
    )


def test_where_a_finger_stops_it_is_looked_at() -> None:
    """It stands nearer for a second, and is there and back between two samples."""
    made = ways(lambda t: ((0 * t, 1 + RADIUS + np.where(abs(t - 2) < 0.5, 0.199, 0.21)), (0 * t, 0 * t)))
    assert verify_motions(made, SQUARE).to_object == pytest.approx(0.199)


def test_a_finger_has_to_be_there_from_the_first_instant_to_the_last() -> None:
    """Samples are 4 / 1024 s apart, one is where the step ends."""
    dt = 4.0 / 1024
    for start in (0.0, 1.0):
        for away, good in (
            (start - dt, start == 0),
            (start, False),
            (start + 1, False),
            (start + 1 + dt, True),
        ):
            made = ways(passing(), starts=np.array([start]))
            on = made.touching

            def touching(t, on=on, away=away):
                here = on(t).copy()
                here[abs(t - away) < dt / 4, 0] = False
                return here

            made.touching = touching
            found = said(made)
            assert ("during step 1 no finger is at A" not in found) == (good or away == start - dt), (
                start,
                away,
            )
            assert ("fewer than 2 fingers touch at" not in found) == (away < 0)


def test_ways_are_sampled_until_no_finger_moves_by_a_tenth_of_the_clearance() -> None:
    for length, samples in (0.4, 1025), (20.4, 1025), (20.5, 2049), (41.0, 4097):
        made = ways(passing(length=length))
        assert verify_motions(made, SQUARE).samples == samples, length


@pytest.mark.parametrize(
    ("name", "value"),
    [("tip_radius", nan), ("tip_radius", 0.0), ("clearance", -1.0), ("clearance", nan), ("duration", 0.0),
     ("duration", np.inf), ("capsules", [[0, 0, nan]] * 3), ("capsules", 3), ("capsules", np.zeros((2, 2))),
     ("capsules", np.zeros((4, 2)))],
)  # fmt: skip
def test_numbers_that_nothing_is_measured_by_are_refused(name, value) -> None:
    with pytest.raises(rg.InvalidInput, match=name.removesuffix("s")):
        verify_motions(ways(passing(), **{name: value}), SQUARE)


def test_what_is_no_motions_and_no_shape_is_refused() -> None:
    made = ways(passing())
    for name in ("positions", "velocities", "touching", "capsules"):
        few = SimpleNamespace(**{k: v for k, v in vars(made).items() if k != name})
        with pytest.raises(rg.InvalidInput, match="verify_motions needs motions"):
            verify_motions(few, SQUARE)
    with pytest.raises(rg.InvalidInput, match="needs an Outline or a Mesh"):
        verify_motions(made, 3)


def test_steps_follow_one_another() -> None:
    for ends, good in (
        ([(0.0, 1.0), (1.0, 2.0)], True), ([(0.0, 1.0), (1 - 1e-13, 2.0)], True),
        ([(0, 1.0), (0.9, 2.0)], False),
        ([(0.5, 1.5), (1.5, 4.0)], True), ([(0, 1.0), (3.0, 4 + 1e-11)], False), ([(-1e-11, 1.0)], False),
        ([(0, 0.0)], False), ([(1.0, 0.5)], False), ([(0, 4 + 1e-13)], True), ([(0, nan)], False),
    ):  # fmt: skip
        found = list(_late(ends, 4.0))
        assert (found == []) == good, ends
        assert good or found[0].startswith(f"step {len(ends)} lasts from {ends[-1][0]:.6g} to")
    after = list(_late([(0.0, 1.0), (0.5, 2.0)], 4.0))
    assert after == ["step 2 lasts from 0.5 to 2 s, not after 1 and until 4 s"]


def test_places_of_fingers_that_touch() -> None:
    at = np.array([[ON[0], ON[1]], [ON[0] + [0, 1e-6], ON[1]], [ON[1], ON[0]]])
    touching = np.array([[True, False], [True, True], [True, True]])
    on = touched((step(A, B),), at, touching, RADIUS, 1e-7)
    assert on["A"].tolist() == [[True, False], [False, False], [False, True]]
    assert on["B"].tolist() == [[False, False], [False, True], [True, False]]
    on = touched((step(A), step(B)), at, touching, RADIUS, 2e-6)
    assert on["A"][1].tolist() == [True, False]
    times = np.array([0.0, 1.0, 2.0])
    on = touched((step(A, B),), at, touching, RADIUS, 1e-7)
    stray = "finger 1 is said to touch off every contact at 1 s"
    found = list(lost(times, (step(A, B),), [[2]], touching, on, 2))
    assert found == [stray, "fewer than 2 fingers touch at 0 s"]
    assert "during step 1 no finger is at B" in list(lost(times, (step(A, B),), [[0]], touching, on, 1))
    assert "fewer" not in "".join(lost(times, (step(A, B),), [[2]], touching, on, 1))
    assert "fewer" not in "".join(lost(times, (step(A, B), step(A)), [[2], [2]], touching, on, 2))
    assert "during step 2 no finger is at B" in list(
        lost(times, (step(A), step(A, B)), [[2], [1, 0]], touching, on, 1)
    )


def test_jumps_are_seen_in_every_interval_and_of_every_finger() -> None:
    times = np.arange(5.0)
    for i in range(2):
        for k in range(4):
            at, v = np.zeros((5, 2, 2)), np.zeros((5, 2, 2))
            at[k + 1 :, i, 1] = 1e-3
            assert list(jumps(times, at, v, 1.1e-3)) == []
            words = f"finger {i + 1} moves otherwise than its velocity says at {k} s"
            assert list(jumps(times, at, v, 0.9e-3)) == [words]


def test_distances_beside_slanted_sides() -> None:
    ring = np.array([[0, 0], [4, 2], [1, 5]], dtype=float)
    a, b, c = ring
    rng = np.random.default_rng(0)
    for point in rng.uniform(-1, 6, (60, 2)):
        u, v = np.linalg.solve(np.stack([b - a, c - a], axis=1), point - a)
        inside = u > 0 and v > 0 and u + v < 1
        ends = [(p, q) for p, q in ((a, b), (b, c), (c, a))]
        s = np.linspace(0, 1, 2001)[:, None]
        away = min(np.linalg.norm(p + s * (q - p) - point, axis=1).min() for p, q in ends)
        assert to_boundary(point[None], ring)[0] == pytest.approx(-away if inside else away, abs=2e-3)


def test_faces_that_are_far_but_for_a_corner() -> None:
    """The corner is opposite to where the face is from the origin, and another face is near."""
    face = np.array([[-1.0, 0, 0], [0.65, 0.3, 0], [0.65, -0.3, 0]])
    other = np.array([[-1.0, 0, 0.1], [-1.2, 0, 0.1], [-1.0, 0.2, 0.1]])
    point = np.array([[-1.01, 0, 0]])
    for faces in ([face, other], [other, face]):
        assert to_faces(point, np.array(faces))[0] == pytest.approx(0.01)
    above = np.array([[0.3, 0, 0.5], [0.3, 0, -0.5], [0.3, 5.0, 0]])
    assert to_faces(above, face[None])[:2] == pytest.approx([0.5, 0.5])
    n = np.array([0.3, 1.65, 0.0]) / np.hypot(0.3, 1.65)  # of the side from the first corner to the second
    outside = np.array([-0.175, 0.15, 0]) + 2 * n * [-1, 1, 1]
    assert to_faces(outside[None], face[None])[0] == pytest.approx(2.0)
    assert to_faces(above, np.array([face[::-1]]))[:2] == pytest.approx([0.5, 0.5])


def test_points_of_axes_are_as_near_as_asked() -> None:
    tips, capsule = np.zeros((1, 3)), np.array([0, 0, 1.0])
    for apart, count in (0.5, 3), (0.51, 3), (0.49, 4), (2.0, 2), (1.0, 2):
        assert points_of_axis(tips, capsule, apart).shape == (1, count, 3)


def test_how_deep_a_tip_may_be_and_how_far_axes_are() -> None:
    corners = np.array([[0, 0, 0], [4.0, 0, 0], [0, 4, 0]])
    mesh = SimpleNamespace(surface=lambda: (corners, np.array([[0, 1, 2]])), smooth=True, crease=0.5)
    assert _depth(mesh, 0.3, 0.01) == pytest.approx(0.3 * (1 - cos(0.25)) + 0.02)
    mesh.smooth = False
    assert _depth(mesh, 0.3, 0.01) == 0.02
    assert _depth(SQUARE, 0.3, 0.01) == 0.02
    axes = np.array([[[1, 1, 3.0], [1, 1, 2]], [[1, 1, 1.0], [1, 1, 5]]])
    assert _away(mesh, axes, 0.1).tolist() == [2, 1]
    assert _away(SQUARE, np.array([[[3.0, 0], [2, 0]], [[0, 0.5], [0, 4]]]), 0.1) == pytest.approx([1, -0.5])


# -- rows -----------------------------------------------------------------------------------------------


def test_the_radius_of_tips_is_off_the_nearest_contact_on_whose_normal_one_is() -> None:
    far = contact("C", [-3, 0], [1, 0])
    for tip, wanted in (
        ([-1.1, 0], 0.1), ([-1, 0], 0.0), ([-1 + 0.9e-6, 0], 0.0), ([-1 + 1.1e-6, 0], nan), ([-3.5, 0], 0.5),
        ([-1.1, 0.9e-6], 0.1), ([-1.1, 1.1e-6], nan), ([-1.1, -1.1e-6], nan), ([1.3, 0], 0.3), ([0, 0], nan),
    ):  # fmt: skip
        for names in ((A, B, far), (far, B, A)):
            made = SimpleNamespace(
                positions=np.array([[[0, 9.0], tip], [tip, [0, 8.0]]]),
                touching=np.array([[False, True], [False, True]]),
            )
            assert _radius([step(*names[:2]), step(names[2])], made, 1e-6) == pytest.approx(
                wanted, nan_ok=True
            )
    made.touching[:] = False
    assert np.isnan(_radius([step(A)], made, 1e-6))


def test_rows_of_a_step_are_from_its_last_start_to_its_first_end() -> None:
    rows = SimpleNamespace(
        steps=np.array([0, 0, 0, 0, 0, 1, 1, 1]), local=np.array([0, 0, 0.5, 1, 1, 0, 0.5, 1])
    )
    assert _during(rows, 0).tolist() == [1, 2, 3]
    assert _during(rows, 1).tolist() == [5, 6, 7]


def pair(**changes):
    """Two steps in which two fingers hold the square, one second each, and rows of both at 0.1 s."""
    state = rg.GraspState(rg.Grasp([A, B]), rg.Wrench([0, 0]), [[2.0, 0], [-2.0, 0]])
    one = rg.Transition(state, state, rg.TimeScaling.spline(1.0), Record(0.0))
    local = np.tile(np.linspace(0, 1, 11), 2)
    given = {
        "times": np.r_[np.linspace(0, 1, 11), np.linspace(1, 2, 11)], "local": local,
        "steps": np.repeat([0, 1], 11), "positions": np.tile(ON, (22, 1, 1)),
        "velocities": np.zeros((22, 2, 2)),
        "touching": np.ones((22, 2), dtype=bool), "forces": np.tile([[2.0, 0], [-2.0, 0]], (22, 1, 1)),
    }  # fmt: skip
    return SimpleNamespace(steps=(one, one)), SimpleNamespace(**given | changes)


def test_rows_of_two_steps() -> None:
    plan, rows = pair()
    verdict = verify_motion_rows(plan, rows)
    assert verdict.ok, str(verdict)
    assert (verdict.rows, verdict.touching) == (22, 2)
    assert verdict.tip_radius == pytest.approx(RADIUS)
    assert verdict.to_fingers == pytest.approx(2.2 - 2 * RADIUS)
    for k, words in (3, "step 1: set-point 3: "), (14, "step 2: set-point 3: "):
        plan, rows = pair()
        rows.forces[k] *= 1.001
        found = verify_motion_rows(plan, rows).violations
        assert found
        assert all(x.startswith(words) for x in found)
    for k, words in (0, "before or after step 1 forces"), (21, "before or after step 2 forces"):
        plan, rows = pair()
        doubled = {n: np.insert(getattr(rows, n), k, getattr(rows, n)[k], axis=0) for n in vars(rows)}
        assert verify_motion_rows(plan, SimpleNamespace(**doubled)).ok
        doubled["forces"][k + (k == 0)] *= 1 + 1e-15
        assert verify_motion_rows(plan, SimpleNamespace(**doubled)).violations[0].startswith(words)
    plan, rows = pair()
    rows.touching[15, 1] = False
    rows.forces[15, 1] = 0
    found = verify_motion_rows(plan, rows).violations
    assert "during step 2 no finger is at B" in found
    assert "during step 1 no finger is at B" not in found
    assert "fewer than 2 fingers touch at 1.4 s" in found

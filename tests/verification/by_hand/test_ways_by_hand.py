"""Ways of discs about a square, made by hand: distances that can be read off, at their limits."""

from math import nan
from types import SimpleNamespace

import numpy as np
import pytest

import regrasp as rg
from regrasp.verification import verify_motion_rows, verify_motions
from regrasp.verification.ways.distances import points_of_axis, to_axis, to_boundary, to_faces
from regrasp.verification.ways.verdict import _SAME, _lifting

pytestmark = pytest.mark.oracle

RADIUS, CLEARANCE, LAST = 0.1, 0.2, 4.0
SQUARE = SimpleNamespace(
    polygon=lambda slack: np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1]]),
)
PLACES = {"A": ([-1, 0], [1, 0]), "B": ([1, 0], [-1, 0]), "C": ([0, -1], [0, 1]), "D": ([0, 1], [0, -1])}


def contact(name: str, dimension: int = 2) -> rg.Contact:
    place, normal = PLACES[name]
    rest = [0.0] * (dimension - 2)
    return rg.Contact([*place, *rest], [*normal, *rest], 0.5, name=name)


def step(*names: str) -> SimpleNamespace:
    return SimpleNamespace(grasp=rg.Grasp(map(contact, names)), duration=1.0)


def tip(name: str, off: float = 0.0) -> np.ndarray:
    """Where a tip is that touches a contact, or is off it along its normal."""
    place, normal = (np.array(x, dtype=float) for x in PLACES[name])
    return place - (RADIUS + off) * normal


class Ways(SimpleNamespace):
    """Fingers that go through points at even times, faster and slower between them; others rest.

    ``points``: (fingers, k, 2). ``free``: the fingers that touch only at both ends.
    """

    def __init__(self, points, free=(2,), **changes) -> None:
        given = {
            "tip_radius": RADIUS, "clearance": CLEARANCE, "capsules": np.zeros((len(points), 2)),
            "steps": (step("A", "B", "C"), step("A", "B", "D")), "starts": np.array([0.0, LAST - 1]),
            "duration": LAST,
        }  # fmt: skip
        super().__init__(points=[np.array(p, dtype=float) for p in points], free=free, **given | changes)

    def _at(self, t, derivative: bool) -> np.ndarray:
        s = np.clip((np.asarray(t) - 1) / (LAST - 2), 0, 1)  # at rest for a second at either end
        rate = np.where((t > 1) & (t < LAST - 1), 1 / (LAST - 2), 0.0)
        rows = []
        for points in self.points:
            legs = len(points) - 1
            if legs == 0:
                rows.append(np.zeros((len(s), 2)) + (0 if derivative else points[0]))
                continue
            k = np.minimum((s * legs).astype(int), legs - 1)
            u = s * legs - k
            smooth, slope = 3 * u**2 - 2 * u**3, 6 * u - 6 * u**2
            ahead = points[k + 1] - points[k]
            rows.append(
                (slope * legs * rate)[:, None] * ahead if derivative else points[k] + smooth[:, None] * ahead
            )
        return np.stack(rows, axis=1)

    def positions(self, t) -> np.ndarray:
        return self._at(t, False)

    def velocities(self, t) -> np.ndarray:
        return self._at(t, True)

    def touching(self, t) -> np.ndarray:
        on = np.ones((len(t), len(self.points)), dtype=bool)
        for i in self.free:
            on[:, i] = (t <= 1) | (t >= LAST - 1)
        return on


def said(ways, shape=SQUARE) -> str:
    return "; ".join(verify_motions(ways, shape).violations)


def right() -> Ways:
    """Finger 3 goes from C to D by the right, past B."""
    side, lift = 1.8, CLEARANCE + 0.05
    points = [tip("C"), tip("C", lift), [side, -1.6], [side, 1.6], tip("D", lift), tip("D")]
    return Ways([[tip("A")], [tip("B")], points])


def test_a_good_way_is_verified() -> None:
    verdict = verify_motions(right(), SQUARE)
    assert verdict.ok, str(verdict)
    assert verdict.touching == 2
    assert verdict.samples >= 1025
    assert verdict.to_object == pytest.approx(CLEARANCE + 0.05, abs=0.3)
    assert "2 or more touch at every instant" in str(verdict)


def passing(gap: float, **changes) -> Ways:
    """Finger 3 stays off every normal, ``gap`` from the right side and far from B, which is not there."""
    side = 1 + RADIUS + gap
    points = [[side + 0.5, -0.9], [side, -0.5], [side + 0.5, -0.2]]
    given = {"steps": (step("A", "C"),), "starts": np.array([0.0]), "free": ()} | changes
    ways = Ways([[tip("A")], [tip("C")], points], **given)
    ways.touching = lambda t: np.tile([True, True, False], (len(t), 1))
    return ways


def test_the_clearance_from_the_object_at_its_limit() -> None:
    for gap, good in (
        (0.2, True),
        (0.1999, True),
        (0.1997, False),
        (0.05, False),
    ):  # a thousandth is the polygon's
        found = said(passing(gap))
        assert (found == "") == good, gap
        assert good or f"a finger off its contacts comes within {gap:g}"[:45] in found
        assert verify_motions(passing(gap), SQUARE).to_object == pytest.approx(gap, abs=1e-6)
    found = said(passing(-0.05))
    assert "finger 3 is in the object by 0.05 at 2 s" in found


def test_capsules_reach_beyond_their_tips() -> None:
    """The way is far off, but the finger's other end reaches back to the side."""
    for length, good in (0.6, True), (0.6003, False), (1.0, False):
        ways = passing(0.8, capsules=np.array([[-0.1, 0], [0, -0.1], [-length, 0.0]]))
        assert (said(ways) == "") == good, length


def test_the_clearance_of_two_fingers_at_its_limit() -> None:
    """Finger 3 passes below the tip of C, between whose surfaces there is a gap."""
    for gap, good in (0.2, True), (0.1999, True), (0.1997, False), (-0.1, False):
        y = -1 - RADIUS - 2 * RADIUS - gap
        ways = passing(0.5)
        ways.points[2] = np.array([[-1.5, y], [0, y], [1.5, y]])
        found = said(ways)
        assert (found == "") == good, gap
        assert good or "two fingers come within" in found
        assert verify_motions(ways, SQUARE).to_fingers == pytest.approx(gap, abs=1e-6)
    ways = passing(0.5, capsules=np.array([[0.0, 0.0], [0.0, -1.0], [0.0, 0.0]]))
    ways.points[2] = np.array([[-1.5, -2.0], [0, -2.0], [1.5, -2.0]])
    assert "two fingers come within -0.2 of one another" in said(ways)  # C reaches down as far


def test_positions_are_what_velocities_say() -> None:
    for factor, good in (1.0, True), (1.5, False), (0.9, False), (1.1, False), (nan, False):
        ways = passing(0.5)
        true = ways.velocities
        ways.velocities = lambda t, v=true, f=factor: f * v(t)
        found = said(ways)
        assert ("moves otherwise than its velocity says" not in found) == good, factor
        assert good or found.startswith("finger ")


def test_fingers_that_touch_are_at_contacts_of_the_plan() -> None:
    for off, good in (0.0, True), (1.9e-7, True), (2.1e-7, False):  # a millionth of the clearance
        ways = passing(0.5)
        ways.points[0] = ways.points[0] + np.array([0.0, off])
        found = said(ways)
        assert (found == "") == good, off
        assert good or "finger 1 is said to touch off every contact at 0 s" in found
        assert good or "during step 1 no finger is at A" in found
    late = passing(0.5)
    late.touching = lambda t: np.stack([t > 0.5, t >= 0, t < 0], axis=1)
    found = said(late)
    assert "during step 1 no finger is at A" in found
    assert "fewer than 2 fingers touch at 0 s" in found  # of the contacts of the step
    assert verify_motions(late, SQUARE).touching == 1


def test_steps_lie_within_the_ways() -> None:
    for start, good in ((0.0, True), (3.0, True), (3.0 + 1e-11, False), (-1e-11, False), (nan, False)):
        found = said(passing(0.5, starts=np.array([start])))
        assert ("step 1 lasts from" not in found) == good, start


def test_distances_from_polygons_and_triangles_and_axes() -> None:
    rng = np.random.default_rng(0)
    ring = np.array([[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]], dtype=float)
    for points in (rng.uniform(-1, 5, (200, 2)), np.array([[0.5, 0.5], [2.0, 2.0], [0.5, 2.0], [1.0, 0.0]])):
        inside = ((points > 0) & (points < [4, 1])).all(axis=1) | ((points > 0) & (points < [1, 3])).all(
            axis=1
        )
        s = np.linspace(0, 1, 4001)[:, None]
        border = np.concatenate(
            [p + s * (q - p) for p, q in zip(ring, np.roll(ring, -1, axis=0), strict=True)]
        )
        away = np.array([np.linalg.norm(border - p, axis=1).min() for p in points])
        assert to_boundary(points, ring) == pytest.approx(np.where(inside, -away, away), abs=1e-3)
        assert to_boundary(points, ring[::-1]) == pytest.approx(np.where(inside, -away, away), abs=1e-3)
    faces = rng.normal(size=(3, 3, 3))
    weights = rng.dirichlet([0.5] * 3, 20_000)
    for point in rng.normal(size=(20, 3)) * 2:
        sampled = min(np.linalg.norm(weights @ face - point, axis=1).min() for face in faces)
        assert to_faces(point[None], faces)[0] == pytest.approx(sampled, abs=0.05)
        assert to_faces(point[None], faces)[0] <= sampled + 1e-12
    tips, capsule = np.array([[0.0, 0.0], [1.0, 1.0]]), np.array([2.0, 0.0])
    axis = points_of_axis(tips, capsule, 0.5)
    assert axis.shape == (2, 5, 2)
    assert np.linalg.norm(np.diff(axis, axis=1), axis=2).max() <= 0.5
    assert (axis[:, 0] == tips).all()
    assert (axis[:, -1] == tips + capsule).all()
    assert points_of_axis(tips, 0 * capsule, 0.5).shape == (2, 1, 2)
    points = np.array([[[1.0, 1.0], [-1.0, 0.0], [4.0, 0.0]]] * 2)
    assert to_axis(points, np.zeros((2, 2)), capsule)[0] == pytest.approx([1.0, 1.0, 2.0])
    assert to_axis(points, np.zeros((2, 2)), 0 * capsule)[0] == pytest.approx([np.sqrt(2), 1.0, 4.0])


# -- rows -----------------------------------------------------------------------------------------------


def rows(**changes) -> SimpleNamespace:
    """Two fingers that hold a square between A and B for a second, and a third one that moves below it."""
    t = np.linspace(0, 1, 11)
    x = np.stack(
        [np.tile(tip("A"), (11, 1)), np.tile(tip("B"), (11, 1)), np.stack([t, 0 * t - 2], axis=1)], axis=1
    )
    v = np.zeros_like(x)
    v[:, 2, 0] = 1.0
    forces = np.zeros_like(x)
    forces[:, 0, 0], forces[:, 1, 0] = 2.0, -2.0
    given = {
        "times": t, "steps": np.zeros(11, dtype=int), "local": t.copy(), "positions": x, "velocities": v,
        "touching": np.tile([True, True, False], (11, 1)), "forces": forces,
    }  # fmt: skip
    return SimpleNamespace(**given | changes)


def held() -> rg.Transition:
    grasp = rg.Grasp([contact("A"), contact("B")])
    state = rg.GraspState(grasp, rg.Wrench([0, 0]), [[2.0, 0], [-2.0, 0]])
    from regrasp.plans.record import Record

    return rg.Transition(state, state, rg.TimeScaling.spline(1.0), Record(0.0))


def told(ways=None, **changes) -> str:
    return "; ".join(verify_motion_rows(held(), rows(**changes), ways).violations)


def changed(name: str, at, add) -> dict:
    values = getattr(rows(), name).copy()
    values[at] = values[at] ^ add if values.dtype == bool else values[at] + add
    return {name: values}


def test_rows_that_are_right() -> None:
    verdict = verify_motion_rows(held(), rows())
    assert verdict.ok, str(verdict)
    assert verdict.tip_radius == pytest.approx(RADIUS)
    assert verdict.touching == 2
    assert str(verdict).startswith("11 set-points of positions and forces verified")
    apart = min(float(np.linalg.norm([x + 1.1, 2.0])) for x in np.linspace(0, 1, 11))
    assert verdict.to_fingers == pytest.approx(min(apart, np.hypot(0.1, 2)) - 2 * RADIUS)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (changed("positions", (5, 0, 1), 1e-6), "finger 1 is said to touch off every contact at 0.5 s"),
        (changed("positions", (5, 1, 0), 1e-6), "finger 2 is said to touch off every contact at 0.5 s"),
        (changed("positions", (5, 2, 0), 0.3), "finger 3 moves otherwise than its velocity says at 0.4 s"),
        (
            changed("velocities", (slice(None), 2, 0), 0.01),
            "finger 3 moves otherwise than its velocity says at 0 s",
        ),
        (changed("velocities", (slice(None), 2, 1), nan), "finger 3 moves otherwise"),
        (changed("touching", (5, 0), True), "during step 1 no finger is at A"),
        (changed("touching", (5, 0), True), "fewer than 2 fingers touch at 0.5 s"),
        (changed("touching", (3, 2), True), "finger 3 is said to touch off every contact at 0.3 s"),
        (changed("forces", (7, 2, 0), 1e-300), "finger 3 has a force in the air at 0.7 s"),
        (changed("forces", (7, 0, 0), 1e-6), "step 1: set-point 7: not in equilibrium"),
        (
            changed("forces", (7, slice(2), 0), np.array([1e-6, -1e-6])),
            "step 1: set-point 7: force of A is not the plan's",
        ),
    ],
)
def test_rows_that_are_not(changes, words) -> None:
    assert words in told(**changes)


def test_tips_are_not_in_one_another() -> None:
    for gap, good in (0.0, True), (-0.9e-9, True), (-3e-9, False), (-0.05, False):
        near = rows()
        near.positions[:, 2] = tip("A") - [2 * RADIUS + gap, 0]
        near.velocities[:, 2] = 0
        verdict = verify_motion_rows(held(), near)
        assert verdict.ok == good, gap
        assert good or "two tips are in one another by" in str(verdict)


def test_forces_stand_while_the_clock_does() -> None:
    kept = rows()
    local = np.r_[0, 0, 0, np.linspace(0, 1, 8)]
    local[3:] = np.linspace(0.1, 1, 8)
    kept.local, kept.times, kept.velocities = local, 2 * kept.times, kept.velocities / 2
    assert verify_motion_rows(held(), kept).ok
    kept.forces[1, :2, 0] *= 1 + 1e-12
    words = "before or after step 1 forces change while the plan's clock stands"
    assert words in str(verify_motion_rows(held(), kept))


def test_rows_are_on_their_ways() -> None:
    for off, good in (0.0, True), (0.9e-9, True), (3e-9, False), (nan, False):

        def positions(t, by=off):
            x = rows().positions[np.searchsorted(rows().times, np.asarray(t) - 1e-9)].copy()
            x[4, 2, 1] += by
            return x

        ways = SimpleNamespace(duration=1.0, positions=positions)
        found = told(ways)
        assert (found == "") == good, off
        assert good or "finger 3 is" in found or "off its way" in found
        assert not off > 1e-9 or f"finger 3 is {off:.3g} off its way at 0.4 s" in found
    for last, good in (1.0, True), (1 + 0.9e-12, True), (1 + 2e-12, False), (2.0, False):
        ways = SimpleNamespace(duration=last, positions=lambda t: rows().positions)
        assert ("rows last 1 s, the ways" not in told(ways)) == good, last


def test_beside_a_change_of_speed_positions_may_be_between_both() -> None:
    """Finger 3 stops between rows 4 and 5: there, and in the intervals beside, 1 m/s times 0.1 s are open."""
    for interval, room in (2, 0.0), (3, 0.1), (4, 0.1), (5, 0.1), (6, 0.0):
        for part, good in (room - 1e-8 if room else 0.0, True), (room + 1e-8, False):
            made = rows()
            made.velocities[5:, 2, 0] = 0
            made.positions[5:, 2, 0] = made.positions[4, 2, 0] + 0.05
            made.positions[interval + 1 :, 2, 1] += part
            found = "; ".join(verify_motion_rows(held(), made).violations)
            assert ("finger 3 moves otherwise" not in found) == good, (interval, part)


def test_lifts_are_on_normals_and_not_too_high() -> None:
    high, near = 4 * (RADIUS + 2 * CLEARANCE), _SAME * CLEARANCE
    for name in "ABCD":
        aside = np.array(PLACES[name][1])[::-1]
        for h, off, good in (
            (0.0, 0.0, True), (-0.9 * near, 0.0, True), (-1.1 * near, 0.0, False), (high - 1e-9, 0.0, True),
            (high + 1e-9, 0.0, False), (1.0, 0.9 * near, True), (1.0, 1.1 * near, False),
        ):  # fmt: skip
            assert _lifting(right(), (tip(name, h) + off * aside)[None]).tolist() == [good], (name, h, off)

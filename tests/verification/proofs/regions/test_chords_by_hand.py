"""Chords beside curves made by hand, mostly straight pieces of a square, and cells: their limits."""

from math import atan, cos, sin, tan

import numpy as np
import pytest

from proofs import bent
from regrasp.verification.exact import RESOLUTION
from regrasp.verification.placed.curved_regions import beside, chords, covered
from regrasp.verification.placed.curves.pieces import Cubics, StraightSides

pytestmark = pytest.mark.oracle

SLACK = float(RESOLUTION)


SQUARE = bent([[-2, -1], [2, -1], [2, 1], [-2, 1]])
"""Around from the lower left, 12 long."""
FLOOR = bent([[2, 0], [4, 0], [4, 4], [0, 4], [0, 0]])
"""The lower side is two pieces, from 4 to 6: x = 2 (u - 4)."""
PIECES = Cubics(FLOOR), StraightSides(FLOOR[:, 0])


def stands(lo, hi, x0, x1, *, height=0.0, inner=0.5, friction=0.5 + 1e-12, tilt=0.0) -> bool:
    """Chords below the lower side, from x0 to x1; both kinds of pieces agree."""
    ends, normal = np.array([[x0, -height], [x1, -height]]), np.array([-sin(tilt), cos(tilt)])
    span = np.array([4 + lo / 2, 4 + hi / 2])
    cubic, straight = (beside(pieces, span, ends, normal, inner, friction) for pieces in PIECES)
    assert cubic == straight
    return cubic


@pytest.mark.parametrize(("lo", "hi"), [(0.25, 1.5), (1.0, 3.0), (2.0, 3.5), (0.0, 4.0)])
@pytest.mark.parametrize("height", [0.0, 0.5, -0.5])
@pytest.mark.parametrize("inner", [0.0, 0.5, 2.0])
@pytest.mark.parametrize("tilt", [0.0, 0.2, -0.2])
def test_chords_reach_beyond_arcs_by_what_forces_may_lean(lo, hi, height, inner, tilt) -> None:
    lean = abs(height) * tan(abs(tilt) + atan(inner))
    friction = tan(abs(tilt) + atan(inner)) + 1e-12
    given = {"height": height, "inner": inner, "friction": friction, "tilt": tilt}
    assert stands(lo, hi, lo - lean - 1e-9, hi + lean + 1e-9, **given)
    assert not stands(lo, hi, lo - lean + 1e-6, hi + lean + 1e-9, **given)
    assert not stands(lo, hi, lo - lean - 1e-9, hi + lean - 1e-6, **given)
    assert not stands(lo, hi, hi + lean + 1, lo - lean - 1, **given)  # its normal points the other way
    assert stands(lo, hi, lo - lean - 1, hi + lean + 1, **given | {"friction": friction + 1e-9})
    assert not stands(lo, hi, lo - lean - 1, hi + lean + 1, **given | {"friction": friction - 1e-9})


def test_leaning_is_less_than_a_right_angle() -> None:
    for inner, good in (14.0, True), (14.2, False):  # 1.5 rad are 14.1
        assert stands(1, 2, 0.9, 2.1, inner=inner, friction=inner + 1) == good


def test_a_place_alone_is_its_own_chord() -> None:
    for off, good in (0.0, True), (0.5 * SLACK, True), (8 * SLACK, False), (-8 * SLACK, False):
        assert stands(1, 1, 1 + off, 1 + off) == good
        assert stands(1, 1, 1, 1, height=off) == good
    assert stands(2, 2, 2, 2)  # where one piece ends
    assert not stands(2, 2, 2.5, 2.5)
    assert not stands(1, 1 + 1e-9, 1, 1)
    assert not stands(1 - 1e-9, 1, 1, 1)
    assert stands(1, 1, 1 - 1e-6, 1 + 1e-6)


CURVE = np.array([[[3, -1], [4, 0.5], [3.5, 2], [2, 3]], [[2, 3], [0, 4], [-2, 2], [-2, 0]],
                  [[-2, 0], [-2, -3], [1, -3], [3, -1]]], dtype=float)  # fmt: skip


def test_places_of_a_curve_are_those_of_its_cubics() -> None:
    for u in np.linspace(0, 5.9, 60):
        t, c = u % 1, CURVE[int(u) % 3]
        weights = [(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t * t * (1 - t), t**3]
        assert Cubics(CURVE).point(float(u)) == pytest.approx(weights @ c, abs=1e-12)


@pytest.mark.parametrize("friction", [0.6, 1.5])
def test_chords_beside_a_curve_are_those_that_samples_allow(friction) -> None:
    """Every force of a place leans into the chord; short arcs that do so by a margin are accepted."""
    rng, seen = np.random.default_rng(0), {True: 0, False: 0}
    for _ in range(150):
        lo = float(rng.uniform(0, 3))
        hi = lo + float(rng.choice([0.02, 0.1]))
        points = np.array([Cubics(CURVE).point(u) for u in np.linspace(lo, hi, 21)])
        tangents = np.diff(points, axis=0)
        tangents /= np.hypot(*tangents.T)[:, None]
        t = points[-1] - points[0]
        length = np.hypot(*t)
        t /= length
        angle = float(rng.normal(0, 0.05))
        normal = np.array([-t[1] * cos(angle) - t[0] * sin(angle), t[0] * cos(angle) - t[1] * sin(angle)])
        inner = friction * float(rng.uniform(0.3, 1.0))
        off = float(rng.uniform(-0.2, 0.2)) * length
        more = float(rng.uniform(0, 0.5)) * length
        shift = off * np.array([-t[1], t[0]])
        ends = np.array([points[0] - more * t + shift, points[-1] + more * t + shift])
        found = beside(Cubics(CURVE), np.array([lo, hi]), ends, normal, inner, friction)
        inward = np.stack([-tangents[:, 1], tangents[:, 0]], axis=1)
        apart = np.arccos(np.clip(inward @ normal, -1, 1)).max()
        gamma = abs(angle) + atan(inner)
        along, away = (points - ends[0]) @ t, np.abs((points - ends[0]) @ [-t[1], t[0]]).max()
        need = away * tan(gamma)
        room = min(
            atan(friction) - apart - atan(inner),
            along.min() / length - need / length,
            (np.hypot(*(ends[1] - ends[0])) - along.max() - need) / length,
        )
        seen[found] += 1
        assert not found or room > -0.02
        assert found or room < 0.1
    assert min(seen.values()) > 20


def test_chords_are_as_long_as_their_span() -> None:
    for lo, hi, long in (0.25, 0.5, 1), (0.5, 1.5, 3), (0, 2, 6), (3, 3, 0), (-1, 1, 6):
        assert chords(Cubics(SQUARE), np.array([lo, hi], dtype=float)) == pytest.approx(long, rel=1e-12)
    round_trip = chords(Cubics(CURVE), np.array([0.0, 3.0]))
    fine = np.array([Cubics(CURVE).point(u) for u in np.linspace(0, 3, 3001)])
    longer = np.hypot(*np.diff(fine, axis=0).T).sum()
    assert 0.999 * longer < round_trip < longer


@pytest.mark.parametrize(
    ("cells", "covers"),
    [
        ([[0, 4, 0, 3]], True),
        ([[0, 4, 0, 2.9]], False),
        ([[0, 3.9, 0, 3]], False),
        ([[0.1, 4, 0, 3]], False),
        ([[0, 4, 0.1, 3]], False),
        ([[-1, 5, -1, 5]], True),
        ([[0, 1, 0, 3], [1, 4, 0, 3]], True),
        ([[1, 4, 0, 3], [0, 1, 0, 3]], True),
        ([[0, 1, 0, 3], [1.1, 4, 0, 3]], False),
        ([[0, 1, 0, 3], [1, 3.9, 0, 3]], False),
        ([[0, 1, 0, 2.9], [1, 4, 0, 3]], False),
        ([[0, 4, 0, 1], [0, 4, 1, 3]], True),
        ([[0, 4, 0, 1], [0, 4, 1, 2], [0, 4, 2, 3]], True),
        ([[0, 4, 0, 1], [0, 4, 2, 3]], False),
        ([[0, 1, 0, 3], [1, 4, 0, 1], [1, 2, 1, 3], [2, 4, 1, 3]], True),
        ([[0, 1, 0, 3], [1, 4, 0, 1], [1, 2, 1, 3], [2, 4, 1.1, 3]], False),
        ([[0, 1, 0, 3], [1, 4, 0, 1], [2, 4, 1, 3]], False),
        ([[1, 4, 0, 3], [4, 5, 0, 3]], False),
        ([[0, 4, 0, 1], [0, 4, 1, 3], [4, 6, 0, 1]], True),
        ([[0, 4, 0, 1], [0, 4, 1, 3], [-2, 0, 0, 1]], True),
        ([[0, 4, 0, 3], [9, 9, 9, 9]], True),
        ([[0, 2, 0, 3], [2, 4, 0, 3], [4, 6, 0, 1]], True),
        ([[-1, 0, 0, 3], [0, 2, 0, 3], [2, 4, 0, 3]], True),
        ([[2, 0, 0, 3], [0, 2, 0, 3]], False),
        (np.zeros((0, 4)), False),
    ],
)
def test_which_cells_cover_a_box(cells, covers) -> None:
    """A box of 4 by 3, in either order of its two fingers."""
    cells, box = np.reshape(cells, (-1, 2, 2)).astype(float), np.array([[0.0, 4], [0, 3]])
    for order in [0, 1], [1, 0]:
        assert covered(cells[:, order], box[order]) == covers
    assert (box == [[0, 4], [0, 3]]).all()


def test_rounding_is_left_room_for() -> None:
    """2^-46 of angles, times the longest way over the shortest, and of the reach, 4, at both ends."""
    for factor, good in (1.02, True), (0.98, False):
        room = factor * 2.0**-46
        turn = atan(0.5) + room
        assert stands(1, 1.5, 0, 3, friction=tan(turn)) == good
        bit = 4 * room * 1.5
        assert stands(1, 1.5, 1 - bit, 3) == stands(1, 1.5, 0, 1.5 + bit) == good
        far = FLOOR - 10
        ends = np.array([[-9 - factor * 10 * 1.5 * 2.0**-46, -10.0], [-6, -10]])
        assert beside(Cubics(far), np.array([4.5, 4.75]), ends, np.array([0.0, 1]), 0.5, 0.6) == good
    uneven = np.array([[[0.0, 0], [1, 0], [4, 0], [9, 0]]])  # ways of 1, 3 and 5
    for factor, good in (5.1, True), (4.9, False):
        friction = tan(atan(0.5) + factor * 2.0**-46)
        ends = np.array([[-1.0, 0], [10, 0]])
        assert beside(Cubics(uneven), np.array([0.0, 1]), ends, np.array([0.0, 1]), 0.5, friction) == good


def test_the_farthest_place_of_a_curve_counts() -> None:
    """A piece that rises by 0.2: forces at its upper end meet the chord a tenth before its foot."""
    up, whole = np.array([[[0.0, 0], [1, 0], [2, 0.2], [3, 0.2]]]), np.array([0.0, 1])
    for sign in 1, -1:
        for by, good in (1e-9, True), (-1e-9, False):
            for ends in ([-0.1 - by, 4], [-1, 3.1 + by]):
                chord = np.array([[ends[0], 0], [ends[1], 0]])
                found = beside(Cubics(sign * up), whole, sign * chord, np.array([0.0, sign]), 0.5, 1.0)
                assert found == good


def test_pieces_end_where_the_next_begins() -> None:
    """The steepest place, 0.4, is where a piece that bends up ends and one that bends down begins."""
    steps = np.array([[[0, 0], [1, 0], [2, 0.2], [3, 0.6]], [[3, 0.6], [4, 1], [5, 1.2], [6, 1.2]]])
    chord = np.array([[-4.0, 0], [10, 0]])
    for off, good in (1e-9, True), (-1e-9, False):
        friction = tan(atan(0.5) + atan(0.4) + off)
        assert beside(Cubics(steps), np.array([0.0, 2]), chord, np.array([0.0, 1]), 0.5, friction) == good


def test_sides_that_meet_are_each_within_the_cones() -> None:
    """A floor that rises by 0.1 at (3, 0): the chord is level, and its cones are those of both sides."""
    rising = StraightSides(np.array([[0.0, 0], [3, 0], [6, 0.3], [6, 4], [0, 4]]))
    normal = np.array([0.0, 1])
    for lo, hi, off, more in (0.5, 1.5, 0.15, atan(0.1)), (0.25, 1.0, 0.0, 0.0), (1.0, 1.5, 0.15, atan(0.1)):
        x0, x1 = 3 * lo, 3 * hi
        for by, good in (1e-9, True), (-1e-9, False):
            span, friction = np.array([lo, hi]), tan(atan(0.5) + more + by)
            ends = np.array([[x0 - 1, 0], [x1 + 1, 0]])
            assert beside(rising, span, ends, normal, 0.5, friction) == good
            for short in (0, 1):
                ends = np.array([[x0 - 1, 0], [x1 + 1, 0]])
                ends[short, 0] = (x0, x1)[short] + (2 * short - 1) * (0.5 * off + by)
                assert beside(rising, span, ends, normal, 0.5, 0.7) == good
    assert rising.point(1.5).tolist() == [4.5, 0.15]
    assert rising.point(5 + 1.5) == pytest.approx([4.5, 0.15])


def test_a_corner_turns_by_more_than_five_degrees() -> None:
    for degrees, back, ahead in (4.9, 2.0, 8.0), (5.1, 2.0, 2.0), (-4.9, 2.0, 8.0), (-5.1, 2.0, 2.0):
        far = [[4.0, 0], [4 + 6 * cos(np.radians(degrees)), 6 * sin(np.radians(degrees))]]
        sides = StraightSides(np.array([[0.0, 0], *far, [far[1][0], 9], [0, 9]]))
        assert sides.to_corners(2.0) == pytest.approx((back, ahead))
        assert sides.to_corners(1.0) == pytest.approx((back - 1, ahead + 1))
    assert Cubics(FLOOR).to_corners(2.0) == (np.inf, np.inf)


def test_cells_may_be_many() -> None:
    lo = np.arange(1200.0)
    cells = np.stack([np.stack([lo, lo + 1], axis=1), np.tile([0.0, 3.0], (1200, 1))], axis=1)
    assert covered(cells, np.array([[0.0, 1200], [0, 3]]))
    assert not covered(cells, np.array([[0.0, 1200.5], [0, 3]]))
    assert not covered(np.delete(cells, 700, axis=0), np.array([[0.0, 1200], [0, 3]]))

"""Ways are judged from the mathematics again, and what is wrong with them is named."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import regrasp as rg
from finger_moves import moved
from motion_checks import star, to_faces
from regrasp.motions import Motions, plan_motions
from regrasp.motions.rounded import RoundedWay
from regrasp.verification import verify_motions
from regrasp.verification.ways.distances import to_boundary
from regrasp.verification.ways.distances import to_faces as checked_faces

pytestmark = pytest.mark.contract

BOX = rg.Mesh.box(0.08, 0.05, 0.03)
AIR = {"tip_radius": 0.003, "clearance": 0.002}


@cache
def planar() -> Motions:
    shape = star()
    places = (0.04, 0.36, 0.73, 0.22, 0.57, 0.93)
    contacts = [shape.contact_at(s * shape.length, friction=0.8, name=f"C{k}") for k, s in enumerate(places)]
    return plan_motions(moved(contacts), shape, **AIR)


@cache
def spatial() -> Motions:
    places = ([0.03, 0, 0.015], [0, 0.025, 0.01], [0, -0.025, 0.01], [-0.04, 0, 0.01], [0.02, 0.01, 0.015])
    contacts = [BOX.contact_at(p, friction=0.8, name=f"C{k}") for k, p in enumerate(places)]
    one = moved([*contacts[:4], contacts[4], *contacts[1:4]]).steps[:2]  # one of four moves
    return plan_motions(rg.RegraspPlan(one, (0.0,) * 3, 0.0), BOX, **AIR, capsules=[0, 0, 0.03])


def test_planned_ways_are_verified() -> None:
    for motions, shape, fingers in ((planar(), star(), 2), (spatial(), BOX, 3)):
        verdict = verify_motions(motions, shape)
        assert verdict.ok, str(verdict)
        assert verdict.to_object >= 0.002 * 0.999
        assert verdict.to_fingers >= 0.002 * 0.999
        assert verdict.touching == fingers
        assert str(verdict).startswith(f"ways verified at {verdict.samples} instants: fingers keep 0.002")


def test_a_straight_way_through_the_object_is_seen() -> None:
    motions = planar()
    m = motions.motions[0]
    straight = RoundedWay(m.way.points[[0, -1]], np.zeros(0))
    wrong = replace(motions, motions=(replace(m, way=straight), *motions.motions[1:]))
    said = str(verify_motions(wrong, star()))
    assert "ways not verified:" in said
    assert f"finger {m.finger + 1} is in the object by 0.0" in said


def test_less_clearance_than_asked_for_is_seen_on_both_sides() -> None:
    motions = planar()
    assert verify_motions(replace(motions, clearance=motions.clearance * 1.0005), star()).ok
    said = str(verify_motions(replace(motions, clearance=0.003), star()))
    assert "a finger off its contacts comes within 0.002" in said
    assert "less than 0.003" in said


def test_fingers_that_meet_jump_or_let_go_are_seen() -> None:
    motions = planar()
    fat = replace(spatial(), capsules=np.array([[-0.08, 0, 0], *[[0, 0, 0.03]] * 3]))
    assert "two fingers come within" in str(verify_motions(fat, BOX))
    late = replace(motions, contacts=~motions.contacts)
    said = str(verify_motions(late, star()))
    assert "during step 1 no finger is at C0" in said
    assert "fewer than 2 fingers touch" in said

    class Slow(Motions):
        def velocities(self, t):  # type: ignore[no-untyped-def, override]
            return super().velocities(t) / 2

    slow = Slow(**{name: getattr(motions, name) for name in motions.__dataclass_fields__})
    assert "moves otherwise than its velocity says" in str(verify_motions(slow, star()))


@pytest.mark.parametrize("number", [np.nan, np.inf, -0.003, 0.0, "3 mm"])
def test_ways_of_others_have_sizes_that_are_numbers(number: object) -> None:
    """Distances less a radius that is none are never less than the clearance."""
    for name in ("tip_radius", "clearance"):
        with pytest.raises(rg.InvalidInput, match=f"^{name} of motions must be"):
            verify_motions(replace(planar(), **{name: number}), star())
    capsules = [[0.0, 0.0], [number, 0.0]]
    if number not in (0.0, -0.003):
        with pytest.raises(rg.InvalidInput, match=r"^capsule 2 of motions must be"):
            verify_motions(replace(planar(), capsules=capsules), star())


class Begins(Motions):
    """Ways whose first steps begin otherwise than said."""

    begins: tuple[float, ...] = ()

    @property
    def starts(self):  # type: ignore[no-untyped-def, override]
        theirs = super().starts
        return np.r_[self.begins, theirs[len(self.begins) :]]


def test_steps_follow_one_another_within_the_ways() -> None:
    motions = planar()
    fields = {name: getattr(motions, name) for name in motions.__dataclass_fields__}
    first, second, *_, end = motions.starts
    over = first + motions.steps[0].duration
    for begins, found in (
        ((first, second), False),
        ((-1e-11 * end, second), True),
        ((first, over - 1e-11 * end), True),
        ((first, over - 1e-13 * end), False),
        ((first, over), False),
        ((np.nan, second), True),
        ((end + 1, end + 3), True),
    ):
        wrong = Begins(**fields)
        object.__setattr__(wrong, "begins", begins)
        said = str(verify_motions(wrong, star()))
        assert ("s, not after" in said) == found


def test_a_jump_is_refused() -> None:
    motions = planar()
    with pytest.raises(rg.InvalidInput, match="ways move or jump by more than a tenth of the clearance"):
        verify_motions(replace(motions, motions=motions.motions[1:]), star())


def test_distances_are_those_of_other_formulas() -> None:
    rng = np.random.default_rng(0)
    points, faces = rng.normal(size=(200, 3)), rng.normal(size=(20, 3, 3))
    assert checked_faces(points, faces) == pytest.approx(to_faces(points, faces))
    square = np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1]])
    x = rng.uniform(-2, 2, (500, 2))
    beyond = np.linalg.norm(np.maximum(abs(x) - 1, 0), axis=1)
    assert to_boundary(x, square) == pytest.approx(np.where(beyond > 0, beyond, abs(x).max(axis=1) - 1))


def test_what_is_no_motions_is_refused() -> None:
    with pytest.raises(rg.InvalidInput, match="verify_motions needs motions, got 3"):
        verify_motions(3, BOX)  # type: ignore[arg-type]
    with pytest.raises(rg.InvalidInput, match="verify_motions needs an Outline or a Mesh, got 'box'"):
        verify_motions(planar(), "box")

"""What choices claim, each claim by itself and on both sides of its limit: values, bounds, loads, levers."""

from fractions import Fraction
from math import atan, hypot, inf, nan, nextafter, sin, sqrt
from types import SimpleNamespace

import numpy as np
import pytest

import regrasp as rg
from proofs import planar, solid
from regrasp.verification.placed import chosen_grasps as claims
from regrasp.verification.placed.claims import contacts, levels
from regrasp.verification.placed.meshes.areas import part_of_surface

pytestmark = pytest.mark.contract

JUST, MORE = 0.9e-9, 1.1e-9  # what counts as the same is a billionth
RESOLUTION = 2.0**-40
NODE = ([(0, 0, 0, 1)], (0, 0), 0, (0, 0, 1))
BOARD = planar([[-3, -4], [3, -4], [3, 4], [-3, 4]], [[0, -1, 0]], [NODE])
PLAIN = {"sum_normal": 1, "peak_normal": 1, "peak": 1, "effort": 2}
LARGEST = ("angle", "force", "answered", "wrench", "wrench_ball")


def plain(**given):
    return SimpleNamespace(**given)


def proven(bound, margin=0.0, **given):
    return plain(bound=bound, margin=margin, **given)


def chosen(objective, value=1.0, bound=1.0, **changes):
    grasp = rg.Grasp([rg.Contact([-1, 0], [1, 0], 0.5), rg.Contact([1, 0], [-1, 0], 0.5)])
    given = {
        "objective": objective, "value": value, "bound": bound, "grasp": grasp, "states": (), "others": (),
        "max_force": None, "min_normal": 0.0, "length": None, "deviations": None,
        "certificate": plain(loads=np.zeros((1, 3))),
    }  # fmt: skip
    return plain(**given | changes)


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_values_of_forces(scale) -> None:
    """Forces of (3, 4) and 5 along normals of (1, 0) and (0, 1)."""
    forces = scale * np.array([[3.0, 4.0], [0.0, 5.0 / 2]])
    state = plain(forces=forces, grasp=plain(normals=np.array([[1.0, 0], [0, 1.0]])))
    worth = {"sum_normal": 5.5, "peak_normal": 3.0, "peak": 5.0, "effort": 5.0**2 + 2.5**2}
    for objective, value in worth.items():
        whole = value * scale ** PLAIN[objective]
        for off, good in (-MORE, False), (-JUST, True), (JUST, True), (1.0, True):
            found = claims._check_value(chosen(objective, whole * (1 + off)), state, 7)
            assert (not found) == good, (objective, off)
            assert good or found == [f"state 7: {objective} is above the value {whole * (1 + off):.12g}"]
    for objective in (*PLAIN, "answered", "wrench", "wrench_ball"):
        most = (3.0 if objective == "wrench_ball" else 5.0) * scale
        for off, good in (-MORE, False), (-JUST, True), (JUST, True):
            limit = most * (1 + off)
            found = claims._check_value(chosen(objective, inf, max_force=limit), state, 1)
            assert (not found) == good, (objective, off)
            assert good or found == [f"state 1: a force of {most:.12g} is above the limit {limit:.12g}"]
        for off, good in (MORE, False), (JUST, True), (-JUST, True):
            least = 2.5 * scale * (1 + off)
            found = claims._check_value(chosen(objective, inf, min_normal=least), state, 1)
            assert (not found) == good
            assert good or found == [f"state 1: a finger pushes with less than {least:.12g}"]


@pytest.mark.parametrize(
    ("objective", "margin", "value", "step", "words"),
    [
        ("angle", "least_angle", 0.25, -1e-9, "the angle margin is below"),
        ("force", "least_force", 4e5, -4e5 * 1e-9, "the force margin is below"),
        ("force", "least_force", 4e-5, -4e-5 * 1e-9, "the force margin is below"),
        ("friction_use", "largest_friction_use", 0.25, 1e-9, "the use of friction is above"),
    ],
)
def test_values_of_margins(objective, margin, value, step, words) -> None:
    state = plain(forces=np.ones((2, 2)), grasp=plain(normals=np.eye(2)))
    for part, good in (0.9, True), (1.1, False), (-1.0, True), (-1e9, True):
        state.margins = plain(**{margin: value + part * step})
        found = claims._check_value(chosen(objective, value, max_force=9.0), state, 1)
        assert found == ([] if good else [f"state 1: {words} the value {value:.12g}"]), part


@pytest.mark.parametrize("objective", PLAIN)
def test_bounds_are_those_of_proofs(objective) -> None:
    proof = proven(3.0)
    most = 3.0 ** PLAIN[objective]
    for off, good in (-1.0, True), (0.0, True), (0.9 * RESOLUTION, True), (1.1 * RESOLUTION, False):
        found = claims._check_bound(chosen(objective, 100.0, most * (1 + off)), proof)
        assert (not found) == good, off
        assert good or found[0].endswith(f"is above what the proof says, {most:.12g}")
    for off, good in (-MORE, False), (-JUST, True), (JUST, True):
        found = claims._check_bound(chosen(objective, most * (1 + off), 1.0), proof)
        assert (not found) == good, off
        assert good or found[0].endswith(f"is below what the proof says, {most:.12g}")


@pytest.mark.parametrize("objective", PLAIN)
def test_bounds_below_zero_prove_zero_and_large_ones_are_compared(objective) -> None:
    """The square of a bound below 0 is none."""
    for bound, good in (0.0, True), (1e-300, False), (9.0, False):
        found = claims._check_bound(chosen(objective, 100.0, bound), proven(-3.0))
        assert found == ([] if good else [f"bound {bound:.12g} is above what the proof says, 0"])
    found = claims._check_bound(chosen(objective, 100.0, 1.0), proven(1e200))
    assert found[0].startswith("value 100 is below what the proof says, 1e+")


def test_bounds_are_no_worse_than_values_and_finite() -> None:
    for objective in claims.MEANINGS:
        way, words = (1, "below") if objective in LARGEST else (-1, "above")
        for step in (1e-15, 0.5, nan):
            found = claims._check_bound(chosen(objective, 1.0, 1.0 - way * step), proven(9.0))
            assert found == [f"bound {1.0 - way * step:.12g} is {words} the value 1"]
        for value, bound in (-inf, inf)[::way], (1.0, way * inf), (-way * inf, 1.0):
            found = claims._check_bound(chosen(objective, value, bound), proven(9.0))
            assert found == ["value and bound must be finite numbers"]
        if objective not in PLAIN:
            for limit in (None, 0.0, -1.0, inf, nan):
                found = claims._check_bound(chosen(objective, max_force=limit), proven(9.0))
                assert found == ["a level needs the limit of its forces"], limit


def test_bounds_of_levels() -> None:
    """Of a proof of more than the limit of 2 N, or of margins that none of 2 N keep; of less it is none."""
    half = atan(0.5) - atan(0.2)
    for objective, bound, step, given in (
        ("friction_use", 0.4, 0.4 * RESOLUTION, {}),
        ("angle", half, -half * 1e-9, {}),
        ("force", 0.3, -1e-16, {"margin": 0.3}),
    ):
        most = 2.0 if "margin" in given else nextafter(2.0, inf)
        for norm, part, good in (most, 1.1, 0), (most, 0.9, 1), (most, -1.0, 1), (nextafter(most, 0), 0.0, 0):
            if objective == "force":
                part = round(part - 0.4)  # to the last bit
            proof = proven(norm, friction=0.2, **given)
            value = bound - 0.01 if objective in LARGEST else bound + 0.01
            found = claims._check_bound(chosen(objective, value, bound + part * step, max_force=2.0), proof)
            assert (not found) == good, (objective, norm, part)
            words = "is better than what the proof says" if norm == most else "the proof proves no bound"
            assert good or found[0].endswith(words)
        mixed = rg.Grasp([rg.Contact([-1, 0], [1, 0], 0.5), rg.Contact([1, 0], [-1, 0], 0.6)])
        found = claims._check_bound(chosen(objective, max_force=2.0, grasp=mixed), proven(3.0))
        assert found == ["a level of friction is that of one coefficient, the contacts have several"]


def test_bounds_that_need_no_proof() -> None:
    """Two fingers of 3 N and 0.5; the farthest corner is 5 m away."""
    for objective, bound, off in (
        ("friction_use", 0.0, -5e-324), ("angle", atan(0.5), 1e-16),
        ("force", 3 * sin(atan(0.5)) * (1 - 1e-9), 1e-15), ("wrench_ball", 6 * hypot(1, 0.5), 1e-15),
    ):  # fmt: skip
        for step, good in (off, True), (-off, False):
            found = levels.check_trivial(chosen(objective, bound=bound + step), BOARD, 3.0)
            assert found == ([] if good else ["the proof proves no bound"]), (objective, step)
    for axis, most in enumerate((6.0, 6.0, 30.0)):
        for way, center in (1, -2.0), (-1, 2.0), (1, 0.0), (1, 2.0):
            proof = plain(**vars(BOARD) | {"loads": np.full((1, 3), center)})
            deviations = np.zeros((2, 3))
            deviations[1, axis] = way * 0.5
            needed = (most - way * center) / 0.5
            for factor, good in (1 + 1e-12, True), (1 - 1e-12, False):
                given = {"bound": needed * factor, "deviations": deviations}
                for objective in ("answered", "wrench"):
                    found = levels.check_trivial(chosen(objective, **given), proof, 3.0)
                    assert (not found) == good, (axis, way, center)


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_springs_hold_the_load_itself_first(scale, axis) -> None:
    """Then the deviations by the value on top: each to a billionth of the largest force, or torque."""
    center, deviations = scale * np.array([0.0, -3.0, 0.0]), scale * np.array([[1.0, 0, 0], [0, 0, 2.0]])
    shown = center + 2 * deviations
    grasp = rg.Grasp([rg.Contact([-1, 0], [1, 0], 0.5), rg.Contact([1, 0], [-1, 0], 0.5)])
    squeeze = scale * np.array([[9.0, 0], [-9.0, 0]])

    def told(*loads, push=squeeze, objective="wrench", **changes):
        states = [plain(load=plain(vector=w), grasp=grasp, forces=squeeze) for w in loads]
        states[-1].forces = push
        given = {"deviations": deviations, "certificate": plain(loads=center[None]), "states": tuple(states)}
        return "; ".join(levels.check_answers(chosen(objective, 2.0, **given | changes)))

    assert told(center, *shown) == ""
    assert "do not hold the load" in told(center, *shown, deviations=None)
    assert "do not hold the load" in told(center, shown[0])
    assert "equal stiffness" in told(center, *shown, push=1.001 * squeeze)
    assert told(center, *shown, push=1.001 * squeeze, objective="answered") == ""
    for objective in "answered", "wrench":
        for loads in (shown, [*shown, center], [center, center, *shown]):
            assert "do not hold the load" in told(*loads, objective=objective)
    for row in range(3):
        size = np.abs(shown[:, :2] if axis < 2 else shown[:, 2]).max()
        for off, good in (JUST, True), (-JUST, True), (MORE, False), (-MORE, False):
            loads = np.array([center, *shown])
            loads[row, axis] += off * size
            assert (told(*loads) == "") == good, (row, off)


@pytest.mark.parametrize("scale", [1e-6, 1.0, -1e6])
def test_what_was_passed_over(scale) -> None:
    """Values and bounds below zero, too: margins may be."""
    for objective in ("peak", "force"):
        way = 1 if objective in LARGEST else -1
        for off, good in (-1.0, True), (JUST, True), (MORE, False):
            others = (
                plain(value=scale - 2.0 * way * abs(scale)),
                plain(value=scale + way * off * abs(scale)),
            )
            found = claims._check_others(chosen(objective, bound=scale, others=others))
            assert (not found) == good, (objective, off)
            assert good or found[0].startswith(f"a grasp passed over has the value {others[1].value:.12g}")


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_places_are_those_of_contacts(scale) -> None:
    grasp = plain(positions=scale * np.array([[-1.0, 0.5], [2.0, -4.0]]))
    for at in np.ndindex(2, 2):
        for off, good in (JUST, True), (-JUST, True), (MORE, False), (-MORE, False):
            given = np.array(grasp.positions)
            given[at] += off * 4 * scale
            found = contacts._off_their_places(plain(grasp=grasp), given)
            assert (not found) == good, (at, off)
            assert good or found == [f"a contact is {abs(off) * 4 * scale:.3g} off its place"]


def test_all_of_a_boundary_is_all_but_a_billionth() -> None:
    for missing, whole in (JUST, True), (MORE, False):
        sides = np.array([[0, 0, 1.0], [1, 1, 2.0], [2, 2, 3.0], [3, 3, 4 - missing * 28 / 8]])
        proof = plain(**vars(BOARD) | {"sides": sides})
        assert claims._part(proof) == ("" if whole else " on the 100.0% of the outline that was asked about")


def test_an_edge_left_out_is_missed_however_short() -> None:
    for width in 1e-12, 1.0:
        corners = [[0, 0], [4, 0], [4, 2], [2, 2 + width], [2 - width, 2], [0, 2]]
        sides = np.array([[e, e, e + 1.0] for e in range(6)])
        for kept, whole in ([0, 1, 2, 3, 4, 5], True), ([0, 1, 2, 4, 5], False):
            proof = plain(**vars(BOARD) | {"vertices": np.array(corners), "sides": sides[kept]})
            assert (claims._part(proof) == "") == whole, (width, kept)


@pytest.mark.parametrize("length", [0.5, 2.0])
def test_the_ball_of_a_pair(length) -> None:
    """Facing fingers with friction 1, a length apart from the middle: a ball of sqrt(2/3) times the limit."""
    grasp = rg.Grasp([rg.Contact([-length, 0], [1, 0], 1.0), rg.Contact([length, 0], [-1, 0], 1.0)])
    radius = 3 * sqrt(2 / 3)
    for factor, good in (1 - 1e-12, True), (1 + 1e-12, False), (0.0, True), (-1e-300, False):
        given = {"grasp": grasp, "length": length, "max_force": 3.0}
        found = levels.check_ball(chosen("wrench_ball", radius * factor, **given), 3.0)
        assert (not found) == good, factor
    for bound, at in (5.0, 5.0), (2.0, 2.0):
        for row, off, good in (0, JUST, True), (0, MORE, False), (1, MORE, False), (1, -1.0, True):
            loads = np.array([[at, 0, 0], [0, 0, at * length]])
            loads[row] *= 1 + off
            proof = proven(3.5, loads=loads)
            given = {"grasp": grasp, "length": length, "max_force": 3.0}
            found = claims._check_bound(chosen("wrench_ball", 1.0, bound, **given), proof)
            assert (not found) == good, (bound, row, off)
    assert levels.check_ball(chosen("wrench_ball", float(Fraction(1, 3)), grasp=grasp), 3.0) != []


def test_what_is_shared_of_surfaces() -> None:
    for missing, whole in (JUST, True), (MORE, False):
        told = part_of_surface(1 - missing)
        assert told == ("" if whole else " on the 100.0% of the surface that was asked about")


def test_springs_are_asked_for_by_the_bound_too() -> None:
    """Without a state there is nothing to show, and another claim says so."""
    given = {"max_force": 3.0, "deviations": np.ones((1, 3))}
    assert claims._check_bound(chosen("wrench", **given), proven(2.0, **vars(NO_LOAD))) != [
        "the states do not hold the load, and the deviations times the value on top of it"
    ]
    state = plain(load=plain(vector=np.ones(3)))
    found = claims._check_bound(chosen("wrench", states=(state, state), **given), proven(9.0))
    assert found == ["the states do not hold the load, and the deviations times the value on top of it"]
    for deviations in None, np.ones((1, 3)):
        good = chosen("answered", states=(state, state), max_force=3.0, deviations=deviations)
        assert claims._check_bound(good, proven(9.0)) == found


NO_LOAD = plain(**{k: v for k, v in vars(BOARD).items() if k != "bound"})


def test_a_proof_without_margins_is_one_for_any() -> None:
    for objective in "force", "peak":
        for size, norm in ("force", "largest"), ("force", "sum"), ("margin", "largest"):
            good = (objective, size, norm) == ("force", "force", "largest")
            assert claims._is_without_margin(chosen(objective), plain(size=size, norm=norm)) == good


def test_proofs_by_themselves() -> None:
    verdict = claims.verify_proof(BOARD)
    assert (verdict.worst_residual, verdict.least_angle, verdict.least_cone_slack) == (0.0, inf, inf)
    assert verdict.asked == ""
    sides = np.array([[0, 0, 1.0]])
    low = [([(0, 0, 0.0, 1.0)], (1, 2), 0, (0, 1, 0))]
    low += [([(0, 0, a, a + 0.5)], (0, 0), 0, (0, 1, 0)) for a in (0.0, 0.5)]
    proof = planar([[-3, -4], [3, -4], [3, 4], [-3, 4]], [[0, -1, 0]], low, sides=sides, bound=0.5)
    verdict = claims.verify_proof(proof)
    assert (verdict.ok, verdict.excluded, verdict.bound) == (True, 2, 0.5)
    assert verdict.asked == " on the 21.4% of the outline that was asked about"
    proof.bound = 2.0
    verdict = claims.verify_proof(proof)
    assert (verdict.ok, verdict.asked) == (False, "")
    corners = [[[0, 0, 0], [2, 0, 0], [2, 3, 0]]]
    node = ([0], (0, 0), 0, [0, 0, 1.0, 0, 0, 0])
    patch = plain(spans=[(0, 1)], halves=[[-1] * 3])
    space = solid(corners, [[0, 0, 1.0]], [[0, 0, -1, 0, 0, 0]], patch, [node], bound=0.5)
    verdict = claims.verify_proof(space)
    assert (verdict.ok, verdict.excluded, verdict.asked) == (True, 1, "")
    space.bound = 2.0
    assert "does not exclude" in claims.verify_proof(space).violations[0]


def test_no_verdict_without_a_meaning() -> None:
    verdict = claims.verify_chosen(chosen("least"))
    assert not verdict.ok
    assert (verdict.worst_residual, verdict.least_angle, verdict.least_cone_slack) == (inf, 0.0, -inf)

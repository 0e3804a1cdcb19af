"""The directions of load that contacts hold: against choosing states, and by hand."""

from collections import Counter
from math import pi

import numpy as np
import pytest

import regrasp as rg
from paper import GRASP

pytestmark = pytest.mark.oracle

DOWN, UP, RIGHT, LEFT = (0, -1), (0, 1), (1, 0), (-1, 0)


def contacts(*rows, friction=0.0):
    return rg.Grasp([rg.Contact(r, n, friction) for r, n in rows])


def unit(angle):
    return np.array([np.cos(angle), np.sin(angle)])


def holds(grasp, direction):
    if len(grasp) == 2:
        return not rg.EquilibriumLocus(grasp, rg.Wrench(direction)).is_empty
    try:
        rg.choose_state(grasp, rg.Wrench(direction), "peak", reserve=0)
    except rg.Infeasible:
        return False
    return True


def random_grasp(rng, count):
    # points on an ellipse about the centre of mass or beside it, normals mostly inwards
    angles = rng.uniform(0, 2 * pi, count)
    r = np.column_stack([2 * np.cos(angles), np.sin(angles)]) + rng.choice([0, 1.5]) * rng.normal(size=2)
    n = -np.column_stack([np.cos(angles), 2 * np.sin(angles)]) + 0.3 * rng.normal(size=(count, 2))
    mu = rng.choice([0.0, 0.2, 0.6, 1.5], count)
    return rg.Grasp([rg.Contact(*c) for c in zip(r, n, mu, strict=True)])


@pytest.mark.parametrize(("count", "grasps", "directions"), [(2, 300, 25), (3, 40, 12), (4, 15, 12)])
def test_held_exactly_where_a_state_exists(count, grasps, directions):
    rng = np.random.default_rng(count)
    seen = Counter()
    for _ in range(grasps):
        grasp = random_grasp(rng, count)
        held = rg.held_directions(grasp)
        angles = rng.uniform(-pi, pi, directions)
        if held.arc is not None and held.kind in (
            "arc",
            "half-plane",
        ):  # and close to both ends, on both sides
            angles = np.append(angles, np.array(held.arc)[:, None] + [-1e-4, 1e-4])
        for angle in angles:
            assert held.contains(unit(angle)) == holds(grasp, unit(angle)), (held, angle, grasp)
            assert held.contains(rg.Wrench(3e5 * unit(angle))) == held.contains(1e-5 * unit(angle))
            seen[held.contains(unit(angle))] += 1
        seen[held.kind] += 1
    assert min(seen[True], seen[False], seen["arc"]) >= 5, seen
    assert count == 2 or seen["everything"], seen


@pytest.mark.parametrize(
    ("grasp", "kind", "arc"),
    [
        (contacts(((-1, 0), RIGHT), ((1, 0), LEFT)), "line", (-pi, 0)),
        (contacts(((-1, 1), RIGHT), ((1, 1), LEFT)), "empty", None),  # they cancel, beside the centre
        (contacts(((-1, -1), UP), ((1, -1), UP)), "direction", (-pi / 2, -pi / 2)),
        (contacts(((1, -1), UP), ((2, -1), UP)), "empty", None),
        (contacts(((-1, 0), RIGHT), friction=5.0), "direction", (-pi, -pi)),
        (contacts(((0, 0), UP), friction=1.0), "arc", (-3 * pi / 4, -pi / 4)),
        (contacts(((-1, 0), RIGHT), ((1, 0), LEFT), friction=0.2), "everything", (-pi, pi)),
        (contacts(((-1, 0), RIGHT), ((1, 0), LEFT), ((0, -1), UP)), "half-plane", (-pi, 0)),
        (contacts(((-1, -1), UP), ((1, -1), UP), friction=1.0), "arc", (-3 * pi / 4, -pi / 4)),
    ],
)  # fmt: skip
@pytest.mark.parametrize("angle", [0.0, 0.7, pi / 2, 3.0])
@pytest.mark.parametrize("length", [1e-6, 1.0, 1e6])
def test_by_hand(grasp, kind, arc, angle, length):
    """Also in other units and with the frame turned."""
    c, s = unit(angle)
    rotation = np.array([[c, -s], [s, c]])
    turned = rg.Grasp(
        [rg.Contact(length * rotation @ k.position, rotation @ k.normal, k.friction) for k in grasp]
    )
    held = rg.held_directions(turned)
    assert held.kind == kind
    if arc is None:
        assert held.arc is None
        assert not held.contains(DOWN)
        return
    lo, hi = held.arc
    assert -pi <= lo < pi
    assert hi - lo == pytest.approx(arc[1] - arc[0], abs=1e-11)
    if kind not in ("everything", "line"):
        assert unit(lo) == pytest.approx(unit(arc[0] + angle), abs=1e-11)
    assert held.contains(unit(lo))
    assert held.contains(unit(hi))
    assert held.contains(unit((lo + hi) / 2)) == (kind != "line")
    assert held.contains(unit((lo + hi) / 2 + pi)) == (kind == "everything")


def test_relabelling_changes_nothing():
    held = rg.held_directions(GRASP.subset(["P1", "P2"]))
    assert rg.held_directions(GRASP.subset(["P2", "P1"])) == held
    assert held.contains(rg.Wrench([-1.5, -3.5]))  # the paper's pair holds the paper's load
    assert not rg.held_directions(GRASP.subset(["P2", "P3"])).contains(rg.Wrench([-1.5, -3.5]))


def test_in_words():
    def words(*rows, friction=0.0):
        return str(rg.held_directions(contacts(*rows, friction=friction)))

    assert (
        words(((-1, -1), UP), ((1, -1), UP), friction=1.0) == "directions from -135 to -45 deg, 90 deg wide"
    )
    assert words(((-1, -1), UP), ((1, -1), UP)) == "the direction -90 deg"
    assert words(((-1, 0), RIGHT), ((1, 0), LEFT)) == "the directions 0 and 180 deg"
    assert words(((1, -1), UP), ((2, -1), UP)) == "no direction"
    assert words(((-1, 0), RIGHT), ((1, 0), LEFT), friction=0.2) == "every direction"


def test_bad_input():
    held = rg.held_directions(GRASP)
    with pytest.raises(rg.InvalidInput, match="direction must not be zero"):
        held.contains([0, 0])
    with pytest.raises(rg.InvalidInput, match="must be a planar force through the centre of mass"):
        held.contains(rg.Wrench([0, -1], 0.1))
    with pytest.raises(rg.InvalidInput, match=r"direction must have shape \(2,\)"):
        held.contains([1, 2, 3])
    with pytest.raises(
        rg.InvalidInput, match="held directions are of a planar Grasp; in space use held_sphere"
    ):
        rg.held_directions(rg.Grasp([rg.Contact([0, 0, 1], [0, 0, -1], 0.5)]))

"""Where no box of places holds: exact places, a refusal with its bound, and what an interrupt leaves."""

import numpy as np
import pytest

import regrasp as rg
from placements import BRACKET
from regrasp.planning.placement.asking import asked_sides
from regrasp.planning.placement.knife_edges import places_towards, where_loads_meet
from regrasp.planning.placement.search import Search
from regrasp.planning.placement.space.surface_search import SurfaceSearch

pytestmark = pytest.mark.oracle

TRIANGLE = rg.Outline([[0, 0], [2, 0], [1, np.sqrt(3)]])
SLIVER = rg.Outline([[0, 0], [10, 0], [5, 1e-2]])
ANY = rg.LoadSet.turned(rg.Wrench([0, -1]))
STEEP = rg.LoadSet.hull([rg.Wrench([0.3, -1]), rg.Wrench([-0.3, -1]), rg.Wrench([0, -1], 0.1)])


def test_lines_of_loads_meet_in_a_point_or_in_none() -> None:
    rng = np.random.default_rng(0)
    point, forces = np.array([0.3, -0.2]), rng.normal(size=(5, 2))
    loads = np.column_stack([forces, point[0] * forces[:, 1] - point[1] * forces[:, 0]])
    met = where_loads_meet(loads)
    assert met is not None
    np.testing.assert_allclose(met, point, atol=1e-14)
    assert where_loads_meet(loads + np.array([0, 0, 1e-6])) is None
    assert where_loads_meet(loads[:1]) is None  # they meet along a line


@pytest.mark.parametrize("outline", [TRIANGLE, rg.Outline.ellipse(2, 1), BRACKET])
def test_normals_and_edges_of_cones_pass_through_a_point(outline: rg.Outline) -> None:
    sides, mu, point = asked_sides(outline, 0.0, None, 0.0, False), 0.3, np.array([0.1, 0.05])
    on, u = places_towards(sides, point, mu)
    assert len(u) >= 6
    for side, at in zip(on, u, strict=True):
        contact = sides.contact(int(side), float(at), mu, "F")
        to, n = point - contact.position, contact.normal
        slope = (n[0] * to[1] - n[1] * to[0]) / (to @ n)
        assert min(abs(slope - edge) for edge in (-mu, 0.0, mu)) < 1e-9


@pytest.mark.parametrize("friction", [0.0, 1e-12])
def test_three_fingers_without_friction_hold_every_orientation_at_the_middles_alone(friction: float) -> None:
    """Each two of the normals, 120 degrees apart, hold what is between them by 2 / sqrt(3) at the most."""
    chosen = rg.choose_grasp(
        TRIANGLE, 3, ANY, friction=friction, objective="peak_normal", from_corners=0.0, most_boxes=500
    )
    np.testing.assert_allclose(chosen.places, [1, 3, 5], atol=1e-12)
    assert chosen.value == pytest.approx(2 / np.sqrt(3), rel=1e-3)
    assert rg.verify(chosen).ok


def test_boxes_are_narrower_where_nothing_is_found() -> None:
    """Two fingers without friction do not hold three loads that span all wrenches."""
    with pytest.raises(rg.Infeasible, match="not by forces of") as caught:
        rg.choose_grasp(
            rg.Outline.ellipse(2, 0.01), 2, STEEP, friction=0.0, objective="peak_normal", from_corners=0.0
        )
    assert rg.verify(caught.value.certificate).ok


def test_a_load_at_the_friction_angle_is_refused_with_a_bound_and_the_friction_that_holds_it() -> None:
    with pytest.raises(rg.Infeasible, match=r"with friction 0\.300001 one does hold them") as caught:
        rg.choose_grasp(TRIANGLE, 2, STEEP, friction=0.3, from_corners=0.0, most_boxes=300)
    proof = caught.value.certificate
    assert rg.verify(proof).ok
    wider = rg.choose_grasp(TRIANGLE, 2, STEEP, friction=0.300001, from_corners=0.0, most_boxes=1000)
    assert 0.9 < proof.bound <= wider.value


def test_a_ball_that_is_rounding_is_none() -> None:
    flat = rg.Outline.ellipse(2, 0.01)
    for outline, fingers, friction in ((TRIANGLE, 2, 1e-12), (flat, 3, 0.0)):
        chosen = rg.choose_grasp(
            outline, fingers, rg.Wrench([0, 0]), friction=friction, objective="wrench_ball", max_force=3.0,
            from_corners=0.0, most_boxes=500,
        )  # fmt: skip
        assert chosen.value == 0.0
        assert rg.verify(chosen).ok


def asked(what: str) -> rg.ChosenGrasp:
    if what == "a mesh":
        return rg.choose_grasp(rg.Mesh.box(1, 1, 1), 3, rg.Wrench([0, 0, -1], [0, 0, 0]), friction=0.5)
    if what == "a level on a mesh":
        cube, down = rg.Mesh.box(1, 1, 1), rg.Wrench([0, 0, -1], [0, 0, 0])
        return rg.choose_grasp(cube, 3, down, friction=0.5, objective="angle", max_force=3.0)
    if what == "constraints":
        return rg.choose_grasp(BRACKET, 2, STEEP, friction=0.5, keep=lambda a, b, _: a[:, 0] > 9)
    if what == "a level of groups":
        return rg.choose_grasp(BRACKET, 2, STEEP, friction=0.5, objective="force", max_force=3.0)
    if what == "a level":
        curve = rg.Outline.ellipse(2, 1)
        return rg.choose_grasp(curve, 3, STEEP, friction=0.5, objective="friction_use", max_force=3.0)
    return rg.choose_grasp(SLIVER, 3, STEEP, friction=0.0)


@pytest.mark.parametrize(
    "what", ["a norm", "constraints", "a level", "a level of groups", "a mesh", "a level on a mesh"]
)
def test_an_interrupt_before_anything_is_found_says_the_bound_so_far(
    what: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    for kind, name in ((Search, "goes_on"), (Search, "terms"), (SurfaceSearch, "some")):
        monkeypatch.setattr(kind, name, interrupted)
    with pytest.raises(KeyboardInterrupt, match=r"not proven.*an interrupt ended the search") as caught:
        asked(what)
    refusal = caught.value.__cause__
    assert isinstance(refusal, rg.Infeasible)
    assert rg.verify(refusal.certificate).ok


def test_an_interrupt_of_a_long_search_leaves_the_bound_that_it_had() -> None:
    def interrupted(*_: float) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt, match=r"none needs less than .* N.*an interrupt ended") as caught:
        rg.choose_grasp(SLIVER, 3, STEEP, friction=0.0, progress=interrupted)
    refusal = caught.value.__cause__
    assert isinstance(refusal, rg.Infeasible)
    assert refusal.certificate.bound > 300  # tops are steep by 0.002, and 0.3 N go aside
    assert rg.verify(refusal.certificate).ok

"""A regrasp that cannot be says what would do: friction, force, turns, margin."""

import pytest

import regrasp as rg
from regrasp.outline import parts
from regrasp.outline.polygon import PolygonBoundary

pytestmark = pytest.mark.laws

WEIGHT = rg.Wrench([0, -3.0])
ELLIPSE = rg.Outline.ellipse(2, 1)


def grasp_on(outline, places, friction=0.5, prefix="A", max_force=None):
    return rg.Grasp(
        outline.contact_at(s * outline.length, friction=friction, name=f"{prefix}{i}", max_force=max_force)
        for i, s in enumerate(places, 1)
    )


START, GOAL = grasp_on(ELLIPSE, (0.02, 0.35, 0.7)), grasp_on(ELLIPSE, (0.2, 0.5, 0.85), prefix="B")


def refused(outline, start, goal, load=WEIGHT, **options):
    with pytest.raises(rg.Infeasible) as error:
        rg.plan_regrasp(outline, start, goal, load, **options)
    return error.value


def test_a_frictionless_disc_says_which_friction_would_do():
    disc = rg.Outline.ellipse(1, 1)

    def ends(friction):
        return (grasp_on(disc, p, friction) for p in ((0.1, 0.25, 0.45), (0.55, 0.72, 0.95)))

    error = refused(disc, *ends(0.0), friction=0.0, orientations=12, candidates=40)
    assert error.certificate.is_proof
    needed = float(str(error).split("they would with friction ")[1])
    assert 0.2 < needed < 1
    assert rg.choose_state(next(ends(needed)), WEIGHT, "force")
    with pytest.raises(rg.Infeasible):
        rg.choose_state(next(ends(0.98 * needed)), WEIGHT, "force")


@pytest.mark.parametrize(
    ("part", "friction", "places"),
    [
        ("wrench", 0.1, [(0.3417, 0.7583, 0.875), (0.2083, 0.975, 0.475)]),
        ("bracket", 0.2, [(0.2417, 0.525, 0.325), (0.3917, 0.9917, 0.425)]),
        ("bottle", 0.2, [(0.125, 0.9583, 0.9417), (0.0083, 0.575, 0.7417)]),
    ],
)
def test_a_goal_on_another_component_says_at_which_friction_they_meet(part, friction, places):
    outline = getattr(parts, part)()

    def regrasp(mu):
        ends = (grasp_on(outline, p, mu) for p in places)
        return rg.plan_regrasp(outline, *ends, WEIGHT, friction=mu, orientations=1, candidates=12)

    with pytest.raises(rg.Infeasible, match="the start's points are in component") as error:
        regrasp(friction)
    obstacle = error.value.certificate
    assert not set(obstacle.start) & set(obstacle.goal) - {-1}
    assert obstacle.max_force is None
    needed = obstacle.friction
    elsewhere = "; whether fingers elsewhere on this outline could, regrasps_on_outline decides"
    polygon = isinstance(outline.boundary, PolygonBoundary) and not outline.holes
    assert str(error.value).endswith(elsewhere) == polygon
    assert f"there would be one with friction {needed:g} instead of {friction:g}" in str(error.value)
    assert rg.verify(regrasp(needed)).ok
    with pytest.raises(rg.Infeasible):
        regrasp(0.98 * needed)


def test_a_force_limit_too_low_says_which_would_do():
    options = {"friction": 0.5, "orientations": 1, "candidates": 60}
    ends = grasp_on(ELLIPSE, (0.7, 0.75, 0.02)), grasp_on(ELLIPSE, (0.5, 0.72, 0.8), prefix="B")
    error = refused(ELLIPSE, *ends, max_force=2.8, **options)
    needed = error.certificate.max_force
    assert f"or with force limits of {needed:g}" in str(error)
    assert rg.verify(rg.plan_regrasp(ELLIPSE, *ends, WEIGHT, max_force=needed, **options)).ok
    refused(ELLIPSE, *ends, max_force=0.97 * needed, **options)


def test_a_force_limit_too_low_for_three_fingers_says_which_would_do():
    error = refused(ELLIPSE, START, GOAL, friction=0.5, orientations=1, max_force=2.0)
    assert error.certificate.is_proof
    needed = float(str(error).split("with force limits of ")[1])
    assert rg.choose_state(START, WEIGHT, "force", max_force=needed).magnitudes.max() <= needed
    with pytest.raises(rg.Infeasible):
        rg.choose_state(START, WEIGHT, "force", max_force=0.98 * needed)


def test_ends_that_cannot_be_held_say_why():
    high = (0.2, 0.25, 0.3)  # all push down
    for start, goal, what in (
        (grasp_on(ELLIPSE, high), GOAL, "start"),
        (START, grasp_on(ELLIPSE, high), "goal"),
    ):
        error = refused(ELLIPSE, start, goal, friction=0.5, orientations=6)
        assert str(error).startswith(f"the fingers of the {what} cannot hold the load at 0 deg: no forces of")
        assert error.certificate.is_proof
        assert "they would with friction" in str(error)


def test_options_that_stand_in_the_way_are_named():
    options = {"friction": 0.5, "orientations": 6, "candidates": 30}
    error = refused(ELLIPSE, START, GOAL, min_distance=5.0, **options)
    assert error.certificate.without == ("min_distance",)
    assert str(error).endswith("there would be one without min_distance")
    error = refused(ELLIPSE, START, GOAL, keep=lambda a, b, angle: a[:, 0] > 9.0, **options)
    assert str(error).endswith("there would be one without keep")


@pytest.mark.parametrize("arcs", [None, [None] * 3])
def test_a_least_margin_says_the_widest_there_is(arcs):
    options = {"friction": 0.5, "orientations": 12, "candidates": 40, "arcs": arcs}
    error = refused(ELLIPSE, START, GOAL, least_margin=0.46, **options)
    widest = error.certificate.margin
    assert f"the widest worst margin on the sampled points and orientations is {widest:.4g} rad" in str(error)
    plan = rg.plan_regrasp(ELLIPSE, START, GOAL, WEIGHT, least_margin=widest * (1 - 1e-6), **options)
    assert plan.margin == pytest.approx(widest, abs=1e-5)

"""Numbers whose squares or products are none: values keep them, questions refuse them in one line."""

import numpy as np
import pytest

import regrasp as rg

pytestmark = [pytest.mark.contract, pytest.mark.filterwarnings("error")]
BEYOND = [1.01e100, 1e160, 1.7e308]


def three(reach: float = 1.0, friction: float = 0.5) -> rg.Grasp:
    places, normals = reach * np.array([[-1, 0], [1, 0], [0, -1]]), [[1, 0], [-1, 0], [0, 1]]
    return rg.Grasp(rg.Contact(p, n, friction=friction) for p, n in zip(places, normals, strict=True))


def soft(torsion: float) -> rg.Grasp:
    return rg.Grasp(rg.Contact([x, 0, 0], [-x, 0, 0], friction=0.5, torsion=torsion) for x in (-1, 1))


DOWN = rg.Wrench([0, -1])


@pytest.mark.parametrize("size", BEYOND)
def test_loads_and_sets_of_them(size: float) -> None:
    huge = rg.Wrench([0, size])
    for make in (
        lambda: rg.LoadSet.ball(DOWN, force=size),
        lambda: rg.LoadSet.ball(DOWN, torque=size),
        lambda: rg.LoadSet.ball(huge, force=1),
        lambda: rg.LoadSet.ellipsoid(DOWN, [[1.0], [-size], [0]]),
        lambda: rg.LoadSet.hull([DOWN, huge]),
        lambda: rg.LoadSet.hull([DOWN], center=huge),
        lambda: rg.LoadSet.tilted(huge, 0.1),
        lambda: rg.LoadSet.turned(huge),
        lambda: rg.LoadSet.ball(DOWN, force=2).scaled(size),
        lambda: rg.LoadSet.ball(DOWN, force=2).contains(huge),
        lambda: rg.LoadSet.ball(DOWN, force=2).support([size, 0, 0]),
        lambda: rg.choose_state(three(), huge, "effort"),
        lambda: rg.largest_load(three(), huge),
        lambda: rg.least_friction(three(), huge),
        lambda: rg.Criteria(min_normal=[size]),
        lambda: rg.Criteria(stiffness=size),
        lambda: rg.least_stiffness(rg.choose_state(three(), DOWN), tip_radius=size),
    ):
        with pytest.raises(
            rg.InvalidInput, match=r"must be at most 1e\+(100|50)( N| in size), got -?1"
        ) as no:
            make()
        assert "\n" not in str(no.value)


def test_sets_just_within() -> None:
    ball = rg.LoadSet.ball(DOWN, force=1e99, torque=1e99)
    for loads in (
        ball,
        ball.scaled(9),
        rg.LoadSet.turned(rg.Wrench([0, 1e100])),
        rg.LoadSet.hull([1e99 * DOWN]),
    ):
        assert np.isfinite(loads.support([0.6e50, 0.8e50, 0]))
        assert loads.contains(loads.center)
    with pytest.raises(rg.InvalidInput, match="deviations of a scaled set must be at most"):
        ball.scaled(11)


def test_wrenches_that_overflow() -> None:
    most = rg.Wrench([1.7e308, 0])
    for make in (lambda: most + most, lambda: most - -most, lambda: 2 * most, lambda: most / 0.5):
        with pytest.raises(rg.InvalidInput, match="wrench must be finite"):
            make()


@pytest.mark.parametrize("size", [1.01e50, 1e160, 1.7e308, 0.99e-50, 1e-320])
def test_grasps_of_such_sizes(size: float) -> None:
    for grasp, load, what in (
        (three(reach=size), DOWN, "positions must reach 0 or"),
        (three(friction=size), DOWN, "friction of 'P1' must be 0 or"),
        (soft(size), rg.Wrench([0, 0, -1]), "torsion of 'P1' must be 0 or"),
    ):
        for ask in (
            lambda g=grasp, w=load: rg.choose_state(g, w, "effort"),
            lambda g=grasp, w=load: rg.held_centres(g, w),
            lambda g=grasp: rg.wrench_ball(g, limit=1),
        ):
            with pytest.raises(rg.InvalidInput, match=f"^{what} between 1e-50 and 1e\\+50, got "):
                ask()
        state = rg.GraspState(grasp, load, np.ones((len(grasp), grasp.width)))
        assert state.margins.angle.shape == (len(grasp),)
    for limit, length in ((size, 1), (1, size)):
        if size > 1 or length != 1:
            with pytest.raises(rg.InvalidInput, match=r"^(limit|length) must be"):
                rg.wrench_ball(three(), limit=limit, length=length)


@pytest.mark.parametrize("size", [1e50, 1e-50])
def test_grasps_just_within(size: float) -> None:
    assert rg.choose_state(three(reach=size), DOWN, "effort").residual < 1e-9
    weight = rg.Wrench([0, -1e100 if size > 1 else -1e-300])
    assert rg.held_centres(three(), weight).vertices.shape == (2, 2)


@pytest.mark.parametrize("size", BEYOND)
def test_states_of_such_forces_are_measured(size: float) -> None:
    forces = np.array([[1.0, 0.25], [-1.0, 0.25], [0.0, 0.5]])
    one, large = (rg.GraspState(three(), DOWN, f) for f in (forces, size * forces))
    assert large.margins.angle == pytest.approx(one.margins.angle)
    assert large.margins.force == pytest.approx(size * one.margins.force)
    assert large.margins.friction_use == pytest.approx(one.margins.friction_use)
    assert large.residual == pytest.approx(size * 1.0) or large.residual == np.inf
    assert not large.is_balanced()
    with pytest.raises(rg.InvalidInput, match="forces to be balanced must be at most"):
        large.balanced()

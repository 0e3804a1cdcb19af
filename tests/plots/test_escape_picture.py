"""The escape twist in words and as a picture: both say what its numbers say, in any unit."""

import re
from math import hypot, inf

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.quiver import Quiver

import regrasp as rg
from drawn import by_gid, ends
from regrasp import plots
from regrasp.plots.look.style import PALETTE

pytestmark = pytest.mark.contract

NUMBER = r"-?\d+(?:\.\d+)?(?:e[-+]\d+)?"


def pair(length=1.0, force=1.0, limit=inf):
    """P2 and P3 of the paper's example, which cannot hold the load alone."""
    grasp = rg.Grasp(
        [
            rg.Contact([4 * length, -5 * length], normal=[-1, 2], friction=0.3, name="P2"),
            rg.Contact([0, 8 * length], normal=[0, -1], friction=0.3, name="P3"),
        ]
    )
    return certificate(grasp, rg.Wrench([-1.5 * force, -3.5 * force]), limit)


def weak_grip(length=1.0, force=1.0):
    """Two fingers of friction 1/2 and limits 1 and 2 beside a weight of 2 and a torque."""
    grasp = rg.Grasp(
        [
            rg.Contact([-length, 0], [1, 0], 0.5, max_force=force, name="thumb"),
            rg.Contact([length, 0], [-1, 0], 0.5, max_force=2 * force, name="index"),
        ]
    )
    return certificate(grasp, rg.Wrench([0, -0.2 * force], 1.2 * force * length))


def certificate(grasp, load, limit=inf):
    with pytest.raises(rg.Infeasible) as error:
        rg.choose_state(grasp, load, "peak", max_force=None if limit == inf else limit)
    return error.value.certificate


def lifted(v=(1.0, 0.2, 0.0)):
    """A motion of a table on two supports that are pressed into by nothing."""
    table = rg.Grasp([rg.Contact([-1, 0], [0, 1], 0.2), rg.Contact([1, 0], [0, 1], 0.2)])
    return rg.EscapeTwist(table, rg.Wrench([1, -1]), v, (0.2, 0.2), (inf, inf))


def texts(ax):
    return {text.get_text() for text in ax.texts}


# -- words -------------------------------------------------------------------------------------------


def test_contacts_that_cannot_oppose_are_said_to():
    twist = pair()
    arm = -twist.centre
    fx, fy = twist.load.force
    torque = abs(arm[0] * fy - arm[1] * fx)  # of the load about the centre
    assert twist.explanation == (
        "turning counter-clockwise about (4.13793, -5.7931): "
        f"per radian the load does {torque:.4g} N m of work; "
        "P2 cannot oppose it; P3 cannot oppose it"
    )


def test_force_limits_are_set_beside_the_load():
    twist = weak_grip()
    head, *parts = twist.explanation.split("; ")
    drive = float(re.search(rf"the load does ({NUMBER}) N m", head)[1])
    thumb = [float(x) for x in re.findall(NUMBER, parts[0])]
    assert parts[0].startswith("thumb can oppose at most")
    arm = twist.grasp["thumb"].position - twist.centre
    edges = [np.array([1, s * 0.5]) / hypot(1, 0.5) for s in (1, -1)]
    levers = [arm[0] * e[1] - arm[1] * e[0] for e in edges]  # torque about the centre of 1 N on an edge
    assert thumb == pytest.approx([-min(levers), 1.0, -min(levers)], rel=1e-3)
    assert parts[1] == "index cannot oppose it"
    assert parts[2] == f"together at most {thumb[0]:.4g} N m, too little"
    assert drive > thumb[0]


def test_a_translation_is_measured_in_forces_per_metre():
    assert lifted().explanation == (
        f"sliding along (0.980581, 0.196116): per metre the load does {0.8 / hypot(1, 0.2):.4g} N of work; "
        "P1 cannot oppose it; P2 cannot oppose it"
    )


def test_a_motion_that_proves_nothing_says_so():
    assert lifted((0.0, -1.0, 0.0)).explanation.endswith(
        "P1 can oppose it without limit; P2 can oppose it without limit; "
        "that is enough against this motion, which proves nothing"
    )


def test_in_space_the_motion_is_per_radian():
    sides = [rg.Contact([1, 0, 0], [-1, 0, 0], 0.5), rg.Contact([-1, 0, 0], [1, 0, 0], 0.5)]
    load = rg.Wrench([0, 0, 0], [2.0, 0, 0])
    spin = rg.EscapeTwist(rg.Grasp(sides), load, [0, 0, 0, 3.0, 0, 0], (0.5, 0.5), (inf, inf))
    assert spin.explanation == (
        "turning about the axis through (0, 0, 0) along (1, 0, 0): "
        "per radian the load does 2 N m of work; "
        "P1 cannot oppose it; P2 cannot oppose it"
    )


@pytest.mark.parametrize("build", [pair, weak_grip, lifted], ids=lambda build: build.__name__)
def test_the_length_of_the_twist_is_not_told(build):
    twist = build()
    for factor in (1e-9, 3.0, 1e9):
        longer = rg.EscapeTwist(twist.grasp, twist.load, factor * twist.twist, twist.frictions, twist.limits)
        assert longer.explanation == twist.explanation


@pytest.mark.parametrize("build", [pair, weak_grip], ids=lambda build: build.__name__)
@pytest.mark.parametrize(("length", "force"), [(1e3, 1.0), (1.0, 1e-6), (1e-6, 1e6)])
def test_other_units_change_the_numbers_as_they_should(build, length, force):
    one, other = build(), build(length, force)
    assert other.drive == pytest.approx(one.drive * length * force, rel=1e-6)
    assert other.resistances == pytest.approx([r * length * force for r in one.resistances], rel=1e-6)
    assert re.sub(NUMBER, "#", other.explanation) == re.sub(NUMBER, "#", one.explanation)
    assert other.helpless == one.helpless


def test_no_motion_is_refused():
    with pytest.raises(rg.InvalidInput, match="must not be zero: the object does not move"):
        lifted((0.0, 0.0, 0.0))


# -- the picture ---------------------------------------------------------------------------------------


def field(ax):
    (motion,) = (artist for artist in ax.collections if isinstance(artist, Quiver))
    return motion.XY, np.column_stack([motion.U, motion.V])


@pytest.mark.parametrize("build", [pair, weak_grip, lifted], ids=lambda build: build.__name__)
def test_the_field_is_v_plus_omega_cross_r(build):
    twist = build()
    points, drawn = field(plots.plot_escape(twist))
    v, omega = twist.twist[:2], twist.twist[2]
    assert len(points) >= 64
    for r, u in zip(points, drawn, strict=True):
        assert u == pytest.approx([v[0] - omega * r[1], v[1] + omega * r[0]])


def test_contacts_move_with_the_object_and_the_fastest_is_a_quarter_of_the_extent():
    twist = pair()
    ax = plots.plot_escape(twist)
    arrows = [ends(by_gid(ax, f"velocity {name}")[0]) for name in twist.grasp.names]
    np.testing.assert_allclose([a[0] for a in arrows], twist.grasp.positions)
    moved = np.array([a[1] - a[0] for a in arrows])
    fastest = np.hypot(*twist.velocities.T).max()
    np.testing.assert_allclose(moved, twist.velocities * 0.25 * 13 / fastest)


def test_the_centre_is_marked_where_it_is_in_sight():
    twist = pair()
    ax = plots.plot_escape(twist)
    (mark,) = by_gid(ax, "centre")
    np.testing.assert_allclose(np.ravel(mark.get_data()), [4.13793, -5.7931], rtol=1e-5)
    tail, head = ends(by_gid(ax, "sense")[0]) - twist.centre
    assert tail[0] * head[1] - tail[1] * head[0] > 0  # counter-clockwise
    assert not by_gid(ax, "towards centre")


def test_a_far_centre_is_pointed_to_and_written():
    near = pair()
    far = rg.EscapeTwist(near.grasp, near.load, [1.0, -0.3, 0.01], (0.3, 0.3), (inf, inf))
    ax = plots.plot_escape(far)
    tail, head = ends(by_gid(ax, "towards centre")[0])
    to = far.centre - tail
    assert (head - tail) @ to == pytest.approx(np.linalg.norm(head - tail) * np.linalg.norm(to))
    assert "centre at (30, 100)" in texts(ax)
    assert not by_gid(ax, "centre")
    assert ax.get_xlim()[1] < 30


def test_a_translation_has_no_centre():
    ax = plots.plot_escape(lifted())
    assert not by_gid(ax, "centre")
    assert not by_gid(ax, "towards centre")
    assert ax.get_title(loc="left").startswith("escapes sliding")


def test_contacts_that_cannot_oppose_differ_in_colour_marker_and_label():
    ax = plots.plot_escape(weak_grip())
    (index,), (thumb,) = by_gid(ax, "helpless index"), by_gid(ax, "opposes thumb")
    assert not by_gid(ax, "helpless thumb")
    assert not by_gid(ax, "opposes index")
    assert (index.get_marker(), index.get_color()) == ("X", PALETTE[1])
    assert (thumb.get_marker(), thumb.get_color()) == ("o", PALETTE[0])
    most = weak_grip().resistances[0]
    assert {f"thumb\n\N{LESS-THAN OR EQUAL TO} {most:.3g} N m", "index"} <= texts(ax)
    keys = [text.get_text() for text in ax.get_legend().get_texts()]
    assert keys == ["motion", "cannot oppose", "opposes too little"]


def test_the_title_sets_the_load_against_the_contacts():
    twist = weak_grip()
    assert plots.plot_escape(twist).get_title(loc="left").splitlines() == [
        "escapes turning counter-clockwise",
        f"the load does {twist.drive:.3g} N m of work per rad",
        f"the contacts oppose at most {sum(twist.resistances):.3g} N m",
    ]
    assert "the contacts oppose nothing" in plots.plot_escape(pair()).get_title(loc="left")
    assert "does not escape" in plots.plot_escape(lifted((0.0, -1.0, 0.0))).get_title(loc="left")


def test_force_and_torque_of_the_load_are_drawn():
    twist = weak_grip()
    ax = plots.plot_escape(twist)
    tail, head = ends(by_gid(ax, "load")[0])
    np.testing.assert_allclose(tail, 0)
    np.testing.assert_allclose((head - tail) / np.linalg.norm(head - tail), [0, -1])
    tail, head = ends(by_gid(ax, "load torque")[0])
    assert tail[0] * head[1] - tail[1] * head[0] > 0
    assert not by_gid(plots.plot_escape(pair()), "load torque")


@pytest.mark.parametrize(("length", "force"), [(1e-6, 1e6), (1e6, 1.0)])
def test_the_picture_is_one_in_any_unit(length, force):
    one, other = (plots.plot_escape(pair(*units)) for units in ((), (length, force)))
    (points, u), (scaled, w) = field(one), field(other)
    np.testing.assert_allclose(scaled / length, points, atol=1e-6)
    cosines = (u * w).sum(axis=1) / np.linalg.norm(u, axis=1) / np.linalg.norm(w, axis=1)
    assert cosines == pytest.approx(1, abs=1e-6)


def test_it_draws_on_the_axes_it_is_given_with_the_units_named():
    ax = Figure().add_subplot()
    assert plots.plot_escape(weak_grip(), ax, units=plots.Units("mm", "kN")) is ax
    assert (ax.get_xlabel(), ax.get_ylabel(), ax.get_aspect()) == ("$x$ [mm]", "$y$ [mm]", 1)
    assert "kN mm of work per rad" in ax.get_title(loc="left")
    plots.plot_escape(lifted(), ax, units=plots.Units("mm", "kN"))
    assert "kN of work per mm" in ax.get_title(loc="left")


def test_notebooks_picture_the_certificate_they_catch():
    assert pair()._repr_png_().startswith(b"\x89PNG\r\n\x1a\n")


def test_an_escape_in_space_is_pictured_on_axes_in_space_only():
    sides = [rg.Contact([1, 0, 0], [-1, 0, 0], 0.5), rg.Contact([-1, 0, 0], [1, 0, 0], 0.5)]
    load = rg.Wrench([0, 0, 0], [2.0, 0, 0])
    spin = rg.EscapeTwist(rg.Grasp(sides), load, [0, 0, 0, 1.0, 0, 0], (0.5, 0.5), (inf, inf))
    with pytest.raises(rg.InvalidInput, match="ax must be 3-D for a grasp in space"):
        plots.plot_escape(spin, Figure().add_subplot())
    assert spin._repr_png_().startswith(b"\x89PNG\r\n\x1a\n")

"""Regions around contacts: every choice within holds, and a little outside some choice does not."""

import re
from dataclasses import replace
from itertools import product

import numpy as np
import pytest

import regrasp as rg
from refusals import refusal

pytestmark = pytest.mark.laws

BRACKET = rg.Outline([[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]])
RING = rg.LoadSet.hull(rg.Wrench([np.cos(t), np.sin(t)]) for t in np.arange(5) * 2 * np.pi / 5)
GRASP = rg.Grasp(
    BRACKET.contact_at(s, friction=0.5, name=name) for s, name in ((2.0, "a"), (5.9, "b"), (9.6, "c"))
)


def holds(places: np.ndarray, limit: float, load: rg.Wrench) -> bool:
    grasp = rg.Grasp(BRACKET.contact_at(s, friction=0.5) for s in places)
    try:
        rg.choose_state(grasp, load, "peak", max_force=limit)
    except rg.Infeasible:
        return False
    return True


def test_every_choice_within_regions_holds_and_corners_are_the_limit() -> None:
    regions = rg.contact_regions(BRACKET, GRASP, RING)
    assert rg.verify(regions).ok
    assert regions.half_width > 0.05
    vertices = RING.vertices
    assert vertices is not None
    loads = [rg.Wrench.from_vector(v) for v in vertices]
    rng = np.random.default_rng(2)
    for _ in range(40):
        places = rng.uniform(regions.arcs[:, 0], regions.arcs[:, 1])
        assert all(holds(places, regions.max_force * (1 + 1e-6), load) for load in loads)
    wider = regions.half_width * 1.01
    ends = np.clip(
        regions.places[:, None] + [-wider, wider], [[0.001], [5.001], [8.001]], [[3.999], [7.999], [9.999]]
    )
    assert not all(
        holds(np.array(corner), regions.max_force, load) for corner in product(*ends) for load in loads
    )


def test_a_load_in_the_middle_of_fingers_is_held_by_the_least_forces() -> None:
    """The largest wrenches of all fingers to either side are in one plane with such a load."""
    for (first, second), friction in product(((0.02, 0.5), (0.1, 0.5), (0.55, 1.2)), (0.2, 0.3, 0.4, 0.7)):
        places = (first, second, 3 * 1.5 - first - second)
        grasp = rg.Grasp(BRACKET.contact_at(s, friction=friction) for s in places)
        regions = rg.contact_regions(BRACKET, grasp, rg.Wrench([0, -1]))
        assert regions.max_force == pytest.approx(3 * 1 / 3, rel=2e-5)


def test_one_finger_alone_goes_farther_than_all_at_once() -> None:
    regions = rg.contact_regions(BRACKET, GRASP, RING)
    room = np.abs(np.array([[0, 4], [5, 8], [8, 10]]) - regions.places[:, None])  # to the ends of the sides
    stopped = regions.alone >= room * (1 - 1e-5)
    assert not stopped.all()
    assert (stopped | (regions.alone >= regions.half_width * (1 - 1e-5))).all()
    i, end = np.unravel_index(int(np.where(stopped, np.inf, regions.alone).argmin()), (3, 2))
    way = (-1, 1)[end]
    vertices = RING.vertices
    assert vertices is not None
    for factor, expected in ((0.999, True), (1.01, False)):
        places = regions.places.copy()
        places[i] += way * factor * regions.alone[i, end]
        found = all(holds(places, regions.max_force, rg.Wrench.from_vector(v)) for v in vertices)
        assert found == expected


def test_more_force_allows_wider_regions() -> None:
    tight = rg.contact_regions(BRACKET, GRASP, RING, max_force=2.2)
    loose = rg.contact_regions(BRACKET, GRASP, RING, max_force=4.0)
    assert 0 < tight.half_width < loose.half_width


def test_widest_by_the_least_arc_and_by_the_product_are_no_narrower_than_any_seen() -> None:
    """Against all intervals between points of a grid, whose corners are looked up."""
    tilted = rg.LoadSet.hull([rg.Wrench([0, -1], 0.1), rg.Wrench([0.6, -1]), rg.Wrench([-0.2, -1])])
    grasp = rg.Grasp(BRACKET.contact_at(s, friction=0.5, name=n) for s, n in ((1.0, "a"), (9.1, "b")))
    found = {
        w: rg.contact_regions(BRACKET, grasp, tilted, widest=w) for w in ("together", "least", "product")
    }
    limit = found["least"].max_force
    vertices = tilted.vertices
    assert vertices is not None
    rows = [np.linspace(0.01, 3.99, 14), np.linspace(8.01, 9.99, 11)]
    at = [int(np.abs(row - p).argmin()) for row, p in zip(rows, (1.0, 9.1), strict=True)]
    good = np.array(
        [
            [all(holds(np.array([a, b]), limit, rg.Wrench.from_vector(v)) for v in vertices) for b in rows[1]]
            for a in rows[0]
        ]
    )
    least = most = 0.0
    for a, b in product(range(at[0] + 1), range(at[0], 14)):
        for c, d in product(range(at[1] + 1), range(at[1], 11)):
            if good[a, c] and good[a, d] and good[b, c] and good[b, d]:
                wide = rows[0][b] - rows[0][a], rows[1][d] - rows[1][c]
                least, most = max(least, min(wide)), max(most, wide[0] * wide[1])
    assert most > 0
    assert found["least"].widths.min() >= least * 0.99
    assert found["product"].widths.prod() >= most * 0.99
    assert found["least"].widths.min() >= found["together"].widths.min() * (1 - 1e-5)
    assert found["product"].widths.prod() >= found["together"].widths.prod() * (1 - 1e-5)
    assert all(rg.verify(regions).ok for regions in found.values())


def test_regions_that_claim_too_much_are_not_verified() -> None:
    good = rg.contact_regions(BRACKET, GRASP, RING)
    arcs = np.array(good.arcs)
    arcs[0, 1] += 0.01
    for wrong, words in (
        (replace(good, arcs=arcs), "missing"),
        (replace(good, corners=good.corners[1:]), "missing"),
        (replace(good, max_force=1.0), "above"),
        (replace(good, corners=()), "no corner"),
        (replace(good, arcs=np.array([[3.5, 4.5], *good.arcs[1:].tolist()])), "one straight side"),
    ):
        assert any(words in v for v in rg.verify(wrong).violations), words


def test_what_has_no_regions_is_refused() -> None:
    with pytest.raises(rg.Infeasible, match=r"above max_force 0\.5 N"):
        rg.contact_regions(BRACKET, GRASP, RING, max_force=0.5)
    for more, words in (
        ({"shape": rg.Outline.ellipse(2, 1)}, "is not on the outline"),
        ({"load": rg.Wrench([0, 0])}, "max_force"),
        ({"widest": "largest"}, "together, least, product"),
        ({"grasp": rg.Grasp([rg.Contact([9, 9], [1, 0], 0.5), rg.Contact([0, 0], [1, 0], 0.5)])}, "no side"),
    ):
        asked = {"shape": BRACKET, "grasp": GRASP, "load": RING} | more
        assert words in str(refusal(lambda asked=asked: rg.contact_regions(**asked)))


ELLIPSE = rg.Outline.ellipse(2, 1)
BOX = rg.Mesh.box(0.04, 0.03, 0.05)
SHAPES = [
    (BRACKET, [BRACKET.contact_at(s, friction=0.4) for s in (0.3, 0.5, 3.98)], rg.Wrench([0, -1])),
    (ELLIPSE, [ELLIPSE.contact_at(s, friction=0.6) for s in (0.5, 3.8, 6.7)], rg.Wrench([0, -1])),
    (BOX, [BOX.contact_at([x, y, -0.025], friction=0.5) for x, y in ((0.01, 0.01), (-0.01, 0.01), (0, -.01))],
     rg.Wrench([0, 0, -2])),
]  # fmt: skip


@pytest.mark.parametrize(("shape", "contacts", "load"), SHAPES)
def test_contacts_given_in_few_digits_are_moved_to_the_boundary(
    shape: rg.Outline | rg.Mesh, contacts: list[rg.Contact], load: rg.Wrench
) -> None:
    rng = np.random.default_rng(3)
    size = 3e-7 * float(np.abs([c.position for c in contacts]).max())

    def off(of: np.ndarray, by: float) -> np.ndarray:
        result: np.ndarray = of + by * rng.uniform(-0.5, 0.5, of.shape)
        return result

    given = rg.Grasp(
        rg.Contact(off(c.position, size), off(c.normal, 1e-7), c.friction, name=c.name) for c in contacts
    )
    regions = rg.contact_regions(shape, given, load)
    assert rg.verify(regions).ok, rg.verify(regions)
    assert np.abs(regions.grasp.positions - given.positions).max() <= size


def test_limits_of_contacts_are_kept() -> None:
    """The least of them counts for all fingers."""
    shape, contacts, load = SHAPES[0]
    free = rg.contact_regions(shape, rg.Grasp(contacts), load)
    least = free.max_force / 3
    limited = rg.Grasp([contacts[0], contacts[1].changed(max_force=2 * least), contacts[2]])
    regions = rg.contact_regions(shape, limited, load, max_force=2.5 * least)
    assert regions.max_force == pytest.approx(2 * least, rel=1e-5)
    assert regions.max_force <= 2 * least
    assert rg.verify(regions).ok
    assert rg.contact_regions(shape, limited, load, max_force=1.5 * least).max_force <= 1.5 * least
    claimed = replace(free, grasp=rg.Grasp(c.changed(max_force=2.9 * least) for c in free.grasp))
    assert "above the max_force of P1" in str(rg.verify(claimed))
    claimed = replace(free, grasp=rg.Grasp(c.changed(max_force=free.max_force) for c in free.grasp))
    assert rg.verify(claimed).ok
    limits = rg.ForceLimits([[1.0, 0.0]], [free.max_force])
    claimed = replace(free, grasp=rg.Grasp(c.changed(limits=limits) for c in free.grasp))
    assert "P1 has linear limits, which regions do not keep" in str(rg.verify(claimed))
    tight = rg.Grasp([*contacts[:2], contacts[2].changed(max_force=0.99 * least)])
    with pytest.raises(rg.Infeasible, match="above max_force"):
        rg.contact_regions(shape, tight, load)


@pytest.mark.parametrize(
    ("places", "friction", "load", "words"),
    [
        ((2.0, 6.0, 14.0), 0.0, rg.Wrench([0, -1]), "on a knife's edge"),  # the first is in the middle
        ((2.5, 3.0), 0.0, rg.Wrench([0, -1]), "does not hold the loads, not Wrench(force=(0, -1)"),
        ((1.0, 3.0), 0.3, rg.Wrench([0.5, -1], -1.0), "does not hold the loads, not Wrench(force=(0.5, -1)"),
    ],
)
def test_what_is_not_held_and_what_is_held_on_an_edge_alone_are_told_apart(
    places: tuple[float, ...], friction: float, load: rg.Wrench, words: str
) -> None:
    square = rg.Outline([[0, 0], [4, 0], [4, 4], [0, 4]])
    grasp = rg.Grasp(square.contact_at(s, friction=friction) for s in places)
    if "edge" in words:
        assert rg.choose_state(grasp, load, "peak").value > 0
    with pytest.raises(rg.Infeasible, match=re.escape(words)):
        rg.contact_regions(square, grasp, load)


def test_a_side_that_ends_is_said() -> None:
    short = rg.Outline([[0, 0], [4, 0], [4.3, 0.3], [4.3, 3], [0, 3]])
    places = (2.0, 4.2, 8.7)
    grasp = rg.Grasp(short.contact_at(s, friction=0.9, name=f"{s:g}") for s in places)
    regions = rg.contact_regions(short, grasp, rg.Wrench([0.0, -1.0]), max_force=9.0)
    assert regions.ended[1].all()
    assert "or to the end of the side" in repr(regions)
    side = (4.0, 4.0 + np.hypot(0.3, 0.3))
    assert regions.arcs[1] == pytest.approx(side, abs=1e-5)
    assert max(abs(regions.arcs[1] - places[1])) < regions.half_width
    assert "end of the side" not in repr(replace(regions, half_width=0.01))


def test_a_half_width_of_none_is_not_said() -> None:
    said = repr(replace(rg.contact_regions(BRACKET, GRASP, RING), half_width=0.0))
    assert said.startswith("ContactRegions(widths ")


def test_more_loads_than_corners_have_states_for_are_refused_before_any_work() -> None:
    angles = np.arange(2049) * 2 * np.pi / 2049
    many = rg.LoadSet.hull(rg.Wrench([np.cos(t), np.sin(t)]) for t in angles)
    said = refusal(lambda: rg.contact_regions(BRACKET, GRASP, many))
    assert str(said).startswith("regions of 3 fingers are proven under 2048 loads at most")
    assert str(said).endswith("got 2049: give fewer whose hull contains them")
    box = rg.Mesh.box(4, 3, 5)
    three = (([2, 0, 0], [-1, 0, 0]), ([-2, 1, 0], [1, 0, 0]), ([-2, -1, 0], [1, 0, 0]))
    grasp = rg.Grasp(rg.Contact(point, normal, 0.5) for point, normal in three)
    many = rg.LoadSet.hull(rg.Wrench([np.cos(t), np.sin(t), 0]) for t in angles[:129])
    assert "under 128 loads at most" in str(refusal(lambda: rg.contact_regions(box, grasp, many)))

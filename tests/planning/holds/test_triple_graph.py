"""The triple graph: millions at once are the same as one at a time; order, filters, memory and refusals."""

from itertools import combinations, pairwise
from math import atan, inf

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import regrasp as rg
from regrasp.closed_form.compiled import triples
from regrasp.closed_form.three_fingers import HOLDS, LINE, three_finger_hold
from regrasp.planning.holds.triples import TripleGraph, directions
from solids import Motion, motions

pytestmark = pytest.mark.oracle


def candidates(seed: int, count: int, *, limited: bool = False, friction: float | None = None):
    """Contacts on an ellipsoid that look along its normals."""
    rng = np.random.default_rng(seed)
    axes = np.array([1.0, 0.8, 0.5])
    on_ball = rng.normal(size=(count, 3))
    on_ball /= np.linalg.norm(on_ball, axis=1)[:, None]
    return tuple(
        rg.Contact(
            p * axes, -p / axes, rng.uniform(0.2, 0.9) if friction is None else friction,
            max_force=rng.uniform(0.4, 3) if limited and i % 3 else None,
        )
        for i, p in enumerate(on_ball)
    )  # fmt: skip


def with_torques(seed: int, count: int) -> np.ndarray:
    loads = directions(count)
    loads[:, 3:] = 0.2 * np.random.default_rng(seed).normal(size=(count, 3))
    return loads


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 10**6), st.booleans(), st.sampled_from([4, 6, 8, 16]))
def test_all_at_once_is_the_same_as_one_at_a_time(seed: int, limited: bool, facets: int) -> None:
    graph = TripleGraph(candidates(seed, 6, limited=limited), with_torques(seed, 9), facets=facets)
    for t, places in enumerate(graph.triples.tolist()):
        for o, load in enumerate(graph.loads.tolist()):
            found, margin, _ = three_finger_hold(
                graph.fingers(places), tuple(load[:3]), tuple(load[3:]), facets, graph.peak_ratio
            )
            table = graph.margins[o, t]
            if found == HOLDS:
                assert table == pytest.approx(atan(margin), abs=1e-6)
            else:
                assert table == -found


def test_holds_are_the_margins_that_are_not_negative() -> None:
    contacts, loads = candidates(3, 12), with_torques(3, 150)
    quick, full = TripleGraph(contacts, loads), TripleGraph(contacts, loads)
    margins = full.margins
    assert quick.holds.dtype == bool
    assert (quick.holds == (margins >= 0)).all()
    assert (full.holds == quick.holds).all()
    assert 0.05 < quick.holds.mean() < 0.95
    assert (margins[margins < 0] == -1).all()


def test_margins_are_the_same_before_anything_is_compiled(monkeypatch) -> None:
    """The first of a process are interpreted, as long as there is patience and no compiled code."""
    graphs = [
        TripleGraph(candidates(7, 7, limited=True), with_torques(7, 6), facets=6, min_distance=0.3)
        for _ in range(2)
    ]
    expected = graphs[0].margins
    monkeypatch.setattr("regrasp.closed_form.compiled.sharing.at_hand", lambda loop: False)  # none is kept
    monkeypatch.setattr(triples, "_asked", 0)
    assert (graphs[1].margins == expected).all()
    assert triples._asked == expected.size
    assert {-2.0, -1.0} <= set(expected[expected < 0].tolist())


def test_the_order_of_loads_changes_no_verdict() -> None:
    contacts, loads = candidates(4, 10), with_torques(4, 80)
    order = np.random.default_rng(0).permutation(80)
    there, back = TripleGraph(contacts, loads).margins, TripleGraph(contacts, loads[order]).margins
    assert abs(there[order] - back).max() < 1e-6


@pytest.mark.parametrize("limited", [False, True])
def test_states_are_states_with_their_margin(limited: bool) -> None:
    graph = TripleGraph(candidates(5, 8, limited=limited), with_torques(5, 20))
    held = np.argwhere(graph.margins >= 0)
    assert len(held) > 50
    for o, t in held[:: len(held) // 40].tolist():
        state = graph.state(t, o)
        assert [tuple(c.position) for c in state.grasp] == [
            tuple(graph.contacts[i].position) for i in graph.triples[t]
        ]
        assert state.residual <= 2.0**-38 * np.linalg.norm(state.forces, axis=1).max()
        assert np.nanmin(state.margins.angle) >= graph.margins[o, t] - 1e-7
        limits = [inf if c.max_force is None else c.max_force for c in state.grasp]
        assert (np.linalg.norm(state.forces, axis=1) <= limits).all()
        exact = rg.choose_state(state.grasp, state.load, "angle", peak_ratio=1.2 * graph.peak_ratio)
        assert np.nanmin(exact.margins.angle) >= graph.margins[o, t] - 1e-6


def test_more_facets_come_close_to_the_exact_margin() -> None:
    contacts, loads = candidates(6, 6, friction=0.5), directions(12)
    contacts = tuple(rg.Contact(c.position, c.normal, c.friction, max_force=2.0) for c in contacts)
    graphs = [TripleGraph(contacts, loads, facets=m) for m in (4, 8, 16, 32)]
    for coarse, fine in pairwise(graphs):
        assert (fine.margins >= coarse.margins - 1e-6).all()
    held = np.argwhere(graphs[-1].margins >= 0)
    assert len(held) > 20
    for o, t in held[::7].tolist():
        state = graphs[-1].state(t, o)
        exact = np.nanmin(rg.choose_state(state.grasp, state.load, "angle").margins.angle)
        assert graphs[-1].margins[o, t] <= exact + 1e-6
        assert np.nanmin(state.margins.angle) >= graphs[-1].margins[o, t] - 1e-7


@settings(deadline=None)
@given(motions())
def test_another_frame_and_unit_give_the_same_table(motion: Motion) -> None:
    contacts, loads = candidates(7, 9), with_torques(7, 30)
    moved = tuple(
        rg.Contact(motion.scale * motion.rotation @ c.position, motion.rotation @ c.normal, c.friction)
        for c in contacts
    )
    turned = np.hstack([loads[:, :3] @ motion.rotation.T, motion.scale * loads[:, 3:] @ motion.rotation.T])
    assert abs(TripleGraph(contacts, loads).margins - TripleGraph(moved, turned).margins).max() < 1e-6


@pytest.mark.parametrize("count", [3, 4, 7, 12])
def test_triples_stand_in_lexicographic_order(count: int) -> None:
    graph = TripleGraph(candidates(0, count), directions(1))
    assert graph.triples.tolist() == [list(t) for t in combinations(range(count), 3)]
    for place, (i, j, k) in enumerate(combinations(range(count), 3)):
        assert graph.triple(i, j, k) == graph.triple(k, i, j) == place


def test_a_sample_of_triples_has_the_margins_of_the_whole() -> None:
    contacts, loads = candidates(8, 10), directions(20)
    whole = TripleGraph(contacts, loads)
    chosen = whole.triples[::7]
    some = TripleGraph(contacts, loads, among=chosen)
    assert (some.triples == chosen).all()
    assert abs(some.margins - whole.margins[:, ::7]).max() < 1e-6
    assert some.triple(*chosen[3].tolist()) == 3
    with pytest.raises(rg.InvalidInput, match=r"\(0, 1, 3\) is not one of those"):
        some.triple(0, 1, 3)


def test_filters_keep_triples_out() -> None:
    contacts, loads = candidates(9, 10), directions(15)
    points = np.array([c.position for c in contacts])
    free = TripleGraph(contacts, loads)
    apart = TripleGraph(contacts, loads, min_distance=0.7)
    high = TripleGraph(contacts, loads, keep=lambda a, b, c: np.maximum(a, np.maximum(b, c))[:, 2] > 0.2)
    for t, places in enumerate(free.triples.tolist()):
        corners = points[places]
        near = min(np.linalg.norm(a - b) for a, b in combinations(corners, 2)) < 0.7
        assert (apart.margins[:, t] == (-2 if near else free.margins[:, t])).all()
        low = corners[:, 2].max() <= 0.2
        assert (high.margins[:, t] == (-2 if low else free.margins[:, t])).all()
    o, t = np.argwhere((free.margins >= 0) & (apart.margins == -2))[0]
    assert free.forces(t, o).shape == (3, 3)
    with pytest.raises(rg.InvalidInput, match="does not hold load"):
        apart.forces(t, o)


def test_collinear_contacts_are_no_hold() -> None:
    line = [rg.Contact([x, 0, 0], [-x, 0, 0.1], 0.8) for x in (-1.0, 0.5, 1.0)]
    graph = TripleGraph((*line, rg.Contact([0, 1, 0], [0, -1, 0], 0.8)), directions(5))
    assert (graph.margins[:, graph.triple(0, 1, 2)] == -LINE).all()
    assert not graph.holds[:, graph.triple(0, 1, 2)].any()
    assert (graph.margins[:, graph.triple(0, 1, 3)] != -LINE).all()


def test_directions_are_spread_evenly() -> None:
    loads = directions(400, size=2.5)
    assert np.linalg.norm(loads[:, :3], axis=1) == pytest.approx(2.5)
    assert not loads[:, 3:].any()
    assert abs(loads.mean(axis=0)).max() < 0.01
    unit = loads[:, :3] / 2.5
    nearest = np.sort(np.arccos(np.clip(unit @ unit.T, -1, 1)), axis=1)[:, 1]
    assert nearest.min() > 0.5 * np.sqrt(4 * np.pi / 400)


BAD = [
    ({"contacts": candidates(0, 2)}, "needs three contacts in space"),
    ({"contacts": (rg.Contact([0, 1], [0, -1], 0.5),) * 3}, "needs three contacts in space"),
    ({"loads": np.zeros((2, 6))}, "no load may be zero"),
    ({"loads": np.ones((2, 3))}, r"loads must have shape \(any, 6\), got \(2, 3\)"),
    ({"facets": 5}, "facets must be an even whole number of at least 4, got 5"),
    ({"facets": 2}, "facets must be a whole number of at least 4, got 2"),
    ({"facets": 8.0}, "facets must be a whole number of at least 4, got 8.0"),
    ({"peak_ratio": 0.5}, "peak_ratio must be at least 1"),
    ({"reserve": 1.0}, "reserve must be less than 1"),
    ({"min_distance": -1.0}, "min_distance must be at least 0"),
]


@pytest.mark.parametrize(("change", "text"), BAD, ids=[f"{t}" for _, t in BAD])
def test_bad_graphs_are_refused(change: dict, text: str) -> None:
    with pytest.raises(rg.InvalidInput, match=text):
        TripleGraph(**{"contacts": candidates(0, 4), "loads": directions(2)} | change)


@pytest.mark.parametrize(
    ("among", "text"),
    [
        ([[0, 1, 4]], "indices of contacts, 0 to 3"),
        ([[0, 1, 2.5]], "indices of contacts"),
        ([[0, 2, 1]], "rising, i < j < k"),
        ([[0, 1]], "must have shape"),
    ],
)
def test_bad_samples_are_refused(among: list, text: str) -> None:
    graph = TripleGraph(candidates(0, 4), directions(2), among=among)
    with pytest.raises(rg.InvalidInput, match=text):
        _ = graph.triples


def test_tables_that_are_too_large_are_refused_before_they_are_made() -> None:
    graph = TripleGraph(candidates(0, 10), directions(10), most_bytes=1000)
    with pytest.raises(rg.InvalidInput, match=r"120 triples under 10 loads need .* allow more by most_bytes"):
        _ = graph.margins
    with pytest.raises(rg.InvalidInput, match="more than"):
        _ = graph.holds
    assert TripleGraph(candidates(0, 10), directions(10), most_bytes=1200).holds.shape == (10, 120)


@pytest.mark.parametrize("places", [(0, 1, 1), (0, 1, 4), (-1, 1, 2)])
def test_a_triple_is_three_contacts_of_the_graph(places: tuple[int, int, int]) -> None:
    with pytest.raises(rg.InvalidInput, match="three different contacts of 0 to 3"):
        TripleGraph(candidates(0, 4), directions(2)).triple(*places)


@pytest.mark.parametrize("count", [0, -1, 2.0, True])
def test_directions_need_a_number(count) -> None:
    with pytest.raises(rg.InvalidInput, match="count must be a whole number"):
        directions(count)

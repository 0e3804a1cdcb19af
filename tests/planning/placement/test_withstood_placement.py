"""What set-points withstand wherever fingers are: against sampled placements, and what ``verify`` catches."""

import json
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

import regrasp as rg
from placements import BRACKET, DEVIATIONS
from regrasp.planning.placement.levels.known_duals import KnownDuals
from regrasp.planning.placement.levels.tied import Ties
from regrasp.planning.placement.levels.tied_boxes import Boxes, Corners
from regrasp.planning.placement.levels.withstood import WithstoodLevel
from regrasp.planning.placement.proofs.placement_proof import PlacementProof
from regrasp.planning.placement.reachable import sides_of
from regrasp.planning.placement.search import Search
from regrasp.planning.placement.sliding import moved_past

pytestmark = pytest.mark.oracle

WEIGHT = rg.Wrench([0, -1])
ASKED = {"friction": 0.5, "objective": "wrench", "disturbance": DEVIATIONS, "max_force": 3.0}


def withstood(grasp: rg.Grasp) -> float:
    assert DEVIATIONS.vertices is not None
    about = rg.LoadSet.hull(map(rg.Wrench.from_vector, DEVIATIONS.vertices), center=rg.Wrench([0, 0]))
    try:
        return rg.choose_state(grasp, WEIGHT, "wrench", disturbance=about, max_force=3.0).value
    except rg.Infeasible:
        return 0.0


@pytest.mark.parametrize(
    ("shape", "fingers", "count"),
    [(BRACKET, 3, 8), (rg.Outline.ellipse(2, 1), 2, 6)],
    ids=["three on the bracket", "ellipse"],
)
def test_no_sampled_placement_withstands_more(shape: rg.Outline, fingers: int, count: int) -> None:
    chosen = rg.choose_grasp(shape, fingers, WEIGHT, tolerance=0.05, **ASKED)
    contacts = [shape.contact_at(s, friction=0.5) for s in shape.sample(count)]
    sampled = max(withstood(rg.Grasp(few)) for few in combinations(contacts, fingers))
    assert 0 < sampled <= chosen.value <= chosen.bound
    assert withstood(chosen.grasp) == pytest.approx(chosen.value, rel=1e-6)
    assert chosen.gap <= 0.05
    again = rg.ChosenGrasp.from_dict(json.loads(json.dumps(chosen.to_dict())))
    assert again == chosen
    assert rg.verify(again).ok


def test_what_was_touched_is_seen() -> None:
    chosen = rg.choose_grasp(BRACKET, 2, WEIGHT, tolerance=0.01, **ASKED)
    assert chosen.deviations is not None
    first, second, *rest = chosen.states
    # as much of a squeeze keeps balance, and is no answer of springs
    along = np.diff(first.grasp.positions, axis=0)[0]
    squeezed = replace(second, forces=second.forces - 1e-4 * np.array([-along, along]))
    for wrong in (
        replace(chosen, value=1.001 * chosen.value),
        replace(chosen, bound=chosen.value),
        replace(chosen, states=(first, squeezed, *rest)),
        replace(chosen, states=(second, first, *rest)),
        replace(chosen, states=(first, *rest)),
        replace(chosen, states=()),
        replace(chosen, deviations=None),
        replace(chosen, deviations=0.99 * chosen.deviations),
    ):
        assert not rg.verify(wrong).ok


def test_every_number_of_duals_counts() -> None:
    chosen = rg.choose_grasp(BRACKET, 2, WEIGHT, tolerance=0.05, **ASKED)
    proof = chosen.certificate
    assert isinstance(proof, PlacementProof)
    assert proof.tied is not None
    assert rg.verify(proof).ok
    assert "equal stiffness" in str(rg.verify(proof))
    data = proof.to_dict()
    assert PlacementProof.from_dict(json.loads(json.dumps(data))) == proof
    row = proof.tied.copy()
    row[0, -1] *= 1 + 1e-12
    with pytest.raises(rg.InvalidInput, match="digest"):
        PlacementProof.from_dict({**data, "tied": row.tolist()})
    for i in range(0, row.shape[1], 6):  # of a twist, or of a tie: another is no bound
        row = proof.tied.copy()
        row[:, i] += np.abs(row).max()
        assert "do not exclude it" in str(rg.verify(replace(proof, tied=row)))
    wider = proof.ends.copy()
    box = int(np.flatnonzero(proof.number == -2)[0])
    wider[box, 0, 0] += 1e-9
    for wrong in (
        replace(proof, ends=wider),
        replace(proof, tied=None),
        replace(proof, tied=proof.tied[:-1]),
        replace(proof, tied=proof.tied[:, :-1]),
        replace(proof, tied=0.0 * proof.tied),
        replace(proof, bound=1.2 * proof.bound),
        replace(proof, size="normal"),
        replace(proof, arcs=np.where(proof.number[:, None, None] < -1, [0, 7], proof.arcs)),
    ):
        assert not rg.verify(wrong).ok
    answered = replace(chosen, objective="answered")
    assert "tied by stiffness" in str(rg.verify(answered))


def test_a_set_without_zero_is_scaled_about_no_deviation() -> None:
    pushes = rg.LoadSet.hull([rg.Wrench([0.1, -0.1]), rg.Wrench([-0.1, -0.1])])
    chosen = rg.choose_grasp(BRACKET, 2, WEIGHT, tolerance=0.01, **ASKED | {"disturbance": pushes})
    assert rg.verify(chosen).ok
    assert chosen.states[1].load.vector == pytest.approx([0.1 * chosen.value, -1 - 0.1 * chosen.value, 0])


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"disturbance": None}, "go together"),
        ({"max_force": None}, "needs max_force"),
        ({"disturbance": rg.LoadSet.ball(rg.Wrench([0, 0]), force=1)}, r"LoadSet\.hull"),
    ],
)
def test_what_it_needs_it_says(more: dict[str, object], words: str) -> None:
    with pytest.raises(rg.InvalidInput, match=words):
        rg.choose_grasp(BRACKET, 2, WEIGHT, **ASKED | more)  # type: ignore[arg-type]


def test_a_map_of_what_is_withstood_has_what_set_points_withstand_in_each_cell() -> None:
    found = rg.placement_map(BRACKET, WEIGHT, count=10, **ASKED)  # type: ignore[arg-type]
    held = 0
    for i, s in enumerate(found.places):
        for j, t in enumerate(found.places[:i]):
            wanted = withstood(rg.Grasp(BRACKET.contact_at(v, friction=0.5) for v in (s, t)))
            if wanted > 0:
                held += 1
                assert found.values[i, j] == pytest.approx(wanted, rel=1e-5, abs=1e-6)
            else:
                assert not found.values[i, j] > 0
    assert held > 3
    assert found.more


@pytest.mark.parametrize(
    ("owner", "name", "call"),
    [
        (Search, "halved", 1), (Search, "halved", 20), (Search, "leave", 3), (Search, "excluded", 40),
        (Ties, "answer", 1), (WithstoodLevel, "state", 4),
    ],
)  # fmt: skip
def test_an_interrupt_leaves_the_best_so_far_with_its_gap(
    owner: type, name: str, call: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    calls, inside = 0, getattr(owner, name)

    def interrupted(*given: object) -> object:
        nonlocal calls
        calls += 1
        done = inside(*given)
        if calls == call:
            raise KeyboardInterrupt
        return done

    monkeypatch.setattr(owner, name, interrupted)
    chosen = rg.choose_grasp(BRACKET, 2, WEIGHT, tolerance=0.02, **ASKED)
    assert calls >= call
    assert 0.02 < chosen.gap < 0.5
    assert rg.verify(chosen).ok


def rounded(corner: float = 0.3, parts: int = 6) -> rg.Outline:
    """A square of 2 with corners of some edges each."""
    angle = np.linspace(0, np.pi / 2, parts + 1)
    arc = 1 - corner + corner * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    turns = [np.array([[np.cos(a), np.sin(a)], [-np.sin(a), np.cos(a)]]) for a in np.arange(4) * np.pi / 2]
    return rg.Outline(np.concatenate([arc @ turn for turn in turns]))


def test_groups_of_edges_are_excluded_at_once() -> None:
    chosen = rg.choose_grasp(rounded(), 2, WEIGHT, tolerance=0.01, **ASKED)
    proof = chosen.certificate
    assert isinstance(proof, PlacementProof)
    assert chosen.gap <= 0.01
    assert rg.verify(chosen).ok
    assert proof.tied is not None
    several = np.flatnonzero((proof.number < -1) & (np.diff(proof.arcs, axis=2)[:, :, 0] > 0).any(axis=1))
    assert len(several) > 0
    assert (proof.number < -1).sum() > len(proof.tied)  # of which some exclude more than one box
    for box in several[:4]:
        finger = int(np.diff(proof.arcs[box], axis=1).argmax())
        for place, step in (0, 1), (1, -1):
            arcs, ends = proof.arcs.copy(), proof.ends.copy()
            arcs[box, finger, place] += step
            assert "not covered" in str(rg.verify(replace(proof, arcs=arcs)))
            ends[box, finger, place] += step * 1e-9
            assert "not covered" in str(rg.verify(replace(proof, ends=ends)))
        tied = proof.tied.copy()
        tied[-2 - proof.number[box]] *= -1
        found = str(rg.verify(replace(proof, tied=tied)))
        same = np.flatnonzero(proof.number == proof.number[box])
        assert any(f"duals of box {other} do not" in found for other in same)


@pytest.mark.parametrize("shape", [rounded(), rg.Outline.ellipse(2, 1)], ids=["edges", "curve"])
def test_duals_of_one_box_bound_placements_in_another(shape: rg.Outline) -> None:
    rng = np.random.default_rng(4)
    sides = sides_of(shape, 1e-3, None, 0.0, False)
    deviations = np.array([[0.1, 0, 0], [-0.1, 0, 0], [0, 0, 0.05]])
    ties = Ties(3, np.array([0, -0.3, 0]), deviations)
    boxes, known = Boxes(sides, 0.5), KnownDuals(ties)

    def box(span: int) -> tuple[np.ndarray, np.ndarray, Corners]:
        first = np.sort(rng.integers(0, len(sides.ends) - span, 3))
        arcs = np.stack([first, first + span - 1], axis=1)
        ends = np.stack([sides.ends[arcs[:, 0], 0], sides.ends[arcs[:, 1], 1]], axis=1)
        corners = boxes.corners(arcs, ends)
        assert corners is not None
        return arcs, ends, corners

    for _ in range(8):
        _, _, corners = box(1)
        points, rays, _ = corners.at(corners.outermost)
        found = ties.answer(points, rays)
        if found is not None:
            known.add(found.duals, corners.middle)
    met = 0
    for _ in range(20):
        arcs, ends, corners = box(2)
        bounds = [known.factor(corners, n)[0] for n in range(len(known.rows))]
        places = arcs[range(3), rng.integers(0, 2, 3)]
        inside = np.clip(sides.ends[places], ends[:, :1], ends[:, 1:])
        u = rng.uniform(*inside.T)
        at = boxes.corners(np.stack([places, places], axis=1), np.stack([u, u], axis=1))
        assert at is not None
        found = ties.answer(*at.at(np.zeros((1, 3), int))[:2])
        if found is None or found.factor < 0:
            continue
        met += 1
        assert found.factor <= min(bounds) * (1 + 1e-6)
        for factor in 0.999 * min(bounds), 1.001 * min(bounds):
            n = known.excluding(corners, factor)
            assert (n >= 0) == (factor > min(bounds))
            assert n < 0 or known.factor(corners, n)[0] <= factor
    assert met > 3


@pytest.mark.parametrize("shape", [BRACKET, rg.Outline.ellipse(2, 1)], ids=["bracket", "ellipse"])
def test_fingers_slide_past_the_ends_of_their_sides(shape: rg.Outline) -> None:
    sides = sides_of(shape, 0.0)
    places, u = np.array([0, len(sides.edges) - 1]), np.array([sides.ends[0, 0], sides.ends[-1].mean()])
    before = np.array([sides.arc_length(int(on), at) for on, at in zip(places, u, strict=True)])
    way = np.array([-0.31, 0.44])
    on, at = moved_past(sides, places, u, way)
    after = np.array([sides.arc_length(int(i), v) for i, v in zip(on, at, strict=True)])
    gone = (after - before) / shape.length - way
    # along a cubic u is not proportional to the length
    assert np.abs(gone - np.round(gone)).max() < (1e-12 if shape is BRACKET else 1e-3)
    assert (on != places).all()
    assert ((sides.ends[on, 0] <= at) & (at <= sides.ends[on, 1])).all()

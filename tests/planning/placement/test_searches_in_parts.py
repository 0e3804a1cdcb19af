"""Large searches in parts, on one thread and on more: the same answer and proof; and all of it is told."""

import signal
from _thread import interrupt_main
from threading import Timer
from typing import Any

import numpy as np
import pytest

import regrasp as rg
from regrasp.outline.parts import gear
from regrasp.planning.placement import parts, sliding
from regrasp.planning.placement.levels import climbing
from regrasp.planning.placement.levels.rounds import Rounds
from regrasp.planning.placement.search import Search

pytestmark = pytest.mark.laws

C = rg.Outline([(0, 0), (3, 0), (3, 1), (1, 1), (1, 4), (3, 4), (3, 5), (0, 5)])
LOADS = rg.LoadSet.hull(
    [
        rg.Wrench.from_vector([np.cos(a), np.sin(a), m])
        for a in np.arange(6) * np.pi / 3
        for m in (0.15, -0.15)
    ]
)

GEAR = gear()
IN_SPACE = rg.LoadSet.hull([rg.Wrench([x, y, -1.8]) for x, y in ((0.5, 0), (-0.5, 0), (0, 0.5))])
TRIANGLE = rg.Outline([(1, 0.6), (-0.9, 0), (-0.4, -0.9)])
ELLIPSE = rg.Outline.ellipse(2, 1)
MOST = 7000


def chosen(**more: Any) -> rg.ChosenGrasp:
    """Three fingers where many placements are nearly as good, as far as boxes go."""
    asked: dict[str, Any] = {"objective": "force", "max_force": 4.0, "tolerance": 1e-6, "from_corners": 0.0}
    asked |= {"most_boxes": MOST} | more
    return rg.choose_grasp(ELLIPSE if asked["objective"] == "force" else C, 3, LOADS, friction=0.4, **asked)


def on(threads: int, monkeypatch: pytest.MonkeyPatch, **more: Any) -> tuple[rg.ChosenGrasp, list[int]]:
    """What is chosen with so many threads, and how many rounds in parts it took."""
    rounds: list[int] = []
    monkeypatch.setattr(parts, "_FROM", 512)

    def counted() -> int:
        rounds.append(threads)
        return threads

    monkeypatch.setattr(parts, "threads", counted)
    return chosen(**more), rounds


@pytest.mark.parametrize("objective", ["force", "sum_normal"])
def test_threads_change_no_number_and_parts_no_answer(
    monkeypatch: pytest.MonkeyPatch, objective: str
) -> None:
    more: dict[str, Any] = {"objective": objective, "tolerance": 1e-9}
    more |= {} if objective == "force" else {"max_force": None}
    (one, rounds), (two, _) = on(1, monkeypatch, **more), on(2, monkeypatch, **more)
    assert rounds
    assert one.to_dict() == two.to_dict()
    assert 0 < len(one.certificate.children) <= MOST
    assert one.gap > 0
    assert rg.verify(rg.ChosenGrasp.from_dict(one.to_dict()))
    monkeypatch.setattr(parts.Queue, "is_for_parts", False)
    alone = chosen(**more)
    assert one.value == pytest.approx(alone.value, rel=1e-3)
    for first, second in ((one, alone), (alone, one)):
        low, high = (first.value, second.bound) if objective == "force" else (first.bound, second.value)
        assert low <= high * (1 + 1e-9)


@pytest.mark.parametrize(
    ("objective", "shape", "more"),
    [
        ("force", C, {"max_force": 4.0, "most_boxes": 600}),  # by twists of all loads together
        ("friction_use", TRIANGLE, {"max_force": 4.0, "most_boxes": 300}),  # by those that move with fingers
        ("friction_use", ELLIPSE, {"max_force": 4.0, "most_boxes": 4000}),  # by those that turn with them
        ("peak_normal", rg.Mesh.box(0.04, 0.03, 0.05), {"most_boxes": 300}),
        ("friction_use", rg.Mesh.box(0.04, 0.03, 0.05), {"max_force": 4.0, "most_boxes": 200}),
    ],
    ids=["joined", "moving", "turning", "space", "space, a level"],
)
def test_rounds_of_boxes_are_the_same_on_more_threads(
    monkeypatch: pytest.MonkeyPatch, objective: str, shape: rg.Outline | rg.Mesh, more: dict[str, Any]
) -> None:
    found = []
    for count in (1, 2):
        asked: list[int] = []
        monkeypatch.setattr(parts, "threads", lambda count=count, asked=asked: asked.append(count) or count)
        loads = LOADS if isinstance(shape, rg.Outline) else IN_SPACE
        found.append(
            rg.choose_grasp(shape, 3, loads, friction=0.4, objective=objective, tolerance=1e-2, **more)
        )
        assert len(asked) > 2
    one, two = found
    assert one.to_dict() == two.to_dict()
    assert len(one.certificate.children) > 0
    if isinstance(shape, rg.Mesh):
        assert rg.verify(one)


def test_an_interrupt_within_a_round_leaves_a_whole_proof(monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[float] = []

    def interrupt(bound: float, best: float) -> None:
        calls.append(bound)
        if len(calls) == 12:
            Timer(0.01, interrupt_main).start()

    ignored = signal.signal(signal.SIGINT, signal.default_int_handler)  # by workers of a run in parallel
    try:
        cut, rounds = on(2, monkeypatch, most_boxes=40_000, progress=interrupt)
    finally:
        signal.signal(signal.SIGINT, ignored)
    assert rounds
    assert len(cut.certificate.children) < 36_000  # it was heard: the search ends by no other cause before
    assert cut.gap > 1e-6
    assert rg.verify(cut)


@pytest.mark.parametrize("objective", ["sum_normal", "force", "friction_use", "wrench"])
@pytest.mark.parametrize("shape", [C, ELLIPSE], ids=["C", "ellipse"])
def test_every_step_of_a_search_is_told(
    monkeypatch: pytest.MonkeyPatch, objective: str, shape: rg.Outline
) -> None:
    steps: list[str] = []

    def told(of: type, name: str) -> None:
        inside = getattr(of, name)

        def noted(*given: Any, **more: Any) -> Any:
            steps.append(name)
            return inside(*given, **more)

        monkeypatch.setattr(of, name, noted)

    told(Search, "goes_on")
    told(Rounds, "next")
    more: dict[str, Any] = {} if objective == "sum_normal" else {"max_force": 4.0}
    more |= {"disturbance": LOADS} if objective == "wrench" else {}
    rg.choose_grasp(
        shape, 2, rg.Wrench([0, -1]), friction=0.5, objective=objective, tolerance=3e-3, most_boxes=3000,
        progress=lambda *_: steps.append("progress"), **more,
    )  # fmt: skip
    between = " ".join(steps).split("progress")
    assert {"goes_on", "next"} & set(steps)
    assert max(part.count("goes_on") + part.count("next") for part in between) <= 1


@pytest.mark.parametrize(
    ("shape", "given"),
    [
        (C, {"objective": "force", "max_force": 4.0}),  # by twists of all loads together
        (ELLIPSE, {"objective": "friction_use", "max_force": 4.0}),  # by boxes one load at a time
        (GEAR, {"objective": "friction_use", "max_force": 4.0}),  # from where normals meet
        (C, {"objective": "peak", "removable": True, "max_force": 20.0}),  # from placements of points
    ],
    ids=["joined", "boxes", "meeting", "points"],
)
@pytest.mark.parametrize("after", [1, 40])
def test_an_interrupt_while_the_first_placement_slides_returns_it(
    monkeypatch: pytest.MonkeyPatch, shape: rg.Outline, given: dict[str, Any], after: int
) -> None:
    """The first one may slide for seconds on many sides, and holds already."""
    calls: list[int] = []
    moved = sliding.moved

    def interrupted(*args: Any, **more: Any) -> Any:
        calls.append(1)
        if len(calls) == after:
            raise KeyboardInterrupt
        return moved(*args, **more)

    monkeypatch.setattr(climbing, "moved", interrupted)
    monkeypatch.setattr(sliding, "moved", interrupted)
    few = rg.LoadSet.hull([rg.Wrench([0, -1], 0.05), rg.Wrench([0.1, -1])])
    cut = rg.choose_grasp(shape, 3, few, friction=0.4, tolerance=1e-6, **given)
    assert len(calls) == after  # no search goes on after it
    assert cut.gap > 1e-6
    assert rg.verify(cut).ok

"""Values go to plain data, through JSON, and come back equal, every number bit for bit."""

import json
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import regrasp as rg
from refusals import refusal
from values import VALUES, removal, rotation

pytestmark = pytest.mark.contract

PLAIN = [
    "Contact", "soft Contact", "limited Contact", "ForceLimits", "Wrench", "Grasp", "GraspState",
    "TimeScaling", "LoadSeries", "straight Transition", "bent Transition", "turning Transition",
    "RegraspPlan", "OutlineCut", "RegraspCut", "Outline, polygon with a hole", "Outline, smooth",
    "Outline, ellipse", "ChosenGrasp", "ContactRegions", "FaceRegions", "PlacementProof", "LoadSet",
    "LoadSet, hull", "LoadSet, tilted", "LoadSet, tilts",
]  # fmt: skip
"""Named, as making all values to ask them takes seconds of every worker that collects."""
FINITE = st.floats(-1e100, 1e100, allow_subnormal=False)


def through_json(data: Any) -> Any:
    return json.loads(json.dumps(data, allow_nan=False))


@pytest.mark.parametrize("name", PLAIN)
def test_value_comes_back_equal(name: str) -> None:
    value = VALUES[name]()
    again = type(value).from_dict(through_json(value.to_dict()))
    assert again == value
    assert type(again) is type(value)
    assert again.to_dict() == value.to_dict()


def test_everything_asked_for_goes_to_plain_data() -> None:
    named = [name for name, make in VALUES.items() if hasattr(make(), "to_dict") and name != "ChosenState"]
    assert named == PLAIN
    kinds = {type(VALUES[name]()) for name in PLAIN}
    assert kinds >= {
        rg.Contact,
        rg.Wrench,
        rg.LoadSeries,
        rg.Grasp,
        rg.GraspState,
        rg.Outline,
        rg.TimeScaling,
    }
    assert kinds >= {rg.Transition, rg.RegraspPlan}


def test_chosen_state_goes_as_the_state_it_is() -> None:
    chosen = VALUES["ChosenState"]()
    state = rg.GraspState.from_dict(through_json(chosen.to_dict()))
    assert state == rg.GraspState(chosen.grasp, chosen.load, chosen.forces)


def test_transition_reads_any_path_but_no_other_kind_reads_it() -> None:
    assert rg.Transition.from_dict(rotation().to_dict()) == rotation()
    with pytest.raises(
        rg.InvalidInput, match="expected the data of a RegraspPlan, found that of a Transition"
    ):
        rg.RegraspPlan.from_dict(removal().to_dict())


@st.composite
def contacts(draw: st.DrawFn, dimension: int) -> rg.Contact:
    vectors = st.lists(FINITE, min_size=dimension, max_size=dimension)
    soft = dimension == 3 and draw(st.booleans())
    return rg.Contact(
        draw(vectors),
        draw(vectors.filter(any)),
        draw(st.floats(1e-9 if soft else 0, 1e9)),
        max_force=draw(st.none() | st.floats(1e-300, 1e300)),
        torsion=draw(st.floats(1e-300, 1e300)) if soft else None,
        name=draw(st.none() | st.text(min_size=1).filter(str.strip)),
    )


@given(st.sampled_from([2, 3]).flatmap(contacts))
def test_any_contact(contact: rg.Contact) -> None:
    assert rg.Contact.from_dict(through_json(contact.to_dict())) == contact


@given(st.sampled_from([3, 6]).flatmap(lambda n: st.lists(FINITE, min_size=n, max_size=n)))
def test_any_wrench(vector: list[float]) -> None:
    wrench = rg.Wrench.from_vector(vector)
    again = rg.Wrench.from_dict(through_json(wrench.to_dict()))
    assert again.vector.tobytes() == wrench.vector.tobytes()


@given(
    st.sampled_from([rg.Outline, rg.Outline.smooth]),
    st.integers(3, 9),
    st.floats(-6, 6),
    st.integers(0, 2**32 - 1),
)
def test_any_outline(make: Any, count: int, power: float, seed: int) -> None:
    """Star-shaped rings of any size and place, run either way, with a hole of another kind."""
    rng = np.random.default_rng(seed)
    turn = (np.arange(count) + rng.uniform(-0.2, 0.2, count)) * 2 * np.pi / count
    ring = rng.uniform(1, 1.3, count)[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    size, place = 10.0**power, rng.normal(size=2)
    points = (size * (ring + place))[:: rng.choice([-1, 1])]
    hole = rg.Outline.ellipse(0.1 * size, 0.05 * size, centre=size * place)
    outline = make(points, holes=[hole])
    again = rg.Outline.from_dict(through_json(outline.to_dict()))
    assert again == outline
    assert (again.area, again.length) == (outline.area, outline.length)


# -- what is not such data ------------------------------------------------------------------------------


def spoiled(data: dict[str, Any]) -> Iterator[Any]:
    """The data with a key too many or too few, or an entry that is something else, at every level."""
    yield from ([], None, "text", 3.5, data | {"extra": 1}, data | {3: 1}, {})
    for key, entry in data.items():
        for wrong in ("x", {"a": 1}, [[["deep"]]], float("nan"), 10**400, object()):
            yield data | {key: wrong}
        if isinstance(entry, dict):
            yield from (data | {key: below} for below in spoiled(entry))
        elif isinstance(entry, list) and entry:
            yield data | {key: [*entry[:-1], "x"]}
            yield data | {key: entry[:-1]} if key != "holes" else data | {key: ["x"]}


@pytest.mark.parametrize("name", PLAIN)
def test_other_data_is_refused_in_words(name: str) -> None:
    value = VALUES[name]()
    count = 0
    for wrong in spoiled(value.to_dict()):
        said = refusal(lambda wrong=wrong: type(value).from_dict(wrong))  # else: fewer contacts, another name
        count += said is not None and len(said) < 2000
    assert count > 10


@pytest.mark.parametrize("name", [n for n in PLAIN if "Transition" not in n and n != "RegraspPlan"])
def test_every_key_is_needed_or_has_a_default(name: str) -> None:
    value = VALUES[name]()
    for key in value.to_dict():
        less = {k: v for k, v in value.to_dict().items() if k != key}
        if name == "ChosenGrasp" and less.pop("digest", None) is None:
            assert type(value).from_dict(less) == value  # data of before had none
            continue
        if key in (
            "name",
            "max_force",
            "min_normal",
            "deviations",
            "length",
            "torque",
            "torsion",
            "limits",
            "holes",
            "centre",
            "turned",
            "forbidden",
        ) and not (key == "max_force" and "Regions" in name):
            assert type(value).from_dict(less) is not None
        else:
            with pytest.raises(rg.InvalidInput, match=r"must have the key|must have exactly one of"):
                type(value).from_dict(less)


def test_holes_nested_without_end_are_refused() -> None:
    data: dict[str, Any] = {"vertices": [[0, 0], [1, 0], [0, 1]]}
    for _ in range(100_000):
        data = {"vertices": [[0, 0], [1, 0], [0, 1]], "holes": [data]}
    with pytest.raises(rg.InvalidInput, match="hole 0 has holes itself"):
        rg.Outline.from_dict(data)

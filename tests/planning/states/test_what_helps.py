"""Every refusal says what would help: as it stands in the message it does, and a little less does not."""

import pickle
import re
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

import regrasp as rg

pytestmark = pytest.mark.laws

WAYS = {
    "a friction of at least": "friction",
    "a torsion of": "torsion",
    "force limits of at least": "max_force",
    "linear limits": "limits",
    "min_normal at most": "min_normal",
    "a reserve at most": "reserve",
    "a disturbance at most": "disturbance",
    "rate limits": "rate_limit",
}
Problem = tuple[Callable[..., Any], rg.Grasp, dict[str, Any]]


def applied(
    grasp: rg.Grasp, options: dict[str, Any], way: str, amount: float
) -> tuple[rg.Grasp, dict[str, Any]]:
    """The problem with what a message says."""
    options = dict(options)
    contacts = list(grasp)
    if way == "friction":
        contacts = [c.changed(friction=max(c.friction, amount)) for c in contacts]
    elif way == "torsion":
        contacts = [c.changed(torsion=max(c.torsion or 0.0, amount)) if c.friction else c for c in contacts]
    elif way == "limits":
        contacts = [c.changed(limits=c.limits.scaled(amount)) if c.limits else c for c in contacts]
    elif way == "max_force":
        contacts = [c.changed(max_force=max(c.max_force, amount)) if c.max_force else c for c in contacts]
        if "max_force" in options:
            options["max_force"] = max(options["max_force"], amount)
    elif way == "disturbance":
        options[way] = options[way].scaled(amount)
    else:
        options[way] = amount * options[way]
    return rg.Grasp(contacts), options


def said(message: str) -> tuple[list[list[tuple[str, float]]], bool]:
    """The remedies of a message, each a list of what is to be changed together."""
    words = message.rsplit("; with ", 1)[-1].removesuffix(", it would do").removesuffix(" together")
    number = r"(-?\d[\d.e+-]*)"
    ways = []
    for alone in words.split(", or with "):
        parts = [re.match(rf"({'|'.join(WAYS)}) {number}", part) for part in alone.split(" and ")]
        assert all(parts), message
        ways.append([(WAYS[part[1]], float(part[2])) for part in parts if part])
    return ways, " together" in message


def weaker(way: str, amount: float) -> float:
    """An amount that helps a little less: three digits are said, and some objectives need a little more."""
    return 1.03 * amount + 2e-3 if way in ("min_normal", "reserve") else 0.97 * amount


def problems(rng: np.random.Generator, d: int) -> Iterator[Problem]:
    """Grasps of weak fingers under a load that is mostly too much for them, for each verb."""
    while True:
        n = int(rng.integers(2, 5))
        normals = rng.normal(size=(n, d))
        soft = d == 3 and rng.random() < 0.3
        contacts = [
            rg.Contact(
                -normal / np.linalg.norm(normal) + 0.2 * rng.normal(size=d),
                normal,
                float(rng.uniform(0.05, 0.6)),
                max_force=float(rng.uniform(1, 4)) if rng.random() < 0.3 else None,
                torsion=0.05 if soft else None,
                limits=([[1.0, *[0.5] * (d - 1)]], [2.0]) if rng.random() < 0.15 else None,
            )
            for normal in normals
        ]
        load = rg.Wrench(rng.normal(size=d), 0.3 * rng.normal(size=3 if d == 3 else None))
        options: dict[str, Any] = {"load": load, "objective": str(rng.choice(list(OBJECTIVES)))}
        if rng.random() < 0.3:
            options["max_force"] = float(rng.uniform(0.3, 3))
        if rng.random() < 0.2:
            options["min_normal"] = float(rng.uniform(0.1, 2))
        if rng.random() < 0.2:
            options["reserve"] = float(rng.uniform(0.05, 0.6))
        verb = str(rng.choice(list(VERBS)))
        yield VERBS[verb], rg.Grasp(contacts), options


COUNT, SEED = {2: 30, 3: 16}, 17
OBJECTIVES = ("angle", "force", "effort", "peak", "peak_normal", "sum_normal", "friction_use")


def chosen(grasp: rg.Grasp, load: rg.Wrench, objective: str, **options: Any) -> rg.GraspState:
    return rg.choose_state(grasp, load, objective, **options)


def removed(grasp: rg.Grasp, **options: Any) -> rg.Transition:
    return rg.plan_removal(grasp, 0, **options)


def added(grasp: rg.Grasp, **options: Any) -> rg.Transition:
    return rg.plan_addition(grasp.without(0), grasp[0], **options)


def exchanged(grasp: rg.Grasp, **options: Any) -> rg.Transition:
    first = grasp[0]
    moved = rg.Contact(1.1 * first.position, first.normal, first.friction, max_force=first.max_force)
    if first.torsion or first.limits:
        moved = moved.changed(torsion=first.torsion, limits=first.limits)
    return rg.plan_exchange(grasp, 0, moved, **options)


def turned(grasp: rg.Grasp, **options: Any) -> rg.Transition:
    return rg.plan_rotation(grasp, 0.5, axis=None if grasp.dimension == 2 else [1, 2, 0], **options)


def held(grasp: rg.Grasp, load: rg.Wrench, **options: Any) -> rg.Transition:
    return rg.plan_hold(
        grasp,
        rg.LoadSeries([0.0, 0.5, 1.0], [load.vector, 1.2 * load.vector, load.vector]),
        instants=11,
        **options,
    )


VERBS: dict[str, Callable[..., Any]] = {
    "choose_state": chosen,
    "plan_removal": removed,
    "plan_addition": added,
    "plan_exchange": exchanged,
    "plan_rotation": turned,
    "plan_hold": held,
}


def refusal(verb: Callable[..., Any], grasp: rg.Grasp, options: dict[str, Any]) -> rg.RegraspError | None:
    try:
        verb(grasp, **options)
    except (rg.Infeasible, rg.SolverFailed) as error:
        return error
    return None


@pytest.mark.parametrize("d", [2, 3])
def test_what_a_refusal_names_helps(d: int) -> None:
    rng = np.random.default_rng(SEED + d)
    counts = dict.fromkeys((*WAYS.values(), "none", "together"), 0)
    for _, (verb, grasp, options) in zip(range(COUNT[d]), problems(rng, d), strict=False):
        refused = refusal(verb, grasp, options)
        if not isinstance(refused, rg.Infeasible):
            continue
        message = str(refused)
        case = verb.__name__, grasp, options, message
        if not message.endswith("it would do"):
            counts["none"] += 1
            assert message.endswith(("no friction helps", "it takes another contact")), case
            most = applied(grasp, options, "friction", 16.0)
            assert refusal(verb, *most) is not None, case
            continue
        ways, together = said(message)
        counts["together"] += together
        for way in ways:
            counts[way[0][0]] += 1
            enough, less = (grasp, options), (grasp, options)
            for what, amount in way:
                enough = applied(*enough, what, amount)
            assert refusal(verb, *enough) is None, (*case, str(refusal(verb, *enough)))
            for what, amount in way:
                less = applied(*less, what, weaker(what, amount))
            if len(way) == 1 and way[0][0] != "torsion":  # any may do, where nothing limits forces
                assert refusal(verb, *less) is not None, (*case, way)
    assert counts["friction"] > 5


def test_help_is_worked_out_when_it_is_read() -> None:
    grasp = rg.Grasp([rg.Contact([-1, 0], [1, 0], 0.1), rg.Contact([1, 0], [-1, 0], 0.1)])
    with pytest.raises(rg.Infeasible) as error:
        rg.choose_state(grasp, rg.Wrench([0, -1]), "effort", max_force=2)
    refused = error.value
    at_once = refused.reason
    copy = pickle.loads(pickle.dumps(refused))
    assert str(copy) == str(refused)
    assert str(refused).startswith(f"{at_once}; with ")
    assert copy.certificate == refused.certificate


@pytest.mark.parametrize("chosen_by_hand", [False, True])
def test_a_state_of_point_contacts_may_be_helped_by_torsion(chosen_by_hand: bool) -> None:
    """Soft fingers have a torque more: the states that were given are asked again with none."""
    ways = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0))
    grasp = rg.Grasp(rg.Contact(way, -np.array(way), 0.6) for way in ways)
    start = rg.choose_state(grasp, rg.Wrench((0, 0, -1), (0.05, 0, 0)))
    if chosen_by_hand:
        start = rg.GraspState(grasp, start.load, start.forces)
    with pytest.raises(rg.Infeasible, match=r"; with a torsion of .* it would do") as refused:
        rg.plan_removal(start, ["P3", "P4"])
    amount = float(str(refused.value).partition("torsion of ")[2].split()[0])
    soft = rg.Grasp(contact.changed(torsion=amount) for contact in grasp)
    given = rg.GraspState(soft, start.load, np.pad(start.forces, ((0, 0), (0, 1))))
    assert rg.plan_removal(given, ["P3", "P4"])

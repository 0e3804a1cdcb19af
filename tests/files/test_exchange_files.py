"""Exchanges in scenario files: planned as by the verb, written, read back, and refused with the reason."""

from pathlib import Path

import pytest

import regrasp as rg
from places import ROOT
from regrasp.files import parse_scenario, plan_scenario, read_plan, read_scenario, write_plan

pytestmark = pytest.mark.contract

EXCHANGE = (ROOT / "examples" / "exchange.toml").read_text(encoding="utf-8")


def changed(*changes: tuple[str, str]) -> str:
    text = EXCHANGE
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    return text


def test_an_exchange_is_planned_as_by_the_verb(tmp_path: Path) -> None:
    scenario = read_scenario(ROOT / "examples" / "exchange.toml")
    plan = plan_scenario(scenario)
    assert (plan.kind, plan.contact, plan.arrival, plan.grasp.names) == (
        "exchange",
        "R",
        "S",
        ("L", "R", "S"),
    )
    whole = scenario.grasp
    same = rg.plan_exchange(
        whole.without("S"), "R", whole["S"], load=scenario.external, objective="angle",
        start_objective="force", rate_limit=[20.0, 20.0, 15.0], reserve=0.1,
    )  # fmt: skip
    assert plan.start == same.start
    assert plan.end == same.end
    assert plan.duration == pytest.approx(same.duration, rel=1e-12)
    assert rg.verify(plan).ok
    assert plan.steepest.max() <= 20.0 * (1 + 1e-9)
    assert plan.steepest[2] <= 15.0 * (1 + 1e-9)
    write_plan(plan, tmp_path / "plan.json")
    assert read_plan(tmp_path / "plan.json") == plan


def test_the_arriving_finger_may_be_listed_first() -> None:
    """Rate limits go by the scenario's order, forces by the plan's."""
    first = EXCHANGE.index("[[contacts]]")
    arriving, task = EXCHANGE.index('[[contacts]]\nname = "S"'), EXCHANGE.index("# No contact has a force")
    text = EXCHANGE[:first] + EXCHANGE[arriving:task] + EXCHANGE[first:arriving] + EXCHANGE[task:]
    text = text.replace("[20.0, 20.0, 15.0]", "[15.0, 20.0, 20.0]")
    assert plan_scenario(parse_scenario(text)) == plan_scenario(parse_scenario(EXCHANGE))


def test_given_forces_and_idle_times() -> None:
    plan = plan_scenario(parse_scenario(changed(("rate_limit = [20.0, 20.0, 15.0]", "duration = 1.0"))))
    text = changed(("rate_limit = [20.0, 20.0, 15.0]", "duration = 1.0\nidle_from = 0.9\nidle_until = 0.1"))
    for name in ("L", "R", "S"):
        lines = [f'name = "{name}"']
        if name != "S":
            lines.append(f"force = {plan.start.force(name).tolist()}")
        if name != "R":
            lines.append(f"end_force = {plan.end.force(name).tolist()}")
        text = text.replace(f'name = "{name}"', "\n".join(lines))
    given = plan_scenario(parse_scenario(text))
    assert given.record.choices == ()
    assert not given.forces(0.95)[1].any()
    assert not given.forces(0.05)[2].any()
    assert rg.verify(given).ok


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (('arrival = "S"', 'arrival = "X"'), "task.arrival: expected one of L, R, S, got 'X'"),
        (('contact = "R"', 'contact = "X"'), "task.contact: expected one of L, R, S, got 'X'"),
        (('arrival = "S"', 'arrival = "R"'), "expected another finger than the one that leaves, got 'R'"),
        (("reserve = 0.1", "idle_time = 0.1"), "task.idle_time: unknown key"),
        (("reserve = 0.1", 'whole_objective = "force"'), "task.whole_objective: unknown key"),
        (
            ('name = "S"', 'name = "S"\nforce = [1.0, 0.0]'),
            "contacts[2].force: S arrives, so it starts without",
        ),
        (('name = "R"', 'name = "R"\nend_force = [1.0, 0.0]'), "contacts[1].end_force: R leaves, so it ends"),
    ],
)
def test_wrong_exchanges(change: tuple[str, str], words: str) -> None:
    with pytest.raises(rg.InvalidInput) as refusal:
        parse_scenario(changed(change))
    assert words in str(refusal.value)

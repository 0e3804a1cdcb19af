"""Cases that are a scenario with some of its keys changed."""

import tomllib
from collections.abc import Mapping
from copy import deepcopy
from pathlib import Path
from typing import Any

from regrasp.errors import InvalidInput, shown
from regrasp.files import plan_scenario, read_scenario
from regrasp.files.scenarios.scenario import scenario_of
from regrasp.files.source import text_of
from regrasp.planning.placement.chosen import ChosenGrasp
from regrasp.plans.regrasp_plan import RegraspPlan
from regrasp.plans.transition import Transition
from regrasp.studies.cases import Cases
from regrasp.studies.task import NotVerified
from regrasp.verification import Verification, verify

NAME = f"{__name__}:planned"


class Answer:
    """A plan that verified. It has what its verification has, and what it has itself."""

    def __init__(self, plan: Transition | RegraspPlan | ChosenGrasp, verification: Verification) -> None:
        self.plan, self.verification = plan, verification

    @property
    def margin(self) -> float:
        """The least angle margin at any instant [rad]."""
        return self.plan.margin if isinstance(self.plan, RegraspPlan) else self.verification.least_angle

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        if hasattr(self.verification, name):
            return getattr(self.verification, name)
        return getattr(self.plan, name)

    def __dir__(self) -> list[str]:
        return sorted({"margin", *dir(self.plan), *dir(self.verification)})


def planned(scenario: Mapping[str, Any], scenario_file: str, **changes: Any) -> Answer:
    """Plan a scenario with some of its keys changed, and verify the plan.

    Raises as the planner does, and ``NotVerified``.
    """
    file = Path(scenario_file)
    plan = plan_scenario(scenario_of(changed(scenario, changes), file))
    verification = verify(plan)
    if not verification.ok:
        raise NotVerified("; ".join(verification.violations[:3]))
    return Answer(plan, verification)


def changed(scenario: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """A scenario's data with other values.

    A key has dots between tables: ``load.force``; of a list it names an entry by its ``name``, its number, or
    all of them: ``contacts.P1.friction``, ``contacts.0.friction``, ``contacts.*.friction``. Raises
    ``InvalidInput`` for a key that leads nowhere.
    """
    data = deepcopy(dict(scenario))
    for key, value in changes.items():
        *way, last = key.split(".")
        places: list[Any] = [data]
        for part in way:
            places = [inner for place in places for inner in _inside(place, part)]
        tables = [place for place in places if isinstance(place, dict)]
        if not tables:
            raise InvalidInput(f"the scenario has no place for {shown(key)}; it has {', '.join(data)}")
        for table in tables:
            if value is None:
                table.pop(last, None)
            else:
                table[last] = value
    return data


def _inside(place: Any, part: str) -> list[Any]:
    if isinstance(place, dict):
        return [place[part]] if part in place else []
    if not isinstance(place, list):
        return []
    if part == "*":
        return place
    named = [entry for entry in place if isinstance(entry, dict) and entry.get("name") == part]
    if named or not part.isdecimal():
        return named
    return place[int(part) : int(part) + 1]


def shared_of(path: Path, cases: Cases) -> dict[str, Any]:
    """What all cases of a scenario share. Raises ``InvalidInput`` where it, or a key of theirs, is none."""
    read_scenario(path)
    data = tomllib.loads(text_of(path, "a scenario in TOML"))
    try:
        scenario_of(changed(data, cases[0]), path)
    except InvalidInput as error:
        if "no place for" in str(error) or "unknown key" in str(error):
            raise
    return {"scenario": data, "scenario_file": str(path)}

"""Plans of others whose values are of no kind that a plan has: refused in one line, or not verified."""

from dataclasses import replace
from math import nan
from types import SimpleNamespace

import numpy as np
import pytest

import regrasp as rg
from foreign import cross, places
from foreign.crosses import CROSSES
from regrasp.errors import InvalidInput
from regrasp.verification.sampling import verify_setpoints

pytestmark = pytest.mark.contract


def failing(*_: object) -> None:
    raise ZeroDivisionError


JUNK = (
    "text", np.zeros(0), np.zeros((2, 3, 4)), np.array(["a"]), np.array([None]), 10**400, 1j, {}, object(),
    failing, [None], ["1"], [[1.0]], (10**400, 0), np.array(nan), b"x", ([],), {"a"},
)  # fmt: skip
PARTS = {
    "scaling": ("duration", "control"),
    "record": ("reserve", "balancing", "choices", "rate_limits", "least_normals"),
    "course": ("times", "forces", "loads"),
    "turn": ("angles", "forces", "axis", "middles"),
}


def answers(plan, rows=None, angles=None) -> list[str]:
    """What both say, "" for verified."""
    found = []
    for ask in (
        lambda: rg.verify(plan),
        lambda: verify_setpoints(plan, rows, angles=angles),
    ):
        try:
            verdict = ask()
            found.append("" if verdict.ok else str(verdict.violations[0]))
        except InvalidInput as error:
            found.append(f"InvalidInput: {error}")
    return found


@pytest.mark.parametrize("make", CROSSES.values(), ids=CROSSES)
def test_values_of_no_kind_are_refused_in_a_line(make) -> None:
    for where, plan in places(*make()):
        angles = None if plan.turn is None else plan.turn.angles[[0, -1]]
        rows = plan.forces(np.array([0.0, plan.scaling.duration]))
        assert answers(plan, rows, angles) == ["", ""], where
        for part, names in PARTS.items():
            whole = getattr(plan, part)
            if whole is None:
                continue
            given = {name: getattr(whole, name) for name in names}
            for name in names:
                for junk in (None, *JUNK, nan):
                    if junk is None and name in ("axis", "middles"):
                        continue
                    if name in ("rate_limits", "least_normals") and getattr(junk, "shape", None) == (0,):
                        continue  # none are promised
                    bad = SimpleNamespace(**given | {name: junk})
                    for said in answers(replace(plan, **{part: bad}), rows, angles):
                        assert said, (where, part, name, junk)
                        assert "\n" not in said
                without = SimpleNamespace(**{k: v for k, v in given.items() if k != name})
                words = answers(replace(plan, **{part: without}), rows, angles)
                assert all(
                    word.startswith(f"InvalidInput: {part}.{name} of a plan must be") for word in words
                )


def test_what_a_plan_answers_must_be_forces() -> None:
    plan = next(iter(places(*cross())))[1]
    rows = plan.forces(np.array([0.0, 1.0]))
    kept = {
        n: getattr(plan, n)
        for n in ("leaving", "arriving", "start", "end", "scaling", "course", "turn", "record")
    }
    for forces in (None, failing, lambda t: None, lambda t: rows[:1], lambda t: "x", lambda t: rows[..., 0]):
        with pytest.raises(InvalidInput):
            verify_setpoints(SimpleNamespace(**kept, forces=forces), rows)
    assert verify_setpoints(SimpleNamespace(**kept, forces=plan.forces), rows).ok
    for fingers in (None, "A", ([],), (1,), (None,), 3, failing, np.ones(3)):
        for name in ("leaving", "arriving"):
            odd = SimpleNamespace(**kept | {name: fingers}, forces=plan.forces)
            assert all("tuple of different names" in said for said in answers(odd, rows))

"""What would help where a call of a verb is refused: found by asking it again, tried before it is said."""

import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

from regrasp.errors import Infeasible, RegraspError
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.escape import EscapeTwist
from regrasp.mechanics.grasp import Grasp
from regrasp.planning.states.criteria import Criteria
from regrasp.planning.states.escape import defies_friction
from regrasp.planning.states.objectives import EFFORT, WithstoodFactor, objective_of
from regrasp.planning.states.refusals.asking import asking_only
from regrasp.planning.states.refusals.least_values import largest_share, least_value, rounded_up
from regrasp.planning.states.refusals.ways import Way, torsion, ways_for

_SLACKER = (1.0, 1.003, 1.01, 1.1, 2.0)
"""An objective of its own may need a little more than the least with which there are forces."""
_OBJECTIVES = frozenset(("objective", "whole_objective", "start_objective"))
_INSTANTS = 21
"""Of paths that are only asked whether they exist."""

Change = tuple[Way, float]


class Call:
    """A call of a verb, which was refused.

    Args:
        verb: what was called.
        arguments: as ``inspect`` binds them.
        known: names of all that the verb takes.
        refusal: what it raised.
    """

    def __init__(
        self,
        verb: Callable[..., Any],
        arguments: Mapping[str, Any],
        known: frozenset[str],
        refusal: Infeasible,
    ) -> None:
        self._verb, self._known = verb, known
        self._arguments = {**arguments, **arguments.get("options", {})}
        self._arguments.pop("options", None)
        self._certificate = refusal.certificate

    def what_helps(self) -> str:
        """What would help, each way by itself or all that are needed together; "" where nothing is known."""
        contacts, ways = self._contacts, self._ways
        if not contacts:
            return ""
        twist = self._certificate
        defied = isinstance(twist, EscapeTwist) and defies_friction(twist)
        alone = [] if defied else [words for way in ways if (words := self._alone(way)) is not None]
        if not alone and (soft := torsion(contacts)) is not None:
            alone = [words for words in [self._alone(soft)] if words is not None]
        if alone:
            return f"with {', or with '.join(alone)}, it would do"
        if defied:
            return ""
        together = self._together(ways) if len(ways) > 1 else None
        if together is not None:
            return f"with {' and '.join(together)} together, it would do"
        others = ", nor larger limits" if len(ways) > 1 else ""
        return f"no friction up to {ways[0].most:g} would do{others}: it takes another contact"

    def holds(self, changes: Sequence[Change], *, as_asked: bool = False) -> bool:
        """Whether the verb answers after changes.

        Args:
            changes: ways and their amounts.
            as_asked: for its own objective; else for effort, which needs no search.
        """
        arguments = self._arguments if as_asked else self._plain
        try:
            for way, amount in changes:
                arguments = {name: way.applied(name, value, amount) for name, value in arguments.items()}
            with warnings.catch_warnings(), asking_only():
                warnings.simplefilter("ignore")
                self._verb(**arguments)
        except RegraspError:
            return False
        return True

    def _alone(self, way: Way, others: Sequence[Change] = ()) -> str | None:
        """The words of a way with the least amount of it, or the most, that will do; None where none will."""
        amount = self._amount(way, others)
        return None if amount is None else way.words.format(amount)

    def _amount(self, way: Way, others: Sequence[Change] = ()) -> float | None:
        def possible(amount: float) -> bool:
            return self.holds([*others, (way, amount)])

        found = largest_share(possible) if way.most == 0 else least_value(possible, way.now, way.most)
        if found is None:
            return None
        for share in _SLACKER:
            amount = found / share if way.most == 0 else rounded_up(share * found)
            if self.holds([*others, (way, amount)], as_asked=True):
                return amount
        return None

    def _together(self, ways: Sequence[Way]) -> list[str] | None:
        """The words of ways that only do together: few, and as little of each as the others let it."""
        needed: list[Change] = [(way, way.most) for way in ways]
        if not self.holds(needed):
            return None
        for way in reversed(ways):
            fewer = [change for change in needed if change[0] is not way]
            if self.holds(fewer):
                needed = fewer
        for k, (way, _) in enumerate(needed):
            amount = self._amount(way, [*needed[:k], *needed[k + 1 :]])
            if amount is None:
                return None
            needed[k] = (way, amount)
        return [way.words.format(amount) for way, amount in needed]

    @cached_property
    def _plain(self) -> dict[str, Any]:
        """The arguments, each objective replaced by effort, but for what is withstood."""
        changed = {**self._arguments}
        for name in _OBJECTIVES & self._known:
            given = changed.get(name, "effort")
            if isinstance(given, Criteria):
                if not isinstance(given.objective, WithstoodFactor):
                    changed[name] = replace(given, objective=EFFORT)
            elif given is not None and not isinstance(objective_of(given), WithstoodFactor):
                changed[name] = EFFORT
        if "instants" in self._known and "rate_limit" not in changed:
            changed["instants"] = min(changed.get("instants", _INSTANTS), _INSTANTS)
        return changed

    @cached_property
    def _contacts(self) -> list[Contact]:
        return [contact for value in self._arguments.values() for contact in _contacts_of(value)]

    @cached_property
    def _ways(self) -> list[Way]:
        given = list(self._arguments.values())
        chosen = [value.criteria for value in given if isinstance(getattr(value, "criteria", None), Criteria)]
        criteria = [value for value in given if isinstance(value, Criteria)]
        return ways_for(self._contacts, self._arguments, criteria + chosen) if self._contacts else []


def _contacts_of(value: Any) -> Iterator[Contact]:
    if isinstance(value, Contact):
        yield value
    elif isinstance(value, Grasp):
        yield from value
    elif isinstance(getattr(value, "grasp", None), Grasp):
        yield from value.grasp
    elif isinstance(value, list | tuple):
        for one in value:
            yield from _contacts_of(one)

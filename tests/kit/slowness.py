"""Which tests are slow: those of a list, which ``pytest --find-slow`` measures anew.

What counts is processor time, children's included, of a function with all of its parameters: a busy machine
changes little of it. A test that is not in the list is quick until it is measured.
"""

import os
from collections import Counter
from collections.abc import Iterator

import pytest

from places import TESTS

LIST = TESTS / "slow.txt"
ALLOWED = 0.25
"""Seconds."""


def slow() -> list[str]:
    """Functions that are slow, as ``tests/<room>/<file>::<function>``."""
    return LIST.read_text(encoding="utf-8").split()


def function(nodeid: str) -> str:
    """The test's name without its parameters."""
    return nodeid.partition("[")[0]


def relisted(known: list[str], measured: dict[str, float]) -> list[str]:
    """The list after a run: of the functions that ran the slow ones, of the others those known."""
    found = {name for name, seconds in measured.items() if seconds > ALLOWED}
    return sorted(found | (set(known) - measured.keys()))


class Finder:
    """Measures every test, on workers too, and writes the list where the run ends."""

    def __init__(self) -> None:
        self.measured: Counter[str] = Counter()

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        """What a test begins with."""
        item.user_properties.append(("begun", processor()))
        return (yield)

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_makereport(self, item: pytest.Item) -> Iterator[None]:
        """What it has used so far goes with each of its reports."""
        begun = dict(item.user_properties)["begun"]
        item.user_properties.append(("used", processor() - begun))
        return (yield)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """The last report of a test, which xdist hands on, has the whole of it."""
        if report.when == "teardown":
            self.measured[function(report.nodeid)] += dict(report.user_properties)["used"]

    def pytest_sessionfinish(self, session: pytest.Session) -> None:
        """Write the list, once, where the reports came together."""
        if not hasattr(session.config, "workerinput") and self.measured:
            LIST.write_text("\n".join(relisted(slow(), self.measured)) + "\n", encoding="utf-8")


def processor() -> float:
    """Processor time of this process and its children so far [s]."""
    used = os.times()
    return used.user + used.system + used.children_user + used.children_system


def mark(items: list[pytest.Item]) -> None:
    """Give the slow ones their mark."""
    listed = set(slow())
    for item in items:
        if function(item.nodeid) in listed:
            item.add_marker(pytest.mark.slow)

"""Tests as calls: where a test is a plain function, pytest's own work around it is left out."""

import tempfile
import warnings
from contextlib import ExitStack
from dataclasses import dataclass
from inspect import isgeneratorfunction, signature
from pathlib import Path
from types import FunctionType
from typing import Any

import pytest

_GIVEN = {"monkeypatch", "tmp_path"}  # fixtures that are made here
_NEEDED = {"request", "tmp_path_factory"}  # by these, in pytest
_MARKS = ("skip", "xfail", "filterwarnings", "usefixtures")


@dataclass(frozen=True)
class Test:
    """One test, the functions that it enters and its usual time [s]; pytest does not call ``plain`` ones."""

    __test__ = False  # pytest's name for what is none of its classes

    item: pytest.Item
    plain: bool
    entered: frozenset[str] = frozenset()
    seconds: float = 0.0

    def passes(self) -> bool:
        """Run it."""
        return _call(self.item) if self.plain else _protocol(self.item)


def is_plain(item: pytest.Item) -> bool:
    """Whether a test is a function whose arguments are typed in, made here or by plain functions of tests."""
    if not isinstance(item, pytest.Function) or item.cls is not None:
        return False
    if getattr(item.obj, "is_hypothesis_test", False) or any(map(item.get_closest_marker, _MARKS)):
        return False
    if any(mark.args[:1] != (False,) for mark in item.iter_markers("skipif")):
        return False
    typed: set[str] = set()
    for mark in item.iter_markers("parametrize"):
        if len(mark.args) < 2 or "indirect" in mark.kwargs:
            return False
        names = mark.args[0]
        typed |= {name.strip() for name in (names.split(",") if isinstance(names, str) else names)}
    others = set(item.fixturenames) - _GIVEN - _NEEDED - typed
    return not typed & _GIVEN and all(_is_plain_fixture(_fixture(item, name)) for name in others)


def _fixture(item: pytest.Function, name: str) -> Any:
    return item._fixtureinfo.name2fixturedefs.get(name, (None,))[-1]


def _is_plain_fixture(fixture: Any) -> bool:
    """Neither pytest's own, nor with parameters or an end."""
    if fixture is None or fixture.params or fixture.func.__module__.startswith("_pytest"):
        return False
    return isinstance(fixture.func, FunctionType) and not isgeneratorfunction(fixture.func)


def _call(item: pytest.Function) -> bool:
    given = dict(item.callspec.params) if hasattr(item, "callspec") else {}

    def made(name: str) -> Any:
        if name not in given:
            fixture = _fixture(item, name)
            given[name] = fixture.func(**{needed: made(needed) for needed in fixture.argnames})
        return given[name]

    with ExitStack() as stack:
        stack.enter_context(warnings.catch_warnings())
        warnings.simplefilter("error")
        if "monkeypatch" in item.fixturenames:
            given["monkeypatch"] = stack.enter_context(pytest.MonkeyPatch.context())
        if "tmp_path" in item.fixturenames:
            given["tmp_path"] = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        try:
            item.obj(**{name: made(name) for name in signature(item.obj).parameters})
        except pytest.skip.Exception:
            return True
        except BaseException:
            return False
    return True


def _protocol(item: pytest.Item) -> bool:
    reports = []

    class Listener:
        @pytest.hookimpl
        def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
            reports.append(report)

    listener = Listener()
    item.config.pluginmanager.register(listener)
    try:
        item.config.hook.pytest_runtest_protocol(item=item, nextitem=None)
    finally:
        item.config.pluginmanager.unregister(listener)
    return not any(report.failed for report in reports)

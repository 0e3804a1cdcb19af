"""Tests run once without a change to learn which lines each looks at, then against every change in a fork.

Everything is imported and collected once. A child of the process swaps the code of the changed function in
place, runs the tests that look at the changed line, quickest first, and says whether one of them failed.
"""

import ast
import gc
import os
import signal
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from types import CodeType, FrameType, FunctionType, ModuleType
from typing import Any

import pytest
from changes import Change, changes

# Tests that take longer, traced, are left out: a change that only they notice counts as not noticed [s].
SLOW = float(os.environ.get("SLOW", "1"))
NOTICED, SURVIVED, UNSEEN, NONE = "noticed", "survived", "unseen", "no change"


class Engine:
    """A pytest plugin whose run of the tests is the run of the changes."""

    def __init__(
        self, modules: list[Path], known: dict[str, str], told: Callable[[str, Change, str], None]
    ) -> None:
        self.modules, self.known, self.told = modules, known, told
        self.jobs = int(os.environ.get("JOBS", "2"))
        self.killers: dict[str, list[int]] = {}

    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        """Run the tests once, then the changes."""
        import hypothesis.internal.conjecture.engine as hypothesis_engine

        hypothesis_engine.MAX_SHRINKS = 0  # that it fails is enough
        session.config.option.maxfail = 1
        seen = [entry for entry in self._baseline(session.items) if entry[2] < SLOW]
        limit = 30 + 6 * int(sum(duration for *_, duration in seen))
        running: dict[int, tuple[str, Change, int]] = {}
        for path in self.modules:
            name = str(path)
            for change, key in _named(changes(path.read_text(encoding="utf-8")), name):
                if key in self.known:
                    continue
                looks = [k for k, (_, lines, _) in enumerate(seen) if change.line in lines.get(name, ())]
                if change.function == "":  # a constant of the module
                    looks = list(range(len(seen)))
                if not looks:
                    self.told(key, change, UNSEEN)
                    continue
                while len(running) >= self.jobs:
                    self._wait(running)
                often = self.killers.get(f"{name} {change.function}", []) + self.killers.get(name, [])
                looks.sort(key=lambda k, often=often: (-often.count(k), k))
                read, write = os.pipe()
                pid = os.fork()
                if pid == 0:
                    _child(path, change, [(k, seen[k][0]) for k in looks], limit, write)
                os.close(write)
                running[pid] = key, change, read
        while running:
            self._wait(running)
        return True

    def _wait(self, running: dict[int, tuple[str, Change, int]]) -> None:
        pid, status = os.wait()
        if pid not in running:
            return
        key, change, read = running.pop(pid)
        if killer := os.read(read, 20):
            module = key.split(" ")[0]
            path = next(str(path) for path in self.modules if str(path).endswith(module))
            for where in (path, f"{path} {change.function}"):
                self.killers.setdefault(where, []).append(int(killer))
        os.close(read)
        self.told(key, change, {0: SURVIVED, 77: NONE}.get(os.waitstatus_to_exitcode(status), NOTICED))

    def _baseline(self, items: list[pytest.Item]) -> list[tuple[pytest.Item, dict[str, set[int]], float]]:
        """Each test with the lines of each module that it runs, and its time, quickest first."""
        found = []
        names = {str(path) for path in self.modules}
        for item in items:
            lines: dict[str, set[int]] = {}

            def local(frame: FrameType, event: str, arg: Any, lines: dict = lines) -> Any:
                lines[frame.f_code.co_filename].add(frame.f_lineno)
                return local

            def entered(frame: FrameType, event: str, arg: Any, lines: dict = lines) -> Any:
                name = frame.f_code.co_filename
                if name not in names:
                    return None
                lines.setdefault(name, set()).update(_lines(frame.f_code))
                return None

            start = time.perf_counter()
            sys.settrace(entered)
            try:
                good = _run(item)
            finally:
                sys.settrace(None)
            if not good:
                raise SystemExit(f"{item.nodeid} fails without a change")
            found.append((item, lines, time.perf_counter() - start))
        return sorted(found, key=lambda entry: entry[2])


def _named(found: Iterator[Change], module: str) -> Iterator[tuple[Change, str]]:
    """Changes and keys; equal ones of one function are counted."""
    count: dict[str, int] = {}
    short = module.split("/src/regrasp/")[-1]
    for change in found:
        key = f"{short} {change.key}"
        count[key] = count.get(key, 0) + 1
        yield change, key if count[key] == 1 else f"{key}  ({count[key]})"


def _lines(code: CodeType) -> set[int]:
    """Of a function and all inside it."""
    lines = {line for *_, line in code.co_lines() if line is not None}
    for inner in code.co_consts:
        if isinstance(inner, CodeType):
            lines |= _lines(inner)
    return lines


def _run(item: pytest.Item) -> bool:
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


def _child(path: Path, change: Change, items: list[tuple[int, pytest.Item]], limit: int, write: int) -> None:
    """Never returns: the status says whether a test failed, ``write`` hears which."""
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, 1)
    os.dup2(null, 2)
    signal.alarm(limit)
    os.nice(5)
    try:
        if not swap(path, change.tree):
            os._exit(77)
    except Exception:
        os._exit(77)
    try:
        for k, item in items:
            if not _run(item):
                os.write(write, str(k).encode())
                os._exit(1)
    except BaseException:
        os._exit(1)
    os._exit(0)


def swap(path: Path, tree: ast.Module) -> bool:
    """Put the code of ``tree`` in the place of the module's, in every function that is alive."""
    module = next(m for m in list(sys.modules.values()) if getattr(m, "__file__", None) == str(path))
    new = compile(tree, str(path), "exec")
    codes = {(code.co_qualname, code.co_firstlineno): code for code in _all_codes(new)}
    changed = False
    for function in gc.get_objects():
        if not isinstance(function, FunctionType) or function.__code__.co_filename != str(path):
            continue
        code = codes.get((function.__code__.co_qualname, function.__code__.co_firstlineno))
        if code is not None and code != function.__code__:
            function.__code__ = code
            changed = True
        if hasattr(function, "cache_clear"):
            function.cache_clear()
    return _swap_constants(module, new) or changed


def _swap_constants(module: ModuleType, new: CodeType) -> bool:
    """Put changed plain values of a module in its place, and wherever else they were imported by name."""
    values: dict[str, Any] = {"__name__": module.__name__, "__file__": module.__file__}
    exec(new, values)
    changed = False
    for name, value in values.items():
        old = getattr(module, name, None)
        if name.startswith("__") or not _is_plain(value) or not _is_plain(old) or value == old:
            continue
        for other in list(sys.modules.values()):
            if isinstance(other, ModuleType) and getattr(other, name, None) is old:
                setattr(other, name, value)
        changed = True
    return changed


def _is_plain(value: Any) -> bool:
    from numbers import Number

    return isinstance(value, (Number, str, tuple, list, dict, frozenset, set))


def _all_codes(code: CodeType) -> Iterator[CodeType]:
    yield code
    for inner in code.co_consts:
        if isinstance(inner, CodeType):
            yield from _all_codes(inner)

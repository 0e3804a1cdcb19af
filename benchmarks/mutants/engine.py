"""Tests run once without a change to learn which functions each enters, then against every change in a fork.

Everything is imported and collected once, and what a test enters is kept from run to run. A child of the
process swaps the code of the changed function in place, runs the tests that enter it, the likeliest and
quickest first, and says whether one of them failed. Every change first meets the quick tests that are plain
functions; those that these do not notice then meet all tests.
"""

import ast
import builtins
import functools
import gc
import hashlib
import json
import os
import signal
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import suppress
from inspect import CO_NEWLOCALS
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any

import pytest

from changes import Change, changes
from plain import Test, is_plain

# Tests that take longer [s] are left out: a change that only they notice counts as not noticed.
SLOW = float(os.environ.get("SLOW", "1"))
# Tests of a change end after this time [s]; what was not noticed by then counts as not noticed.
BUDGET = float(os.environ.get("BUDGET", "60"))
QUICK, QUICKLY = 0.3, 2.5  # the same of the first stage, after which a change is open
_PRINT = 8  # letters of a file's
_CACHED = type(functools.cache(lambda: None))
NOTICED, OPEN, SURVIVED, UNSEEN, NONE = "noticed", "open", "survived", "unseen", "no change"


class Engine:
    """A pytest plugin whose run of the tests is the run of the changes.

    ``wanted`` says of a key, and of whether this is the first stage, if the change is to be tried; ``told``
    hears each verdict; ``kept`` is the file of what tests enter; ``plainly`` ends after the first stage.
    """

    def __init__(
        self,
        modules: list[Path],
        wanted: Callable[[str, bool], bool],
        told: Callable[[str, Change, str], None],
        kept: Path,
        plainly: bool = False,
    ) -> None:
        self.modules, self.wanted, self.told, self.kept = modules, wanted, told, kept
        self.plainly = plainly
        self.jobs = int(os.environ.get("JOBS", "2"))
        self.killers: dict[str, Counter[str]] = {}
        self.running: dict[int, tuple[str, Change, str, list[Test], int]] = {}

    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        """Run the tests once, then the changes."""
        import hypothesis.internal.conjecture.engine as hypothesis_engine

        hypothesis_engine.MAX_SHRINKS = 0  # that it fails is enough
        session.config.option.maxfail = 1
        every = self._changes()
        tests: list[Test] = []
        for first in (True,) if self.plainly else (True, False):
            if any(self.wanted(key, first) for *_, key in every):
                done = {test.item.nodeid for test in tests}
                rest = [item for item in session.items if item.nodeid not in done]
                tests += self._baseline([item for item in rest if is_plain(item)] if first else rest, first)
                tests.sort(key=lambda test: test.seconds)
                self._stage(every, tests, first)
        return True

    def _changes(self) -> list[tuple[Path, bool, Change, str]]:
        """All changes, those in functions first: others are asked of every test."""
        every = []
        for path in self.modules:
            codes = [code for code in _all_codes(_compiled(path)) if code.co_flags & CO_NEWLOCALS]
            functions = {code.co_qualname.replace("<locals>.", "") for code in codes}
            for change, key in named(changes(path.read_text(encoding="utf-8")), str(path)):
                every.append((path, change.function in functions, change, key))
        return sorted(every, key=lambda entry: not entry[1])

    def _stage(self, every: list[tuple[Path, bool, Change, str]], tests: list[Test], first: bool) -> None:
        longest, until = (QUICK, QUICKLY) if first else (SLOW, BUDGET)
        tests = [test for test in tests if test.seconds < longest]
        for path, inside, change, key in every:
            if not self.wanted(key, first):
                continue
            name = f"{path} {change.function}"
            looks = [test for test in tests if name in test.entered] if inside else list(tests)
            if not looks:
                self.told(key, change, OPEN if first else UNSEEN)
                continue
            while len(self.running) >= self.jobs:
                self._wait(first)
            near, far = self.killers.get(name, Counter()), self.killers.get(str(path), Counter())
            worth = {t.item.nodeid: 5 * near[t.item.nodeid] + far[t.item.nodeid] for t in looks}
            looks.sort(
                key=lambda t, worth=worth: (-worth[t.item.nodeid] / (0.003 + t.seconds) ** 0.5, t.seconds)
            )
            read, write = os.pipe()
            pid = os.fork()
            if pid == 0:
                _child(path, change, looks, write, until)
            os.close(write)
            self.running[pid] = key, change, str(path), looks, read
        while self.running:
            self._wait(first)

    def _wait(self, first: bool) -> None:
        pid, status = os.wait()
        if pid not in self.running:
            return
        key, change, path, looks, read = self.running.pop(pid)
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(pid, signal.SIGKILL)  # what it started
        if killer := os.read(read, 20):
            for where in (path, f"{path} {change.function}"):
                self.killers.setdefault(where, Counter())[looks[int(killer)].item.nodeid] += 1
        os.close(read)
        left = {0: OPEN if first else SURVIVED, 77: NONE}
        self.told(key, change, left.get(os.waitstatus_to_exitcode(status), NOTICED))

    def _baseline(self, items: list[pytest.Item], plainly: bool) -> list[Test]:
        """Each test with the functions of the modules that it enters, and its time."""
        sources = "".join(_print(path) for path in self.modules)
        rows = [json.loads(line) for line in self.kept.read_text().splitlines()] if self.kept.exists() else []
        kept = {(row["test"], row["print"]): row for row in rows}
        took = {(row["test"], row["print"][:_PRINT]): row["seconds"] for row in rows}
        found = []
        builtins.__entered__ = set().add  # type: ignore[attr-defined] # modules call functions of their own
        for path in self.modules:
            swap(path, _instrumented(path))
        remembering = [function for path in self.modules for function in _caches(path)]
        for item in items:
            key = item.nodeid, _print(item.path) + sources
            if key not in kept:
                if took.get((item.nodeid, key[1][:_PRINT]), 0.0) > 2 * SLOW:
                    continue  # what modules change makes it no quick one
                entered: set[str] = set()
                for function in remembering:
                    function.cache_clear()
                builtins.__entered__ = entered.add  # type: ignore[attr-defined]
                start = time.process_time()
                if not Test(item, plainly).passes():
                    if not plainly:  # as a plain function it may lack what pytest does
                        print(f"{item.nodeid} fails without a change, and is left out", flush=True)
                    continue
                taken = time.process_time() - start
                kept[key] = {"test": key[0], "print": key[1], "entered": sorted(entered), "seconds": taken}
                with self.kept.open("a") as file:
                    file.write(json.dumps(kept[key]) + "\n")
            found.append(Test(item, plainly, frozenset(kept[key]["entered"]), kept[key]["seconds"]))
        _functions.cache_clear()
        _caches.cache_clear()
        for path in self.modules:
            swap(path, ast.parse(path.read_text(encoding="utf-8")))
        gc.freeze()  # forks share what is here
        return found


@functools.cache
def _print(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()[:_PRINT]


def _instrumented(path: Path) -> ast.Module:
    """The module, each of whose functions says that it was entered."""
    tree = ast.parse(path.read_text(encoding="utf-8"))

    def walk(node: ast.AST, function: str) -> None:
        for child in ast.iter_child_nodes(node):
            named = isinstance(child, (ast.FunctionDef, ast.ClassDef))
            inside = f"{function}.{child.name}".lstrip(".") if named else function
            walk(child, inside)
            if isinstance(child, ast.FunctionDef):
                told = ast.parse(f"__entered__({f'{path} {inside}'!r})").body[0]
                child.body.insert(0, ast.copy_location(told, child.body[0]))

    walk(tree, "")
    return ast.fix_missing_locations(tree)


def _compiled(path: Path) -> CodeType:
    return compile(path.read_text(encoding="utf-8"), str(path), "exec")


def named(found: Iterator[Change], module: str) -> Iterator[tuple[Change, str]]:
    """Changes and keys; equal ones of one function are counted."""
    count: dict[str, int] = {}
    short = module.split("/src/regrasp/")[-1]
    for change in found:
        key = f"{short} {change.key}".strip()
        count[key] = count.get(key, 0) + 1
        yield change, key if count[key] == 1 else f"{key}  ({count[key]})"


def _child(path: Path, change: Change, tests: list[Test], write: int, until: float) -> None:
    """Never returns: the status says whether a test failed, ``write`` hears which."""
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, 1)
    os.dup2(null, 2)
    signal.alarm(60)
    os.nice(5)
    os.setpgid(0, 0)
    try:
        if not swap(path, change.tree):
            os._exit(77)
    except Exception:
        os._exit(77)
    try:
        for k, test in enumerate(tests):  # what takes ten times its time goes round for ever, and is noticed
            signal.alarm(int((15 if test.plain else 60) + 20 * test.seconds))
            signal.setitimer(signal.ITIMER_PROF, (1 if test.plain else 5) + 10 * test.seconds)
            if not test.passes():
                os.write(write, str(k).encode())
                os._exit(1)
            if time.process_time() > until:
                break
    except BaseException:
        os._exit(1)
    os._exit(0)


def swap(path: Path, tree: ast.Module) -> bool:
    """Put the code of ``tree`` in the place of the module's, in every function that is alive."""
    module = next(m for m in list(sys.modules.values()) if getattr(m, "__file__", None) == str(path))
    new = compile(tree, str(path), "exec")
    codes = {(code.co_qualname, code.co_firstlineno): code for code in _all_codes(new)}
    changed = False
    for function in _functions(path):
        code = codes.get((function.__code__.co_qualname, function.__code__.co_firstlineno))
        if code is not None and code != function.__code__:
            function.__code__ = code
            changed = True
    for function in _caches(path):
        function.cache_clear()
    return _swap_constants(module, new) or changed


@functools.cache
def _functions(path: Path) -> list[FunctionType]:
    """The functions of a module: looked for once, not in each fork."""
    gc.unfreeze()  # a test of the command line may have hidden them all
    return [
        function
        for function in gc.get_objects()
        if isinstance(function, FunctionType) and function.__code__.co_filename == str(path)
    ]


@functools.cache
def _caches(path: Path) -> list[Any]:
    """The functions of a module that remember what they returned."""
    return [
        function
        for function in gc.get_objects()
        if isinstance(function, _CACHED)
        and getattr(getattr(function.__wrapped__, "__code__", None), "co_filename", "") == str(path)
    ]


def _swap_constants(module: ModuleType, new: CodeType) -> bool:
    """Put changed plain values of a module in its place, and wherever else they were imported by name."""
    values: dict[str, Any] = {"__name__": module.__name__, "__file__": module.__file__}
    exec(new, values)
    changed = False
    for name, value in values.items():
        old = getattr(module, name, None)
        if getattr(old, "__module__", "") == module.__name__:
            changed |= _swap_defaults(old, value)
        if (
            name.startswith("__")
            or value is old  # NaN, too
            or not _is_plain(value)
            or not _is_plain(old)
            or value == old
        ):
            continue
        for other in list(sys.modules.values()):
            if isinstance(other, ModuleType) and vars(other).get(name) is old:
                setattr(other, name, value)
        changed = True
    return changed


def _swap_defaults(old: Any, new: Any) -> bool:
    """Put changed plain defaults of a function, or of those of a class (so of fields), in its place."""
    if isinstance(old, type) and isinstance(new, type):
        functions = [
            (one, vars(new).get(name)) for name, one in vars(old).items() if not isinstance(one, type)
        ]
        return sum(_swap_defaults(*pair) for pair in functions) > 0
    if not (isinstance(old, FunctionType) and isinstance(new, FunctionType)):
        return False
    changed = False
    for name in ("__defaults__", "__kwdefaults__"):
        one, other = getattr(old, name) or (), getattr(new, name) or ()
        values = [list(each.values() if isinstance(each, dict) else each) for each in (one, other)]
        if any(a != b for a, b in zip(*values, strict=True) if _is_plain(a) and _is_plain(b)):
            setattr(old, name, other)
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

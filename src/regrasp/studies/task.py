"""What is done with a case, wherever it is done: a function by its name, and what is kept of its answer."""

import platform
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from time import perf_counter
from typing import Any, NamedTuple

from regrasp.errors import Infeasible, InvalidInput, RegraspError, shown
from regrasp.studies.axes import Plain, plain
from regrasp.studies.cases import Case

ANSWERED, INFEASIBLE, INVALID, UNVERIFIED = "answered", "infeasible", "invalid", "not verified"
FAILED, LATE, MEMORY, LOST = "failed", "time limit", "out of memory", "worker lost"
VERDICTS = (ANSWERED, INFEASIBLE, INVALID, UNVERIFIED, FAILED, LATE, MEMORY, LOST)
_COMMON = ("value", "margin", "moves", "friction_needed", "duration")
_SHOWN = 400  # letters of an error


class NotVerified(RegraspError):
    """A plan of a case did not verify."""


class NotKept(InvalidInput):
    """What is to be kept is not there: of this case and surely of the others."""


class Outcome(NamedTuple):
    """What came of a case."""

    verdict: str
    outputs: dict[str, Plain]
    error: str | None = None
    certificate: str | None = None
    seconds: float = 0.0
    plan: Any = None
    """To be written to a file, if that was asked for."""


@dataclass(frozen=True, eq=False)
class Task:
    """A function of a case.

    name: "module:function". keep: attributes or keys of what it returns; empty for all of a mapping, or the
    common ones. shared: arguments that all cases share. plans: whether the plan itself is kept.
    """

    name: str
    keep: tuple[str, ...] = ()
    shared: Mapping[str, Any] = field(default_factory=dict)
    plans: bool = False

    def function(self) -> Callable[..., Any]:
        """The function. Raises ``InvalidInput`` where it cannot be imported."""
        return function_named(self.name)

    def outcome(self, function: Callable[..., Any], case: Case) -> Outcome:
        """Do one case; only ``NotKept`` is raised."""
        started = perf_counter()
        result, outputs, certificate = None, {}, None
        try:
            result = function(**case, **self.shared)
            outputs, verdict, error = self.kept(result), ANSWERED, None
        except NotKept:
            raise
        except Infeasible as no:
            verdict, error = INFEASIBLE, _line(str(no))
            certificate = None if no.certificate is None else type(no.certificate).__name__
        except NotVerified as no:
            verdict, error = UNVERIFIED, _line(str(no))
        except InvalidInput as no:
            verdict, error = INVALID, _line(str(no))
        except MemoryError as no:
            verdict, error = MEMORY, _line(f"MemoryError: {str(no) or 'no memory left'}")
        except (Exception, SystemExit) as no:
            verdict, error = FAILED, _line(f"{type(no).__name__}: {no}")
        took = perf_counter() - started
        plan = getattr(result, "plan", result) if self.plans and verdict == ANSWERED else None
        return Outcome(verdict, outputs, error, certificate, took, plan)

    def kept(self, result: Any) -> dict[str, Plain]:
        """What is kept of a result, as plain values; of entries that are no numbers, how many."""
        if isinstance(result, Mapping):
            names = self.keep or tuple(result)
            return {name: _value(_entry(result, name), name) for name in names}
        if result is None or isinstance(result, (bool, int, float, str)) or hasattr(result, "dtype"):
            if self.keep not in ((), ("value",)):
                raise NotKept(f"{self.name} returns a value, of which {', '.join(self.keep)} cannot be kept")
            return {"value": _value(result, "value")}
        names = self.keep or tuple(name for name in _COMMON if hasattr(result, name))
        if not names:
            raise NotKept(f"{self.name} returns {shown(result)}: say what to keep of it")
        return {name: _value(_attribute(result, name), name) for name in names}


def name_of(function: Any) -> str:
    """The name by which workers find a function. Raises ``InvalidInput`` where they cannot."""
    if isinstance(function, str):
        function_named(function)
        return function
    module, name = getattr(function, "__module__", None), getattr(function, "__qualname__", "<none>")
    if not callable(function) or not isinstance(module, str):
        raise InvalidInput(
            f"function must be a function or its name 'module:function', got {shown(function)}"
        )
    if module == "__main__" or "<" in name:
        raise InvalidInput(
            f"workers import the function by its name, and do not find {shown(name)} of {module}; "
            "put it into a module, or give workers=0"
        )
    if function_named(f"{module}:{name}") is not function:
        raise InvalidInput(f"{module}:{name} is another function than the one given; give workers=0")
    return f"{module}:{name}"


def function_named(name: str) -> Callable[..., Any]:
    """The function of a name "module:function". Raises ``InvalidInput`` where there is none."""
    module, colon, path = name.partition(":")
    if not (colon and module and path):
        raise InvalidInput(f"function must be named 'module:function', got {shown(name)}")
    try:
        value: Any = import_module(module)
        for part in path.split("."):
            value = getattr(value, part)
    except (ImportError, AttributeError, ValueError) as error:
        raise InvalidInput(f"function {name} cannot be imported: {error}") from None
    if not callable(value):
        raise InvalidInput(f"{name} must be a function, got {shown(value)}")
    found: Callable[..., Any] = value
    return found


@cache
def machine() -> str:
    """Where rows are made."""
    return platform.node() or "unknown"


@cache
def versions() -> str:
    """What rows are made with."""
    found = [f"python {platform.python_version()}"]
    for package in ("regrasp", "numpy", "numba"):
        try:
            found.append(f"{package} {version(package)}")
        except PackageNotFoundError:
            continue
    return ", ".join(found)


def _entry(result: Mapping[str, Any], name: str) -> Any:
    if name not in result:
        raise NotKept(f"keep: a case returns no {shown(name)}; it has {', '.join(map(str, result))}")
    return result[name]


def _attribute(result: Any, name: str) -> Any:
    value = result
    for part in name.split("."):
        if not hasattr(value, part):
            there = ", ".join(key for key in dir(value) if not key.startswith("_"))
            raise NotKept(f"keep: a {type(value).__name__} has no {shown(part)}; it has {there}")
        value = getattr(value, part)
    return value


def _value(value: Any, name: str) -> Plain:
    """A plain value; numbers that are not finite stay, as rows hold them."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, float):
        return value
    try:
        return plain(value, name)
    except InvalidInput:
        pass
    if isinstance(value, (list, tuple)) and all(isinstance(entry, (int, float)) for entry in value):
        return [float(entry) for entry in value]
    if hasattr(value, "__len__"):
        return len(value)
    raise NotKept(f"keep: {name} must be a number, text or a list of numbers, got {shown(value)}")


def _line(text: str) -> str:
    text = " ".join(text.split())
    return text if len(text) <= _SHOWN else f"{text[: _SHOWN - 3]}..."

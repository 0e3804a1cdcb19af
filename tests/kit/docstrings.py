"""The public names of the project and what their docstrings say of parameters."""

import ast
import inspect
import re
import textwrap
from collections.abc import Iterator
from enum import Enum
from importlib import import_module
from typing import Any, NamedTuple

ROOMS = ("regrasp", "regrasp.programs", "regrasp.files", "regrasp.plots", "regrasp.verification")
_ENTRY = re.compile(r"^    (\*{0,2}\w+): ", re.MULTILINE)


class Documented(NamedTuple):
    """A public function, method or class: its name, where it is defined, and the object itself."""

    name: str
    module: str
    value: Any

    @property
    def parameters(self) -> list[str]:
        """The parameters that a caller gives."""
        if inspect.isclass(self.value) and (_is_plain(self.value) or hasattr(self.value, "model_fields")):
            return []  # the fields of a model of files describe themselves
        found = inspect.signature(self.value).parameters.values()
        first = 1 if "." in self.name and not inspect.isclass(self.value) and _takes_self(self) else 0
        return [("*" * _stars(p)) + p.name for p in list(found)[first:]]

    @property
    def documented(self) -> list[str]:
        """The parameters its docstring names, and those fields of a class that have words of their own."""
        named = args_of(inspect.getdoc(self.value) or "")
        fields = attributes_of(self.value) if inspect.isclass(self.value) else []
        return named + [name for name in fields if name in self.parameters]


def _is_plain(cls: type) -> bool:
    made = inspect.isfunction(cls.__init__) or issubclass(cls, tuple)
    return not made or issubclass(cls, Enum)


def _stars(p: inspect.Parameter) -> int:
    return {p.VAR_POSITIONAL: 1, p.VAR_KEYWORD: 2}.get(p.kind, 0)


def _takes_self(entry: Documented) -> bool:
    return next(iter(inspect.signature(entry.value).parameters), "") == "self"


def section(doc: str, title: str) -> str | None:
    """The lines of one section of a docstring, indented as they are."""
    found = re.search(rf"^{title}:\n((?:    .*\n|\n)+)", doc + "\n", re.MULTILINE)
    return found[1] if found else None


def args_of(doc: str) -> list[str]:
    """The names in the section ``Args``, in order."""
    return _ENTRY.findall(section(doc, "Args") or "")


def attributes_of(cls: type) -> list[str]:
    """The fields of a class that a string of their own describes."""
    found = []
    for base in reversed(cls.__mro__[:-1]):
        if base.__module__.startswith("regrasp"):
            (node,) = ast.parse(textwrap.dedent(inspect.getsource(base))).body
            assert isinstance(node, ast.ClassDef)
            for line, after in zip(node.body, node.body[1:], strict=False):
                words = isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant)
                if isinstance(line, ast.AnnAssign) and words:
                    found.append(ast.unparse(line.target))
    return found


def public() -> Iterator[Documented]:
    """Every public function and class, and every public method of the classes, once."""
    seen = set()
    for room in ROOMS:
        module = import_module(room)
        for name in module.__all__:
            value = getattr(module, name)
            if not callable(value) or id(value) in seen or not str(value.__module__).startswith("regrasp"):
                continue
            seen.add(id(value))
            yield Documented(name, value.__module__, value)
            if inspect.isclass(value):
                for method in vars(value):
                    member = getattr(value, method)
                    if not method.startswith("_") and (
                        inspect.isfunction(member) or inspect.ismethod(member)
                    ):
                        yield Documented(f"{name}.{method}", value.__module__, member)

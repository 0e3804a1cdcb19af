"""Which module imports which, read from the sources: for the rules of the house and the map of it."""

import ast
from functools import cache
from pathlib import Path


def sources(root: Path) -> dict[str, str]:
    """Module name -> source, for every module of the package at ``root``, read once."""
    return dict(_read(root))


@cache
def _read(root: Path) -> dict[str, str]:
    found = {}
    for path in root.rglob("*.py"):
        parts = path.relative_to(root).with_suffix("").parts
        found[".".join((root.name, *parts)).removesuffix(".__init__")] = path.read_text(encoding="utf-8")
    return found


def imported(module: str, modules: dict[str, str]) -> set[str]:
    """Every module imported anywhere in ``module``: in functions, for types only or by a literal name."""
    is_package = any(name.startswith(f"{module}.") for name in modules)
    here = module.split(".") if is_package else module.split(".")[:-1]
    found: set[str] = set()
    for level, base, name in _named(modules[module]):
        if level:
            base = ".".join([*here[: len(here) - level + 1], *([base] if base else [])])
        whole = f"{base}.{name}"
        found.add(whole if name and whole in modules else base)
    return found


@cache
def _named(source: str) -> list[tuple[int, str, str]]:
    """Dots in front, module and name of every import of a source, which is parsed once for all rules."""
    found = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found += [(0, alias.name, "") for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            found += [(node.level, node.module or "", alias.name) for alias in node.names]
        elif isinstance(node, ast.Call) and node.args and isinstance(node.args[0], ast.Constant):
            called = ast.unparse(node.func).rpartition(".")[2]
            if called in ("import_module", "__import__"):
                found.append((0, str(node.args[0].value), ""))
    return found

"""Which module imports which, read from the sources: for the rules of the house and the map of it."""

import ast
from pathlib import Path


def sources(root: Path) -> dict[str, str]:
    """Module name -> source, for every module of the package at ``root``."""
    found = {}
    for path in root.rglob("*.py"):
        parts = path.relative_to(root).with_suffix("").parts
        found[".".join((root.name, *parts)).removesuffix(".__init__")] = path.read_text(encoding="utf-8")
    return found


def imported(module: str, modules: dict[str, str]) -> set[str]:
    """Every module imported anywhere in ``module``: in functions, for types only or by a literal name."""
    is_package = any(name.startswith(f"{module}.") for name in modules)
    found: set[str] = set()
    for node in ast.walk(ast.parse(modules[module])):
        if isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                here = module.split(".") if is_package else module.split(".")[:-1]
                base = ".".join([*here[: len(here) - node.level + 1], *([base] if base else [])])
            for alias in node.names:
                whole = f"{base}.{alias.name}"
                found.add(whole if whole in modules else base)
        elif isinstance(node, ast.Call) and node.args and isinstance(node.args[0], ast.Constant):
            called = ast.unparse(node.func).rpartition(".")[2]
            if called in ("import_module", "__import__"):
                found.add(str(node.args[0].value))
    return found

"""Measures what is installed and writes the tables of installing.md: python docs/megabytes.py."""

import re
import tomllib
from importlib.metadata import PackageNotFoundError, distribution, requires
from pathlib import Path

from packaging.requirements import Requirement

PAGE = Path(__file__).with_name("installing.md")
PROJECT = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text(encoding="utf-8"))["project"]
EXTRAS = PROJECT["optional-dependencies"]
WHAT_FOR = {
    "clarabel": "the conic solver behind three fingers and more, and space",
    "click": "the command line",
    "cvxpy": 'whatever solver cvxpy finds (`method="cvxpy"`); it brings SCS',
    "matplotlib": "pictures and films",
    "numba": "compiled sweeps: many pairs, hold graphs, wrench balls (with LLVM)",
    "numpy": "arrays; all that `import regrasp` loads",
    "osqp": "a second opinion on quadratic programs",
    "pydantic": "scenario files, checked to the key",
    "qpsolvers": "any other QP solver by its name",
    "rich": "tables and colours on the command line",
    "scipy": "sparse matrices, hulls, splines",
    "shapely": "outlines: mending, holes, distances",
}


def closure(name: str, extra: str = "") -> set[str]:
    """Distributions that come with one, itself left out."""
    found: set[str] = set()
    todo = [(name, extra)]
    while todo:
        dist, wanted = todo.pop()
        for line in needs(dist, wanted):
            need = Requirement(line)
            if need.marker and not any(need.marker.evaluate({"extra": e}) for e in {wanted, ""}):
                continue
            for more in need.extras or {""}:
                if canonical(need.name) not in found or more:
                    found.add(canonical(need.name))
                    if need.name != "regrasp":
                        todo.append((need.name, more))
    return {one for one in found if installed(one) and one != "regrasp"}


def needs(dist: str, extra: str) -> list[str]:
    """What a distribution requires; our own from today's pyproject.toml."""
    if dist == "regrasp":
        return [*PROJECT["dependencies"], *EXTRAS.get(extra, ())]
    return requires(dist) or []


def canonical(name: str) -> str:
    """One spelling for each distribution."""
    return re.sub(r"[-_.]+", "-", name).lower()


def installed(name: str) -> bool:
    """Whether a distribution is here to be measured."""
    try:
        distribution(name)
    except PackageNotFoundError:
        return False
    return True


def megabytes(names: set[str]) -> float:
    """Size on disk, byte code left out [MB]."""
    total = 0
    for name in names:
        for file in distribution(name).files or ():
            path = Path(str(file.locate()))
            if path.suffix != ".pyc" and path.is_file():
                total += path.stat().st_size
    return total / 1e6


def tables() -> str:
    """Both tables as Markdown."""
    direct = {canonical(Requirement(line).name) for line in needs("regrasp", "")}
    core = closure("regrasp")
    lines = ["| package | MB | with what it brings | what for |", "|---|--:|--:|---|"]
    rows = [(megabytes({name}), name) for name in direct]
    for size, name in sorted(rows, reverse=True):
        own = closure(name) - direct
        lines.append(f"| {name} | {size:.1f} | {size + megabytes(own):.1f} | {WHAT_FOR.get(name, '')} |")
    lines += [f"| **all of the core** | | **{megabytes(core):.0f}** | {len(core)} packages |", ""]
    lines += ["| extra | MB besides the core |", "|---|--:|"]
    for extra in sorted(EXTRAS.keys() - {"dev"}):
        lines.append(f"| `{extra}` | {megabytes(closure('regrasp', extra) - core):.1f} |")
    return "\n".join(lines)


if __name__ == "__main__":
    before, _, rest = PAGE.read_text(encoding="utf-8").partition("<!-- measured -->\n")
    after = rest.partition("<!-- end -->")[2]
    PAGE.write_text(f"{before}<!-- measured -->\n{tables()}\n<!-- end -->{after}", encoding="utf-8")

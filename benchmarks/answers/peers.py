"""How many of other people's test programs each back end answers rightly; writes the table of docs/peers.md.

    python benchmarks/answers/peers.py [-o FILE]

Right is the optimum that its authors print, to ``TOLERANCE``, or their verdict; where they print none, an
answer whose own duals prove it here, in plain NumPy. Refused is an error or a status that claims nothing.
"""

import argparse
import logging
import warnings
from collections import Counter
from math import inf
from pathlib import Path

import numpy as np

from peer_problems import Peer, peers
from regrasp.errors import InvalidInput, SolverUnavailable
from regrasp.programs import Cone, Program, Solution, Status, available_backends, solve
from regrasp.programs.facts import BACKENDS

PAGE = Path(__file__).parents[2] / "docs" / "peers.md"
BEGIN, END = "<!-- counts -->\n", "<!-- end of counts -->"
TOLERANCE = 1e-5
RIGHT, WRONG, REFUSED, NOT_TAKEN = "right", "wrong", "refused", "not taken"
_CVXPY = ("CLARABEL", "SCS", "ECOS", "CVXOPT", "QOCO")


def backends() -> list[str]:
    """``auto``, every installed back end, and conic solvers of cvxpy."""
    names = [name for name in available_backends() if name != "cvxpy"]
    if "cvxpy" in available_backends():
        import cvxpy

        names += [f"cvxpy:{name}" for name in _CVXPY if name in cvxpy.installed_solvers()]
    return ["auto", *names]


def outcome(peer: Peer, backend: str) -> str:
    """What comes of one program on one back end."""
    taken = BACKENDS.get(backend.partition(":")[0])
    if peer.program.has_second_order and taken is not None and not taken.second_order:
        return NOT_TAKEN
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            answer = solve(peer.program, backend, throw=False)
    except (InvalidInput, SolverUnavailable):
        return REFUSED
    if answer.status in (Status.INFEASIBLE, Status.UNBOUNDED):
        said = inf if answer.status is Status.INFEASIBLE else -inf
        return RIGHT if peer.optimum == said else WRONG
    if answer.status is not Status.SOLVED:
        return REFUSED
    return RIGHT if is_right(peer, answer) else WRONG


def is_right(peer: Peer, answer: Solution) -> bool:
    """Whether a solution is the optimum that is printed, or proves itself where none is."""
    program, x, z = answer.program, answer.value, answer.duals
    value = 0.5 * float(x @ program.P @ x) + float(program.q @ x)
    size = max(1.0, abs(value), abs(peer.constant))
    sides = 1 + abs(program.b) + abs(program.A) @ abs(x)
    if outside(program, program.b - program.A @ x, sides) > TOLERANCE:
        return False
    if peer.optimum is not None:
        return abs(value + peer.constant - peer.optimum) <= TOLERANCE * size
    duals = np.full(z.size, 1 + abs(z).max(initial=0.0))
    gradient = program.P @ x + program.q + program.A.T @ z
    terms = 1 + abs(program.P) @ abs(x) + abs(program.q) + abs(program.A.T) @ abs(z)
    slack = abs((program.b - program.A @ x) @ z)
    misses = (outside(program, z, duals, dual=True), (abs(gradient) / terms).max(), slack / size)
    return max(misses) <= TOLERANCE


def outside(program: Program, s: np.ndarray, sizes: np.ndarray, *, dual: bool = False) -> float:
    """How far s lies outside the cones, or their duals, beside the sizes of the rows."""
    worst = 0.0
    for block, rows in program.slices:
        if block.cone is Cone.SECOND_ORDER:
            each = s[rows].reshape(block.count, block.size)
            out = np.linalg.norm(each[:, 1:], axis=1) - each[:, 0]
            worst = max(worst, float(out.max() / sizes[rows].max()))
        elif block.cone is Cone.NONNEGATIVE:
            worst = max(worst, float((-s[rows] / sizes[rows]).max()))
        elif not dual:
            worst = max(worst, float((abs(s[rows]) / sizes[rows]).max()))
    return worst


def counts() -> dict[str, Counter[str]]:
    """What came of all programs, by back end."""
    logging.getLogger("regrasp.programs").setLevel(logging.ERROR)  # auto says which back end it leaves
    problems = peers().values()
    return {name: Counter(outcome(peer, name) for peer in problems) for name in backends()}


def table(found: dict[str, Counter[str]]) -> str:
    """The table in Markdown."""
    words = (RIGHT, REFUSED, NOT_TAKEN, WRONG)
    lines = [f"| back end | {' | '.join(words)} |", "| --- |" + " ---: |" * len(words)]
    lines += [f"| `{name}` | {' | '.join(str(there[w]) for w in words)} |" for name, there in found.items()]
    return "\n".join(lines) + "\n"


def documented(page: str) -> dict[str, int]:
    """Right answers by back end as a page has them."""
    lines = page.split(BEGIN)[1].split(END)[0].splitlines()[2:]
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if line]
    return {row[0].strip("`"): int(row[1]) for row in rows}


def main() -> None:
    parser = argparse.ArgumentParser(description="count right answers to other people's test programs")
    parser.add_argument("-o", "--output", type=Path, default=PAGE)
    path = parser.parse_args().output
    head, _, rest = PAGE.read_text(encoding="utf-8").partition(BEGIN)
    path.write_text(head + BEGIN + table(counts()) + END + rest.partition(END)[2], encoding="utf-8")
    print(f"wrote {path}")


if __name__ == "__main__":
    main()

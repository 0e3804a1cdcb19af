"""Does a change of the code change any answer? Thousands of tasks through the public verbs, to the last bit.

    python benchmarks/answers/same_answers.py record FILE.npz   # a minute; before the change and after
    python benchmarks/answers/same_answers.py compare BEFORE.npz AFTER.npz

The tasks are drawn from fixed seeds, so two runs of one version on one machine are equal to the last bit.
``compare`` counts by kind the tasks that are, with the largest difference relative to the task's largest
force (of other numbers: to the largest of their own), and the largest of the objectives' values alone, since
many forces may share one. It lists the tasks whose outcome differs: an error's type and text, names of
fingers and methods, the verdict, or which values there are. Printed text is compared besides ("words"). Exit
status 1 where an outcome differs, or a number by more than 1e-9; words alone are left to the reader.
"""

import argparse
import sys
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from itertools import zip_longest
from pathlib import Path
from time import perf_counter

import numpy as np

from answer_plans import PLANS
from answer_states import STATES
from answers import Answer, Told, load, save, told_by

ALLOWED = 1e-9
PACKAGES = ("clarabel", "cvxpy", "numba", "numpy", "osqp", "qpsolvers", "regrasp", "scipy", "shapely")
# How much of a long text is shown.
SHOWN = 200

Texts = tuple[str, str]


@dataclass(frozen=True)
class Difference:
    """What differs between two answers to one task.

    equal: whether all values are, to the last bit. worst: the name of the value that differs most, by
    ``amount`` relative to its scale. optimum: by how much the value of an objective does. outcome, words:
    before and after, None where they are the same.
    """

    kind: str
    key: str
    equal: bool
    worst: str
    amount: float
    optimum: float
    outcome: Texts | None
    words: Texts | None

    @property
    def matters(self) -> bool:
        """Whether the answer is another one."""
        return self.outcome is not None or self.amount > ALLOWED


def differences(before: Iterable[Answer], after: Iterable[Answer]) -> list[Difference]:
    """One for each task of either side, in the order of the first."""
    sides = [{(a.kind, a.key): a.told for a in side} for side in (before, after)]
    tasks = dict.fromkeys((*sides[0], *sides[1]))
    return [_difference(*task, *(side.get(task) for side in sides)) for task in tasks]


def _difference(kind: str, key: str, a: Told | None, b: Told | None) -> Difference:
    if a is None or b is None:
        outcome = tuple("no such task" if told is None else told.outcome for told in (a, b))
        return Difference(kind, key, False, "", 0.0, 0.0, outcome, None)
    outcome = (a.outcome, b.outcome)
    if a.outcome == b.outcome:
        outcome = (_layout(a), _layout(b))
    equal, amount, worst, optimum = True, 0.0, "", 0.0
    for name in filter(b.values.__contains__, a.values):
        (x, scale), (y, _) = a.values[name], b.values[name]
        if x.shape != y.shape or x.tobytes() == y.tobytes():
            continue
        equal = False
        apart = _apart(x, y) / scale
        if name.endswith("value"):
            optimum = max(optimum, apart)
        if apart > amount:
            amount, worst = apart, name
    equal = equal and outcome[0] == outcome[1]
    told = (outcome, (a.words, b.words))
    return Difference(kind, key, equal, worst, amount, optimum, *(t if t[0] != t[1] else None for t in told))


def _layout(told: Told) -> str:
    return ", ".join(f"{name} {value.numbers.shape}" for name, value in sorted(told.values.items()))


def _apart(x: np.ndarray, y: np.ndarray) -> float:
    """The largest difference; infinite where one is infinite or not a number and the other is not."""
    same = (x == y) | (np.isnan(x) & np.isnan(y))
    with np.errstate(invalid="ignore"):
        apart = np.where(same, 0.0, abs(x - y))
    return float(np.where(np.isnan(apart), np.inf, apart).max())


def report(found: Sequence[Difference], most: int) -> str:
    """A line for each kind, then of each kind up to ``most`` tasks that differ, in each way."""
    lines = [
        f"{'':28}{'tasks':>7}{'to the bit':>12}{'largest':>12}{'outcomes':>10}{'words':>7}{'optimum':>12}"
    ]
    for kind in dict.fromkeys(d.kind for d in found):
        lines.append(_row(kind, [d for d in found if d.kind == kind]))
    lines.append(_row("all", found))
    other = [d for d in found if d.outcome]
    lines += _listing("other outcome", other, most, lambda d: _beside(*d.outcome))
    moved = sorted((d for d in found if not d.equal and not d.outcome), key=lambda d: -d.amount)
    lines += _listing("other bits", moved, most, lambda d: [f"{d.worst or 'sign of zero'}: {d.amount:.3g}"])
    said = [d for d in found if d.words]
    lines += _listing("other words", said, most, lambda d: _beside(*d.words))
    return "\n".join(lines)


def _row(kind: str, found: Sequence[Difference]) -> str:
    equal, outcomes, words = (
        sum(map(bool, marks)) for marks in zip(*((d.equal, d.outcome, d.words) for d in found), strict=True)
    )
    worst, optimum = (max(sizes) for sizes in zip(*((d.amount, d.optimum) for d in found), strict=True))
    return f"{kind:28}{len(found):7}{equal:12}{worst:12.3g}{outcomes:10}{words:7}{optimum:12.3g}"


def _listing(
    title: str, found: Sequence[Difference], most: int, shown: Callable[[Difference], list[str]]
) -> list[str]:
    lines, listed = [f"\n{title}: {len(found)}"] if found else [], Counter[str]()
    for d in found:
        listed[d.kind] += 1
        if listed[d.kind] <= most:
            lines += [f"  {d.kind}: {d.key}", *(f"    {line}" for line in shown(d))]
    return lines + [f"  {kind}: and {n - most} more" for kind, n in listed.items() if n > most]


def _beside(before: str, after: str) -> list[str]:
    """The first line that differs, from a little before the place."""
    pairs = zip_longest(before.splitlines(), after.splitlines(), fillvalue="")
    a, b = next(((x, y) for x, y in pairs if x != y), (before, after))
    place = next((k for k, (x, y) in enumerate(zip(a, b, strict=False)) if x != y), min(len(a), len(b)))
    start = max(place - SHOWN // 4, 0) if max(len(a), len(b)) > SHOWN else 0
    cut = "... " if start else ""
    return [f"{sign} {cut}{text[start : start + SHOWN]}" for sign, text in (("-", a), ("+", b))]


def recorded() -> list[Answer]:
    """Work every task."""
    answers = []
    for kind, tasks in (STATES | PLANS).items():
        start, count = perf_counter(), len(answers)
        answers += [Answer(kind, key, told_by(task)) for key, task in tasks()]
        print(f"{kind:28}{len(answers) - count:6} tasks {perf_counter() - start:8.1f} s", flush=True)
    twice = [task for task, count in Counter((a.kind, a.key) for a in answers).items() if count > 1]
    if twice:
        raise RuntimeError(f"tasks of one key: {twice}")
    return answers


def versions() -> dict[str, str]:
    """Of the packages that bits depend on."""
    found = {}
    for name in PACKAGES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "none"
    return found


def main(arguments: Sequence[str] | None = None) -> int:
    """The command line; returns the exit status."""
    raw = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=raw)
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("record", help="work all tasks").add_argument("file", type=Path)
    comparing = commands.add_parser("compare", help="tell two records apart")
    comparing.add_argument("before", type=Path)
    comparing.add_argument("after", type=Path)
    comparing.add_argument("--most", type=int, default=3, help="tasks listed of each kind (default: 3)")
    options = parser.parse_args(arguments)
    if options.command == "record":
        save(options.file, versions(), recorded())
        return 0
    (old, before), (new, after) = load(options.before), load(options.after)
    for name in sorted(old.keys() | new.keys()):
        if old.get(name) != new.get(name):
            print(f"{name}: {old.get(name)} before, {new.get(name)} after; bits may differ for that alone")
    found = differences(before, after)
    print(report(found, options.most))
    return int(any(d.matters for d in found))


if __name__ == "__main__":
    sys.exit(main())

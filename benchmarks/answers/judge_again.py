"""Judge the rows of a run anew by their own numbers, after what counts as right has changed.

    python benchmarks/answers/judge_again.py [FOLDER [CERTIFICATES]]

FOLDER holds ``rows.jsonl.xz`` and ``run.json``; both the rows and the report are written again. A row keeps
no point and no certificate, so whether constraints hold stays as it was measured, and so does how far a
certificate is off, unless CERTIFICATES is a folder where the same solvers have solved the same problems
since: then that residual is taken from there, and nothing else. What is judged anew is the distance from the
known optimum and what a certificate counts for. Programs that planning makes differ from release to release
in their last digits: a row of such a program keeps the optimum that it was asked for.
"""

import lzma
import sys
from collections import Counter
from dataclasses import replace
from math import isclose
from pathlib import Path
from shutil import copy
from tempfile import TemporaryDirectory

from regrasp.bench.families import FAMILIES
from regrasp.bench.judging.judgement import is_near, is_proof
from regrasp.bench.problems.problem import BenchProblem, Verdict
from regrasp.bench.problems.settings import right_within
from regrasp.bench.reporting.report import write_report
from regrasp.bench.running.result import Key, Row
from regrasp.bench.running.store import ROWS, read_rows
from regrasp.programs.answer import Claim

FOLDER = Path(__file__).parents[1] / "solvers"


def judged_again(row: Row, problem: BenchProblem, since: dict[Key, Row]) -> Row:
    """The row with the verdict that its numbers deserve now."""
    known, within = problem.known, right_within(row.settings)
    if row.digest != problem.digest and row.optimum is not None:
        known = replace(known, optimum=row.optimum)
    if row.status == Claim.INFEASIBLE.value and known.verdict is Verdict.INFEASIBLE:
        newer = since.get(row.key)
        residual = row.certificate_residual
        if newer is not None and (newer.status, newer.version) == (row.status, row.version):
            residual = newer.certificate_residual
        if residual is None:
            return replace(row, correct=None, why="claims infeasibility without a certificate")
        proven = is_proof(residual)
        why = f"its certificate {'proves' if proven else 'does not prove'} infeasibility"
        return replace(row, correct=proven or None, why=why, certificate_residual=residual)
    breaks = row.primal_residual is None or row.primal_residual > within
    if row.status != Claim.FOUND.value or known.verdict is not Verdict.SOLVABLE or breaks:
        return row
    if row.objective is None:
        return row
    distance = known.distance(row.objective)
    if distance is None:
        return row
    if row.distance is not None and isclose(distance, row.distance, rel_tol=1e-9, abs_tol=1e-15):
        distance = row.distance  # the same but for its last bits
    near = is_near(distance, known, within)
    words = {True: "within", False: "farther than"}
    why = f"{words[near]} {within:g} from the known optimum" if near is not None else row.why
    if near is None and None not in (row.dual_residual, row.gap):
        near = max(row.dual_residual or 0.0, row.gap or 0.0) <= within or None
    return replace(row, distance=distance, correct=near, why=why)


def main() -> None:
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER
    since = {row.key: row for row in read_rows(Path(sys.argv[2]))} if len(sys.argv) > 2 else {}
    problems = {problem.name: problem for family in FAMILIES.values() for problem in family.problems()}
    packed = folder / f"{ROWS}.xz"
    with TemporaryDirectory() as work:
        run = Path(work)
        copy(folder / "run.json", run)
        (run / ROWS).write_bytes(lzma.decompress(packed.read_bytes()))
        before = read_rows(run)
        after = [judged_again(row, problems[row.problem], since) for row in before]
        lines = "".join(row.line() + "\n" for row in after).encode()
        (run / ROWS).write_bytes(lines)
        for path in write_report(run):
            copy(path, folder)
    packed.write_bytes(lzma.compress(lines, preset=9 | lzma.PRESET_EXTREME))
    changes = Counter(
        (old.solver, old.status, old.correct, new.correct)
        for old, new in zip(before, after, strict=True)
        if old.correct is not new.correct
    )
    for (solver, status, was, now), times in sorted(changes.items(), key=str):
        print(f"{solver:16} {status:12} {was!s:6} -> {now!s:6} {times}")


if __name__ == "__main__":
    main()

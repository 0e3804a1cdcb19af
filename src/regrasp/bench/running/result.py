"""A row of results: one solve, what came of it and how long it took."""

import json
from dataclasses import asdict, dataclass, fields
from typing import Any, NamedTuple

from regrasp.bench.judging.judgement import Judgement, judged
from regrasp.bench.problems.problem import BenchProblem
from regrasp.bench.problems.settings import SETTINGS, right_within
from regrasp.bench.running.solvers import Solver
from regrasp.errors import shown
from regrasp.programs.answer import Answer, Claim

# How a solve can end besides the words of ``Claim``.
ERROR, TIMEOUT, CRASHED, MEMORY = "error", "timeout", "crashed", "out of memory"
LOST = (TIMEOUT, CRASHED, MEMORY)
COLD, WARM = "cold", "warm"
TIMES = ("build_time", "setup_time", "solve_time", "total_time", "memory")
"""Fields that differ from run to run."""
_WORDS: dict[str, tuple[str, ...]] = {
    "settings": SETTINGS,
    "mode": (COLD, WARM),
    "status": (*(claim.value for claim in Claim), ERROR, *LOST),
}


class Key(NamedTuple):
    """What makes a row the only one of its kind."""

    problem: str
    solver: str
    settings: str
    mode: str
    repeat: int


@dataclass(frozen=True)
class Row:
    """One solve, flat for tables; None where there is nothing to say.

    problem to repeat: the key; mode is ``cold``, or ``warm`` for a solver that solved the problem ``follows``
    names and was given another right side. digest: of the problem. version: of the solver. verdict, truth,
    optimum: what is known. unknowns, rows, nonzeros, cones: the size. status: a word of ``Claim``, or
    ``error`` (the call raised), ``timeout``, ``crashed``, ``out of memory``. said: the solver's own words.
    correct, why and the measures: as in ``Judgement``; an answer that did not come is not correct.
    iterations: as the solver counts. build_time, setup_time, solve_time: as in ``Answer``. total_time: around
    the whole call [s]; of a timeout the limit. memory: growth of the worker's resident set during its first
    such solve over what it held just before, after it gave free memory back [bytes]; below a page it says
    nothing, and memory that the allocator kept is not in it. time_limit: [s]. machine: its name for the rows.
    """

    problem: str
    family: str
    digest: str
    solver: str
    settings: str
    mode: str
    repeat: int
    version: str
    verdict: str
    truth: str
    optimum: float | None
    unknowns: int
    rows: int
    nonzeros: int
    cones: str
    status: str
    said: str
    correct: bool | None
    why: str
    objective: float | None
    distance: float | None
    primal_residual: float | None
    dual_residual: float | None
    gap: float | None
    absolute_primal_residual: float | None
    absolute_dual_residual: float | None
    absolute_gap: float | None
    certificate_residual: float | None
    iterations: int | None
    build_time: float | None
    setup_time: float | None
    solve_time: float | None
    total_time: float | None
    memory: int | None
    time_limit: float
    machine: str

    @property
    def key(self) -> Key:
        """The row's key."""
        return Key(self.problem, self.solver, self.settings, self.mode, self.repeat)

    @property
    def is_lost(self) -> bool:
        """Whether the solve never came back; it is then not repeated."""
        return self.status in LOST

    def line(self) -> str:
        """The row as a line of JSON."""
        return json.dumps(asdict(self), allow_nan=False)


def row_of(values: Any) -> Row:
    """The row of a line's values. Raises ``TypeError`` for values that are no row."""
    if not isinstance(values, dict) or values.keys() != {field.name for field in fields(Row)}:
        raise TypeError("not the fields of a row")
    for name, known in _WORDS.items():
        if values[name] not in known:
            raise TypeError(f"{name} must be one of {', '.join(known)}, got {shown(values[name])}")
    return Row(**values)


def written(
    problem: BenchProblem,
    solver: Solver,
    key: Key,
    answer: Answer | None,
    *,
    time_limit: float,
    machine: str,
    status: str = "",
    said: str = "",
    total_time: float | None = None,
    memory: int | None = None,
) -> Row:
    """The row of an answer, judged; or of none, with the ``status`` and ``said`` that tell why."""
    if answer is None:
        judgement, answer = Judgement(False, "no answer"), Answer("failed", said=said)
    else:
        judgement, status = judged(problem, answer, right_within(key.settings)), answer.status
    unknowns, rows, nonzeros = problem.size
    return Row(
        **key._asdict(),
        family=problem.family,
        digest=problem.digest,
        version=solver.version,
        verdict=problem.known.verdict.value,
        truth=problem.known.truth.value,
        optimum=problem.known.optimum,
        unknowns=unknowns,
        rows=rows,
        nonzeros=nonzeros,
        cones=problem.cones,
        status=status,
        said=answer.said,
        **asdict(judgement),
        iterations=answer.iterations,
        build_time=answer.build_time,
        setup_time=answer.setup_time,
        solve_time=answer.solve_time,
        total_time=total_time,
        memory=memory,
        time_limit=time_limit,
        machine=machine,
    )

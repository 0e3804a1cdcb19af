"""The back ends that are installed and the one verb that calls them."""

import logging
import sys
from collections.abc import Callable
from dataclasses import replace
from importlib import import_module
from math import nan
from typing import Any

import numpy as np

from regrasp.errors import InvalidInput, RegraspError, SolverFailed, SolverUnavailable, shown, told
from regrasp.programs.answer import given_numbers
from regrasp.programs.blocks import Array
from regrasp.programs.calls.deadline import Deadline
from regrasp.programs.facts import BACKENDS, Backend, available_backends, is_installed, named
from regrasp.programs.judging.loose_rows import with_loose_rows, without_loose_rows
from regrasp.programs.judging.own_units import in_own_units
from regrasp.programs.judging.quick import surely_sound
from regrasp.programs.judging.verdict import PROVEN, judged
from regrasp.programs.program import Program
from regrasp.programs.solution import Solution, Status, failed

_log = logging.getLogger("regrasp.programs")


# Statuses that say something of the program; the others say something of the back end.
_CLAIMS = (Status.SOLVED, Status.INFEASIBLE, Status.UNBOUNDED)
_DOUBTFUL = (Status.STOPPED, Status.UNSOUND, Status.NOT_FOUND)
_LONGEST = sys.float_info.max
_WHOLE = 1e-7
"""Largest measure of a solution that was found without some of the rows."""
_CLOSE, _SOUND = 5e-10, 1e-8
"""Largest measures of an answer by a kept solver: that of its constraints, and the others."""
_AUTO = ("clarabel", "daqp", "osqp", "cvxpy")


def solve(
    program: Program,
    backend: str = "auto",
    *,
    throw: bool = True,
    time_limit: float | None = None,
    isolated: bool = False,
    **options: Any,
) -> Solution:
    """Solve a program and audit the answer.

    Args:
        program: the program.
        backend: a name of ``available_backends()``, ``cvxpy:<SOLVER>``, or ``auto``: the first installed one
            whose answer is sound (a warning is logged for each that was not).
        throw: raise ``SolverFailed`` for an answer that is neither sound nor a proven impossibility; without
            it such an answer is returned with its status.
        time_limit: [s] for all that solvers do, whichever are asked in turn; one that has no such option is
            run in a process of its own and ended. The start of such a process, about a second, and our audit
            come on top.
        isolated: run the solver in a process of its own in any case, so that its crash is an error like
            others; that takes a second to start.
        **options: passed to the back end as they are.

    Raises:
        SolverUnavailable: For a back end unknown or not installed.
        InvalidInput: For a program with second-order cones on a back end that takes none and for an objective
            that is not convex.
    """
    if not isinstance(program, Program):
        raise InvalidInput(f"solve takes a Program, got {shown(program)}")
    if not isinstance(backend, str):
        raise InvalidInput(f"backend must be a name, got {shown(backend)}")
    for name, word in (("throw", throw), ("isolated", isolated)):
        if not isinstance(word, (bool, np.bool_)):
            raise InvalidInput(f"{name} must be True or False, got {shown(word)}")
    is_number = isinstance(time_limit, (int, float, np.number)) and not isinstance(time_limit, bool)
    if time_limit is not None and not (is_number and 0 < time_limit <= _LONGEST):
        raise InvalidInput(
            f"time_limit must be a positive number of seconds or None, got {shown(time_limit)}"
        )
    if program.why_not_convex:
        raise InvalidInput(f"{program.why_not_convex}; the objective must be convex")
    return _solved(program, backend, throw, Deadline(time_limit), isolated, options)


def _solved(
    program: Program, backend: str, throw: bool, limit: Deadline, isolated: bool, options: dict[str, Any]
) -> Solution:
    if backend == "auto":
        return _first_sound(program, throw, limit, isolated, options)
    entry = _entry(backend)
    if program.has_second_order and not entry.second_order:
        takers = ", ".join(name for name in available_backends() if BACKENDS[name].second_order)
        raise InvalidInput(
            f"back end {shown(backend)} solves QPs only and the program has second-order "
            "cones; use linearised "
            f"cones (facets=...), or one of {takers}"
        )

    def ask(given: Program) -> Solution:
        return _asked(given, backend, entry, limit, isolated, options)

    def feasibility(given: Program) -> Solution:
        if limit.is_over:
            return failed(given, backend, "no time is left to look for a point")
        return _solved(given.without_objective(), backend, False, limit, isolated, {})

    def answered(given: Program) -> Solution:
        claim = ask(given)
        solution = judged(claim, entry.tolerance, feasibility)
        if solution.status in _DOUBTFUL and claim.status is not Status.SOLVED and not limit.is_over:
            from regrasp.programs.judging.elastic import proven_anyway

            return proven_anyway(solution, ask, PROVEN) or solution
        return solution

    solution = answered(program)
    if solution.status not in _CLAIMS and not limit.is_over and (own := in_own_units(program)):
        whole = judged(own.answer(answered(own.program), program), entry.tolerance, feasibility)
        solution = whole if whole.status in _CLAIMS else solution
    if throw and solution.status not in _CLAIMS:
        raise SolverFailed(f"{program}: {solution}; {solution.status.advice}", program, solution)
    return solution


def _asked(
    program: Program,
    backend: str,
    entry: Backend,
    limit: Deadline,
    isolated: bool,
    options: dict[str, Any],
) -> Solution:
    """The back end's answer, not audited; an error of the solver's own is an answer, too."""
    time_limit = limit.left
    if time_limit is not None and entry.time_limit:
        options = {entry.time_limit: time_limit, **options}
        time_limit = None
    if isolated or time_limit is not None:
        from regrasp.programs.child import solved_apart

        return solved_apart(program, backend, time_limit, options)
    return asked(program, backend, options)


def asked(program: Program, backend: str, options: dict[str, Any]) -> Solution:
    """What a back end answers in this process, not audited."""
    call: Callable[..., Solution] = import_module(_module(_entry(backend))).solve
    try:
        answer = call(program, backend, **options)
        value, duals = (
            given_numbers(answer.value, program.q.size),
            given_numbers(answer.duals, program.b.size),
        )
        return replace(answer, value=value, duals=duals)
    except (RegraspError, KeyboardInterrupt, SystemExit, GeneratorExit):
        raise
    except BaseException as error:  # Rust's panics are no exceptions
        return failed(program, backend, told(error))


def least_room(program: Program, backend: str) -> float:
    """How much more room the inequalities need to have a point, by their largest entries, at least -1.

    Below 0 where there is room left; NaN where the back end does not say. Not audited: no proof.
    """
    from regrasp.programs.judging.elastic import elastic

    answer = asked(elastic(program), "clarabel" if backend == "auto" else backend, {})
    return float(answer.value[-1]) if answer.status is Status.SOLVED else nan


def solved_at_once(program: Program, backend: str) -> Solution | None:
    """The answer of a back end if it is sound as it is; None else, and then nothing is proven.

    For those who only ask whether: what ``solve`` does to save an answer or a proof takes longest.
    """
    name = "clarabel" if backend == "auto" else backend
    answer = asked(program, name, {})
    if answer.status not in (Status.SOLVED, Status.STOPPED):
        return None
    return replace(answer, status=Status.SOLVED) if answer.residual <= _entry(name).tolerance else None


def solved_quickly(program: Program) -> Solution | None:
    """The answer to a small program by a kept solver of Clarabel, audited; None where that is not enough.

    For many programs of one pattern whose unknowns are in one unit; ``solve`` has the last word.
    """
    answer = answered_quickly(program)
    if answer is None:
        return None
    audit = surely_sound(program, *answer, _CLOSE, _SOUND)
    if audit is None:
        return None
    solution = Solution(program, "clarabel", Status.SOLVED, *answer, None, 0.0, 0.0, "Solved")
    vars(solution)["audit"] = audit
    return solution


def answered_quickly(program: Program, entries: Array | None = None) -> tuple[Array, Array] | None:
    """Its value and duals, not audited; entries (k,), finite, stand at the places of A if given."""
    if not program.is_quick:
        return None
    from regrasp.programs.clarabel_backend import solved_again

    try:
        return solved_again(program, program.A.data if entries is None else entries)
    except (KeyboardInterrupt, SystemExit):
        raise
    except BaseException:  # Rust's panics are no exceptions
        return None


def warm(backend: str) -> None:
    """Import what a back end needs, so that its time is its own."""
    entry = _entry(backend)
    import_module(_module(entry))
    import_module(entry.module)


def _module(entry: Backend) -> str:
    """The module with ``solve(program, name, **options)``; solvers called by name share one."""
    return "regrasp.programs.qp_backend" if ".calls." in entry.module else entry.module


def _entry(backend: str) -> Backend:
    entry = named(backend)
    if entry is None:
        raise SolverUnavailable(
            f"no back end {shown(backend)}; known: auto, {', '.join(BACKENDS)}, cvxpy:<SOLVER>"
        )
    if not is_installed(entry):
        raise SolverUnavailable(
            f"back end {shown(backend)} needs the package {entry.needs}: pip install 'regrasp[solvers]'"
        )
    return entry


def _first_sound(
    program: Program, throw: bool, limit: Deadline, isolated: bool, options: dict[str, Any]
) -> Solution:
    if options:
        raise InvalidInput("options belong to one solver; name the back end they are for instead of 'auto'")
    names = [
        name
        for name in _AUTO
        if is_installed(BACKENDS[name]) and BACKENDS[name].second_order >= program.has_second_order
    ]
    if not names:
        raise SolverUnavailable(f"none of {', '.join(_AUTO)} is installed")
    for k, name in enumerate(names):
        if k and limit.is_over:
            break
        solution = _solved(program, name, False, limit, isolated, {})
        if solution.status in _CLAIMS:
            return solution
        _log.warning("%s; trying the next back end", solution)

    def anyhow(given: Program) -> Solution:
        return _first_sound(given.without_objective(), False, limit, isolated, {})

    looser = None if limit.is_over else without_loose_rows(program)
    if looser is not None:
        rest, kept = looser
        found = _first_sound(rest, False, limit, isolated, options)
        whole = judged(with_loose_rows(found, program, kept), _WHOLE, anyhow)
        if whole.status in _CLAIMS:
            return whole
    if throw:
        raise SolverFailed(
            f"{program}: no back end gave a sound answer; the last: {solution}", program, solution
        )
    return solution

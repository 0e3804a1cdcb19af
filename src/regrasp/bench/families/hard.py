"""Problems that solvers misjudge: at the edge of what is held, without a unique answer, in awkward units."""

from collections.abc import Iterator
from dataclasses import replace
from math import inf, tan

import numpy as np
from scipy import sparse

from regrasp.bench.families.grasps import planar
from regrasp.bench.families.states import state_problem
from regrasp.bench.families.truth import certified
from regrasp.bench.problems.problem import BenchProblem, Family, Known, Truth, Verdict
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.choosing import choose_state
from regrasp.planning.states.escape import escape_twist
from regrasp.planning.states.program import state_program
from regrasp.planning.states.solving import force_unit
from regrasp.planning.states.two_fingers import EquilibriumLocus
from regrasp.programs import Block, Cone, Program

_TILT = 0.3
_ROOM = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
_LENGTHS, _FORCES = (1.0, 1e-6, 1e3), (1.0, 1e3, 1e-6)


def _edge_grasp(room: float) -> Grasp:
    """Two fingers on a wedge: their line lies in both cones for friction of tan(0.3) and more."""
    mu, c, s = tan(_TILT) * (1 + room), np.cos(_TILT), np.sin(_TILT)
    return Grasp([Contact([-1, 0], [c, s], mu), Contact([1, 0], [-c, s], mu)])


def _nearly() -> Iterator[BenchProblem]:
    """A load that pushes out of the wedge: held by squeezes of the order of 1 / room, or by none."""
    load = Wrench([0, 1.0])
    for room in _ROOM:
        for sign, kind in ((1, "held"), (-1, "lost")):
            grasp = _edge_grasp(sign * room)
            name = f"nearly-infeasible/{kind}/{room:.0e}"
            program = state_program(
                grasp, load, "effort", grasp.frictions.tolist(), [inf] * 2, force_unit(grasp, load)
            )
            locus = EquilibriumLocus(grasp, load)
            if not locus.is_empty:
                value = choose_state(grasp, load, "effort", method="closed-form", reserve=0.0).value
                known = Known(Verdict.SOLVABLE, Truth.CLOSED_FORM, value / force_unit(grasp, load) ** 2, 1e-9)
            else:
                proven = escape_twist(grasp, load, grasp.frictions.tolist(), [inf] * 2) is not None
                known = Known(
                    Verdict.INFEASIBLE if proven else Verdict.UNKNOWN, Truth.PROOF if proven else Truth.NONE
                )
            yield BenchProblem(name, "nearly-infeasible", program, known)


def _infeasible() -> Iterator[BenchProblem]:
    """Grasps whose load points where no finger can push: the escape is proven in exact arithmetic."""
    made = number = 0
    while made < 12:
        rng = np.random.default_rng([7, number])
        number += 1
        grasp, load = planar(rng, int(rng.integers(2, 5)))
        lost = Wrench(-load.force, float(load.torque[0]) + 3 * float(rng.normal()))
        frictions = grasp.frictions.tolist()
        if escape_twist(grasp, lost, frictions, [inf] * len(grasp)) is None:
            continue
        for objective in ("effort", "peak_normal", "peak"):
            program = state_program(
                grasp, lost, objective, frictions, [inf] * len(grasp), force_unit(grasp, lost)
            )
            name = f"infeasible/{objective}/{made:02d}-{len(grasp)}"
            yield BenchProblem(name, "infeasible", program, Known(Verdict.INFEASIBLE, Truth.PROOF))
        made += 1


def _degenerate() -> Iterator[BenchProblem]:
    """Contacts side by side on one edge, fingers without friction, rows that repeat one another."""
    for count in (4, 8, 16):
        row = [Contact([x, -1.0], [0, 1], 0.4) for x in np.linspace(-1, 1, count)]
        grasp, load = Grasp([*row, Contact([0.0, 1.0], [0, -1], 0.0)]), Wrench([0.1, -1.0])
        for objective in ("effort", "peak_normal", "peak"):
            name = f"degenerate/{objective}/row-{count:02d}"
            known = state_problem("degenerate", name, grasp, load, objective)
            yield known
            yield _repeated(replace(known, name=f"degenerate/{objective}/repeated-{count:02d}"))


def _repeated(problem: BenchProblem) -> BenchProblem:
    """The same with its equations a second time: they depend on one another, the answer stays."""
    program = problem.program
    equations = next(rows for block, rows in program.slices if block.cone is Cone.ZERO)
    size = equations.stop - equations.start
    again = Program(
        program.P, program.q, sparse.vstack([program.A[equations], program.A], format="csc"),
        np.concatenate([program.b[equations], program.b]), (Block(Cone.ZERO, 1, size), *program.blocks),
    )  # fmt: skip
    again.A.sum_duplicates()
    return replace(problem, program=again)


def _scaled() -> Iterator[BenchProblem]:
    """The same grasps in micrometres, kilonewtons and their opposites, as a user would type them."""
    for number in range(4):
        grasp, load = planar(np.random.default_rng([8, number]), 2 + number % 3)
        for length, force in zip(_LENGTHS, _FORCES, strict=True):
            frictions, name = grasp.frictions.tolist(), f"scaled/effort/{number}-{length:g}m-{force:g}N"
            unit = force_unit(grasp, load)
            plain = state_program(grasp, load, "effort", frictions, [inf] * len(grasp), unit)
            known = certified(plain, 0.0)
            if len(grasp) == 2:
                best = choose_state(grasp, load, "effort", method="closed-form", reserve=0.0).value
                known = Known(Verdict.SOLVABLE, Truth.CLOSED_FORM, best / unit**2, 1e-10, 0.0)
            factor = (force * unit) ** 2
            optimum = None if known.optimum is None else known.optimum * factor
            yield BenchProblem(
                name, "scaled", _in_units(plain, force * unit, length * (grasp.size or 1.0)),
                replace(known, optimum=optimum),
            )  # fmt: skip


def _in_units(program: Program, force: float, length: float) -> Program:
    """The program with forces in ``force`` and torque rows in ``force * length``: nothing is balanced."""
    rows = np.ones(program.b.size)
    rows[2] = length
    scaled = sparse.diags(rows) @ program.A
    return Program(
        program.P, program.q * force, sparse.csc_matrix(scaled), rows * program.b * force, program.blocks
    )


NEARLY = Family(
    "nearly-infeasible",
    "two fingers on a wedge whose friction is 1e-1 to 1e-6 more, or less, than what holds the load",
    "effort subject to G f = -w and the friction cones (QP); the squeeze grows as one over the room",
    _nearly,
)
INFEASIBLE = Family(
    "infeasible",
    "planar grasps whose object escapes, proven by a twist in exact arithmetic",
    "effort, peak normal force (QP) and peak force (second order) where no forces exist",
    _infeasible,
)
DEGENERATE = Family(
    "degenerate",
    "rows of contacts side by side, a finger without friction, equations given twice",
    "effort, peak normal and peak force with many optima, or with dependent equations",
    _degenerate,
)
SCALED = Family(
    "scaled",
    "planar states in micrometres and kilonewtons, and in kilometres and micronewtons",
    "effort subject to G f = -w and the friction cones, numbers as typed (QP)",
    _scaled,
)

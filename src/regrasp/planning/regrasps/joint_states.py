"""All states of a regrasp in one program: the widest worst margin, then the least change of force.

The unknowns are the forces of every state, block after block, and t:

    equilibrium, cones less t, limits     of every state, as in ``state_program`` for ``force``
    least normal forces, linear limits,
    withstood deviations                  of every finger of a state, as for the state alone
    margin    maximise t
    change    minimise the sum of |f_k+1 - f_k|^2 over states that follow one another, less w t;
              a contact that one of the two does not have counts with zero there

The weight w rises until t is the widest: were t given instead, there would be next to no room inside of the
rows, where interior points stall before they keep them.
"""

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy import sparse

from regrasp.errors import Infeasible, InvalidInput, SolverFailed
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.criteria import Criteria
from regrasp.planning.states.objectives import FORCE
from regrasp.planning.states.pressing import pressing
from regrasp.planning.states.program import state_program
from regrasp.planning.states.solving import SLACK, Chooser
from regrasp.planning.states.withstanding.demand import Demand
from regrasp.programs import Program, Status, solve

_MARGIN = 1e-7
"""Fraction of the widest margin that the second program may give up."""
_EXACT = 1e-10
"""Of a margin, in units: what a solver's answer is known to."""
_WEIGHTS = 10.0 ** np.arange(5, 10)
"""Of t beside the change, both in units of force; the first that gives up no more is taken."""


@dataclass(frozen=True)
class SequenceState:
    """One state of a sequence: its grasp and load, who its contacts are, and what they may use.

    places: (n,) one name for each contact, by which it is known in the other states. frictions, limits [N],
    counts: (n,); a contact that does not count may be idle, and its margin is left out of the worst. least:
    normal force of every contact at the least [N]. criteria: with the set that is withstood; None for none.
    """

    grasp: Grasp
    load: Wrench
    places: tuple[Hashable, ...]
    frictions: list[float]
    limits: list[float]
    counts: tuple[bool, ...]
    least: float = 0.0
    criteria: Criteria | None = None

    @cached_property
    def demand(self) -> Demand | None:
        """The set that is withstood; None for none."""
        asked = self.criteria
        return asked.demand(self.grasp) if asked is not None and asked.withstands else None

    @property
    def normals(self) -> Array:
        """(n,) least normal forces [N]."""
        return np.full(len(self.grasp), self.least)

    @property
    def weights(self) -> Array:
        """(n,) distance to the edge of a cone per margin, 0 for contacts that do not count."""
        return np.where(self.counts, np.sqrt(1 + np.array(self.frictions) ** 2), 0.0)


def sequence_program(states: Sequence[SequenceState], unit: float, weight: float | None = None) -> Program:
    """The program of the widest worst margin; or, with its ``weight``, that of the least change less it.

    Unknowns are the forces of all states in order, then t, in units of ``unit`` [N].
    """
    if len(states) < 2:
        raise InvalidInput(f"a sequence has two states or more, got {len(states)}")
    parts = [_part(s, unit) for s in states]
    forces = sparse.block_diag([part.A[:, :-1] for part in parts], format="csc")
    distances = sparse.vstack([part.A[:, -1] for part in parts], format="csc")
    b = np.concatenate([part.b for part in parts])
    blocks = tuple(block for part in parts for block in part.blocks)
    width = forces.shape[1] + 1
    P, q = sparse.csc_matrix((width, width)), np.zeros(width)
    q[-1] = -1.0 if weight is None else -weight
    if weight is not None:
        change = _changes(states, [part.q.size - 1 for part in parts], width)
        P = sparse.csc_matrix(2 * change.T @ change)
    return Program(P, q, sparse.hstack([forces, distances], format="csc"), b, blocks, size=1.0)


def spread_forces(states: Sequence[SequenceState], unit: float, backend: str = "clarabel") -> list[Array]:
    """Forces (n, d) of every state [N], in exact equilibrium, by both programs in turn.

    Raises ``Infeasible`` where some state has no forces, ``SolverFailed`` where the back end finds none.
    """
    kept = [
        replace(
            state,
            frictions=[mu * (1 - SLACK) for mu in state.frictions],
            limits=[limit * (1 - SLACK) for limit in state.limits],
        )
        for state in states
    ]
    widest = solve(sequence_program(kept, unit), backend)
    if widest.status is Status.INFEASIBLE or (widest.status is Status.SOLVED and widest.value[-1] < -1e-7):
        raise Infeasible("some state of the sequence has no forces inside cones and limits")
    if widest.status is not Status.SOLVED:
        raise SolverFailed(f"{backend}: {widest.status.advice}", widest.program, widest)
    margin = widest.value[-1]
    for weight in _WEIGHTS:
        answer = solve(sequence_program(kept, unit, weight), backend, throw=False)
        lost = margin - answer.value[-1]
        if answer.status is Status.SOLVED and lost <= _MARGIN * abs(margin) + _EXACT:
            break
    else:
        raise SolverFailed(f"{backend}: no least change at the widest margin", answer.program, answer)
    result, begin = [], 0
    for state in states:
        shape = (len(state.grasp), state.grasp.width)
        size = shape[0] * shape[1]
        wanted = answer.value[begin : begin + size].reshape(shape) * unit
        begin += _part(state, unit).q.size - 1
        asks = state.least or state.demand is not None or state.grasp.limit_rows is not None
        least = state.normals if asks else None
        chooser = Chooser(state.grasp, state.load, backend, None, state.limits, least, state.demand)
        forces = chooser.settled(wanted, state.frictions, state.limits)
        if forces is None:
            raise SolverFailed(f"{backend} answered forces far from equilibrium", answer.program, answer)
        result.append(state.grasp.cones.forces(forces))
    return result


def _part(state: SequenceState, unit: float) -> Program:
    """The program of one state; its unknowns are its forces, others that withstanding takes, and t."""
    s = state
    program = state_program(s.grasp, s.load, FORCE, s.frictions, s.limits, unit, weights=s.weights)
    if s.demand is not None:
        from regrasp.planning.states.withstanding.rows import with_rows

        program = with_rows(program, s.demand, s.frictions, s.limits, unit, by_factor=False)
    return pressing(program, s.grasp, s.normals, unit, unit)


def _changes(states: Sequence[SequenceState], widths: Sequence[int], width: int) -> sparse.csr_matrix:
    """Rows f_k+1 - f_k of every contact of two states that follow one another."""
    d = states[0].grasp.width
    starts = np.concatenate([[0], np.cumsum(widths)])
    rows: list[int] = []
    columns: list[int] = []
    signs: list[float] = []
    row = 0
    for k in range(len(states) - 1):
        for place in dict.fromkeys((*states[k].places, *states[k + 1].places)):
            for at, sign in ((k, -1.0), (k + 1, 1.0)):
                if place in states[at].places:
                    first = int(starts[at]) + d * states[at].places.index(place)
                    rows += range(row, row + d)
                    columns += range(first, first + d)
                    signs += [sign] * d
            row += d
    return sparse.csr_matrix((signs, (rows, columns)), (row, width))

"""How deep inside narrowed cones forces reach: one program whose cones change from call to call.

All entries of A are linear in the friction of a contact, so that they are filled in at once.
"""

from collections.abc import Collection, Iterable
from math import inf

import numpy as np
from numpy.typing import NDArray

from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.reserve import NEGLIGIBLE
from regrasp.mechanics.value import kept
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.objectives import FORCE
from regrasp.planning.states.program import state_program
from regrasp.planning.states.solving import SLACK, Chooser, Depth
from regrasp.programs import Program
from regrasp.programs.backends import answered_quickly

NOISE = 1e-4
"""A force below this fraction of the largest may be what a solver leaves at a finger that need not push: the
root of its tolerance, where the optimum is flat."""
_NO_LOAD = {2: Wrench((0.0, 0.0)), 3: Wrench((0.0, 0.0, 0.0))}


class Depths:
    """The depths of forces within ``limits`` of a chooser's contacts, inside cones of any friction."""

    def __init__(self, chooser: Chooser, limits: list[float]) -> None:
        self.chooser, self.limits = chooser, limits
        self._is_plain = chooser.backend == "clarabel" and chooser.facets is None and chooser.least is None
        self._tables: dict[tuple[int, ...], _Table] = {}

    def of(self, cones: dict[int, float], weights: Array | None) -> Depth | None:
        """The depth in cones of some contacts, the others idle; None where the back end fails.

        weights: (n,) of all contacts how deep a unit is there; for None depths are distances.
        """
        chosen = tuple(cones)
        mu = np.array(list(cones.values()))
        asked = None if weights is None else weights[list(chosen)]
        if self._is_plain and mu.min(initial=inf) > NEGLIGIBLE:
            table = self._tables.get(chosen)
            if table is None:
                some = of_some(self.chooser, chosen)
                table = self._tables[chosen] = _Table(some, [self.limits[i] for i in chosen])
            found = table.depth(mu, asked)
            if found is not None:
                return found
        some = of_some(self.chooser, chosen)
        return some.depth(mu.tolist(), [self.limits[i] for i in chosen], asked)


class _Table:
    """A = base + friction slope entry by entry, but for the last column, where the weights are."""

    def __init__(self, chooser: Chooser, limits: list[float]) -> None:
        n = len(chooser.grasp)
        self.chooser, self._unit = chooser, chooser.unit
        self.program: Program = chooser.program(FORCE, [1.0] * n, limits, None, SLACK)
        self._entries = kept(chooser.grasp, tuple(limit < chooser.loose for limit in limits), _entries)

    def depth(self, mu: Array, weights: Array | None) -> Depth | None:
        """For frictions (n,) and weights (n,), or those of distances."""
        n, chooser = mu.size, self.chooser
        base, slope, contact, rows, each = self._entries
        units = np.sqrt(1 + mu * mu) if weights is None else weights
        entries = np.concatenate([base + slope * mu[contact], units.repeat(each)])
        answer = answered_quickly(self.program, entries)
        if answer is None:
            return None
        x, duals = answer
        if not np.isfinite(x[-1]):
            return chooser.out_of_reach(duals)
        forces = chooser.in_newtons(x)
        shares = duals[rows].reshape(n, -1)
        return Depth(
            float(x[-1]),
            forces,
            chooser.grasp.cones.normal(forces) / self._unit,
            np.add.reduce(shares, axis=1) if each > 1 else shares[:, 0],
            chooser.twist_of(duals),
        )


def _entries(
    grasp: Grasp, limited: tuple[bool, ...]
) -> tuple[Array, Array, NDArray[np.intp], NDArray[np.int32], int]:
    """Entries of A without friction, what a unit of it adds, and whose; the rows of weights, k of each."""
    n, w = len(grasp), grasp.width
    limits = [1.0 if some else inf for some in limited]
    once, twice = (
        state_program(grasp, _NO_LOAD[grasp.dimension], FORCE, [mu * (1 - SLACK)] * n, limits, 1.0).A
        for mu in (1.0, 2.0)
    )
    last = int(once.indptr[-2])
    slope = (twice.data - once.data)[:last]
    contact: NDArray[np.intp] = np.repeat(np.arange(w * n) // w, once.indptr[1:-1] - once.indptr[:-2])
    rows = once.indices[last:]
    return once.data[:last] - slope, slope, contact, rows, rows.size // n


def of_some(chooser: Chooser, contacts: Collection[int]) -> Chooser:
    """The same for some contacts, itself for all."""
    return chooser if len(contacts) == len(chooser.grasp) else chooser.of(contacts)


def of_all(grasp: Grasp, contacts: Iterable[int], forces: Array) -> Array:
    """Forces (n, d) of all contacts, those of ``contacts`` given and the others idle."""
    whole = np.zeros((len(grasp), grasp.width))
    whole[list(contacts), : forces.shape[1]] = forces
    return whole


def of_those_that_push(
    chooser: Chooser, forces: Array, frictions: list[float], limits: list[float]
) -> Array | None:
    """Forces near these of the fingers that carry more than noise, others idle; None if there are none."""
    sizes = abs(forces).max(axis=1)
    used = np.flatnonzero(sizes > NOISE * sizes.max()).tolist()
    if len(used) in (0, len(forces)) or not np.isfinite(forces).all():
        return None
    mu, bounds = [frictions[i] for i in used], [limits[i] for i in used]
    some = chooser.of(used)
    rest = some.shifted(forces[used][:, : some.grasp.width], mu, bounds)
    return None if rest is None else of_all(chooser.grasp, used, rest)

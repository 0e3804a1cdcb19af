"""The best internal squeeze: what a margin asks of a grasp that has nothing to hold.

Without a load every state may be scaled, so the forces of a level are those of

    maximise t   subject to   G f = 0,   sum_i f_i.n_i = 1,   mu_i f_i.n_i - |f_i across n_i| >= t w_i

over cones narrowed to it, and the best state found is scaled until a finger reaches its limit. A level that
no squeeze reaches has t < 0; the duals of G f = 0 are then a motion along which every force in the cones
works, so that none of them cancel. Zero forces are the answer only where nothing else is.
"""

from collections.abc import Iterable
from math import inf

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.reserve import NEGLIGIBLE
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.criteria import Criteria
from regrasp.planning.states.faces import cone_faces
from regrasp.planning.states.level_search import highest
from regrasp.planning.states.narrowing import Narrowing
from regrasp.planning.states.objectives import ConvexObjective, LevelObjective
from regrasp.planning.states.solving import Chooser, Found
from regrasp.programs import Program, Rows, solve

# A finger that pushes less than this fraction of the others, however hard they do, takes no part in a
# squeeze.
_APART = 1e-7
# A motion along which each force in the cones does at least this fraction of its speed's work proves it.
_WORKS = 1e-12


class Squeezer(Chooser):
    """Chooses among internal forces whose normal parts sum to one."""

    def of(self, contacts: Iterable[int]) -> "Squeezer":
        """The same, for some of the contacts."""
        return Squeezer(self.grasp.subset(contacts), self.load, self.backend, self.facets, [])

    def program(
        self,
        objective: ConvexObjective,
        frictions: list[float],
        limits: list[float],
        weights: Array | None,
        slack: float,
        inside: bool = True,
    ) -> Program:
        """That of ``squeeze_program``; objective and limits are its own."""
        mu = (1 - slack) * np.array(frictions)
        return squeeze_program(
            self.grasp, mu, np.sqrt(1 + mu**2) if weights is None else weights, self.facets
        )

    def settled(self, wanted: Array, frictions: list[float], limits: list[float]) -> Array | None:
        """Internal forces near to ``wanted``; None if only zero is."""
        return _if_left(wanted, super().settled(wanted, frictions, [inf] * len(limits)))

    def shifted(self, wanted: Array, frictions: list[float], limits: list[float]) -> Array | None:
        """The same by the least change."""
        return _if_left(wanted, super().shifted(wanted, frictions, limits))

    def nearest(self, forces: Array, frictions: list[float], limits: list[float]) -> Array | None:
        """The same by the least change inside the cones."""
        return _if_left(forces, super().nearest(forces, frictions, limits))

    def proves(self, twist: Array, frictions: list[float], limits: list[float]) -> bool:
        """Whether every force in the cones works along a motion."""
        cones, largest = self.grasp.cones, float(abs(twist).max())
        if not 0 < largest < inf:
            return False
        twist = twist / largest  # of a solver that diverged it may be of any size
        moved = (cones.matrix.T @ twist).reshape(len(self.grasp), -1)
        normal = (moved * cones.normals).sum(axis=1)
        across = np.linalg.norm(moved - normal[:, None] * cones.normals, axis=1)
        speed = float(abs(twist * self.grasp.lengths).max())
        return bool((normal - np.array(frictions) * across > _WORKS * speed).all())

    def is_lost(self, frictions: list[float], limits: list[float]) -> bool:
        """Whether a motion proves that no squeeze exists."""
        mu = np.array(frictions)
        program = squeeze_program(self.grasp, mu, np.sqrt(1 + mu**2), self.facets)
        answer = solve(program, self.backend, throw=False)
        return self.proves(self.twist_of(answer.duals), frictions, limits)


def _if_left(wanted: Array, found: Array | None) -> Array | None:
    """What was found, unless next to nothing is left of what was wanted."""
    is_left = found is not None and abs(found).max() > _APART * abs(wanted).max()
    return found if is_left else None


def squeeze_program(grasp: Grasp, frictions: Array, weights: Array, facets: int | None = None) -> Program:
    """The program above; unknowns (f_1, ..., f_n, t), torques divided by the grasp's size."""
    w, n = grasp.width, len(grasp)
    rows = Rows(w * n + 1)
    rows.equal(np.column_stack([grasp.scaled_matrix, np.zeros(len(grasp.matrix))]))
    rows.equal(np.append(grasp.cones.normals.ravel(), 0.0), -1.0)
    rough = frictions > NEGLIGIBLE
    _inside_cones(rows, grasp, np.where(rough, frictions, 0.0), weights, facets, 1)
    top = np.eye(w * n + 1)[-1]
    if not rough.any():  # no cone bounds the margin of rays: it is zero
        rows.at_least_zero(-top)
    return rows.program(-top)


def _inside_cones(
    rows: Rows, grasp: Grasp, frictions: Array, weights: Array | None, facets: int | None, more: int
) -> None:
    """Demand forces inside the cones, by the last of ``more`` unknowns times ``weights`` where given."""
    w, cones, unknowns = grasp.width, grasp.cones, grasp.width * len(grasp) + more
    faces = cone_faces(grasp, frictions, facets) if w == 2 or facets is not None else None
    for i, mu in enumerate(frictions.tolist()):
        pick = np.zeros((w, unknowns))
        pick[:, w * i : w * i + w] = np.eye(w)
        deeper = np.zeros(unknowns)
        if weights is not None:
            deeper[-1] = weights[i]
        if mu == 0:
            rows.equal(cones.tangents[i] @ pick)
            rows.at_least_zero(cones.normals[i] @ pick)
        elif faces is not None:
            rows.at_least_zero(faces[i] @ pick - deeper)
        else:
            rows.second_order(np.vstack([mu * cones.normals[i] @ pick - deeper, cones.tangents[i] @ pick]))


def squeezing(
    grasp: Grasp, frictions: list[float], backend: str, facets: int | None
) -> tuple[list[int], Array]:
    """The contacts that take part in any squeeze, and forces (n, w) of one in which all of them do.

    maximise sum_i s_i   subject to   G f = 0,   f_i in cone_i,   0 <= s_i <= 1,   s_i <= f_i.n_i
    """
    w, n = grasp.width, len(grasp)
    rows = Rows(w * n + n)
    rows.equal(np.hstack([grasp.scaled_matrix, np.zeros((len(grasp.matrix), n))]))
    mu = np.array(frictions)
    _inside_cones(rows, grasp, np.where(mu > NEGLIGIBLE, mu, 0.0), None, facets, n)
    shares, along = np.eye(w * n + n)[w * n :], np.zeros((n, w * n + n))
    for i in range(n):
        along[i, w * i : w * i + w] = grasp.cones.normals[i]
    rows.at_least_zero(along - shares)
    rows.at_least_zero(-shares, 1.0)
    rows.at_least_zero(shares)
    answer = solve(rows.program(np.r_[np.zeros(w * n), -np.ones(n)]), backend)
    part = np.flatnonzero(answer.value[w * n :] > _APART).tolist()
    forces = np.zeros((n, w))
    forces[part] = answer.value[: w * n].reshape(n, w)[part]
    return part, forces


def best_squeeze(
    grasp: Grasp,
    criteria: Criteria,
    backend: str,
    facets: int | None,
    frictions: list[float],
    limits: list[float],
) -> Found | None:
    """The forces (n, w) of the best internal squeeze under finite ``limits``; None where there is none."""
    part, forces = squeezing(grasp, frictions, backend, facets)
    if not part:
        return None
    some, mu, bounds = grasp.subset(part), [frictions[i] for i in part], [limits[i] for i in part]
    none = Wrench.from_vector(np.zeros(len(grasp.matrix)))
    squeezer = Squeezer(some, none, backend, facets, [])
    start = squeezer.settled(forces[part], mu, bounds)
    if start is None:
        return None
    start = _scaled(start, bounds)
    if isinstance(criteria.objective, ConvexObjective):
        widest = Chooser(some, none, backend, facets, bounds).best(criteria.objective, mu, bounds)
        is_none = widest is None or not abs(widest.forces).max() > _APART * min(bounds)
        found = Found(start, 0.0) if widest is None or is_none else widest
    elif isinstance(criteria.objective, LevelObjective):
        found = highest(squeezer, Narrowing(some, criteria.objective, mu), start, [inf] * len(part))
        found = Found(_scaled(found.forces, bounds), found.gap)
    whole = np.zeros((len(grasp), grasp.width))
    whole[part] = found.forces
    return Found(whole, found.gap)


def _scaled(forces: Array, limits: list[float]) -> Array:
    """Internal forces as large as the limits let them be."""
    sizes = np.sqrt((forces**2).sum(axis=1))
    used = sizes > 0
    result: Array = forces * float((np.array(limits)[used] / sizes[used]).min() * (1 - 2.0**-50))
    return result

"""How far a load can go: the best k for which contacts balance base + D k, with a bound from its dual.

    maximise c . k   subject to   G f + base + D k = 0,   f_i in cone_i,   |f_i| <= limit_i

For any twist y, the contacts do no work below -sum limit_i opposition_i(y) along it, so y . (base + D k) is
at most that sum, whatever k: a half-plane of k that holds all k that are balanced. Linear limits of contacts
count in it by their duals (``states.linear.row_duals``).
"""

from math import inf
from typing import NamedTuple

import numpy as np

from regrasp.errors import SolverFailed
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.limits.limit_rows import LimitRows
from regrasp.mechanics.opposition import oppositions
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.linear.row_duals import counted
from regrasp.planning.states.separation import cleared
from regrasp.planning.states.solving import SLACK, Chooser
from regrasp.planning.surveys.extremes.reach_of_two import reach_of_two
from regrasp.programs import Program, Rows, Solution, Status, solve

# Work against a twist below this fraction of its speed per newton is rounding of the twist.
ROUNDING = 1e-12
LOOSE = 1e6
"""Forces this many times the load count as none."""
_NOTHING = 1e-30  # of a load beside one: solvers take the exponents of numbers for their sizes
_SHARES = (0.0, 1e-12, 1e-10, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5)

_MORE_SHARES = (1e-4, 1e-3)  # beside linear limits, which forces may miss by their own rounding


class Reached(NamedTuple):
    """k (p,), forces (n, w) as the cones measure them, the dual's twist; k None where no k is balanced.

    row_duals: (m,) of the contacts' linear limits, in the scale of the twist; none without any.
    """

    k: Array | None
    forces: Array
    twist: Array
    is_unbounded: bool = False
    row_duals: Array = np.zeros(0)


def farthest(
    grasp: Grasp,
    base: Array,
    directions: Array,
    cost: Array,
    limits: list[float],
    most: float = inf,
    unit: float = 1.0,
) -> Reached:
    """base: (3 or 6,), directions: (3 or 6, p) in one unit of force; torques as they are. cost: (p,).

    most: keeps k within a box of this half-side. unit: of force, in which linear limits are measured [N].
    """
    n, w = len(grasp), grasp.width
    p = directions.shape[1]
    t = n * w
    if (n, w, p) == (2, 2, 1) and grasp.limit_rows is None and min(limits) == inf:
        two = reach_of_two(grasp, base, directions[:, 0], float(np.sign(cost[0])), most)
        if two is not None:
            return Reached(np.array([two.k]), two.forces, two.twist, two.is_unbounded)
    weight = 1 / grasp.lengths
    rows = Rows(t + p)
    along, start = directions * weight[:, None], base * weight
    along, start = np.where(abs(along) < _NOTHING, 0.0, along), np.where(abs(start) < _NOTHING, 0.0, start)
    rows.equal(np.hstack([grasp.scaled_matrix, along]), start)
    linear, first = grasp.limit_rows, len(base)
    if linear is not None:
        rows.at_least_zero(-_spread(linear, w, t + p), (1 - SLACK) * linear.bounds / unit)
    _inside_cones(rows, grasp, t + p)
    for i, limit in enumerate(limits):
        if limit < inf:
            rows.second_order(np.vstack([np.zeros(t + p), _pick(i, w, t + p)]), [limit, *[0.0] * w])
    if most < inf:
        box = np.hstack([np.zeros((p, t)), np.eye(p)])
        rows.at_least_zero(np.vstack([box, -box]), most)
    answer = _answer(rows.program(np.r_[np.zeros(t), -cost]))
    twist = -answer.duals[: len(base)] * weight
    duals = np.zeros(0) if linear is None else answer.duals[first : first + len(linear.bounds)]
    if twist @ directions @ cost < 0:
        twist, duals = -twist, 0 * duals
    forces = answer.value[:t].reshape(n, w)
    if answer.status is Status.INFEASIBLE:
        return Reached(None, forces, twist, row_duals=duals)
    return Reached(answer.value[t:], forces, twist, answer.status is Status.UNBOUNDED, duals)


class Share(NamedTuple):
    """A state, None for none; the dual's twist, and in its scale the duals (m,) of the linear limits."""

    state: GraspState | None
    twist: Array
    row_duals: Array


def largest_share(grasp: Grasp, load: Wrench, limits: list[float]) -> Share:
    """A state that balances a load, found without ever asking for the impossible; and the dual's twist.

        maximise s   subject to   G f + s w_ext = 0,   f_i in cone_i,   |f_i| <= 1,   |f_i| <= s limit_i

    Zero always does. Forces f / s balance the load where s is more than rounding; |f_i| <= 1 keeps all
    numbers near 1, however large the forces that the load needs.
    """
    n, w = len(grasp), grasp.width
    t = n * w
    weight = 1 / grasp.lengths
    target = load.vector * weight
    unit = float(np.abs(target).max())
    rows = Rows(t + 1)
    rows.equal(np.hstack([grasp.scaled_matrix, target[:, None] / unit]))
    share, linear = np.eye(t + 1)[-1:], grasp.limit_rows
    if linear is not None:
        rows.at_least_zero((1 - SLACK) * linear.bounds[:, None] / unit * share - _spread(linear, w, t + 1))
    _inside_cones(rows, grasp, t + 1, SLACK)
    rows.at_least_zero(np.vstack([share, -share]), [0.0, 1.0])
    for i, limit in enumerate(limits):
        rows.second_order(np.vstack([np.zeros(t + 1), _pick(i, w, t + 1)]), [1.0, *[0.0] * w])
        if limit < inf and limit < LOOSE * unit:
            rows.second_order(np.vstack([(1 - SLACK) * limit / unit * share, _pick(i, w, t + 1)]))
    answer = _answer(rows.program(-share[0]))
    twist = -answer.duals[: len(target)] * weight
    duals = np.zeros(0) if linear is None else answer.duals[len(target) : len(target) + len(linear.bounds)]
    if twist @ load.vector < 0:
        twist, duals = -twist, 0 * duals
    s = float(answer.value[-1])
    if not s * LOOSE > 1 or not np.isfinite(answer.value).all():
        return Share(None, twist, duals)
    one = np.ones(1)
    found = Reached(one, answer.value[:t].reshape(n, w) / s, twist)
    along = load.vector[:, None] / unit
    held = held_state(grasp, 0 * load.vector, along, found, one, [limit / unit for limit in limits], unit)
    return Share(None if held is None else held[1], twist, duals)


def _inside_cones(rows: Rows, grasp: Grasp, unknowns: int, slack: float = 0.0) -> None:
    """Demand f_i in cone_i of the forces that stand first among the unknowns; slack: kept of the friction."""
    w, cones = grasp.width, grasp.cones
    for i, mu in enumerate(((1 - slack) * grasp.frictions).tolist()):
        pick = _pick(i, w, unknowns)
        along, across = cones.normals[i] @ pick, cones.tangents[i] @ pick
        rows.at_least_zero(along)
        if mu == 0:
            rows.equal(across)
        elif w == 2:
            rows.at_least_zero(np.vstack([mu * along - across[0], mu * along + across[0]]))
        else:
            rows.second_order(np.vstack([mu * along, across]))


def _pick(i: int, w: int, unknowns: int) -> Array:
    """(w, unknowns) that takes the force of one contact."""
    pick = np.zeros((w, unknowns))
    pick[:, w * i : w * i + w] = np.eye(w)
    return pick


def _spread(linear: LimitRows, w: int, unknowns: int) -> Array:
    """(m, unknowns) the rows of linear limits, forces first among the unknowns."""
    wide = np.zeros((len(linear.rows), unknowns))
    for row, i, a in zip(wide, linear.contacts.tolist(), linear.rows, strict=True):
        row[w * i : w * i + w] = a
    return wide


def _answer(program: Program) -> Solution:
    try:
        return solve(program, "clarabel")
    except SolverFailed as failed:  # near enough or not, the check of forces and twist decides
        answer: Solution = failed.solution
        return answer


def half_plane(
    grasp: Grasp,
    base: Array,
    directions: Array,
    twist: Array,
    limits: list[float],
    duals: Array,
    unit: float = 1.0,
) -> tuple[Array, float]:
    """(normal, bound), |normal| = 1 or 0: normal . k <= bound for every k that forces balance.

    duals: of the contacts' linear limits, as ``farthest`` has them. unit: of force [N].
    """
    rows = grasp.limit_rows
    mu = grasp.frictions.tolist()
    if not twist.any() or not np.isfinite(twist).all():
        return np.zeros(directions.shape[1]), inf
    best: tuple[Array, float] = np.zeros(directions.shape[1]), inf
    kept = limits
    if rows is not None:
        kept = [1.0 if (rows.contacts == i).any() else limit for i, limit in enumerate(limits)]
    for y in (twist, cleared(grasp, twist, mu, kept)):
        normal = y @ directions
        size = float(np.linalg.norm(normal))
        speed = float(np.abs(y * grasp.lengths).max())
        if size == 0 or speed == 0:
            continue
        counts = [] if rows is None else counted(grasp, rows, y, duals, mu, limits).tolist()
        work = 0.0 if rows is None else float(np.dot(counts, rows.bounds)) / unit
        for opposition, limit in zip(map(float, oppositions(grasp, mu, y, counts)), limits, strict=True):
            if limit < inf:
                work += limit * opposition
            elif opposition > ROUNDING * speed:
                work = inf
        bound = (work - float(y @ base)) / size
        if bound < best[1]:
            best = normal / size, bound
    return best


def held_state(
    grasp: Grasp,
    base: Array,
    directions: Array,
    found: Reached,
    inside: Array,
    limits: list[float],
    unit: float,
) -> tuple[Array, GraspState] | None:
    """(k, a state that balances base + D k), k moved towards ``inside`` as little as rounding asks for."""
    if found.k is None or not np.isfinite(found.k).all() or not np.isfinite(found.forces).all():
        return None
    cones = grasp.cones
    for share in _SHARES if grasp.limit_rows is None else (*_SHARES, *_MORE_SHARES):
        k = found.k + share * (inside - found.k)
        load = base + directions @ k
        if not load.any():
            return k, GraspState(grasp, Wrench.from_vector(load), np.zeros_like(found.forces))
        chooser = Chooser(grasp, Wrench.from_vector(load), "clarabel", None, limits)
        wanted = found.forces if grasp.limit_rows is None else (1 - share) * found.forces
        forces = chooser.settled(wanted, grasp.frictions.tolist(), limits)
        if forces is not None:
            state = GraspState(grasp, Wrench.from_vector(unit * load), unit * cones.forces(forces))
            if state.is_balanced(reserve=0.0):
                return k, state
    return None

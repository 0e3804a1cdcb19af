"""The best forces of many grasps under their loads, as arrays."""

from dataclasses import dataclass
from math import inf

import numpy as np

from regrasp.closed_form.conic.grasp_states import HELD, NONE
from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, Flags, number, read_only
from regrasp.mechanics.margins import Margins, margins
from regrasp.mechanics.reserve import RESERVE, reserve_fraction
from regrasp.mechanics.value import ArrayValue
from regrasp.planning.states.arrays.chosen import chosen
from regrasp.planning.states.arrays.left_open import again
from regrasp.planning.states.arrays.many_grasps import ManyGrasps
from regrasp.planning.states.criteria import PEAK_RATIO
from regrasp.planning.states.objectives import Objective, objective_of

_ASKED, _OF = 100, 500


@dataclass(frozen=True, eq=False)
class BatchStates(ArrayValue):
    """The best forces of many grasps; leading shapes (...) are those given.

    Args:
        held: (...) whether a grasp holds its load: by ``forces`` that were checked.
        refused: (...) whether none do, proven by ``twists``. Where neither is so the grasp is open: the small
            programs were left by rounding, or a motion that no contact resists, and ``choose_state`` found no
            proof, either. It is asked for a hundred grasps, or one in 500 if these are more; of those open
            beyond it says more.
        values: (...) of the objective in its unit; NaN where a load is not held.
        forces: (..., n, d) [N]; NaN where it is not held.
        margins: of these forces, each (..., n).
        twists: (..., 3) or (..., 6) motions along which the load does more work than any forces within cones
            and limits oppose, or within 1e4 times the load where there are no limits; zero where none is
            needed.
    """

    held: Flags
    refused: Flags
    values: Array
    forces: Array
    margins: Margins
    twists: Array


def choose_states(
    positions: ArrayLike,
    normals: ArrayLike,
    frictions: ArrayLike,
    force: ArrayLike,
    torque: ArrayLike = 0.0,
    *,
    objective: str | Objective = "force",
    max_force: ArrayLike | None = None,
    peak_ratio: float = PEAK_RATIO,
    reserve: float = RESERVE,
) -> BatchStates:
    """``choose_state`` for arrays of grasps of point contacts, in the plane and in space.

    Two planar contacts by the closed form; others by small conic programs, compiled by Numba (seconds on the
    first call, then kept) and run on all cores. Every state is checked, every refusal proven.

    Args:
        positions: (..., n, d) of the contacts, object frame, n from 2 to 8 in the plane, 3 to 8 in space [m].
        normals: (..., n, d) into the object, of any length but zero.
        frictions: (..., n), or one number, greater than 0.
        force: (..., d) of the load, object frame [N].
        torque: (...) of the load about the centre of mass, (..., 3) in space; 0 for none [N m].
        objective: a word: ``force``, ``angle``, ``friction_use``, ``effort``, ``peak``, ``peak_normal`` or
            ``sum_normal``.
        max_force: (..., n), or one number; infinite for none [N].
        peak_ratio: as for ``choose_state`` [-].
        reserve: fraction of every friction coefficient that is kept back [-].

    Raises:
        InvalidInput: For bad input, and for an objective that needs limits under a load of zero.
    """
    sought = objective_of(objective)
    if sought.closed_form is None:
        raise InvalidInput(f"objective {shown(sought.name)} has no batch; ask choose_state")
    number(peak_ratio, "peak_ratio", least=1)
    given = ManyGrasps.of(positions, normals, frictions, force, torque, max_force)
    kept = 1 - reserve_fraction(reserve)
    given.demand_limits(sought)
    forces, _, verdicts, twists = chosen(given, sought, peak_ratio, kept)
    held = (verdicts == HELD) & given.holds(forces)
    refused = (verdicts == NONE) & given.is_lost(twists)
    left = np.flatnonzero(~held & ~refused)
    for k in left[: max(_ASKED, len(held) // _OF)]:
        again(given, int(k), sought, peak_ratio, reserve, forces, twists)
    if left.size:
        held[left] = given.some(left).holds(forces[left])
        refused[left] = ~held[left] & given.some(left).is_lost(twists[left])
    forces[~held] = np.nan
    twists[~refused] = 0.0
    found = margins(forces, given.normals, given.frictions)
    for verdict in (held, refused):
        verdict.setflags(write=False)
    return BatchStates(
        held.reshape(given.shape),
        refused.reshape(given.shape),
        read_only(np.where(held, _values(sought.name, forces, found, given), np.nan).reshape(given.shape)),
        read_only(forces.reshape(*given.shape, *forces.shape[1:])),
        Margins(
            *(
                read_only(x.reshape(*given.shape, x.shape[1]))
                for x in (found.angle, found.force, found.friction_use)
            )
        ),
        read_only(twists.reshape(*given.shape, twists.shape[1])),
    )


def _values(name: str, forces: Array, found: Margins, given: ManyGrasps) -> Array:
    """(m,) what the objective comes to."""
    sizes = (forces * forces).sum(axis=-1)
    normal = np.einsum("mnd,mnd->mn", forces, given.normals)
    by_name = {
        "angle": lambda: np.where(np.isnan(found.angle), inf, found.angle).min(axis=1),
        "friction_use": lambda: np.where(np.isnan(found.friction_use), -inf, found.friction_use).max(axis=1),
        "force": lambda: found.force.min(axis=1),
        "effort": lambda: sizes.sum(axis=1),
        "peak": lambda: np.sqrt(sizes.max(axis=1)),
        "peak_normal": lambda: normal.max(axis=1),
        "sum_normal": lambda: normal.sum(axis=1),
    }
    with np.errstate(all="ignore"):
        return np.asarray(by_name[name]())

"""The best states of many grasps, ``conic.grasp_states`` compiled by Numba. Imported when needed."""

from typing import Any

import numpy as np
from numba import njit

from regrasp.closed_form.compiled.compiling import INNER, compiled, digest
from regrasp.closed_form.compiled.sharing import shared
from regrasp.closed_form.conic import balance, cone_program, grasp_states, levels, state_program
from regrasp.closed_form.conic.balance import Room

_MODULES = cone_program, balance, state_program, levels, grasp_states
_best_state = compiled(_MODULES, inline=False)["best_state"]


@njit(**INNER)
def _room(n, d):  # type: ignore[no-untyped-def]
    q, count = 3 * d - 3, n * d
    rows, unknowns = 3 * n * d + 4 * n + count, count + 1
    return Room(
        np.zeros((count, q)),
        np.zeros(q),
        np.zeros((count, count + 1)),
        np.zeros(count),
        np.zeros((rows, unknowns)),
        np.zeros(rows),
        np.zeros(rows),
        np.zeros(rows),
        np.zeros(unknowns),
        np.zeros(unknowns),
        np.zeros(3 * n + 2, dtype=np.int64),
        np.zeros((12, rows)),
        np.zeros((unknowns, unknowns)),
        np.zeros((rows, unknowns)),
        np.zeros(n),
        np.zeros(n),
        np.zeros(n),
        np.zeros((n, d)),
        np.zeros((n, d)),
        np.zeros(unknowns),
    )


def _loop(sources: str) -> Any:
    @shared("the best states of many grasps", error_model="numpy")
    def best_states(  # type: ignore[no-untyped-def]
        begin,
        end,
        objective,
        peak_ratio,
        matrices,
        loads,
        normals,
        tangents,
        mu,
        limits,
        forces,
        used,
        twists,
        found,
    ):
        _ = sources
        n, d = normals.shape[1], normals.shape[2]
        room = _room(n, d)
        for k in range(begin, end):
            found[k] = _best_state(
                objective, matrices[k], loads[k], normals[k], tangents[k], mu[k], limits[k], peak_ratio, n, d,
                room, forces[k], used[k], twists[k],
            )  # fmt: skip
        return 0

    return best_states


best_states = _loop(digest(_MODULES))
"""Writes forces (m, n, d), limits (m, n), twists (m, q) and verdicts (m,) of ``best_state``."""

"""The planar path of least change through internal forces, where instants are coupled to neighbours alone.

Forces that balance a load differ by internal forces N u, so that equilibrium is kept whatever u is; what is
left of the path program is a quadratic program whose band ``time_banded`` factors.
"""

from math import inf

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.planning.changes.path_program import PathTask
from regrasp.planning.changes.time_banded import solved_over_time
from regrasp.planning.states.faces import cone_faces

# From so many instants on it is faster than a program of all of them.
_MANY = 200
_FLAT = 1e-10


def least_change(task: PathTask) -> Array | None:
    """The inner forces (K - 2, n, 2) of least change [N]; None where limits or idle fingers forbid this road.

    They balance the load to rounding and are inside the cones to the tolerance of the method.
    """
    grasp, mu, unit = task.grasp, task.frictions, task.unit
    is_plain = grasp.width == 2 and task.times.size >= _MANY and bool(task.active[1:-1].all())
    has_limits = min(task.limits.min(), task.rates.min()) < inf or grasp.limit_rows is not None
    if not is_plain or has_limits:
        return None
    smooth = np.flatnonzero(mu == 0)
    equal, rows = [grasp.scaled_matrix], []
    offsets: list[float] = []
    for i, faces in enumerate(cone_faces(grasp, mu, None)):
        normal, pick = grasp.cones.normals[i], np.zeros((2, len(grasp), 2))
        if mu[i] > 0:
            pick[:, i] = faces
            rows.append(pick.reshape(2, -1))
            offsets += [0.0, 0.0] if task.set_back is None else (task.set_back[i] / unit).tolist()
        else:
            pick[0, i], pick[1, i] = normal, grasp.cones.tangents[i, 0]
            rows.append(pick[:1].reshape(1, -1))
            equal.append(pick[1:].reshape(1, -1))
            offsets.append(0.0)
        if task.least_normals[i] > 0:
            pushed = np.zeros((len(grasp), 2))
            pushed[i] = normal
            rows.append(pushed.reshape(1, -1))
            offsets.append(task.least_normals[i] / unit)
    E, C = np.vstack(equal), np.vstack(rows)
    _, sizes, right = np.linalg.svd(E)
    rank = int((sizes > _FLAT * sizes[0]).sum())
    N = right[rank:].T
    if not N.shape[1]:
        return None
    ends = task.reference.reshape(len(task.times), -1) / unit
    ends[0], ends[-1] = task.start.ravel() / unit, task.end.ravel() / unit
    loads = np.pad(task.loads[1:-1] / (grasp.lengths * unit), ((0, 0), (0, smooth.size)))
    start = ends.copy()
    back = np.linalg.pinv(E)
    for _ in range(2):
        start[1:-1] -= (start[1:-1] @ E.T + loads) @ back.T
    if abs(start[1:-1] @ E.T + loads).max() > 1e-12 * max(1.0, float(abs(start).max())):
        return None
    w = 1 / np.diff(task.phases)
    changes = 2 * w[:, None] * (np.diff(start, axis=0) @ N)
    h = start[1:-1] @ C.T - np.array(offsets)
    u = solved_over_time(np.ascontiguousarray(C @ N), h, w, changes[:-1] - changes[1:])
    return None if u is None else unit * (start[1:-1] + u @ N.T).reshape(-1, len(grasp), 2)

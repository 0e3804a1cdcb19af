"""Twists that move with the fingers: what bounds all placements of a box where no fixed twists do.

For twists y_l of loads w_l whose velocities are affine in where fingers are on straight sides, and whose
angular velocities are fixed, the velocity of each finger is affine in the places, too. So

    sum_l (-w_l) . y_l - limit sum_l sum_i sigma(v_il)

is concave in all places together, and where it is above zero at the corners of a box, no placement in the box
holds all loads with forces of at most the limit. The proof stands in the documentation, page "Where to put
the fingers".
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse

from regrasp.mechanics.checks import Array
from regrasp.programs import Block, Cone, Program, Status
from regrasp.programs.backends import asked

_ROUGH = dict.fromkeys(("tol_gap_abs", "tol_gap_rel", "tol_feas"), 1e-7)  # any twists that exclude do
_SURE = 1e-9  # of the terms, more than rounding adds


@dataclass(frozen=True, eq=False)
class MovingTwists:
    """Twists of k fingers: velocity (2,), angular velocity, and by how much each finger adds to v_x and v_y.

    A finger adds nothing at the beginning of its arc, and all at the end.
    """

    fingers: int

    @cached_property
    def corners(self) -> np.ndarray:
        """(2^k, k) which end of its arc each finger is at."""
        return np.indices([2] * self.fingers).reshape(self.fingers, -1).T

    @cached_property
    def at_corners(self) -> Array:
        """(2^k, 3, 3 + 2 k) by which the numbers of a twist become a twist at each corner."""
        k = self.fingers
        found = np.zeros((len(self.corners), 3, 3 + 2 * k))
        found[:, range(3), range(3)] = 1.0
        found[:, 0, 3 : 3 + k] = found[:, 1, 3 + k :] = self.corners
        return found

    def excluding(self, points: Array, normals: Array, friction: float, loads: Array) -> Array | None:
        """(L, 3 + 2 k) twists that exclude a box for forces of at most 1; None for none found.

        points: (k, 2, 2) ends of the arcs. normals: (k, 2). loads: (L, 3) to be made.
        """
        across = normals[:, ::-1] * [1, -1] * friction
        edges = np.stack([normals - across, normals + across], axis=1) / np.hypot(1, friction)
        forces = np.concatenate([edges, normals[:, None]], axis=1)[:, None].repeat(2, axis=1)
        around = points[:, :, None, 0] * forces[..., 1] - points[:, :, None, 1] * forces[..., 0]
        wrenches = np.concatenate([forces, around[..., None]], axis=3)[np.arange(self.fingers), self.corners]
        k, c, count, each = self.fingers, len(self.corners), len(loads), 3 + 2 * self.fingers
        n = count * each + c * count * k + 1
        sigma = count * each + np.arange(c * count * k).reshape(c, count, k)
        done = np.zeros((c, count, k, 3, n))
        work, sums = np.zeros((c, n)), np.zeros((c, n))
        along = np.einsum("cigd,cdp->cigp", wrenches, self.at_corners)
        for i, load in enumerate(loads):
            done[:, i, ..., i * each : (i + 1) * each] = along
            work[:, i * each : (i + 1) * each] = -np.einsum("d,cdp->cp", load, self.at_corners)
        corner, number, finger = np.indices(sigma.shape)
        done[corner, number, finger, :, sigma] = -1.0
        work[corner, sigma] = sums[corner, sigma] = 1.0
        work[:, -1] = 1.0
        least = -np.eye(n)[count * each : -1]
        A = sparse.csc_matrix(np.vstack([done.reshape(-1, n), least, work, sums]))
        b, q = np.zeros(A.shape[0]), np.zeros(n)
        b[-c:], q[-1] = 1.0, -1.0
        program = Program(sparse.csc_matrix((n, n)), q, A, b, (Block(Cone.NONNEGATIVE, len(b)),))
        found = asked(program, "clarabel", _ROUGH)
        if found.status not in (Status.SOLVED, Status.STOPPED):
            return None
        twists: Array = found.value[: count * each].reshape(count, each)
        return twists if self._exclude(twists, points, normals, friction, loads) else None

    def _exclude(self, twists: Array, points: Array, normals: Array, friction: float, loads: Array) -> bool:
        y = np.einsum("cdp,lp->cld", self.at_corners, twists)
        p = points[np.arange(self.fingers), self.corners][:, None]
        x = y[:, :, None, 0] - y[:, :, None, 2] * p[..., 1]
        z = y[:, :, None, 1] + y[:, :, None, 2] * p[..., 0]
        ahead = x * normals[:, 0] + z * normals[:, 1]
        aside = np.abs(x * normals[:, 1] - z * normals[:, 0])
        edge = np.maximum(ahead + friction * aside, 0.0) / np.hypot(1, friction)
        most = np.where(aside <= friction * ahead, np.hypot(x, z), edge).sum(axis=(1, 2))
        work, size = (y * loads).sum(axis=(1, 2)), np.abs(y * loads).sum(axis=(1, 2))
        return bool((work > most + _SURE * (size + most)).all())

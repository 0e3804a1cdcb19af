"""How far a contact may be off along its surface, forces as they are.

At r' with the normal n' the forces f balance the load but for (G' - G) f, which the springs answer:
f' = f + R' (G' - G) f inside the cones, of which that at n' has turned. Nothing of it is linear in the
offset, so the first failure is looked for in steps and closed in on; it is exact but for what a step may jump
over.
"""

from math import inf
from typing import NamedTuple

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.orientation.tangents import tangents_of
from regrasp.mechanics.robust.moved import moved
from regrasp.mechanics.robust.stiffness import response, stiffness_matrices
from regrasp.mechanics.robust.withstanding import EXCEEDS, OPENS, SLIPS, Withstanding, measured_response
from regrasp.mechanics.wrench import torque
from regrasp.planning.robustness.views import View

_STEPS = 24  # finer near 0, where little may fail and hold again
_SECTIONS, _ROUNDS = 12, 9
_ZOOMS = 6
_NEXT = 1e-4  # its square is the first length of all, so that a dip after it has three around it
_DIRECTIONS = 8
_ROUNDING = 1e-13  # of the largest force
_TURN = 3.0  # of a normal, at most [rad]


def farthest_offsets(
    view: View, base: LoadSet | None, curvatures: Array, reach: float
) -> tuple[Array, list[tuple[str, str]]]:
    """(n,) lengths [m] at which a finger first fails, infinite where none does in reach; who, how."""
    lengths, failing = [], []
    for i, curvature in enumerate(curvatures.tolist()):
        found = inf, ("", "")
        if view.state.forces[i].any():
            most = reach if curvature == 0 else min(reach, _TURN / abs(curvature))
            found = _first_failure(_Moving(view, base, curvatures, i), most)
        lengths.append(found[0])
        failing.append(found[1])
    return np.array(lengths), failing


def _first_failure(moving: "_Moving", most: float) -> tuple[float, tuple[str, str]]:
    """The least length in any direction, and which finger fails there and how."""
    ways = _directions(moving.view.grasp.dimension)
    steps = most * np.append(_NEXT, (np.arange(_STEPS) + 1) / _STEPS) ** 2
    left = moving.left(np.tile(steps, (len(ways), 1)), ways)  # (ways, steps, n)
    fails = np.asarray((left < 0).any(axis=2))
    first = np.where(fails.any(axis=1), fails.argmax(axis=1), steps.size)
    ends = np.append(0.0, steps)
    high = np.append(steps, inf)[first]
    low = ends[first]
    for way, at in _dips(moving, ways, steps, left).items():
        if at < high[way]:
            high[way], low[way] = at, ends[np.searchsorted(ends, at) - 1]
    if high.min() == inf:
        return inf, ("", "")
    near = low < high.min()
    ways, start = ways[near], float(low[near].min())
    width = float(high.min()) - start
    for _ in range(_ROUNDS):
        inner = start + width * (np.arange(_SECTIONS) + 1) / _SECTIONS
        fails = np.asarray((moving.left(np.tile(inner, (len(ways), 1)), ways) < 0).any(axis=2))
        first = np.where(fails.any(axis=1), fails.argmax(axis=1), _SECTIONS)
        k = min(int(first.min()), _SECTIONS - 1)
        ways = ways[first == first.min()]
        width /= _SECTIONS
        start += k * width
    return start, moving.who((start + 2 * width) * ways[0])


def _dips(moving: "_Moving", ways: Array, steps: Array, left: Array) -> dict[int, float]:
    """By way, the least length between steps at which a finger fails that holds at both.

    What a finger has left is smooth, so where it is least between three steps a parabola finds the bottom.
    """
    middle = left[:, 1:-1]
    bottoms = (middle >= 0) & (middle <= left[:, :-2]) & (middle <= left[:, 2:])
    way, k, finger = np.nonzero(bottoms & np.isfinite(left[:, :-2] + left[:, 2:]))
    if not way.size:
        return {}
    x = np.stack([steps[k], steps[k + 1], steps[k + 2]])
    v = np.stack([left[way, k + j, finger] for j in range(3)])
    found: dict[int, float] = {}
    for _ in range(_ZOOMS):
        at = _vertex(x, v)
        value = moving.left(at[:, None], ways[way])[np.arange(way.size), 0, finger]
        for place in np.flatnonzero(value < 0).tolist():
            found[way[place]] = min(found.get(way[place], inf), float(at[place]))
        lower, right = value < v[1], at > x[1]
        inner_x, inner_v = np.where(lower, at, x[1]), np.where(lower, value, v[1])
        outer_x, outer_v = np.where(lower, x[1], at), np.where(lower, v[1], value)
        replaced = right != lower  # the end on the left is what is not the new middle's side
        x = np.stack([np.where(replaced, x[0], outer_x), inner_x, np.where(replaced, outer_x, x[2])])
        v = np.stack([np.where(replaced, v[0], outer_v), inner_v, np.where(replaced, outer_v, v[2])])
    return found


def _vertex(x: Array, v: Array) -> Array:
    """(m,) where the parabola through three points (3, m) is least, well inside of them."""
    a, b = x[1] - x[0], x[2] - x[1]
    p, q = (v[0] - v[1]) / a, (v[2] - v[1]) / b  # not negative
    with np.errstate(divide="ignore", invalid="ignore"):
        shift = (p * b - q * a) / (2 * (p + q))
    shift = np.where(np.isfinite(shift), shift, 0.0)
    shift = np.where(np.abs(shift) < 1e-3 * (a + b), np.where(b > a, 0.1 * b, -0.1 * a), shift)
    return np.asarray(x[1] + np.clip(shift, -0.9 * a, 0.9 * b))


def _directions(dimension: int) -> Array:
    if dimension == 2:
        return np.array([[1.0], [-1.0]])
    angles = 2 * np.pi * np.arange(_DIRECTIONS) / _DIRECTIONS
    return np.column_stack([np.cos(angles), np.sin(angles)])


class _Spares(NamedTuple):
    """(m, n) distances to the cone's edge and to the limit, and normal forces [N]; infinite where none is."""

    slipping: Array
    exceeding: Array
    normal: Array


class _Moving:
    """One contact that is off, the others where they are."""

    def __init__(self, view: View, base: LoadSet | None, curvatures: Array, i: int) -> None:
        self.view, self.base, self.curvatures, self.i = view, base, curvatures, i
        grasp = view.grasp
        n, w = len(grasp), grasp.width
        self.springs = stiffness_matrices(grasp, view.stiffness, view.controlled)
        self.blocks = np.moveaxis((grasp.matrix / grasp.lengths[:, None]).reshape(-1, n, w), 1, 0)
        self.held = np.einsum("nqa,nab,npb->nqp", self.blocks, self.springs, self.blocks)
        normal = grasp.normals[i]
        inner = self.springs[i][: grasp.dimension, : grasp.dimension]
        self.turns = np.ndim(view.stiffness) == 2 and bool(self.springs[i].any())
        self.along = float(normal @ inner @ normal)
        self.across = float((np.trace(inner) - self.along) / (grasp.dimension - 1))
        self.working = view.state.forces.any(axis=1)
        self.rounding = _ROUNDING * float(np.abs(view.state.forces).max())

    def left(self, lengths: Array, ways: Array) -> Array:
        """(ways, lengths, n) what fingers have left for lengths (ways, lengths); negative where they fail."""
        offsets = (ways[:, None] * lengths[:, :, None]).reshape(-1, ways.shape[1])
        spares = self._spares(offsets)
        return np.minimum(spares.slipping, spares.exceeding).reshape(*lengths.shape, -1)

    def who(self, offset: Array) -> tuple[str, str]:
        """Which finger is farthest outside, and how."""
        slipping, exceeding, normal = (row[0] for row in self._spares(offset[None]))
        k = int(np.minimum(slipping, exceeding).argmin())
        how = EXCEEDS if exceeding[k] < slipping[k] else OPENS if normal[k] <= 0 else SLIPS
        return self.view.grasp.names[k], how

    def _spares(self, offsets: Array) -> _Spares:
        found = self._alone(offsets) if self.base is None else self._besides(offsets)
        for left in (found.slipping, found.exceeding):  # without friction rounding alone would slip
            left += self.rounding
        out = ~self.working
        found.slipping[:, out] = inf
        found.exceeding[:, out] = inf
        return found

    def _alone(self, offsets: Array) -> _Spares:
        """Without a disturbance, all offsets (m, d - 1) at once."""
        grasp, i = self.view.grasp, self.i
        forces = self.view.state.forces
        d, w, arms = grasp.dimension, grasp.width, 1 / grasp.lengths
        position, normal = self._places(offsets)
        block = np.zeros((len(offsets), self.blocks.shape[1], w))
        block[:, :d, :d] = np.eye(d)
        block[:, d:, :d] = np.moveaxis(torque(position[:, None], np.eye(d)), 1, 2)
        if w > d:
            block[:, d:, d] = normal
        block *= arms[:, None]
        springs = np.broadcast_to(self.springs[i], (len(offsets), w, w))
        if self.turns:
            springs = springs.copy()
            springs[:, :d, :d] = self.across * np.eye(d)
            springs[:, :d, :d] += (self.along - self.across) * normal[:, :, None] * normal[:, None]
        answer_i = np.einsum("mab,mqb->maq", springs, block)
        held = self.held.sum(axis=0) - self.held[i] + np.einsum("mqa,map->mqp", block, answer_i)
        error = (block - self.blocks[i]) @ forces[i]  # of the balance, (m, q)
        moves = -np.linalg.solve(held, error[..., None])[..., 0]
        change = np.einsum("nab,nqb,mq->mna", self.springs, self.blocks, moves)
        change[:, i] = np.einsum("maq,mq->ma", answer_i, moves)
        measured = grasp.cones.measured(forces + change)
        normals = np.broadcast_to(grasp.cones.normals, measured.shape).copy()
        normals[:, i, :d] = normal
        along = (measured * normals).sum(axis=-1)
        across = np.sqrt(((measured - along[..., None] * normals) ** 2).sum(axis=-1))
        mu, within = grasp.frictions, self.view.limits - np.hypot(along, across)
        if grasp.limit_rows is not None:
            within = np.minimum(within, self._row_spares(forces + change, measured, normal))
        edge = np.minimum((mu * along - across) / np.sqrt(1 + mu**2), along)  # pulls, without friction too
        return _Spares(edge, within, along)

    def _row_spares(self, forces: Array, measured: Array, normal: Array) -> Array:
        """(m, n) what linear limits leave, where those of the contact that is off turn with its normal."""
        grasp, i, share, d = self.view.grasp, self.i, self.view.share, self.view.grasp.dimension
        rows, contact = grasp.limit_rows, grasp.contacts[i]
        assert rows is not None
        spares = rows.scaled(share).spare(measured)
        if contact.limits is None:
            return spares
        frame = np.concatenate([normal[:, None], tangents_of(normal)], axis=1)
        given, bounds = contact.limits.rows, share * contact.limits.bounds
        used = np.einsum("kd,mde,me->mk", given[:, :d], frame, forces[:, i, :d])
        used += forces[:, i, d : given.shape[1]] @ given[:, d:].T
        spares[:, i] = ((bounds - used) / np.hypot.reduce(given, axis=1)).min(axis=1)
        return spares

    def _places(self, offsets: Array) -> tuple[Array, Array]:
        """(m, d) points and normals of the contact off along its surface (``moved``)."""
        grasp, curvature = self.view.grasp, float(self.curvatures[self.i])
        tangents = grasp.tangents.reshape(len(grasp), -1, grasp.dimension)[self.i]
        n, s = grasp.normals[self.i], np.sqrt((offsets**2).sum(axis=1))[:, None]
        t = offsets @ tangents / s
        turn = curvature * s
        along = np.sin(turn) / curvature if curvature else s
        inwards = 2 * np.sin(turn / 2) ** 2 / curvature if curvature else 0 * s
        return grasp.positions[self.i] + along * t + inwards * n, np.cos(turn) * n - np.sin(turn) * t

    def _besides(self, offsets: Array) -> _Spares:
        """Besides a disturbance, one offset after the other."""
        view, base = self.view, self.base
        grasp, stacked = view.grasp, view.state.forces.ravel()
        found = []
        for offset in offsets:
            whole = np.zeros((len(grasp), grasp.dimension - 1))
            whole[self.i] = offset
            off = moved(grasp, whole, self.curvatures)
            answer = response(off, view.stiffness, view.controlled)
            forces = stacked + answer @ ((off.matrix - grasp.matrix) @ stacked)
            measured = off.cones.measured(forces.reshape(view.state.forces.shape))
            given = Withstanding(
                off.cones, measured, measured_response(off, answer), off.frictions, view.limits, base,
                None if off.limit_rows is None else off.limit_rows.scaled(view.share),
            )  # fmt: skip
            found.append((given.spare(), off.cones.normal(measured)))
        spares, normal = (np.array(column) for column in zip(*found, strict=True))
        return _Spares(spares, np.full(spares.shape, inf), normal)

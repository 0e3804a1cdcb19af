"""How far a contact may be off along its surface, forces as they are.

At r' with the normal n' the forces f balance the load but for (G' - G) f, which the springs answer:
f' = f + R' (G' - G) f inside the cones, of which that at n' has turned. Nothing of it is linear in the
offset, so the first failure is looked for in steps and closed in on; it is exact but for what a step may jump
over.
"""

from math import inf
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

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
_DIRECTIONS = 8
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
    steps = most * ((np.arange(_STEPS) + 1) / _STEPS) ** 2
    fails = moving.fails(steps, ways)  # (ways, steps)
    first = np.where(fails.any(axis=1), fails.argmax(axis=1), _STEPS)
    if first.min() == _STEPS:
        return inf, ("", "")
    ways = ways[first == first.min()]
    ends = np.append(0.0, steps)[first.min() : first.min() + 2]
    low, width = float(ends[0]), float(ends[1] - ends[0])
    for _ in range(_ROUNDS):
        inner = low + width * (np.arange(_SECTIONS) + 1) / _SECTIONS
        fails = moving.fails(inner, ways)
        first = np.where(fails.any(axis=1), fails.argmax(axis=1), _SECTIONS)
        k = min(int(first.min()), _SECTIONS - 1)
        ways = ways[first == first.min()]
        width /= _SECTIONS
        low += k * width
    return low, moving.who((low + 2 * width) * ways[0])


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

    def fails(self, lengths: Array, ways: Array) -> NDArray[np.bool_]:
        """(ways, lengths) whether some finger fails."""
        offsets = (ways[:, None] * lengths[:, None]).reshape(-1, ways.shape[1])
        spares = self._spares(offsets)
        broken = (np.minimum(spares.slipping, spares.exceeding) < 0).any(axis=1)
        return np.asarray(broken.reshape(len(ways), lengths.size))

    def who(self, offset: Array) -> tuple[str, str]:
        """Which finger is farthest outside, and how."""
        slipping, exceeding, normal = (row[0] for row in self._spares(offset[None]))
        k = int(np.minimum(slipping, exceeding).argmin())
        how = EXCEEDS if exceeding[k] < slipping[k] else OPENS if normal[k] <= 0 else SLIPS
        return self.view.grasp.names[k], how

    def _spares(self, offsets: Array) -> _Spares:
        found = self._alone(offsets) if self.base is None else self._besides(offsets)
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
        return _Spares((mu * along - across) / np.sqrt(1 + mu**2), within, along)

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

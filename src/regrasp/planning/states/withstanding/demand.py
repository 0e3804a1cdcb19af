"""What forces must withstand: in which cases, by which response, against which set.

A finger that leaves or arrives is force-controlled: the others answer for it. As long as it touches it may
answer, too; and it may lose contact early, which takes its wrench from the others. Each is a case,

    T f + R d inside cones and limits for every d of the set,

so that the forces that withstand all of them are a convex set, and with them every straight path between two.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import cast

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.robust.stiffness import Stiffness, response
from regrasp.mechanics.robust.withstanding import Withstanding, Worst, measured_response

_SPARE = 1e-8


@dataclass(frozen=True, eq=False)
class Case:
    """Forces T f, and their change R d (n, w, q), as the cones measure them; and whose cones count.

    transform: (n w, n w) T, None for none.
    """

    responses: Array
    transform: Array | None
    contacts: tuple[int, ...]

    def after(self, forces: Array) -> Array:
        """(n, w) T f."""
        return forces if self.transform is None else (self.transform @ forces.ravel()).reshape(forces.shape)


@dataclass(frozen=True, eq=False)
class Demand:
    """A set that the forces of a grasp withstand.

    controlled: places of the fingers that leave or arrive, or groups of them, each by itself. early_loss:
    whether these may lose contact early.
    is_kept: False where a factor of it is made widest, in the place of the set as it is.
    """

    grasp: Grasp
    disturbance: LoadSet
    stiffness: Stiffness
    controlled: tuple[int, ...] | tuple[tuple[int, ...], ...] = ()
    early_loss: bool = False
    is_kept: bool = True

    def __post_init__(self) -> None:
        if self.disturbance.dimension != self.grasp.dimension:
            raise InvalidInput(
                f"disturbance must have the grasp's dimension {self.grasp.dimension}, got "
                f"{self.disturbance.dimension}"
            )

    @property
    def is_round(self) -> bool:
        """Whether the set is a ball or an ellipsoid, for which polytopes stand."""
        return self.disturbance.half_axes is not None

    @cached_property
    def cases(self) -> tuple[Case, ...]:
        """The stiffness of those that stay; of all; and the loss of those that leave or arrive."""
        everyone = tuple(range(len(self.grasp)))
        every = Case(self._response(()), None, everyone)
        if not self._groups:
            return (every,)
        answers = [self._response(group) for group in self._groups]
        cases = [Case(staying, None, everyone) for staying in answers]
        cases.append(every)
        if self.early_loss:
            for group, staying in zip(self._groups, answers, strict=True):
                some = [(i,) for i in group]
                lost = some if len(some) == 1 else [*some, group]
                cases += [self._without(gone, staying) for gone in lost]
        return tuple(cases)

    @property
    def _groups(self) -> tuple[tuple[int, ...], ...]:
        """Of the fingers that are controlled together."""
        if not self.controlled or isinstance(self.controlled[0], tuple):
            return cast(tuple[tuple[int, ...], ...], self.controlled)
        return (self.controlled,)

    def _response(self, controlled: tuple[int, ...]) -> Array:
        return measured_response(self.grasp, response(self.grasp, self.stiffness, controlled))

    def _without(self, gone: tuple[int, ...], staying: Array) -> Case:
        """The case in which some fingers are lost: f - R G_gone f_gone for the others."""
        n, w, _ = staying.shape
        transform = np.eye(n * w)
        for i in gone:
            here = slice(w * i, w * i + w)
            transform[:, here] -= staying.reshape(n * w, -1) @ self.grasp.cones.matrix[:, here]
            transform[here] = 0.0
        return Case(staying, transform, tuple(i for i in range(n) if i not in gone))

    def least_normals(self) -> Array:
        """(n,) normal forces without which a cone cannot hold what its finger must answer [N]."""
        normals = self.grasp.cones.normals
        twists = -np.einsum("nw,nwq->nq", normals, self.cases[0].responses)
        return np.maximum(self.disturbance.support(twists), 0.0)

    def set_back(self) -> Array:
        """(n, 2) in the plane, on the way: what g . f must be at least for the edges g = mu n -+ t [N]."""
        cones, mu = self.grasp.cones, self.grasp.frictions[:, None]
        edges = np.stack(
            [mu * cones.normals - cones.tangents[:, 0], mu * cones.normals + cones.tangents[:, 0]], axis=1
        )
        twists = -np.einsum("new,nwq->neq", edges, self.cases[0].responses)
        work = self.disturbance.support(twists)
        return work + _SPARE * np.abs(work)

    def row_bounds(self) -> Array | None:
        """(m,) what linear limits leave on the way, b less the most work of the set [N]; None without any."""
        rows = self.grasp.limit_rows
        if rows is None:
            return None
        twists = np.einsum("mw,mwq->mq", rows.rows, self.cases[0].responses[rows.contacts])
        work = self.disturbance.support(twists)
        left: Array = rows.bounds - work - _SPARE * np.abs(work)
        return left

    def largest_changes(self) -> Array:
        """(n,) at least the largest change of each force on the way [N]."""
        responses, around, axes = self.cases[0].responses, self.disturbance.cover, self.disturbance.half_axes
        if axes is None:
            assert around is not None
            changes = np.einsum("nwq,vq->nvw", responses, around)
            most: Array = np.sqrt((changes * changes).sum(axis=-1)).max(axis=1)
            return most
        middle = np.linalg.norm(responses @ self.disturbance.center.vector, axis=1)
        widest: Array = middle + np.linalg.norm(responses @ axes, 2, axis=(1, 2))
        return widest

    def spare(self, forces: Array, limits: Array, *, on_the_way: bool = False) -> float:
        """The least distance to the edges of cones and to limits, over all members [N].

        on_the_way: between two states, where the fingers that leave or arrive are force-controlled.
        """
        every = len(self._groups)
        cases = [c for k, c in enumerate(self.cases) if not (on_the_way and every and k == every)]
        return min(
            float(self._withstanding(c, forces, limits).spare()[list(c.contacts)].min()) for c in cases
        )

    def factors(self, forces: Array, limits: Array, scaled: LoadSet) -> list[Worst]:
        """How far another set may be scaled besides, in each case."""
        return [self._withstanding(case, forces, limits).factors(scaled) for case in self.cases]

    def _withstanding(self, case: Case, forces: Array, limits: Array) -> Withstanding:
        grasp = self.grasp
        return Withstanding(
            grasp.cones,
            case.after(forces),
            case.responses,
            grasp.frictions,
            limits,
            self.disturbance,
            grasp.limit_rows,
        )

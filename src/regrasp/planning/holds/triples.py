"""The hold graph in space: every triple of points that holds the load, in every direction of the load."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import comb, cos, inf, pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

from regrasp.closed_form.pyramid import facet_angles
from regrasp.closed_form.three_fingers import HOLDS, three_finger_hold
from regrasp.closed_form.triple_program import Fingers
from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, Flags, array, number, read_only, whole
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.orientation.spiral import even_directions
from regrasp.mechanics.reserve import RESERVE, kept_force, kept_friction, reserve_fraction
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.value import ArrayValue
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.choosing import MOST_FACETS
from regrasp.planning.states.criteria import PEAK_RATIO

TripleFilter = Callable[[Array, Array, Array], Flags]
"""(m, 3) first, second and third points -> (m,) which triples are allowed."""

FACETS = 8
"""Default facets of the inner pyramids."""
MOST_BYTES = 2 * 2**30
"""Default memory for the margins."""
_SLACK = 1e-9  # [rad] by which cones are narrowed less than a margin, for rounding
_TOGETHER = 64  # loads whose margins are held at a time where only verdicts are kept


@dataclass(frozen=True, eq=False)
class TripleGraph(ArrayValue):
    """Triples of contacts in space that hold loads with three fingers.

    contacts: candidates. loads: (O, 6) force and torque on the object, in its own frame [N, N m]: one load
    seen from the object in O orientations, or any others; ``directions`` gives forces. facets: of the inner
    pyramids that stand for the friction cones, even, at least 4. min_distance: between two fingers [m].
    keep: a filter of triples by reach or collision. among: (T, 3) indices of the triples to look at, None
    for all.

    A hold's margin [rad] is the widest angle by which its pyramids can be narrowed while every force stays
    below the contact's ``max_force`` or, where any contact has none, below ``peak_ratio`` times the least
    peak force of the hold (the force of a contact taken as f.n / cos(atan mu), the largest that its cone
    allows with that normal force). The pyramids lie inside the cones: the exact margin of the state found is
    at least as wide, and a triple that holds in its exact cones only, by little, may be missed (see
    ``facets``). Points within a fraction 2^-30 of one line are no hold, since the rotation about it is left
    free.
    """

    contacts: tuple[Contact, ...]
    loads: Array
    facets: int = FACETS
    peak_ratio: float = PEAK_RATIO
    reserve: float = RESERVE
    min_distance: float = 0.0
    keep: TripleFilter | None = None
    among: ArrayLike | None = None
    most_bytes: int = MOST_BYTES

    def __post_init__(self) -> None:
        if len(self.contacts) < 3 or any(c.dimension != 3 for c in self.contacts):
            raise InvalidInput("a triple graph needs three contacts in space or more")
        loads = array(self.loads, "loads", (None, 6))
        if not loads.any(axis=1).all():
            raise InvalidInput("no load may be zero: it has no direction, and three idle fingers hold it")
        object.__setattr__(self, "loads", loads)
        if whole(self.facets, "facets", least=4, most=MOST_FACETS) % 2:
            raise InvalidInput(f"facets must be an even whole number of at least 4, got {shown(self.facets)}")
        number(self.peak_ratio, "peak_ratio", least=1)
        reserve_fraction(self.reserve)
        number(self.min_distance, "min_distance", least=0)

    @cached_property
    def triples(self) -> NDArray[np.int32]:
        """(T, 3) indices i < j < k of contacts, by i, then by j, then by k; or those of ``among``."""
        if self.among is None:
            from regrasp.closed_form.compiled.triples import triples_of

            count = len(self.contacts)
            if 30 * comb(count, 3) > max(self.most_bytes, MOST_BYTES):  # while they are listed
                raise InvalidInput(
                    f"{count} contacts make too many triples to list; take fewer, or sample them by among"
                )
            return triples_of(len(self.contacts))
        given = array(self.among, "among", (None, 3))
        rows = given.astype(np.int32)
        if (rows != given).any() or rows.min(initial=0) < 0 or rows.max(initial=0) >= len(self.contacts):
            raise InvalidInput(f"among must be indices of contacts, 0 to {len(self.contacts) - 1}")
        if (np.diff(rows, axis=1) <= 0).any():
            raise InvalidInput("every row of among must be rising, i < j < k")
        rows.setflags(write=False)  # like all triples: Numba compiles anew for arrays that may be written
        return rows

    def triple(self, i: int, j: int, k: int) -> int:
        """The place of three contacts in ``triples``; raises ``InvalidInput`` if they are not among them."""
        i, j, k = sorted((i, j, k))
        count = len(self.contacts)
        if not 0 <= i < j < k < count:
            raise InvalidInput(f"a triple is three different contacts of 0 to {count - 1}, got {(i, j, k)}")
        if self.among is None:
            before = comb(count, 3) - comb(count - i, 3) + comb(count - i - 1, 2) - comb(count - j, 2)
            return before + k - j - 1
        found = np.flatnonzero((self.triples == (i, j, k)).all(axis=1))
        if not found.size:
            raise InvalidInput(f"the triple {(i, j, k)} is not one of those to look at")
        return int(found[0])

    @cached_property
    def margins(self) -> NDArray[np.float32]:
        """(O, T) margins [rad]; negative where a triple does not hold the load.

        -1: proven not to, in the pyramids. -2: on a line, too near or not allowed. -3: left open by rounding.
        Raises ``InvalidInput`` where the table needs more than ``most_bytes``.
        """
        self._refuse_above(4)
        result = np.zeros((len(self.loads), len(self.triples)), dtype=np.float32)
        self._judge(self.loads, True, result)
        return result

    def margins_of(self, places: NDArray[np.int64], least: float = 0.0) -> NDArray[np.float32]:
        """(n, O) the margins [rad] of some triples, by their places in ``triples``; each is found once.

        least: a margin below it [rad] need not be known, and may come as -1.
        """
        if "margins" in self.__dict__:
            return self.margins[:, places].T
        table, known = self._found
        new = places[known[places] > least]
        if new.size:
            result = self._verdicts(new, least) if least > 0 else self._unknown(new.size)
            self._judge(self.loads, True, result, new)
            table[new], known[new] = result.T, least
        return table[places]

    def bounds_of(self, places: NDArray[np.int64], least: float) -> NDArray[np.float32]:
        """(n, O) for some triples 0 where margins may be ``least`` [rad] or more, -1 where they are not."""
        verdicts = self._verdicts(places, least).T
        return np.where((verdicts == -1.0) | (verdicts == -2.0), np.float32(-1.0), np.float32(0.0))

    def under(self, few: NDArray[np.int64]) -> "TripleGraph":
        """The same triples under some of the loads, by their places."""
        graph = object.__new__(TripleGraph)  # a value is its own copy
        known = ("margins", "holds", "_found")
        graph.__dict__.update({name: each for name, each in self.__dict__.items() if name not in known})
        object.__setattr__(graph, "loads", read_only(self.loads[few]))  # as above
        return graph

    @cached_property
    def holds(self) -> NDArray[np.bool_]:
        """(O, T) whether triples hold, without margins: a fraction of the time, one byte each."""
        if "margins" in self.__dict__:
            return self.margins >= 0
        self._refuse_above(1)
        result = np.empty((len(self.loads), len(self.triples)), dtype=bool)
        some = np.empty((min(_TOGETHER, len(self.loads)), len(self.triples)), dtype=np.float32)
        for o in range(0, len(self.loads), _TOGETHER):
            loads = self.loads[o : o + _TOGETHER]
            some[:] = 0.0
            self._judge(loads, False, some[: len(loads)])
            result[o : o + len(loads)] = some[: len(loads)] >= 0
        return result

    def forces(self, t: int, o: int) -> Array:
        """(3, 3) forces [N] of the hold in place ``t`` under load ``o``: the state that has its margin.

        Raises ``InvalidInput`` where the triple does not hold that load.
        """
        places = self.triples[t].tolist()
        force, torque = self.loads[o].reshape(2, 3).tolist()
        verdict, _, forces = three_finger_hold(
            self.fingers(places), tuple(force), tuple(torque), self.facets, float(self.peak_ratio)
        )
        if verdict != HOLDS or not self._allowed[t]:
            raise InvalidInput(f"the triple {tuple(places)} does not hold load {o}: it has no forces")
        return np.array(forces)

    def state(self, t: int, o: int) -> GraspState:
        """The same as a state of a grasp of the three contacts."""
        grasp = Grasp([self.contacts[i] for i in self.triples[t].tolist()])
        return GraspState(grasp, Wrench.from_vector(self.loads[o]), self.forces(t, o))

    def fingers(self, places: list[int]) -> Fingers:
        """Three contacts as the closed form takes them."""
        vectors: list[Any] = [tuple(map(tuple, rows[places].tolist())) for rows in self._frames]
        numbers: list[Any] = [tuple(row) for row in self._frictions[:, places].tolist()]
        numbers += [tuple(row) for row in self._limits[:, places].tolist()]
        (points, normals), (mu, usable_mu, limits, usable_limits) = vectors, numbers
        return Fingers(points, normals, mu, limits, usable_mu, usable_limits)

    @cached_property
    def _found(self) -> tuple[NDArray[np.float32], Array]:
        """(T, O) margins of triples that were asked for, and (T,) the least margin [rad] that was."""
        self._refuse_above(4)
        count = len(self.triples)
        return np.empty((count, len(self.loads)), dtype=np.float32), np.full(count, inf)

    def _unknown(self, count: int) -> NDArray[np.float32]:
        return np.zeros((len(self.loads), count), dtype=np.float32)

    def _verdicts(self, places: NDArray[np.int64], least: float) -> NDArray[np.float32]:
        """(O, n) -1 where triples do not hold in cones narrowed by ``least`` [rad], whatever the forces."""
        result = self._unknown(places.size)
        self._judge(self.loads, False, result, places, max(least - _SLACK, 0.0))
        return result

    def _judge(
        self,
        loads: Array,
        with_margin: bool,
        result: NDArray[np.float32],
        places: NDArray[np.int64] | None = None,
        narrowed: float = 0.0,
    ) -> None:
        """Writes to ``result`` what triples in narrowed cones [rad] hold, but where it is -1 already."""
        from regrasp.closed_form.compiled.triples import triple_margins

        triples, allowed = self.triples, self._allowed
        if places is not None:
            triples, allowed = triples[places], allowed[places]
            triples.setflags(write=False)  # as above
        frictions = self._frictions
        if narrowed > 0:
            frictions = np.tan(np.maximum(np.arctan(frictions) - narrowed, 0.0))
        triple_margins(
            triples, allowed, *self._frames, frictions, self._limits, loads,
            facet_angles(self.facets), cos(pi / self.facets), float(self.peak_ratio), with_margin, result,
        )  # fmt: skip

    def _refuse_above(self, size: int) -> None:
        needed = size * len(self.loads) * len(self.triples)
        if needed > self.most_bytes:
            raise InvalidInput(
                f"{len(self.triples)} triples under {len(self.loads)} loads need {needed / 2**30:.3g} GiB, "
                f"more than {self.most_bytes / 2**30:.3g}; take fewer, sample triples by among, or allow "
                "more by most_bytes"
            )

    @cached_property
    def _frames(self) -> tuple[Array, Array]:
        """Points and normals, (N, 3) each."""
        return np.array([c.position for c in self.contacts]), np.array([c.normal for c in self.contacts])

    @cached_property
    def _frictions(self) -> Array:
        """(2, N) the friction a state is judged by, and what may be used of it."""
        each = [c.friction for c in self.contacts]
        return np.array([each, [kept_friction(mu, self.reserve) for mu in each]])

    @cached_property
    def _limits(self) -> Array:
        """(2, N) the same for the force limits [N]; infinite for none."""
        each = [inf if c.max_force is None else c.max_force for c in self.contacts]
        return np.array([each, [kept_force(limit, self.reserve) for limit in each]])

    @cached_property
    def _allowed(self) -> NDArray[np.bool_]:
        """(T,) whether the points are far enough from each other, and what the filter says."""
        corners = [self._frames[0][self.triples[:, c]] for c in range(3)]
        allowed = np.ones(len(self.triples), dtype=bool)
        if self.min_distance > 0:
            for a, b in ((0, 1), (1, 2), (2, 0)):
                allowed &= np.linalg.norm(corners[a] - corners[b], axis=1) >= self.min_distance
        if self.keep is not None:
            kept = self.keep(*corners)
            if np.shape(kept) != allowed.shape:
                raise InvalidInput(
                    f"keep must return which of {allowed.size} triples are allowed, shape "
                    f"{allowed.shape}; it "
                    f"returned shape {np.shape(kept)}"
                )
            allowed &= np.asarray(kept, dtype=np.bool_)
        return allowed


def directions(count: int, size: float = 1.0) -> Array:
    """(count, 6) loads without torque: forces of one size [N] in directions spread evenly over the sphere.

    They are those of ``even_directions``.
    """
    return np.pad(even_directions(count) * number(size, "size", above=0), ((0, 0), (0, 3)))

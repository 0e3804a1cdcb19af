"""Fingers put on a shape to begin with, and the question about a grasp."""

from contextlib import suppress
from itertools import combinations
from typing import Any

import numpy as np

from regrasp.errors import Infeasible, InvalidInput, RegraspError
from regrasp.explore.question import LONGEST_NAME, MOST_FINGERS, Question
from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.limits.limit_rows import refuse_limits
from regrasp.mechanics.wrench import Wrench
from regrasp.mesh.mesh import Mesh
from regrasp.outline.outline import Outline
from regrasp.planning.states.choosing import choose_state
from regrasp.planning.states.two_fingers import EquilibriumLocus

# Places on an outline and friction, until two fingers hold it.
_TRIED = ((24, 0.5), (60, 0.5), (60, 1.0), (120, 1.0))
_PUSH = 3.0  # the most force of a finger, for a load of 1
_PLACES, _FRICTION, _PAIRS = 30, 0.8, 6  # on a mesh


def two_and_one(outline: Outline) -> Question:
    """Three fingers on an outline under a load of 1 N, two of which hold it best; the third is far from both.

    Args:
        outline: the object.
    """
    load = Wrench([0.0, -1.0])
    for places, friction in _TRIED:
        contacts = [outline.contact_at(s, friction=friction) for s in outline.sample(places).tolist()]
        pair = _best_pair(contacts, load)
        if pair is not None:
            break
    held = [contacts[i] for i in pair or (0, len(contacts) // 2)]
    grasp = Grasp([*held, _far(contacts, held)])
    return question_of(grasp, load, leaves=grasp.names[2])


def three_and_one(mesh: Mesh) -> Question:
    """Four fingers on a mesh under a load of 1 N, three of which hold it well; the fourth is far from them.

    Args:
        mesh: the object.
    """
    contacts, load = list(mesh.contacts(_PLACES, friction=_FRICTION)), Wrench([0.0, 0.0, -1.0])
    pairs = sorted(combinations(range(len(contacts)), 2), key=lambda p: -_facing(*(contacts[i] for i in p)))
    best: tuple[float, list[Contact]] = (0.0, [])
    for i, j in pairs[:_PAIRS]:
        for k in set(range(len(contacts))) - {i, j}:
            chosen = [contacts[i], contacts[j], contacts[k]]
            with suppress(RegraspError):
                margin = choose_state(Grasp(chosen), load, "force", max_force=_PUSH).margins.least_force
                best = max(best, (margin, chosen), key=lambda b: b[0])
    held = best[1] or contacts[:3]
    grasp = Grasp([*held, _far(contacts, held)])
    return question_of(grasp, load, leaves=grasp.names[3])


def _facing(a: Contact, b: Contact) -> float:
    """How well two normals point at each other: the lesser cosine to the line between, less its distance."""
    line = b.position - a.position
    u = line / max(float(np.linalg.norm(line)), 1e-300)
    off = float(np.linalg.norm(a.position - (a.position @ u) * u))  # of the line from the centre of mass
    return min(float(a.normal @ u), float(-b.normal @ u)) - off / max(float(np.linalg.norm(line)), 1e-300)


def _far(contacts: list[Contact], held: list[Contact]) -> Contact:
    """The contact farthest from the nearest of others."""

    def distance(c: Contact) -> float:
        return min(float(np.linalg.norm(c.position - h.position)) for h in held)

    return max((c for c in contacts if c not in held), key=distance)


def _best_pair(contacts: list[Contact], load: Wrench) -> tuple[int, int] | None:
    """The two contacts that hold a load with the widest force margin, so that both push."""
    best: tuple[float, tuple[int, int] | None] = (0.0, None)
    for pair in combinations(range(len(contacts)), 2):
        locus = EquilibriumLocus(Grasp(contacts[i] for i in pair), load)
        if not locus.is_empty:
            with suppress(Infeasible):  # but for a reserve
                margin = float(locus.best("force", max_force=_PUSH).margins.force.min())
                best = max(best, (margin, pair), key=lambda b: b[0])
    return best[1]


def question_of(grasp: Grasp, load: Wrench, **asked: Any) -> Question:
    """The question about a grasp; ``InvalidInput`` where the explorer has no place for it.

    Args:
        grasp: the contacts.
        load: object frame [N, N m].
        asked: other fields of ``Question``.
    """
    if len(grasp) > MOST_FINGERS or len(grasp) < 2:
        raise InvalidInput(f"the explorer takes 2 to {MOST_FINGERS} contacts, got {len(grasp)}")
    refuse_limits(grasp, "the explorer")
    contacts = [
        {
            "name": str(c.name)[:LONGEST_NAME],
            "position": c.position.tolist(),
            "normal": c.normal.tolist(),
            "friction": c.friction,
        }
        | {key: getattr(c, key) for key in ("max_force", "torsion") if getattr(c, key) is not None}
        for c in grasp
    ]
    return Question.of({"contacts": contacts, "load": load.vector.tolist()} | asked)


def drawn(shape: Outline | Mesh | None) -> dict[str, Any]:
    """A shape as a page draws it: rings of points, or corners and triangles, relative to the centre of mass.

    Args:
        shape: contacts stay on it.
    """
    if isinstance(shape, Outline):
        flat = 2e-4 * float(np.ptp(shape.polygon(), axis=0).max())
        rings: list[Array] = [shape.polygon(flat), *shape.hole_polygons(flat)]
        return {"rings": [ring.tolist() for ring in rings]}
    if isinstance(shape, Mesh):
        vertices, faces = _coarse(*shape.surface())
        return {"solid": {"vertices": np.round(vertices, 9).tolist(), "faces": faces.tolist()}}
    return {}


_MOST_FACES, _GRID = 8_000, 40


def _coarse(vertices: Array, faces: Any) -> tuple[Array, Any]:
    """A picture of a mesh of few enough triangles: corners in one cell of a grid become their mean."""
    if len(faces) <= _MOST_FACES:
        return vertices, faces
    low, wide = vertices.min(axis=0), float(np.ptp(vertices, axis=0).max())
    cells = np.floor((vertices - low) * (_GRID / wide)).astype(int)
    _, cell = np.unique(cells, axis=0, return_inverse=True)
    cell = cell.reshape(-1)
    means = np.stack([np.bincount(cell, x) / np.bincount(cell) for x in vertices.T], axis=1)
    moved = cell[faces]
    kept = (moved[:, 0] != moved[:, 1]) & (moved[:, 1] != moved[:, 2]) & (moved[:, 2] != moved[:, 0])
    return means, np.unique(moved[kept], axis=0)

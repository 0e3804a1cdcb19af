"""Planar membership in rational arithmetic against an independent one, and the forces that it finds."""

import numpy as np
import pytest

import regrasp as rg
from boundary import boundary
from exact_judge import is_held, state_faults
from regrasp.mechanics.exact.membership import vertex_forces
from strategies import lattice_pair

pytestmark = pytest.mark.oracle


def check(grasp: rg.Grasp, load: rg.Wrench) -> bool:
    forces = vertex_forces(grasp, load, grasp.frictions)
    truly = is_held(grasp.positions, grasp.normals, grasp.frictions, load.vector)
    huge = forces is not None and np.abs(forces).max() > 1e8 * np.abs(load.vector).max()
    assert (forces is not None) == truly or huge  # which the judge does not call held
    if forces is not None:
        assert np.count_nonzero(forces.any(axis=1)) <= 3
        wider = grasp.frictions * (1 + 1e-12) + 1e-12
        none = np.full(len(grasp), np.inf)
        assert state_faults(grasp.positions, grasp.normals, wider, none, load.vector, forces) == []
    return truly


def test_small_whole_numbers() -> None:
    rng = np.random.default_rng(1)
    held = 0
    for _ in range(300):
        pair, more = lattice_pair(rng), lattice_pair(rng)
        third = rg.Contact(more.r1, more.n1, more.mu1)
        if more.r1 in (pair.r1, pair.r2):
            continue
        held += check(pair.grasp.with_contact(third), pair.load)
    assert held > 50


@pytest.mark.parametrize("kind", ["sliding", "tipping", "both", "box tips"])
def test_beside_the_edge(kind: str) -> None:
    rng = np.random.default_rng(2)
    for _ in range(15):
        at = boundary(rng, 2, kind)
        grasp = rg.Grasp(
            rg.Contact(r, n, float(m)) for r, n, m in zip(at.positions, at.normals, at.frictions, strict=True)
        )
        for beyond in (1e-3, -1e-3, 1e-9, -1e-9):
            held = check(grasp, rg.Wrench.from_vector(at.load(beyond)))
            # Where a contact stands still beside one that slides, rounding of both may hold by huge forces.
            assert held == (beyond < 0) or kind == "both"


def test_no_load_is_held_by_nothing() -> None:
    grasp = rg.Grasp([rg.Contact([0, 0], [0, 1], 0.5)])
    forces = vertex_forces(grasp, rg.Wrench([0, 0]), [0.5])
    assert forces is not None
    assert not forces.any()
    assert vertex_forces(grasp, rg.Wrench([0, -1]), [0.5]) == pytest.approx(np.array([[0, 1]]))
    assert vertex_forces(grasp, rg.Wrench([0, 1]), [0.5]) is None
    assert vertex_forces(grasp, rg.Wrench([0, -1], 1e-300), [0.5]) is None

"""Groups of faces: the most work of their corners, of which few are looked at; proofs about many faces."""

from dataclasses import replace
from types import FunctionType
from typing import Any

import numpy as np
import pytest

import regrasp as rg
from regrasp.closed_form.compiled.patches import patch_support
from regrasp.mesh.clear import clear_faces
from regrasp.planning.placement.space.patches import patches_of
from solids import pebble

pytestmark = pytest.mark.oracle


def plain(module: Any) -> dict[str, Any]:
    """Its functions as they were written, not compiled."""
    names: dict[str, Any] = dict(vars(module))
    for name, function in vars(module).items():
        if hasattr(function, "py_func"):
            names[name] = FunctionType(function.py_func.__code__, names, name)
    return names


@pytest.mark.parametrize("size", [0, 1])
def test_the_most_work_of_a_group_is_that_of_all_its_corners(size: int) -> None:
    corners, normals = clear_faces(pebble(12), 0.0)
    patches, functions = patches_of(corners, normals), plain(patch_support)
    surface, rng, few = (
        (patches.rows, patches.spans, patches.tree, patches.balls),
        np.random.default_rng(4),
        0,
    )
    force, best, stack, above = np.zeros(3), np.zeros(3), np.zeros(256, int), np.zeros(256)
    for number in range(40):
        patch = int(rng.integers(12)) if number else 0
        twist = rng.normal(size=6) * np.repeat([1, [0, 3, 300][number % 3]], 3)
        looked = np.zeros(1, int)
        most, at = functions["largest"](surface, patch, twist, 0.4, size, best, stack, above, looked)
        first, count = patches.spans[patch]
        rows = range(first, first + count)
        every = [functions["sigma"](patches.rows[r], twist, 0.4, size, force) for r in rows]
        assert most == pytest.approx(max(every), rel=1e-12)
        assert most == 0 or every[at - first] == pytest.approx(most, rel=1e-12)
        velocity = twist[:3] + np.cross(twist[3:], patches.rows[at, :3])
        assert velocity @ best == pytest.approx(most, abs=1e-12)
        few += int(looked[0] < count / 3)
    assert few > 15


def test_proofs_about_many_faces() -> None:
    loads = rg.LoadSet.hull([rg.Wrench([0, 0, -2]), rg.Wrench([0.5, 0, -1.5])])
    found = rg.choose_grasp(pebble(20), 3, loads, friction=0.5, objective="peak", tolerance=0.05)
    assert found.gap <= 0.05
    verdict = rg.verify(found)
    assert verdict.ok, verdict
    assert verdict.bound == found.bound
    proof = found.certificate
    one = int(np.flatnonzero((proof.children[:, 1] == 0) & (proof.number >= 0))[0])
    twists = proof.twists.copy()
    twists[one] *= -1
    assert not rg.verify(replace(proof, twists=twists)).ok

"""Proofs on meshes by twists of all loads together: checked by a cone program, and seen where touched."""

import json
from dataclasses import replace
from functools import cache
from typing import Any

import cvxpy as cp
import numpy as np
import pytest

import regrasp as rg
from regrasp.mesh import parts
from regrasp.verification.placed.meshes import together

pytestmark = pytest.mark.oracle

LOADS = rg.LoadSet.hull(
    [rg.Wrench([x, y, -1.8]) for x, y in ((0.5, 0), (-0.5, 0), (0, 0.5), (0, -0.5))]
    + [rg.Wrench([0, 0, -1.8], [0.005, 0, 0])]
)


@cache
def chosen() -> rg.ChosenGrasp:
    asked = {"friction": 0.6, "objective": "peak_normal", "tolerance": 0.1, "from_corners": 0.0}
    return rg.choose_grasp(parts.bracket(), 3, LOADS, **asked, most_boxes=4000)


def at_corners(proof: Any, box: int) -> float:
    """The least largest normal force for all loads, each finger at corners of its patch in shares."""
    most, rules, patches = cp.Variable(), [], []
    for first, count in proof.spans[proof.boxes[box]]:
        points = proof.corners[first : first + count].reshape(-1, 3)
        patches.append((points, np.repeat(proof.normals[first : first + count], 3, axis=0)))
    shares = [cp.Variable(len(points), nonneg=True) for points, _ in patches]
    rules += [cp.sum(share) == most for share in shares]
    for load in proof.loads:
        force, torque = load[:3], load[3:] / 0.04
        for (points, normals), share in zip(patches, shares, strict=True):
            f = cp.Variable((len(points), 3))
            along = cp.sum(cp.multiply(f, normals), axis=1)
            across = f - cp.multiply(cp.reshape(along, (len(points), 1), order="C"), normals)
            rules += [cp.norm(across, axis=1) <= 0.6 * along, along <= share]
            force = force + cp.sum(f, axis=0)
            torque = torque + sum(np.cross(p, np.eye(3)).T / 0.04 @ f[c] for c, p in enumerate(points))
        rules += [force == 0, torque == 0]
    return float(cp.Problem(cp.Minimize(most), rules).solve(solver=cp.CLARABEL))


def test_a_box_that_all_loads_exclude_is_excluded_by_a_cone_program() -> None:
    proof = chosen().certificate
    boxes = np.flatnonzero((proof.number < -1) & (proof.boxes < len(proof.spans)).all(axis=1))
    few = boxes[np.argsort(proof.spans[:, 1][proof.boxes[boxes]].sum(axis=1))[:4]]
    assert len(few) == 4
    least = [at_corners(proof, box) for box in few]
    assert min(least) >= proof.bound * (1 - 1e-6)


def test_what_is_touched_of_such_twists_is_seen() -> None:
    found = chosen()
    proof = found.certificate
    assert rg.verify(found).ok
    twists = np.array(proof.together)
    for row in 0, len(twists) - 1:
        for load in range(len(proof.loads)):
            touched = twists.copy()
            touched[row, load] += 0.5 * np.abs(touched[row]).max()
            assert not rg.verify(replace(proof, together=touched)).ok
    assert "has no load" in str(rg.verify(replace(proof, together=twists[:-1])))
    assert "has no load" in str(rg.verify(replace(proof, together=None)))
    assert "shapes" in str(rg.verify(replace(proof, together=twists[:, 1:])))
    assert "finite" in str(rg.verify(replace(proof, together=np.nan * twists)))
    assert "largest force alone" in str(rg.verify(replace(proof, norm="sum")))
    assert not rg.verify(replace(proof, bound=1.2 * proof.bound)).ok


def test_such_proofs_are_kept_in_files() -> None:
    found = chosen()
    plain = json.loads(json.dumps(found.to_dict()))
    assert rg.ChosenGrasp.from_dict(plain) == found
    assert rg.verify(rg.ChosenGrasp.from_dict(plain)).ok
    plain["certificate"]["together"][0][0][0] *= 2
    with pytest.raises(rg.InvalidInput, match="digest"):
        rg.ChosenGrasp.from_dict(plain)


def test_rationals_decide_where_doubles_do_not(monkeypatch: pytest.MonkeyPatch) -> None:
    proof, asked = chosen().certificate, []
    monkeypatch.setattr(together, "_is_clear", lambda *a: (asked.append(a), len(asked) > 4)[1])
    assert rg.verify(proof).ok
    assert len(asked) > 4
    touched = np.array(proof.together)
    touched[0] *= -1
    asked.clear()
    assert not rg.verify(replace(proof, together=touched)).ok

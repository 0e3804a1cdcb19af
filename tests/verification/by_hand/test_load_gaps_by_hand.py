"""Loads that differ from a plan's between instants: by as much as the margins take, and by a little more."""

from dataclasses import replace
from math import sqrt

import numpy as np
import pytest

import regrasp as rg
from foreign import Plan, Record, Scaling, course, cross, solid_cross

pytestmark = pytest.mark.contract

MAKES = {"plane": cross, "space": solid_cross}


def room(grasp, forces, least) -> float:
    """The least change that takes a force out of its cone, over its limits or below its least normal."""
    found = []
    for k, (c, f) in enumerate(zip(grasp, forces, strict=True)):
        push = float(f @ c.normal)
        across = float(np.linalg.norm(f - push * c.normal))
        found.append((c.friction * push - across) / sqrt(1 + c.friction**2))
        if c.max_force is not None:
            found.append(c.max_force - float(np.linalg.norm(f)))
        if c.limits is not None:
            for row, bound in zip(c.limit_rows, c.limits.bounds, strict=True):
                found.append((bound - float(row @ f)) / float(np.linalg.norm(row)))
        if least:
            found.append(push - least[k])
    return min(found)


def least_singular(grasp, stays=slice(None)) -> float:
    d, n = grasp.dimension, len(grasp)
    matrix = np.array(grasp.matrix).reshape(-1, n, d)[:, stays].reshape(len(grasp.matrix), -1)
    matrix[d:] /= grasp.size
    return float(np.linalg.svd(matrix, compute_uv=False)[-1])


def changed_by(grasp, k, **changes):
    return rg.Grasp(c.changed(**changes) if i == k else c for i, c in enumerate(grasp))


def cases(make):
    for length in (2.0**-10, 2.0**10):
        grasp, forces = make((0.9, 1.0, 1.1, 1.2), length=length)
        yield "cone of the first", grasp, forces, ()
    grasp, forces = make((1.1, 1.2, 1.0, 0.9))
    yield "cone of the last", grasp, forces, ()
    grasp, forces = make((3.0,) * 4)
    size = float(np.linalg.norm(forces[0]))
    yield "limit", changed_by(grasp, 2, max_force=size + 0.1), forces, ()
    d = grasp.dimension
    row = [1.0, 0.5, 0.25][:d]
    used = float((rg.ForceLimits([row], [1.0]).rows @ _in_frame(grasp[1], forces[1]))[0])
    limits = rg.ForceLimits([[-v for v in row], row], [9.0, used + 0.125])
    yield "linear limit", changed_by(grasp, 1, limits=limits), forces, ()
    push = float(forces[0] @ grasp[0].normal)
    yield "least normal", grasp, forces, (0.0, 0.0, push - 0.2, 0.0)


def _in_frame(contact, force):
    rows = rg.ForceLimits(np.eye(contact.dimension), np.ones(contact.dimension))
    return contact.changed(limits=rows).limit_rows @ force


@pytest.mark.parametrize("make", MAKES.values(), ids=MAKES)
@pytest.mark.parametrize("axis", range(0, 6, 2))
def test_as_much_as_the_margins_take(make, axis) -> None:
    for what, grasp, forces, least in cases(make):
        d = grasp.dimension
        if axis >= 3 * (d - 1):
            return
        zero = rg.Wrench([0.0] * d)
        state = rg.GraspState(grasp, zero, forces)
        plan = Plan("rotation", None, state, state, Scaling(2.0), Record(least_normals=least))
        most = room(grasp, forces, least) * least_singular(grasp) / sqrt(2)
        unit = np.zeros(3 * (d - 1))
        unit[axis] = 1.0 if axis < d else grasp.size
        for factor, good in (0.999, True), (1.001, False):

            def load(t, by=factor * most * unit):
                return rg.Wrench.from_vector(by if 0 < t < 2 else 0 * by)

            verdict = rg.verify(plan, load)
            assert verdict.ok == good, (what, factor, verdict)
            assert verdict.load_gap == pytest.approx(factor * most, rel=1e-9)
            assert not verdict.load_gap_is_proven
            curved = rg.verify(plan, load, curvature=2 * factor * most * (1 + 1e-9))  # c h^2 / 8, h = 2
            assert curved.ok == good, what
            assert curved.load_gap_is_proven
            assert curved.load_gap == pytest.approx(factor * most, rel=1e-8)
            bends = rg.verify(plan, load, curvature=2 * factor * most * (1 - 1e-5))
            assert "bends more than the curvature" in "; ".join(bends.violations)


@pytest.mark.parametrize("make", MAKES.values(), ids=MAKES)
def test_the_load_at_the_instants_is_the_plans(make) -> None:
    grasp, forces = make((2.0,) * 4)
    d = grasp.dimension
    state = rg.GraspState(grasp, rg.Wrench([0.0] * d), forces)
    path = course([0, 1, 2], [forces] * 3, [[0.0] * (3 * d - 3)] * 3)
    for plan in (
        Plan("rotation", None, state, state, Scaling(2.0)),
        Plan("rotation", None, state, state, Scaling(2.0), course=path),
    ):
        times = [0.0, 2.0] if plan.course is None else [0.0, 1.0, 2.0]
        for at in times:
            for axis in range(3 * d - 3):
                vector = np.zeros(3 * d - 3)
                vector[axis] = 0.1 * (1.0 if axis < d else grasp.size)
                for small in (1.0, 1e-11):
                    off = small * vector
                    found = rg.verify(
                        plan, lambda t, a=at, v=off: rg.Wrench.from_vector(v if t == a else 0 * v)
                    )
                    assert f"at t = {at:g} s the load given differs" in str(found)
                    assert found.load_gap == pytest.approx(0.1 * small)


def test_fingers_that_leave_hold_nothing_between() -> None:
    """Four fingers of which two leave: the two that stay answer, with the singular values of two."""
    grasp, forces = cross((2.0,) * 4)
    forces[:, 1:] = 0
    upper = forces.copy()
    upper[[1, 3]] = 0
    start, end = (rg.GraspState(grasp, rg.Wrench([0.0, 0.0]), f) for f in (forces, upper))
    path = course([0, 2], [forces, upper], [[0.0] * 3] * 2)
    plan = Plan("removal", None, start, end, Scaling(2.0), course=path)
    plan = replace(plan, contact="B")
    stays = [0, 2, 3]
    kept = room(grasp.subset([0]), forces[[0]], ())
    for factor in (0.5, 1.0):
        by = np.array([factor * kept * least_singular(grasp, stays), 0, 0])
        found = rg.verify(plan, lambda t, v=by: rg.Wrench.from_vector(v if 0 < t < 2 else 0 * v))
        assert not found.ok  # D carries nothing at the end, and so can give nothing
        assert "more than the margins take (0)" in str(found)


def test_what_no_load_function_returns() -> None:
    grasp, forces = cross()
    state = rg.GraspState(grasp, rg.Wrench([0.0, 0.0]), forces)
    plan = Plan("rotation", None, state, state)
    for wrong in (None, rg.Wrench([0.0, 0.0, 0.0]), [0.0, 0.0]):
        with pytest.raises(rg.InvalidInput, match="load must return a Wrench of the plan's dimension"):
            rg.verify(plan, lambda t, w=wrong: w)

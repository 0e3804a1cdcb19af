"""What floating point settles of plans that withstand a set: never what rational arithmetic refuses."""

from fractions import Fraction

import numpy as np
import pytest

import regrasp as rg
from paper import GRASP, LOAD
from regrasp.verification.withstood import judge
from regrasp.verification.withstood.contacts import Body, Touch
from regrasp.verification.withstood.float_filter import Sized, doubt, surely_withstood
from regrasp.verification.withstood.matrices import in_doubles, rational
from values import WEIGHT, shaken, space_grasp

pytestmark = pytest.mark.oracle

BALL = rg.LoadSet.ball(rg.Wrench([0, 0]), force=0.1, torque=0.4)
IN_SPACE = rg.LoadSet.ball(rg.Wrench([0, 0, 0]), force=0.05, torque=0.01)


def random_set(rng: np.random.Generator, d: int, size: float) -> rg.LoadSet:
    q = 3 * (d - 1)
    center = rg.Wrench.from_vector(0.1 * size * rng.normal(size=q))
    if rng.random() < 0.4:
        spread = size * rng.normal(size=(5, q))
        return rg.LoadSet.hull([rg.Wrench.from_vector(w) for w in spread], center=center)
    return rg.LoadSet.ellipsoid(center, size * rng.normal(size=(q, int(rng.integers(1, q + 1)))))


def random_touch(rng: np.random.Generator, d: int, size: float) -> tuple[Touch, np.ndarray]:
    """A contact, soft at times, and a force inside its cone."""
    normal = rng.normal(size=d)
    mu, soft = 10 ** rng.uniform(-2, 0.5), d == 3 and rng.random() < 0.4
    limits = rng.random() < 0.6
    contact = rg.Contact(
        rng.normal(size=d), normal, mu, torsion=0.1 if soft else None, max_force=3 * size if limits else None
    )
    across = rng.normal(size=d)
    across -= (across @ contact.normal) * contact.normal
    across *= rng.uniform(0, 0.8) * mu / np.linalg.norm(across)
    force = size * (contact.normal + (0.5 if soft else 1.0) * across)
    width = 4 if soft else d
    return Touch(contact, Fraction(1), width), np.append(force, [0.02 * size * rng.normal()] * (width - d))


@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("size", [1e-12, 1e12])
def test_nothing_is_settled_that_is_broken_up_to_the_limit(d: int, size: float) -> None:
    rng, near, tried = np.random.default_rng(d), 0, 0
    for _ in range(9):
        touch, force = random_touch(rng, d, size)
        answer = rng.normal(size=(len(force), 3 * (d - 1)))
        loads, exact = random_set(rng, d, size), rational(answer.tolist())

        def holds(factor: float, touch=touch, force=force, exact=exact, loads=loads) -> bool:
            stacked = [Fraction(x) for x in force.tolist()]
            return touch.broken(stacked, exact, Body(loads.scaled(factor))) is None

        def settled(factor: float, touch=touch, force=force, answer=answer, loads=loads) -> bool:
            forces = Sized(force[None], abs(force)[None])
            return bool(
                surely_withstood(touch, forces, answer, Body(loads.scaled(factor)), 1.0, doubt(12))[0]
            )

        low, high = 1e-3, 1e3  # of what is withstood and what is not
        if not holds(low) or holds(high):
            continue
        for _ in range(44):
            middle = (low * high) ** 0.5
            low, high = (middle, high) if holds(middle) else (low, middle)
        tried += 1
        near += settled(low * (1 - 1e-7))
        for part in 10.0 ** -np.arange(1, 17):
            assert not settled(high * (1 + part)), (d, size, part)
            assert holds(low * (1 - part)) or not settled(low * (1 - part))
    assert tried >= 3
    assert near == tried


def cases():
    """Plans, what they withstand and the stiffness of their fingers."""
    kept = {"disturbance": BALL, "max_force": 20.0}
    yield rg.plan_removal(GRASP, "P3", load=LOAD, early_loss=True, **kept), BALL, None
    yield rg.plan_removal(GRASP, "P3", load=shaken, instants=4, **kept), BALL, None
    yield rg.plan_rotation(GRASP, 0.6, load=LOAD, **kept), BALL, None
    soft = rg.Grasp(c.changed(torsion=0.05) for c in space_grasp())
    for grasp, springs in (space_grasp(), None), (soft, [[1000.0, 500.0, 1.0]] * len(soft)):
        plan = rg.plan_removal(grasp, 3, load=WEIGHT, disturbance=IN_SPACE, stiffness=springs, max_force=20.0)
        yield plan, IN_SPACE, springs


def test_verdicts_are_those_without_the_filter(monkeypatch: pytest.MonkeyPatch) -> None:
    rng, asked, refused = np.random.default_rng(3), [], 0
    for plan, loads, springs in cases():
        grasp, found = plan.grasp, []
        shape = (2, len(grasp), *([2] if grasp.dimension == 3 else []))
        off = {"position": 0.02 * rng.normal(size=shape), "surface": 0.1}
        for factor in 0.5, 1 - 1e-9, 1.0, 1.001:
            found.append({"disturbance": loads.scaled(factor)})
        found.append({"disturbance": loads.scaled(0.5), "early_loss": True})
        found.append({"disturbance": loads.scaled(0.3), "friction": 0.97})
        found.append(off)
        spread = [rg.Wrench.from_vector(0.7 * v) for v in np.vstack([loads.half_axes.T, -loads.half_axes.T])]
        found.append({"disturbance": rg.LoadSet.hull(spread)})
        asked += [(plan, {"stiffness": springs, **more}) for more in found]
    verdicts = [rg.verify(plan, **more) for plan, more in asked]
    monkeypatch.setattr(
        judge, "surely_withstood", lambda touch, forces, *_: np.zeros(len(forces.values), bool)
    )
    for (plan, more), found in zip(asked, verdicts, strict=True):
        assert rg.verify(plan, **more) == found
        refused += not found.ok
    assert 5 < refused < len(asked) - 5


def test_numbers_beyond_doubles_are_left_to_rational_arithmetic() -> None:
    grown = in_doubles([[Fraction(10) ** 400, Fraction(1, 3)]])
    assert grown.tolist() == [[np.inf, 1 / 3]]
    touch = Touch(rg.Contact([0, 0], [0, 1], 0.5), Fraction(1), 2)
    for size in 0.0, 1e-300, 1e300, np.inf, np.nan:
        forces = Sized(np.array([[0.0, size]]), np.array([[0.0, size]]))
        assert not surely_withstood(touch, forces, np.zeros((2, 3)), Body(BALL), 1.0, doubt(9))[0]

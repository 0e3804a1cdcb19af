"""What doubles settle of sets, against rationals: at the limit of their doubt, which can be read off."""

from fractions import Fraction
from itertools import product

import numpy as np
import pytest

import regrasp as rg
from foreign import Plan, cross, solid_cross
from regrasp.verification.withstood.contacts import Body, Touch
from regrasp.verification.withstood.float_filter import (
    Sized,
    _columns,
    _is_definite,
    _keeps,
    _surely_positive,
    doubt,
    surely_withstood,
)
from regrasp.verification.withstood.matrices import doubles, in_doubles
from regrasp.verification.withstood.multipliers import multipliers

pytestmark = pytest.mark.oracle

NEAR = 1e-9


def ints(rng: np.random.Generator, *shape: int) -> np.ndarray:
    """Numbers of both signs, whose sums and products are exact."""
    return rng.integers(-4, 5, shape).astype(float)


def sets(rng: np.random.Generator, q: int):
    """A hull, and an ellipsoid whose only half axis has a length along any twist that is exact."""
    yield rg.LoadSet.hull([rg.Wrench.from_vector(v) for v in ints(rng, 4, q)])
    yield rg.LoadSet.ellipsoid(rg.Wrench.from_vector(ints(rng, q)), ints(rng, q, 1))


def test_sizes_are_those_of_all_terms() -> None:
    rng = np.random.default_rng(0)
    for _ in range(5):
        f, size, r, e = ints(rng, 3, 4), abs(ints(rng, 3, 4)), ints(rng, 4, 3), ints(rng, 3, 4)
        made = Sized(f, size).changed(r, e)
        for k in range(3):
            wrench = [sum(e[a, j] * f[k, j] for j in range(4)) for a in range(3)]
            most = [sum(abs(e[a, j]) * size[k, j] for j in range(4)) for a in range(3)]
            for i in range(4):
                assert made.values[k, i] == f[k, i] + sum(r[i, a] * wrench[a] for a in range(3))
                assert made.sizes[k, i] == size[k, i] + sum(abs(r[i, a]) * most[a] for a in range(3))
        part = made.part(slice(1, 3))
        assert (part.values == made.values[:, 1:3]).all()
        assert (part.sizes == made.sizes[:, 1:3]).all()


def test_changes_keep_their_digits_at_every_scale() -> None:
    """Levers of 2^-680 m turn forces of 2^-396 N; what is lost below the least double has a size."""
    f, e, r = np.array([[2.0**-396, 0.0]]), np.array([[2.0**-680 / 3, 1.0]]), np.array([[2.0**680], [0.0]])
    made = Sized(f, f).changed(r, e)
    assert made.values[0, 0] == pytest.approx(2.0**-396 * 4 / 3, rel=1e-15)
    least, large = np.full((1, 1), 2.0**-600), np.full((1, 1), 2.0**300)
    lost = Sized(large, large).changed(least, least).sizes - large
    assert lost.tolist() == [[0]]
    apart = np.array([[0.0, 2.0**300]])
    lost = Sized(apart, apart).changed(np.array([[2.0**-600], [0]]), np.array([[0, 2.0**-600]])).sizes[0, 0]
    assert 2.0**-1075 * 2.0**300 < 2.0**-45 * lost < 2.0**-700


def test_a_row_is_kept_where_it_is_by_more_than_its_doubt() -> None:
    """g . f + room less the most work, against ``off`` times the sizes of all terms."""
    rng, tried = np.random.default_rng(1), 0
    while tried < 40:
        w, q = 2 + tried % 3, 3
        g, f, size, r = ints(rng, w), ints(rng, 1, w), abs(ints(rng, 1, w)) + 4, ints(rng, w, q)
        room = float(rng.integers(-9, 60))
        for loads in sets(rng, q):
            twist, sizes = g @ r, abs(g) @ abs(r)
            if loads.vertices is not None:
                least = min(twist @ v for v in loads.vertices)
                most = max(sizes @ abs(v) for v in loads.vertices)
            else:
                axis, middle = loads.half_axes[:, 0], loads.center.vector
                least, most = twist @ middle - abs(twist @ axis), sizes @ abs(middle) + sizes @ abs(axis)
            slack, whole = float(f[0] @ g) + room + least, float(size[0] @ abs(g)) + abs(room) + most
            if slack <= 0:
                assert not _keeps(g, room, Sized(f, size), r, Body(loads), 0.0)[0]
                continue
            tried += 1
            for factor, good in (1 - NEAR, True), (1 + NEAR, False):
                off = slack / whole * factor
                assert _keeps(g, room, Sized(f, size), r, Body(loads), off).tolist() == [good]
    round_one = Body(rg.LoadSet.tilted(rg.Wrench([1, 0]), 0.1))
    assert not _keeps(
        np.ones(2), 99.0, Sized(np.ones((1, 2)), np.ones((1, 2))), np.ones((2, 3)), round_one, 0
    )


def test_rows_of_sizes_beyond_squares_are_left_to_rationals() -> None:
    point = Body(rg.LoadSet.hull([rg.Wrench([0, 0])]))
    for exponent, good in (-402, False), (-398, True), (0, True), (398, True), (402, False):
        one = np.array([[2.0**exponent, 0.0]])
        kept = _keeps(np.array([1.0, 0]), 0.0, Sized(one, one), np.zeros((2, 3)), point, 2.0**-20)
        assert kept.tolist() == [good]
        for contact, limit in (SPACE, None), (PLANE, 1.5):
            d = contact.dimension
            touch = Touch(contact.changed(max_force=None), Fraction(1), d)
            touch.limit = None if limit is None else Fraction(limit) * Fraction(2) ** exponent
            force = np.eye(d)[:1] * 2.0**exponent
            still, none = Body(rg.LoadSet.hull([rg.Wrench([0] * d)])), np.zeros((d, 3 * d - 3))
            settled = surely_withstood(touch, Sized(force, force), none, still, 1.0, doubt(9))
            assert settled.tolist() == [good], (exponent, d)


PLANE, SPACE = rg.Contact([0, 0], [1, 0], 0.5), rg.Contact([0, 0, 0], [1, 0, 0], 0.5)


def test_columns_and_their_sizes() -> None:
    rng = np.random.default_rng(2)
    for _ in range(4):
        f, size, r, lift = ints(rng, 2, 4), abs(ints(rng, 2, 4)), ints(rng, 4, 3), np.array([1.0, 1, 1, 2])
        hull, ball = (Body(x) for x in sets(rng, 3))
        r2, f2 = r * lift[:, None], f * lift
        values, sizes = _columns(Sized(f, size), r, hull, lift)
        for k, (v, vertex) in product(range(2), enumerate(hull.loads.vertices)):
            assert (values[k, v, :, 0] == f2[k] + r2 @ vertex).all()
            assert (sizes[k, v, :, 0] == size[k] * lift + abs(r2) @ abs(vertex)).all()
        values, sizes = _columns(Sized(f, size), r, ball, lift)
        middle, axis = ball.loads.center.vector, ball.loads.half_axes[:, 0]
        for k in range(2):
            assert np.array_equal(values[k, 0].T, [r2 @ axis, f2[k] + r2 @ middle])
            assert np.array_equal(
                sizes[k, 0].T, [abs(r2) @ abs(axis), size[k] * lift + abs(r2) @ abs(middle)]
            )


@np.errstate(all="ignore")
def test_factorisations_complete_where_all_minors_are_positive() -> None:
    rng, seen = np.random.default_rng(3), set()
    for k in (1, 2, 3, 4):
        root = rng.integers(-2, 3, (60, k, k))
        stacked = np.swapaxes(root, 1, 2) @ root + rng.integers(-2, 1, (60, 1, 1)) * np.eye(k)
        good = [all(np.linalg.det(a[:j, :j]) > 0.5 for j in range(1, k + 1)) for a in stacked]
        found = _is_definite(stacked.copy())
        clear = [abs(np.linalg.det(a)) > 0.5 for a in stacked]  # of others the last pivot is rounding
        assert (found == good)[clear].all()
        seen |= {(k, g) for g in good}
    assert len(seen) == 8
    assert not _is_definite(np.zeros((1, 1)))
    assert not _is_definite(np.ones((2, 2)))
    assert not _is_definite(np.array([[1.0, 0, 0], [0, -1, 0], [0, 0, 1]]))


def least(s: np.ndarray) -> float:
    """The least of a quadratic of one or two unknowns over the ball, sampled."""
    angle, r = np.meshgrid(np.linspace(0, 2 * np.pi, 241), np.linspace(0, 1, 41))
    z = np.stack([r * np.cos(angle), r * np.sin(angle)])[: len(s) - 1]
    full = np.concatenate([z, np.ones((1, *angle.shape))])
    return float(np.einsum("i...,ij,j...->...", full, s, full).min())


@np.errstate(all="ignore")
def test_quadratics_are_positive_where_they_are_by_more_than_their_doubt() -> None:
    rng, delta = np.random.default_rng(4), 2.0**-10
    for k in [1, 2] * 12:
        s = rng.normal(size=(k + 1, k + 1))
        s = s + s.T
        s[-1, -1] -= least(s)
        for above, good in (-0.1, False), (0.5 * delta, False), (20 * delta, True), (9.0, True):
            given = s.copy()
            given[-1, -1] += above
            assert bool(_surely_positive(given[None], np.array([delta]), 1e-13)[0]) == good, (k, above)
    point = np.array([[[2 * delta]], [[0.5 * delta]], [[np.nan]], [[np.inf]]])
    assert _surely_positive(point, np.full(4, delta), 1e-13).tolist() == [True, False, False, False]
    assert not _surely_positive(np.ones((1, 1, 1)), np.array([np.inf]), 1e-13)[0]
    assert not _surely_positive(np.array([[[np.nan, 0], [0, 1]]]), np.array([0.0]), 1e-13)[0]


@np.errstate(all="ignore")
def test_a_doubt_grows_with_the_multiplier() -> None:
    """c - 9 z^2: the multiplier is 9 + 3 delta, and delta + 9 off are in doubt beside the 3 of it."""
    off = 2.0**-20
    delta = 5 * off
    for c, good in (9 + 4 * delta + 8.9 * off, False), (9 + 4 * delta + 9.1 * off, True):
        s = np.array([[[-9.0, 0], [0, c]]])
        assert _surely_positive(s, np.array([delta]), off).tolist() == [good]


def test_multipliers_are_where_the_slope_is_zero() -> None:
    for b, values, low, wanted in (
        ([3], [1], 0, 2.0), ([3], [-1], 1, 4.0), ([0.5], [1], 0, 0.0), ([0], [-2], 2, 2.0),
        ([3, 0], [0, -2], 2, 3.0), ([0, 3], [0, -2], 2, 5.0), ([1, 0], [3, -2], 2, 2.0),
        ([2.4, 1.6], [1, 0], 0, None), ([0, 0], [0, 0], 0, 0.0),
    ):  # fmt: skip
        found = float(multipliers(np.array(values), np.array(b), np.float64(low)))
        if wanted is None:
            assert (np.array(b) ** 2 / (np.array(values) + found) ** 2).sum() == pytest.approx(1, rel=1e-14)
        else:
            assert found == pytest.approx(wanted, rel=1e-15)
    stacked = multipliers(np.array([[1.0], [-1.0]]), np.array([[3.0], [3.0]]), np.array([0.0, 1.0]))
    assert stacked == pytest.approx([2, 4], rel=1e-15)


SCALES, FRICTIONS = (2.0**-43, 1.0, 2.0**43), (1e-6, 0.5, 1e3)
BITS = (1 - 2.0**-52, 1.0, 1 + 2.0**-52)


@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("mu", FRICTIONS)
def test_what_doubles_cannot_tell_from_the_limit_rationals_decide(d: int, mu: float) -> None:
    """On the edge of the cone and at the limit, a last bit inside and outside: left to rationals."""
    up, side = np.eye(d)[:2]
    near = 1 - 1e-8 * (1 + mu) if d == 2 else 0.5 if mu > 1e-6 else None  # squares lose small frictions
    for scale, part in product(SCALES, [*BITS, near, 1 + 1e-9]):
        if part is None:
            continue
        contact = rg.Contact([0] * d, up, mu)
        limited = rg.Contact([0] * d, up, 2 * mu, max_force=scale)
        cases = [(contact, scale * (up + sign * part * mu * side)) for sign in (1, -1)]
        cases += [(limited, scale * part * up)]
        for (one, force), loads in product(cases, (rg.LoadSet.hull, rg.LoadSet.ellipsoid)):
            none = rg.Wrench([0] * d)
            body = Body(loads([none]) if loads is rg.LoadSet.hull else loads(none, np.zeros((3 * d - 3, 1))))
            touch, answer = Touch(one, Fraction(1), d), np.zeros((d, 3 * d - 3))
            f = [Fraction(x) for x in force]
            within = f[1] ** 2 <= (Fraction(one.friction) * f[0]) ** 2
            within &= one.max_force is None or f[0] ** 2 + f[1] ** 2 <= Fraction(one.max_force) ** 2
            assert (touch.broken(f, in_fractions(answer), body) is None) == within
            given = Sized(force[None], abs(force)[None])
            settled = surely_withstood(touch, given, answer, body, 1.0, doubt(12)).tolist()
            easy = one is contact or d == 2 or mu > 1e-6
            assert settled == [within and part not in BITS] or not easy, (scale, part, force)
            assert within or settled == [False]


def in_fractions(a: np.ndarray) -> list[list[Fraction]]:
    return [[Fraction(float(x)) for x in row] for row in a]


@pytest.mark.parametrize("mu", FRICTIONS)
def test_plans_on_the_edge_of_their_cones(mu: float) -> None:
    for scale in SCALES:
        grasp, forces = cross((mu,) * 4, slope=mu, force=scale)
        state = rg.GraspState(grasp, rg.Wrench([0, 0]), forces)
        plan = Plan("rotation", None, state, state)
        for factor, good in (1.0, True), (1 - 2.0**-53, False), (1 + 2.0**-52, True):
            assert rg.verify(plan, friction=factor).ok == good, (scale, factor)
    grasp, forces = solid_cross((0.5,) * 4, force=scale)
    state = rg.GraspState(grasp, rg.Wrench([0, 0, 0]), forces)
    for factor, good in (1.0, True), (1 - 2.0**-53, False):
        assert rg.verify(Plan("rotation", None, state, state), friction=factor).ok == good


def test_what_no_double_holds_is_infinite() -> None:
    assert doubles([Fraction(10) ** 400, -(Fraction(10) ** 400), Fraction(1, 3)]).tolist() == [
        np.inf,
        -np.inf,
        1 / 3,
    ]
    assert in_doubles([[Fraction(1), Fraction(2)], [Fraction(3), Fraction(4)]]).tolist() == [[1, 2], [3, 4]]
    assert doubt(12) == 20 / 2**45


def test_what_is_sure_of_a_finger_in_space() -> None:
    """Pushing, pulling and aside; a linear limit of 2 and its quarter; a limit of 3 on all of the force."""

    def sure(forces, loads, share=1.0, size=1.0, **limits) -> list[bool]:
        touch = Touch(rg.Contact([0, 0, 0], [1, 0, 0], 0.5, **limits), Fraction(1), 3)
        given, answer = np.array(forces, dtype=float), size * np.eye(3, 6)
        return surely_withstood(
            touch, Sized(given, abs(given)), answer, Body(loads), share, doubt(24)
        ).tolist()

    still = rg.Wrench([0, 0, 0])
    for loads in rg.LoadSet.hull([still]), rg.LoadSet.ball(still, force=0.1):
        assert sure([[1, 0, 0], [-1, 0, 0], [1, 1, 0], [0, 0, 0]], loads) == [True, False, False, False]
        limits = rg.ForceLimits([[1, 0, 0]], [2])
        assert sure([[1, 0, 0], [3, 0, 0]], loads, limits=limits) == [True, False]
        assert sure([[1, 0, 0], [0.3, 0, 0]], loads, 0.25, limits=limits) == [False, True]
        assert sure([[2.85, 0, 0], [2.95, 0.8, 0]], loads, max_force=3.0) == [True, False]
    assert sure([[1, 0, 0], [1e300, 0, 0]], loads, size=1e300) == [False, False]  # no doubles any more

"""The compiled batch against the same formulas called one grasp at a time."""

from collections.abc import Callable
from math import inf

import numba
import numpy as np
import pytest

import regrasp as rg
from models import OBJECTIVES
from regrasp.closed_form.choice import best_squeeze
from regrasp.closed_form.compiled import two_fingers as compiled
from regrasp.closed_form.compiled.two_fingers import BLOCK
from regrasp.closed_form.locus import squeeze_interval
from strategies import Pair, lattice_pair, random_pair

pytestmark = pytest.mark.oracle

ULP = 4
NAMES = ("r1", "n1", "mu1", "r2", "n2", "mu2", "force", "torque")
PAPER = {
    "r1": [-4, -4], "n1": [1, 1], "mu1": 0.3, "r2": [4, -5], "n2": [-1, 2], "mu2": 0.3, "force": [-1.5, -3.5],
    "torque": 0.0,
}  # fmt: skip


def random_pairs(count: int, seed: int, zero_load: bool = True) -> list[Pair]:
    """Random and lattice geometry in turn, every fourth in other units."""
    rng = np.random.default_rng(seed)
    result: list[Pair] = []
    while len(result) < count:
        pair = random_pair(rng, facing=1.0) if len(result) % 2 else lattice_pair(rng)
        if len(result) % 4 == 3:
            length, force = 10.0 ** rng.uniform(-6, 6, 2)
            pair = pair.scaled(float(length), float(force), (float(length), 1.0))
        if zero_load or any((*pair.force, pair.torque)):
            result.append(pair)
    return result


def arrays(pairs: list[Pair]) -> dict[str, np.ndarray]:
    return {name: np.array([pair.arguments[i] for pair in pairs]) for i, name in enumerate(NAMES)}


def assert_same(found: np.ndarray, want: np.ndarray) -> None:
    """Equal to a few ulp; NaN and infinities in the same places."""
    found, want = np.asarray(found), np.asarray(want)
    assert found.shape == want.shape
    np.testing.assert_array_equal(np.isnan(found), np.isnan(want))
    np.testing.assert_array_equal(np.isinf(found), np.isinf(want))
    finite = np.isfinite(want)
    np.testing.assert_array_max_ulp(found[finite], want[finite], ULP)


def one_by_one(
    pairs: list[Pair],
    objective: str,
    limits1: np.ndarray | float = inf,
    limits2: np.ndarray | float = inf,
    ratio: float = 3.0,
) -> np.ndarray:
    code = OBJECTIVES.index(objective)
    limits = [np.broadcast_to(limit, len(pairs)).tolist() for limit in (limits1, limits2)]
    return np.array(
        [best_squeeze(*p.plain, code, a, b, ratio)[0] for p, a, b in zip(pairs, *limits, strict=True)]
    )


@pytest.mark.parametrize("seed", range(2))
def test_intervals_are_those_of_the_scalar_function(seed: int) -> None:
    pairs = random_pairs(3000, seed)
    lo, hi = rg.locus_intervals(**arrays(pairs))
    want = np.array([squeeze_interval(*pair.plain) for pair in pairs])
    assert_same(lo, want[:, 0])
    assert_same(hi, want[:, 1])
    empty = lo > hi
    assert 300 < empty.sum() < 2700
    assert (lo[empty] == inf).all()
    assert (hi[empty] == -inf).all()


LIMITS: list[tuple[str, Callable[[np.random.Generator, int], object]]] = [
    ("none", lambda rng, n: None),
    ("one for all", lambda rng, n: 2.0),
    ("two for all", lambda rng, n: (1.5, 4.0)),
    ("one each", lambda rng, n: 10 ** rng.uniform(-1, 1, n)),
    ("two each", lambda rng, n: (10 ** rng.uniform(-1, 1, n), 10 ** rng.uniform(-1, 1, n))),
    ("on one only", lambda rng, n: (None, 10 ** rng.uniform(-1, 1, n))),
    ("infinite for some", lambda rng, n: np.where(rng.random(n) < 0.5, inf, 3.0)),
]


@pytest.mark.parametrize(("kind", "limits_of"), LIMITS, ids=[kind for kind, _ in LIMITS])
@pytest.mark.parametrize("objective", OBJECTIVES)
def test_squeezes_are_those_of_the_scalar_function(objective: str, kind: str, limits_of: Callable) -> None:
    rng = np.random.default_rng(7)
    pairs = random_pairs(1500, 10, zero_load=False)
    max_force = limits_of(rng, len(pairs))
    x = rg.best_squeezes(**arrays(pairs), objective=objective, max_force=max_force, peak_ratio=2.5)
    both = max_force if isinstance(max_force, tuple) else (max_force, max_force)
    limits = [np.asarray(inf if limit is None else limit) for limit in both]
    assert_same(x, one_by_one(pairs, objective, limits[0], limits[1], 2.5))
    assert np.isfinite(x).sum() > 50
    assert np.isnan(x).sum() > 50


def test_limits_and_ratio_come_into_it() -> None:
    """Each option changes some answer, so none is accepted and dropped."""
    pairs = random_pairs(500, 11, zero_load=False)
    data = arrays(pairs)
    free = rg.best_squeezes(**data)
    for options in (
        {"objective": "force"},
        {"peak_ratio": 1.5},
        {"max_force": 1.0},
        {"max_force": (1.0, None)},
        {"max_force": (None, 1.0)},
    ):
        other = rg.best_squeezes(**data, **options)
        assert ((other != free) & ~np.isnan(free)).any(), options


def test_squeezes_are_those_of_the_locus() -> None:
    """And so the numbers mean what the object's do, reserve apart."""
    grasp = rg.Grasp([rg.Contact([-4, -4], [1, 1], 0.3), rg.Contact([4, -5], [-1, 2], 0.3)])
    locus = rg.EquilibriumLocus(grasp, rg.Wrench([-1.5, -3.5]))
    lo, hi = rg.locus_intervals(**PAPER)
    assert (float(lo), float(hi)) == pytest.approx(locus.interval, rel=1e-15)
    for objective in OBJECTIVES:
        x = rg.best_squeezes(**PAPER, objective=objective)
        assert float(x) == pytest.approx(locus.squeeze(locus.best(objective, reserve=0.0)), rel=1e-12), (
            objective
        )


def test_a_zero_load_under_a_limit() -> None:
    opposed = {**PAPER, "r1": [0, 0], "n1": [1, 0], "r2": [2, 0], "n2": [-1, 0], "force": [0, 0]}
    assert rg.best_squeezes(**opposed, objective="force", max_force=4.0) == 4.0
    assert rg.best_squeezes(**opposed, objective="effort") == 0.0


def test_one_grasp_gives_numbers_without_axes() -> None:
    lo, hi = rg.locus_intervals(**PAPER)
    assert lo.shape == hi.shape == rg.best_squeezes(**PAPER).shape == ()
    assert float(lo) == pytest.approx(1.3574912618930035, rel=1e-14)


def test_the_torque_may_be_left_out() -> None:
    without = {name: value for name, value in PAPER.items() if name != "torque"}
    assert rg.locus_intervals(**without) == rg.locus_intervals(**PAPER)
    assert rg.best_squeezes(**without) == rg.best_squeezes(**PAPER)


@pytest.mark.parametrize("shape", [(0,), (3, 0), (0, 5)])
def test_empty_arrays(shape: tuple[int, ...]) -> None:
    data = PAPER | {"r1": np.empty((*shape, 2))}
    lo, hi = rg.locus_intervals(**data)
    assert lo.shape == hi.shape == rg.best_squeezes(**data, max_force=1.0).shape == shape


def test_every_first_with_every_second() -> None:
    """(n, 1) x (1, m): first contacts down, second contacts across, the load one value, friction by row."""
    pairs = random_pairs(40, 20)
    first, second = arrays(pairs[:25]), arrays(pairs[25:])
    mixed = {
        "r1": first["r1"][:, None], "n1": first["n1"][:, None], "mu1": first["mu1"][:, None],
        "r2": second["r2"][None], "n2": second["n2"][None], "mu2": 0.4,
        "force": [0.3, -2.0], "torque": np.array([[0.1]]),
    }  # fmt: skip
    table = [
        [Pair(p.r1, p.n1, p.mu1, q.r2, q.n2, 0.4, (0.3, -2.0), 0.1) for q in pairs[25:]] for p in pairs[:25]
    ]
    lo, hi = rg.locus_intervals(**mixed)
    want = np.array([[squeeze_interval(*pair.plain) for pair in row] for row in table])
    assert lo.shape == (25, 15)
    assert_same(lo, want[..., 0])
    assert_same(hi, want[..., 1])
    limit = np.linspace(1, 3, 15)
    x = rg.best_squeezes(**mixed, objective="peak", max_force=(limit, 5.0))
    want_x = np.array([one_by_one(row, "peak", limit, 5.0) for row in table])
    assert_same(x, want_x)
    assert (~np.isnan(x)).sum() > 10


@pytest.mark.parametrize("name", NAMES)
def test_each_argument_alone_may_vary(name: str) -> None:
    """The others are one value, which serves every block."""
    rng = np.random.default_rng(30)
    count = 2 * BLOCK + 3
    base = np.array(PAPER[name], float)
    values = base + 0.1 * rng.random((count, *base.shape))
    data = PAPER | {name: values}
    lo, hi = rg.locus_intervals(**data)
    x = rg.best_squeezes(**data)
    assert len(set(x.tolist())) > count / 2
    sample = [0, 1, BLOCK - 1, BLOCK, BLOCK + 1, 2 * BLOCK, count - 1]
    pairs = [Pair(**(PAPER | {name: values[i].tolist()})) for i in sample]
    assert_same(np.stack([lo, hi], axis=1)[sample], np.array([squeeze_interval(*p.plain) for p in pairs]))
    assert_same(x[sample], one_by_one(pairs, "angle"))


def test_compiled_once_for_all_shapes() -> None:
    """Not once for every mix of one value and many, of the caller's memory and ours: each takes seconds."""
    rg.locus_intervals(**PAPER)
    many = np.random.default_rng(0).random((9, 2)) + 1
    for name in ("r1", "n2", "force"):
        rg.locus_intervals(**PAPER | {name: many})
    rg.locus_intervals(**PAPER | {"r1": many[:, None], "n2": many})
    assert len(compiled.INTERVALS.signatures) == 1


@pytest.mark.parametrize(
    "count", [1, 2, BLOCK - 1, BLOCK, BLOCK + 1, 2 * BLOCK - 1, 2 * BLOCK, 3 * BLOCK + 7]
)
def test_sizes_around_the_block(count: int) -> None:
    pairs = (random_pairs(97, 40) * (count // 97 + 1))[:count]
    data = arrays(pairs)
    lo, hi = rg.locus_intervals(**data)
    want = np.array([squeeze_interval(*pair.plain) for pair in pairs[:97]])
    assert_same(lo, np.resize(want[:, 0], count))
    assert_same(hi, np.resize(want[:, 1], count))
    x = rg.best_squeezes(**data, objective="effort")
    assert_same(x, np.resize(one_by_one(pairs[:97], "effort"), count))


def test_inputs_are_left_as_they_are_and_need_not_be_contiguous() -> None:
    pairs = random_pairs(2 * BLOCK, 50)
    data = arrays(pairs)
    strided = {name: np.repeat(value, 2, axis=0)[::2] for name, value in data.items()}
    turned = strided | {"r1": np.asfortranarray(data["r1"])}
    for value in turned.values():
        value.setflags(write=False)
    before = {name: value.copy() for name, value in turned.items()}
    for one, other in zip(rg.locus_intervals(**data), rg.locus_intervals(**turned), strict=True):
        np.testing.assert_array_equal(one, other)
    for name, value in turned.items():
        np.testing.assert_array_equal(value, before[name])


def test_the_number_of_threads_does_not_matter() -> None:
    data = arrays(random_pairs(500, 60, zero_load=False))
    data = {name: np.concatenate([value] * 40) for name, value in data.items()}  # 20 blocks
    threads = numba.get_num_threads()
    try:
        found = []
        for count in {1, threads}:
            numba.set_num_threads(count)
            found.append((*rg.locus_intervals(**data), rg.best_squeezes(**data)))
    finally:
        numba.set_num_threads(threads)
    for one, other in zip(found[0], found[-1], strict=True):
        np.testing.assert_array_equal(one, other)
        np.testing.assert_array_equal(one[:500], one[-500:])

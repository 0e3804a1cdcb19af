"""Every back end chooses the same states: verdict and optimum, for grasps of two to five planar contacts."""

import numpy as np
import pytest

import regrasp as rg
from regrasp.programs import available_backends

# Largest relative difference of the optimum from Clarabel's. First-order methods answer to their tolerance.
AGREEMENT = {
    "daqp": 1e-7,
    "quadprog": 1e-7,
    "highs": 1e-6,
    "piqp": 1e-6,
    "proxqp": 1e-6,
    "osqp": 1e-5,
    "scs": 1e-5,
    "qpalm": 1e-5,
    "cvxpy:CLARABEL": 1e-6,
}
# Methods that answer linear programs too, where the quadratic term is zero.
LINEAR = ("highs", "piqp", "cvxpy:CLARABEL")
FACETS = 24


def installed(names):
    return sorted(name for name in names if name.partition(":")[0] in available_backends())


def grasps(count: int, seed: int):
    rng = np.random.default_rng(seed)
    for _ in range(count):
        points = rng.normal(size=(rng.integers(2, 6), 2))
        contacts = [rg.Contact(p, rng.normal(size=2) - p, rng.uniform(0.05, 1.0)) for p in points]
        yield rg.Grasp(contacts), rg.Wrench(rng.normal(size=2), 0.3 * rng.normal())


def outcome(grasp, load, objective, **options):
    """The value of the best state, or None with a proof that none exists."""
    try:
        return rg.choose_state(grasp, load, objective, **options).value
    except rg.Infeasible as reason:
        if reason.certificate is None or not reason.certificate.is_proof:
            pytest.fail(f"infeasible without a proof: {reason}")
        return None


@pytest.mark.parametrize("backend", installed(AGREEMENT))
def test_least_effort_is_the_same_by_every_back_end(backend):
    held = 0
    for grasp, load in grasps(25, seed=1):
        expected = outcome(grasp, load, "effort")
        found = outcome(grasp, load, "effort", method=backend)
        assert (found is None) == (expected is None)
        if expected is not None:
            held += 1
            assert found == pytest.approx(expected, rel=AGREEMENT[backend])
    assert 5 < held < 25


@pytest.mark.parametrize("backend", installed(LINEAR))
@pytest.mark.parametrize("objective", ["peak", "peak_normal", "force"])
def test_polygons_let_qp_back_ends_choose_what_clarabel_chooses(backend, objective):
    for grasp, load in grasps(8, seed=2):
        options = {"facets": FACETS, "max_force": 20.0}
        expected = outcome(grasp, load, objective, method="clarabel", **options)
        found = outcome(grasp, load, objective, method=backend, **options)
        assert (found is None) == (expected is None)
        if expected is not None:
            assert found == pytest.approx(expected, rel=1e-5)


def test_polygons_are_inside_the_circle_and_close_in_on_it():
    grasp, load = next((g, w) for g, w in grasps(50, seed=3) if outcome(g, w, "peak") is not None)
    exact = outcome(grasp, load, "peak", method="clarabel")
    least = []
    for facets in (8, 32, 128):
        value = outcome(grasp, load, "peak", method="clarabel", facets=facets)
        assert value >= exact * (1 - 1e-9)
        assert value <= exact / np.cos(np.pi / facets) * (1 + 1e-9)
        least.append(value)
    assert least[2] == pytest.approx(exact, rel=1e-3)


def test_second_order_rows_on_a_qp_back_end_name_the_way():
    grasp, load = next(grasps(1, seed=4))
    with pytest.raises(rg.InvalidInput, match="use linearised cones"):
        rg.choose_state(grasp, load, "peak", method="osqp")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"facets": 2}, "facets must be a whole number of at least 3, got 2"),
        ({"facets": 8.0}, "facets must be a whole number of at least 3, got 8.0"),
        ({"facets": 8, "method": "closed-form"}, "leave facets out"),
        ({"method": "simplex"}, "method must be one of auto, closed-form, clarabel"),
    ],
)
def test_bad_options_are_refused(options, message):
    grasp = rg.Grasp([rg.Contact([-1, 0], [1, 0], 0.5), rg.Contact([1, 0], [-1, 0], 0.5)])
    with pytest.raises(rg.InvalidInput, match=message):
        rg.choose_state(grasp, rg.Wrench([0, -1]), **options)

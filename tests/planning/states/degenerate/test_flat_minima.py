"""Forces of least effort or peak to the last digits: a solver's tolerance leaves its root on them.

The best forces come first. For a motion y every finger pushes as far as it can along u = -G'y, its velocity:

    effort        f_i = u_i projected onto the cone, cut at the limit
    peak          |f_i| = t along that projection, or 0
    peak_normal   f_i . n_i = t on the edge of the cone towards u_i, or 0

They are the only best ones for the load that they hold, whatever the fingers, by weak duality with y.
"""

from itertools import count

import numpy as np
import pytest

import regrasp as rg
from regrasp.planning.states.degenerate import flat_minima

pytestmark = pytest.mark.oracle

OBJECTIVES = ("effort", "peak", "peak_normal")


def onto_cone(u: np.ndarray, n: np.ndarray, mu: float) -> np.ndarray:
    along = u @ n
    across = u - along * n
    size = float(np.linalg.norm(across))
    if size <= mu * along:
        return u
    if mu * size <= -along:
        return 0 * u
    edge = n + (mu / size) * across
    return max(u @ edge, 0.0) / (1 + mu * mu) * edge


def known(rng: np.random.Generator, d: int, objective: str) -> tuple[rg.Grasp, rg.Wrench, np.ndarray]:
    """A grasp, a load and its best forces."""
    while True:
        n = int(rng.integers(3, 7))
        r = rng.normal(size=(n, d))
        normals = 0.6 * rng.normal(size=(n, d)) - r
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        mu = rng.choice([0.0, 0.1, 0.3, 0.5, 0.8, 1.5], n)
        v, omega = rng.normal(size=d), rng.normal(size=1 if d == 2 else 3)
        u = v + (np.cross(omega, r) if d == 3 else omega * np.column_stack([-r[:, 1], r[:, 0]]))
        limits = np.full(n, np.inf)
        if objective == "peak_normal":
            along = (u * normals).sum(axis=1)
            across = u - along[:, None] * normals
            size = np.linalg.norm(across, axis=1)
            f = np.where((along + mu * size > 0)[:, None], normals + (mu / size)[:, None] * across, 0.0)
        else:
            f = np.array([onto_cone(*each) for each in zip(u, normals, mu, strict=True)])
            sizes = np.maximum(np.linalg.norm(f, axis=1), 1e-300)
            if objective == "peak":
                f /= sizes[:, None]
            else:
                limits = np.where(rng.random(n) < 0.3, rng.uniform(0.3, 1.5, n), np.inf)
                f *= np.minimum(1, limits / sizes)[:, None]
        if np.count_nonzero(f.any(axis=1)) > 1:
            break
    length, force = 10.0 ** rng.integers(-3, 4, 2)
    torque = np.cross(r, f).sum(axis=0) if d == 3 else (r[:, 0] * f[:, 1] - r[:, 1] * f[:, 0]).sum()
    grasp = rg.Grasp(
        rg.Contact(length * p, normal, m, max_force=None if limit == np.inf else force * limit)
        for p, normal, m, limit in zip(r, normals, mu, limits, strict=True)
    )
    return grasp, rg.Wrench(-force * f.sum(axis=0), -force * length * torque), force * f


@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("objective", OBJECTIVES)
def test_the_best_forces_are_found_to_a_billionth(objective: str, d: int) -> None:
    rng, misses = np.random.default_rng(3), []
    for _ in range(40):
        grasp, load, best = known(rng, d, objective)
        state = rg.choose_state(grasp, load, objective, reserve=0.0)
        misses.append(abs(state.forces - best).max() / abs(best).max())
        assert (state.forces[~best.any(axis=1)] == 0).all() or misses[-1] < 1e-9
    # Where many equations depend on one another, inverting them may take a digit more.
    assert max(misses) < 1e-8
    assert np.count_nonzero(np.array(misses) > 1e-9) <= 1
    assert np.median(misses) < 1e-11


@pytest.mark.parametrize("seed", range(6))
def test_of_many_best_forces_some_are_found(seed: int) -> None:
    """Two rough fingers face each other and more stand by: squeezes that cost nothing are left alone."""
    rng = np.random.default_rng(seed)
    legs = rg.Grasp(rg.Contact([x, y, 0], [0, 0, 1], 0.5) for x in (-1, 1) for y in (-1, 1))
    load = rg.Wrench([*rng.uniform(-0.1, 0.1, 2), -1])
    for objective, least in (("peak", None), ("sum_normal", 1.0), ("peak_normal", 0.25)):
        state = rg.choose_state(legs, load, objective)
        assert state.is_balanced()
        if least is not None:
            assert state.value == pytest.approx(least, rel=1e-9)


def test_forces_of_a_cost_of_ones_own() -> None:
    """Weights a: the least of sum a |f|^2 over legs in a row is f = -G'y / (2 a), within wide cones."""
    x, a = np.array([-2.0, 1.0, 4.0]), np.array([1.0, 3.0, 0.2])
    legs = rg.Grasp(rg.Contact([place, -1], [0, 1], 5.0) for place in x)
    rows = np.array([[1.0, 1, 1], x])  # with sideways forces equal and opposite through torques: none is best
    best = np.linalg.solve(rows / a @ rows.T, [3.0, 1.5]) @ rows / a
    state = rg.choose_state(legs, rg.Wrench([0, -3], -1.5), rg.ForceCost("mine", weights=a))
    assert state.forces[:, 1] == pytest.approx(best, rel=1e-9)
    assert abs(state.forces[:, 0]).max() < 1e-9


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_the_face_at_once_is_the_face_that_is_searched(
    objective: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where the constraints in sight are the right ones, loops that search for others end there, too."""
    rng, answered = np.random.default_rng(11), 0
    at_once, given = flat_minima.at_once.refined, []

    def kept(*arguments: object) -> object:
        given.append((at_once(*arguments), arguments))
        return given[-1][0]

    monkeypatch.setattr(flat_minima.at_once, "refined", kept)
    monkeypatch.setattr(flat_minima, "_calls", count())  # as in a process that has just begun
    for d in (2, 3) * 10:
        rg.choose_state(*known(rng, d, objective)[:2], objective, reserve=0.0)
    for answer, arguments in given:
        if answer is not None:
            answered += 1
            searched, is_no_worse, _ = flat_minima.face_newton.refined(*arguments)
            assert is_no_worse
            assert abs(answer[0] - searched).max() < 1e-9 * abs(searched).max()
    assert len(given) // 4 < answered < len(given)


def test_a_margin_is_no_worse_for_being_polished() -> None:
    """Forces that were polished past a limit, and moved back into it, had lost 2.5e-6 of their margin."""
    places = [((0.16604, -1), (0, 1)), ((1, -0.159217), (-1, 0)), ((-1, -0.0199905), (1, 0))]
    grasp = rg.Grasp(rg.Contact(at, normal, 1.0) for at, normal in places)
    state = rg.choose_state(grasp, rg.Wrench([0, -1], 0.02 * np.sqrt(2)), "force", max_force=3.0)
    batch = rg.choose_states(
        grasp.positions, grasp.normals, 1.0, [0, -1], 0.02 * np.sqrt(2), objective="force", max_force=3.0
    )
    assert state.value == pytest.approx(float(batch.values), rel=1e-8)

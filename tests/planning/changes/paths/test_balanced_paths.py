"""Forces of a path moved into exact equilibrium: by how much, by which fingers, and when that will do."""

from dataclasses import replace
from math import inf
from types import SimpleNamespace

import numpy as np
import pytest

import regrasp as rg
import regrasp.planning.changes.path_search as searched
from feet import PAIR, on_feet, task
from regrasp.errors import SolverFailed
from regrasp.planning.changes.path_search import _balanced, _exact

pytestmark = pytest.mark.contract


def test_every_instant_is_balanced_by_the_fingers_it_has() -> None:
    """Three feet in a row, of which another one is idle at each instant."""
    feet = rg.Grasp(rg.Contact([x, 0], [0, 1], 0.5) for x in (-1, 0, 1))
    active = np.array([[1, 1, 1], [1, 1, 0], [1, 0, 1], [0, 1, 1], [1, 1, 1]], dtype=bool)
    right = np.array([[1, 0, 1], [0.0, 2, 0], [1, 0, 1], [0, 2, 0], [1, 0, 1]])[..., None] * [0.0, 1.0]
    three = {name: np.full(3, inf) for name in ("limits", "rates")} | {"frictions": np.full(3, 0.5)}
    asked = task(
        grasp=feet,
        active=active,
        start=(0, 0),
        end=(0, 0),
        least_normals=np.zeros(3),
        stays=np.ones(3) > 0,
        **three,
    )
    asked = replace(asked, start=right[0], end=right[-1])
    some = asked.active[1:-1]
    value = (right - asked.reference)[1:-1][some].ravel()
    off = 1e-7 * np.random.default_rng(0).uniform(size=value.size)
    off[1::2] = abs(off[1::2])
    forces = _exact(asked, SimpleNamespace(value=value + off, program=None))
    for k in range(5):
        assert abs(feet.matrix @ forces[k].ravel() + asked.loads[k]).max() <= 1e-15
        assert not forces[k, ~active[k]].any()


@pytest.mark.parametrize(("way", "off", "good"), [(1, 5e-4, True), (-1, 5e-4, True), (1, 5e-3, False)])
def test_how_far_is_measured_by_the_largest_force(way, off, good) -> None:
    feet = on_feet(way)
    push = np.full((2, 2), 100.0 * way) * [0, 1]
    asked = replace(task(grasp=feet), start=push, end=push)
    asked = replace(asked, loads=100 * way * asked.loads)
    value = np.zeros(12)
    value[5] = off
    if good:
        assert _exact(asked, SimpleNamespace(value=value, program=None))[2] == pytest.approx(push, rel=1e-12)
    else:
        with pytest.raises(SolverFailed, match="no equilibrium inside"):
            _exact(asked, SimpleNamespace(value=value, program=None))


def kept_as_is(monkeypatch, asked, forces, load) -> bool:
    """Whether shifted forces serve without Newton's."""
    monkeypatch.setattr(searched, "nearest_equilibrium", lambda *_: None)
    moved = _balanced(
        asked, np.array([forces], dtype=float), np.array([load], dtype=float), np.arange(len(forces))
    )
    return bool(np.isfinite(moved).all())


@pytest.mark.parametrize(("square", "inside"), [(8.9, True), (9.1, False)])
@pytest.mark.parametrize("who", [0, 1])
def test_balanced_forces_keep_their_limits(square, inside, who, monkeypatch) -> None:
    limits = np.full(2, 4.0)
    limits[who] = 3.0
    push = np.sqrt(square - 1)
    asked = task(grasp=PAIR, limits=limits)
    assert kept_as_is(monkeypatch, asked, [[push, 1], [-push, 1]], [0, -2, 0]) == inside


@pytest.mark.parametrize(("squeeze", "inside"), [(0.49, True), (0.55, False)])
def test_balanced_forces_are_all_inside_their_cones(squeeze, inside, monkeypatch) -> None:
    """Two feet with 1 and 1.4 N, friction 1/2: the second could take more."""
    forces = [[squeeze, 1.0], [-squeeze, 1.4]]
    assert kept_as_is(monkeypatch, task(), forces, [0, -2.4, -0.4]) == inside


def in_a_row(places, normals) -> rg.Grasp:
    """Fingers along x in space, which balance no torque about it."""
    return rg.Grasp(rg.Contact([x, 0, 0], n, 0.5) for x, n in zip(places, normals, strict=True))


@pytest.mark.parametrize(("share", "good"), [(0.9, True), (1.4, False)])
@pytest.mark.parametrize("case", ["squeeze", "feet", "hanging"])
def test_what_is_left_is_measured_by_forces_and_load(case, share, good, monkeypatch) -> None:
    """A torque about the row of fingers is left over, a share of half of what equilibrium may miss."""
    if case == "squeeze":  # 500, 500 and -1000 N along x
        grasp, largest = in_a_row([-1, -0.5, 1], [[1, 0, 0], [1, 0, 0], [-1, 0, 0]]), 1000.0
        forces, load = [[500, 0, 0], [500, 0, 0], [-1000, 0, 0]], [0.0] * 6
    else:  # a quarter of 2 N each
        z = 1 if case == "feet" else -1
        grasp, largest = in_a_row([-1, -0.5, 0.5, 1], [[0, 0, z]] * 4), 2.0
        forces, load = [[0, 0, 0.5 * z]] * 4, [0, 0, -2.0 * z, 0, 0, 0]
    load[3] = share * searched.EQUILIBRIUM / 2 * largest
    n = len(grasp)
    asked = replace(task(), grasp=grasp, frictions=np.full(n, 0.5), limits=np.full(n, inf))
    assert kept_as_is(monkeypatch, asked, forces, load) == good


@pytest.mark.parametrize("size", [1e-3, 0.0, 8.0])
def test_newton_is_told_the_size_of_the_grasp(size, monkeypatch) -> None:
    told = []
    monkeypatch.setattr(searched, "nearest_equilibrium", lambda *given: told.append(given[-1]))
    asked = task(
        grasp=rg.Grasp([rg.Contact([size, 0], [0, 1], 0.5)]), frictions=np.ones(1), limits=np.ones(1)
    )
    _balanced(asked, np.array([[[0.0, 2.0]]]), np.array([[0.0, -2.0, 0.0]]), np.arange(1))
    assert told == [size or 1.0]


def test_forces_of_point_contacts_of_a_soft_grasp_have_no_torque() -> None:
    """The soft finger is idle: what is balanced is narrower, and what comes back as wide."""
    feet = [rg.Contact([np.cos(a), np.sin(a), 0], [0, 0, 1], 0.5) for a in (0, 2.1, 4.2)]
    grasp = rg.Grasp([*feet, rg.Contact([0, 0, 1], [0, 0, -1], 0.5, torsion=0.2)])
    asked = replace(task(), grasp=grasp, frictions=np.full(4, 0.5), limits=np.full(4, inf))
    forces = np.zeros((1, 3, 4))
    forces[..., 2] = 1.0
    load = -np.concatenate([[0, 0, 3.0], sum(np.cross(f.position, [0, 0, 1.0]) for f in feet)])
    moved = _balanced(asked, forces + np.array([1e-9, 0, 0, 0]), load[None], np.arange(3))
    assert moved.shape == (1, 3, 4)
    assert moved == pytest.approx(forces, abs=1e-8)
    assert abs(grasp.matrix[:, :12] @ moved.ravel() + load).max() <= 1e-15

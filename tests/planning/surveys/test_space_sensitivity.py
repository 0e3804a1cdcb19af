"""Rates in space against differences of the best value itself: exact cones and soft fingers."""

import numpy as np
import pytest

import regrasp as rg
from space import random_grasp, random_load

pytestmark = pytest.mark.oracle

STEP, ROOM = 3e-4, 1e-3
OBJECTIVES = ("force", "effort", "peak", "angle", "friction_use")


def changed(grasp: rg.Grasp, load: rg.Wrench, parameter: str, place: tuple[int, ...], by: float):
    """A grasp and load of which one number is changed, written by hand."""
    i = place[0]
    if parameter == "load":
        return grasp, rg.Wrench.from_vector(load.vector + by * np.eye(6)[i])
    c = grasp[i]
    if parameter in ("position", "normal"):
        t = grasp.tangents[i, place[1]]
        r, n = (c.position + by * t, c.normal) if parameter == "position" else (c.position, c.normal + by * t)
        new = rg.Contact(
            r, n, c.friction, max_force=c.max_force, torsion=c.torsion, limits=c.limits, name=c.name
        )
    else:
        new = c.changed(
            **{
                {"limit": "max_force"}.get(parameter, parameter): by
                + getattr(c, {"limit": "max_force"}.get(parameter, parameter))
            }
        )
    return grasp.replaced(i, new), load


@pytest.mark.parametrize(
    ("objective", "soft", "rows"),
    [
        *((objective, soft, False) for objective in OBJECTIVES for soft in (False, True)),
        ("force", False, True),
        ("effort", True, True),
    ],
)
def test_rates_are_the_differences_of_the_value(objective: str, soft: bool, rows: bool) -> None:
    rng = np.random.default_rng(11)
    agreed, kinks, sizes = 0, 0, []
    while agreed < 8:
        grasp, load = random_grasp(rng, 4, 0.7), random_load(rng)
        if soft:
            grasp = rg.Grasp(c.changed(torsion=0.1 if i < 2 else None) for i, c in enumerate(grasp))
        try:
            peak = rg.choose_state(grasp, load, "peak").value
            if rows:
                limits = rng.normal(size=(2, 3)), rng.uniform(0.5, 1.2, 2) * peak
                grasp = grasp.replaced(1, grasp[1].changed(limits=limits))
            grasp = grasp.replaced(0, grasp[0].changed(max_force=1.5 * peak))
            found = rg.sensitivity(grasp, load, objective)
        except rg.Infeasible:
            continue
        numbers = [
            (name, place, rate)
            for name in ("friction", "position", "normal", "limit", "torsion", "load")
            for place, rate in np.ndenumerate(getattr(found, name))
            if not np.isnan(rate)
        ]
        assert found.position.shape == found.normal.shape == (4, 2)
        assert np.isnan(found.torsion).sum() == (2 if soft else 4)
        for k in rng.permutation(len(numbers))[:4]:
            name, place, rate = numbers[k]
            behind, ahead = (
                rg.choose_state(*changed(grasp, load, name, place, by), objective).value
                for by in (-STEP, STEP)
            )
            room = ROOM * max(1.0, abs(rate), abs(found.value))
            if abs(ahead - 2 * found.value + behind) / STEP > 10 * room:
                kinks += 1
                continue
            assert (ahead - behind) / (2 * STEP) == pytest.approx(rate, abs=room), (name, place)
            agreed += 1
            sizes.append(abs(rate))
    assert kinks < 4
    assert np.mean(np.array(sizes) > 1e-2) > 0.3


def test_it_prints_tabulates_and_is_drawn() -> None:
    from regrasp import plots

    rng = np.random.default_rng(2)
    grasp = rg.Grasp(c.changed(torsion=0.05, max_force=9.0) for c in random_grasp(rng, 4, 0.9))
    found = rg.sensitivity(grasp, rg.Wrench([0, 0, -1.0]), "force")
    assert "position 2" in str(found)
    assert "torque z" in str(found)
    table = found.to_dataframe()
    assert len(table) == 4 * 7 + 6
    assert set(table["parameter"]) >= {"position 1", "normal 2", "torsion", "force z"}
    ax = plots.plot_sensitivity(found)
    assert any("t_2" in label.get_text() for label in ax.get_yticklabels())
    steps = found.steps()
    for name, effect in found.effects().items():
        assert effect.shape == steps[name].shape == getattr(found, name).shape

"""Rates of the best value against differences of the best value itself, which never sees a dual."""

import builtins
from collections.abc import Iterator
from dataclasses import replace
from math import cos, isnan, sin

import numpy as np
import pytest

import regrasp as rg
from invariance import numbered
from models import OBJECTIVES
from regrasp import plots
from regrasp.planning.surveys import envelope
from regrasp.plots.surveys.sensitivity import sensitivity_png
from regrasp.programs import Program, Solution, Status, solve
from strategies import comfortable_pair, comfortable_triple

pytestmark = pytest.mark.oracle

PARAMETERS = ("friction", "position", "normal", "limit", "load")
BETTER_LARGE = ("angle", "force")


def moved(grasp: rg.Grasp, load: rg.Wrench, parameter: str, i: int, by: float) -> tuple[rg.Grasp, rg.Wrench]:
    """A grasp and load of which one number is changed."""
    if parameter == "load":
        return grasp, rg.Wrench.from_vector(load.vector + by * np.eye(3)[i])
    c, (x, y) = grasp[i], grasp[i].normal
    changed = {
        "friction": lambda: replace(c, friction=c.friction + by),
        "position": lambda: replace(c, position=c.position + by * np.array([-y, x])),
        "normal": lambda: replace(c, normal=[cos(by) * x - sin(by) * y, sin(by) * x + cos(by) * y]),
        "limit": lambda: replace(c, max_force=c.max_force + by),
    }[parameter]()
    return grasp.replaced(i, changed), load


def sides(sensitivity: rg.Sensitivity, step: float, **options) -> Iterator[tuple[float, float, float]]:
    """(rate, difference behind, difference ahead) for each number of the grasp and the load."""
    s = sensitivity
    here = rg.choose_state(s.grasp, s.state.load, s.objective, **options).value
    assert s.value == pytest.approx(here, rel=1e-7, abs=2e-7)
    for parameter in PARAMETERS:
        for i, rate in enumerate(getattr(s, parameter)):
            if not isnan(rate):
                behind, ahead = (
                    rg.choose_state(
                        *moved(s.grasp, s.state.load, parameter, i, by), s.objective, **options
                    ).value
                    for by in (-step, step)
                )
                yield rate, (here - behind) / step, (ahead - here) / step


def limited(rng: np.random.Generator, fingers: int, case: int) -> tuple[rg.Grasp, rg.Wrench, dict]:
    """A grasp with force limits of its own (case 0), by peak_ratio (1, 2), or some of each (3)."""
    grasp, load = comfortable_pair(rng) if fingers == 2 else comfortable_triple(rng)
    if case % 4 in (0, 3):
        peak = rg.choose_state(grasp, load, "peak").value
        own = range(fingers) if case % 4 == 0 else (0,)
        for i in own:
            grasp = grasp.replaced(i, replace(grasp[i], max_force=(1.2 + 0.3 * i) * peak))
    return grasp, load, {"peak_ratio": 1.5} if case % 4 == 2 else {}


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize(("fingers", "cases", "step", "tolerance"), [(2, 32, 1e-6, 1e-4), (3, 8, 3e-4, 3e-4)])
def test_rates_are_the_differences_of_the_value(
    objective: str, fingers: int, cases: int, step: float, tolerance: float
) -> None:
    """Wherever the differences to both sides agree; the few kinks, where they do not, are counted.

    Two contacts in closed form, exact to rounding; three by Clarabel, whose 1e-7 the longer step outweighs.
    """
    rng = np.random.default_rng(7)
    kinks, sizes = [], []
    for case in range(cases):
        grasp, load, options = limited(rng, fingers, case)
        found = rg.sensitivity(grasp, load, objective, **options)
        for rate, behind, ahead in sides(found, step, **options):
            room = tolerance * max(1.0, abs(rate), abs(found.value))
            kinks.append(abs(ahead - behind) > 10 * room)
            sizes.append(abs(rate))
            if not kinks[-1]:
                assert min(behind, ahead) - room <= rate <= max(behind, ahead) + room
    assert np.mean(kinks) < 0.05
    assert np.mean(np.array(sizes) > 1e-2) > 0.3


def test_by_hand() -> None:
    """Two fingers pinch a weight W between them: f_t = W / 2 each, and the rougher finger does not matter."""
    pinch = rg.Grasp([rg.Contact([-1, 0], [1, 0], 0.5), rg.Contact([1, 0], [-1, 0], 0.8)])
    effort = rg.sensitivity(pinch, rg.Wrench([0, -2]), "effort")  # 2 (W/2)^2 (1 + 1 / mu^2)
    assert effort.value == pytest.approx(10)
    assert effort.friction == pytest.approx([-32, 0], abs=1e-6)
    assert effort.load[:2] == pytest.approx([4, -10], abs=1e-6)
    assert np.isnan(effort.limit).all()


def test_a_limit_that_does_not_bind_has_rate_zero_and_one_that_does_has_not() -> None:
    contacts = [rg.Contact([-1, 0], [1, 0], 0.5, max_force=4), rg.Contact([1, 0], [-1, 0], 0.8, max_force=5)]
    wide = rg.sensitivity(rg.Grasp(contacts), rg.Wrench([0, -2]), "force")
    squeeze = np.sqrt(16 - 1)  # margin (mu f_n - f_t) / sqrt(1 + mu^2) at |f| = 4
    assert wide.value == pytest.approx((0.5 * squeeze - 1) / np.sqrt(1.25), rel=1e-7)
    assert wide.limit == pytest.approx([0.5 * 4 / squeeze / np.sqrt(1.25), 0], abs=1e-7)
    every = rg.sensitivity(
        rg.Grasp(replace(c, max_force=None) for c in contacts), rg.Wrench([0, -2]), max_force=4
    )
    assert not np.isnan(every.limit).any()


def test_position_and_normal_together_follow_a_disc() -> None:
    """Along a boundary of curvature 1 / R: d/ds = position - normal / R."""
    rng = np.random.default_rng(3)
    radius, step = 2.5, 1e-6
    for _ in range(10):
        angles = 2 * np.pi * rng.uniform() + np.array([0, np.pi + rng.uniform(-0.3, 0.3)])
        frictions, load = rng.uniform(0.6, 1.0, 2), rg.Wrench(rng.normal(size=2), 0.1 * rng.normal())

        def on_disc(angles: np.ndarray, frictions: np.ndarray = frictions) -> rg.Grasp:
            inward = -np.column_stack([np.cos(angles), np.sin(angles)])
            return rg.Grasp(rg.Contact(-radius * n, n, mu) for n, mu in zip(inward, frictions, strict=True))

        found = rg.sensitivity(on_disc(angles), load)
        for i in (0, 1):  # along the tangent is clockwise
            turn = -step / radius * np.eye(2)[i]
            behind, ahead = (rg.choose_state(on_disc(angles + d), load).value for d in (-turn, turn))
            expected = found.position[i] - found.normal[i] / radius
            assert (ahead - behind) / (2 * step) == pytest.approx(expected, abs=1e-5)


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_units_frame_and_order_transform_the_rates(objective: str) -> None:
    rng = np.random.default_rng(4)
    for case in range(4):
        grasp, load, options = limited(rng, 3, case)
        frame, order = numbered(rng), rng.permutation(3)
        here = rg.sensitivity(grasp, load, objective, **options)
        there = rg.sensitivity(frame.grasp(grasp, order), frame.load(load), objective, **options)
        value = frame.value(1.0, objective)
        before, after = here.effects(1.0), there.effects(1.0)
        room = 2e-5 * max(np.nanmax(abs(effect), initial=0.0) for effect in before.values())
        for parameter in PARAMETERS[:-1]:
            assert after[parameter] / value == pytest.approx(before[parameter][order], abs=room, nan_ok=True)
        turned = np.append(frame.rotation @ before["load"][:2], before["load"][2])
        assert after["load"] / value == pytest.approx(turned, abs=room)
        assert there.position * frame.length / value == pytest.approx(here.position[order], abs=room)


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_with_a_reserve_value_and_rates_are_those_of_the_friction_left(objective: str) -> None:
    grasp, load = comfortable_triple(np.random.default_rng(6))
    kept = rg.Grasp(replace(c, friction=0.9 * c.friction) for c in grasp)
    with_reserve = rg.sensitivity(grasp, load, objective, reserve=0.1)
    less = rg.sensitivity(kept, load, objective, reserve=0)
    assert with_reserve.value == pytest.approx(less.value, rel=1e-6, abs=2e-7)
    assert with_reserve.friction == pytest.approx(0.9 * less.friction, abs=1e-4 * (1 + abs(less.value)))
    assert with_reserve.normal == pytest.approx(less.normal, abs=1e-4 * (1 + abs(less.value)))


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_a_frictionless_contact_has_no_rate_by_friction_and_all_others(objective: str) -> None:
    rng = np.random.default_rng(8)
    agreed = 0
    for _ in range(6):
        grasp, load = comfortable_triple(rng)
        contacts = [replace(c, max_force=50, friction=c.friction if i else 0.0) for i, c in enumerate(grasp)]
        try:
            easy = rg.choose_state(rg.Grasp(contacts), load, "peak").value < 10
        except rg.Infeasible:
            easy = False
        if not easy:
            continue
        found = rg.sensitivity(rg.Grasp(contacts), load, objective)
        assert np.isnan(found.friction).tolist() == [True, False, False]
        for rate, behind, ahead in sides(found, 3e-4):
            room = 3e-4 * max(1.0, abs(rate), abs(found.value))
            if abs(ahead - behind) < 10 * room:
                assert min(behind, ahead) - room <= rate <= max(behind, ahead) + room
                agreed += 1
    assert agreed > 40


def test_an_idle_finger_has_rates_zero() -> None:
    """A finger of no use to the angle margin: the others hold with more than its cone has."""
    contacts = [rg.Contact([-1, 0], [1, 0], 0.9), rg.Contact([1, 0], [-1, 0], 0.8)]
    idle = rg.Contact([0, 1], [0, -1], 0.01)
    grasp, load = rg.Grasp([*contacts, idle]), rg.Wrench([0, -1])
    found = rg.sensitivity(grasp, load, "angle", max_force=10)
    two = rg.sensitivity(rg.Grasp(contacts), load, "angle", max_force=10)
    assert found.friction[2] == found.position[2] == found.normal[2] == 0
    assert found.normal[:2] == pytest.approx(two.normal, abs=1e-5)


# -- the failure contract ---------------------------------------------------------------------------------

PINCH = rg.Grasp(
    [rg.Contact([-1, 0], [1, 0], 0.5, name="left"), rg.Contact([1, 0], [-1, 0], 0.8, name="right")]
)
WEIGHT = rg.Wrench([0, -2])


@pytest.mark.parametrize(
    ("arguments", "options", "message"),
    [
        ((PINCH, WEIGHT, "ease"), {}, "objective must be one of angle, force, effort, peak, peak_normal"),
        ((PINCH, WEIGHT), {"peak_ratio": 1}, "peak_ratio must be greater than 1 for a sensitivity: 1 leaves"),
        ((PINCH, WEIGHT), {"peak_ratio": 0.5}, "peak_ratio must be at least 1, got 0.5"),
        ((PINCH, WEIGHT), {"max_force": -1}, "max_force must be greater than 0, got -1"),
        ((PINCH, WEIGHT), {"reserve": 1}, "reserve must be less than 1"),
        ((PINCH, rg.Wrench([0, 0])), {}, "under a zero load needs max_force"),
        ((PINCH, rg.Wrench([0, 0]), "effort"), {}, "no finger pushes in the state best for 'effort', so its"),
        ((rg.Grasp([rg.Contact([0, 0], [0, 1], 1)]), WEIGHT), {}, "needs two contacts or more"),
    ],
)
def test_bad_arguments_are_named(arguments: tuple, options: dict, message: str) -> None:
    with pytest.raises(rg.InvalidInput, match=message):
        rg.sensitivity(*arguments, **options)


def test_a_grasp_that_cannot_hold_says_why() -> None:
    away = rg.Grasp([rg.Contact([-1, 0], [0, -1], 0.1), rg.Contact([1, 0], [0, -1], 0.1)])
    with pytest.raises(rg.Infeasible) as caught:
        rg.sensitivity(away, WEIGHT)
    assert caught.value.certificate.is_proof


def test_an_answer_without_duals_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    def undecided(program: Program, backend: str) -> Solution:
        return replace(solve(program, backend), status=Status.INFEASIBLE)

    monkeypatch.setattr(envelope, "solve", undecided)
    with pytest.raises(rg.SolverFailed, match="no duals to differentiate by: clarabel: INFEASIBLE"):
        rg.sensitivity(PINCH, WEIGHT, "effort")


# -- table and picture ------------------------------------------------------------------------------------


def test_the_text_has_every_rate_with_its_unit() -> None:
    assert str(rg.sensitivity(PINCH, WEIGHT, "effort")) == (
        "effort 10 N^2 under Wrench(force=(0, -2), torque=0); it changes by\n"
        "              friction      position        normal\n"
        "                 [N^2]       [N^2/m]     [N^2/rad]\n"
        "left               -32           -16           -40\n"
        "right                0           -16             0\n"
        "load           force x       force y        torque\n"
        "               [N^2/N]       [N^2/N]   [N^2/(N m)]\n"
        "                     4           -10             8"
    )


def test_the_table_has_a_row_for_each_number() -> None:
    found = rg.sensitivity(PINCH, WEIGHT, "friction_use", max_force=8)
    table = found.to_dataframe()
    assert table.columns.tolist() == ["of", "parameter", "rate", "unit"]
    assert len(table) == 4 * 2 + 3
    rows = table.set_index(["of", "parameter"])
    assert rows.loc[("right", "normal"), "rate"] == found.normal[1]
    assert rows.loc[("left", "limit"), "unit"] == "1/N"
    assert rows.loc[("left", "friction"), "unit"] == "-"
    assert rows.loc[("load", "torque")].tolist() == [found.load[2], "1/(N m)"]


def test_a_table_needs_pandas(monkeypatch: pytest.MonkeyPatch) -> None:
    found, real = rg.sensitivity(PINCH, WEIGHT), builtins.__import__

    def without_pandas(name: str, *args, **kwargs):
        if name == "pandas":
            raise ImportError(name)
        return real(name, *args, **kwargs)

    monkeypatch.setattr(builtins, "__import__", without_pandas)
    with pytest.raises(ImportError, match=r"to_dataframe needs pandas: pip install 'regrasp\[pandas\]'"):
        found.to_dataframe()


def test_values_are_frozen_and_compare() -> None:
    found = rg.sensitivity(PINCH, WEIGHT)
    assert found == rg.sensitivity(PINCH, WEIGHT)
    assert found != rg.sensitivity(PINCH, WEIGHT, "force")
    with pytest.raises(ValueError, match="read-only"):
        found.normal[0] = 1.0


@pytest.mark.parametrize(
    ("objective", "options"), [("angle", {}), ("effort", {}), ("force", {"max_force": 8})]
)
def test_bars_are_the_effects_of_a_hundredth(objective: str, options: dict) -> None:
    found = rg.sensitivity(PINCH, WEIGHT, objective, **options)
    ax = plots.plot_sensitivity(found, units=plots.Units("mm", "N"))
    drawn = np.array([bar.get_width() for bar in ax.patches])
    effects, factor = found.effects(), np.degrees(1.0) if objective == "angle" else 1.0
    shown = [effects[name] for name in PARAMETERS if not np.isnan(effects[name]).any()]
    assert drawn == pytest.approx(factor * np.concatenate(shown))
    labels = [label.get_text() for label in ax.get_yticklabels()]
    assert labels[:3] == ["friction\n+1%", "position\n+0.01 mm", "normal\n+0.57 deg"]
    assert ("force limit\n+1%" in labels) == ("max_force" in options)
    arrow = "better \N{RIGHTWARDS ARROW}" if objective in BETTER_LARGE else "\N{LEFTWARDS ARROW} better"
    assert ax.get_xlabel().startswith(f"change ({arrow}) [")
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["left", "right"]


def test_a_notebook_shows_the_picture() -> None:
    found = rg.sensitivity(PINCH, WEIGHT)
    assert found._repr_png_() == sensitivity_png(found)
    assert found._repr_png_().startswith(b"\x89PNG")

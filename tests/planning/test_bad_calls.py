"""What choices of states, loci, changes of fingers and time functions refuse, to the word."""

import re
from collections.abc import Callable
from math import inf, nan

import numpy as np
import pytest

import regrasp as rg
from paper import GRASP, LOAD, STATE
from refusals import check_error
from regrasp.programs import available_backends

pytestmark = pytest.mark.contract

METHODS = ", ".join(("auto", "closed-form", *available_backends()))

NO_EQUILIBRIUM = (
    "start: the forces are no equilibrium inside the friction cones and limits; the nearest one differs "
    "by {}, more than 0.001 of the largest force {}; correct them, or allow more by balance_tolerance"
)

P1, P2, P3 = GRASP
TWO, REMOVAL = GRASP.without("P3"), rg.plan_removal(STATE, "P3")
LOCUS = rg.EquilibriumLocus(TWO, LOAD)
SPACE = rg.Grasp([rg.Contact([np.cos(a), np.sin(a), 0], [-np.cos(a), -np.sin(a), 0], 1) for a in (0, 2, 4)])
PAIRS = ([0.0, 0.0], [1.0, 0.0], 0.5, [1.0, 0.0], [-1.0, 0.0], 0.5, [0.0, -1.0])

Call = Callable[[], object]
CALLS: dict[str, tuple[Call, type[Exception], str | re.Pattern[str]]] = {
    "choose_state: unknown objective": (
        lambda: rg.choose_state(TWO, LOAD, "safest"),
        rg.InvalidInput,
        "objective must be one of angle, force, effort, peak, peak_normal, friction_use, sum_normal, wrench; "
        "got 'safest'",
    ),
    "choose_state: unknown method": (
        lambda: rg.choose_state(TWO, LOAD, method="magic"),
        rg.InvalidInput,
        f"method must be one of {METHODS}; got 'magic'",
    ),
    "choose_state: closed form of three": (
        lambda: rg.choose_state(GRASP, LOAD, method="closed-form"),
        rg.InvalidInput,
        "the closed form chooses for two planar contacts, got 3 of dimension 2; use method='auto'",
    ),
    "choose_state: in space without facets": (
        lambda: rg.choose_state(SPACE, rg.Wrench([0, 0, -1]), "effort", method="daqp"),
        rg.InvalidInput,
        re.compile(r"back end 'daqp' solves QPs only .* use linearised cones \(facets=.*\), or one of .*"),
    ),
    "choose_state: one contact": (
        lambda: rg.choose_state(rg.Grasp([P1]), LOAD),
        rg.Infeasible,
        re.compile(r"no forces of P1 balance .*: none resists turning about P1, about which the load has .*"),
    ),
    "choose_state: peak ratio below 1": (
        lambda: rg.choose_state(TWO, LOAD, peak_ratio=0.5),
        rg.InvalidInput,
        "peak_ratio must be at least 1, got 0.5",
    ),
    "choose_state: reserve of everything": (
        lambda: rg.choose_state(TWO, LOAD, reserve=1),
        rg.InvalidInput,
        "reserve must be less than 1, a fraction of the friction, got 1",
    ),
    "choose_state: zero load": (
        lambda: rg.choose_state(TWO, rg.Wrench([0, 0])),
        rg.InvalidInput,
        "objective 'angle' under a zero load needs max_force: any squeeze holds it, so no force follows from "
        "the load",
    ),
    "choose_state: cannot hold": (
        lambda: rg.choose_state(TWO, rg.Wrench([0, 4])),
        rg.Infeasible,
        "no forces of P1, P2 inside their friction cones balance Wrench(force=(0, 4), torque=0): "
        "the object escapes by sliding along (0, 1); with a friction of at least 1.51 at every contact, it "
        "would do",
    ),
    "EquilibriumLocus: three contacts": (
        lambda: rg.EquilibriumLocus(GRASP, LOAD),
        rg.InvalidInput,
        "an equilibrium locus needs two planar contacts, got 3 of dimension 2; use grasp.subset([...]), "
        "or a SqueezeLocus",
    ),
    "EquilibriumLocus: squeeze outside": (
        lambda: LOCUS.state(9.0),
        rg.InvalidInput,
        "squeeze 9.0 is not on the locus; the locus is [1.35749126, 2.25329768]",
    ),
    "locus_intervals: zero normal": (
        lambda: rg.locus_intervals([0, 0], [0, 0], *PAIRS[2:]),
        rg.InvalidInput,
        "n1 must not be zero; give the direction that points into the object",
    ),
    "locus_intervals: coincident": (
        lambda: rg.locus_intervals([1, 0], *PAIRS[1:]),
        rg.InvalidInput,
        "r1 and r2 coincide in at least one pair; place contacts at different points",
    ),
    "locus_intervals: NaN": (
        lambda: rg.locus_intervals([[0, 0], [nan, 1]], *PAIRS[1:]),
        rg.InvalidInput,
        "r1 must be finite, got 1 entries that are not",
    ),
    "locus_intervals: wrong shape": (
        lambda: rg.locus_intervals([0, 0, 0], *PAIRS[1:]),
        rg.InvalidInput,
        "r1 must have shape (..., 2), got (3,)",
    ),
    "locus_intervals: shapes that do not broadcast": (
        lambda: rg.locus_intervals(np.zeros((3, 2)), np.ones((4, 2)), *PAIRS[2:]),
        rg.InvalidInput,
        "leading shapes must broadcast, got r1 (3,), n1 (4,), mu1 (), r2 (), n2 (), mu2 (), force (), "
        "torque ()",
    ),
    "best_squeezes: negative friction": (
        lambda: rg.best_squeezes(*PAIRS[:2], [0.5, -0.5], *PAIRS[3:]),
        rg.InvalidInput,
        "mu1 must be at least 0 everywhere",
    ),
    "best_squeezes: zero load": (
        lambda: rg.best_squeezes(*PAIRS[:6], [0, 0]),
        rg.InvalidInput,
        "objective 'angle' under a zero load needs max_force",
    ),
    "best_squeezes: zero limit": (
        lambda: rg.best_squeezes(*PAIRS, max_force=0),
        rg.InvalidInput,
        "max_force must be greater than 0 everywhere",
    ),
    "plan_removal: no load": (
        lambda: rg.plan_removal(GRASP, "P3"),
        rg.InvalidInput,
        "a plan from a grasp needs the load: load=Wrench(force=[...])",
    ),
    "plan_removal: two loads": (
        lambda: rg.plan_removal(STATE, "P3", load=rg.Wrench([0, -1])),
        rg.InvalidInput,
        "the start state has the load Wrench(force=(-1.5, -3.5), torque=0); leave load out, "
        "got Wrench(force=(0, -1), torque=0)",
    ),
    "plan_removal: of nothing": (
        lambda: rg.plan_removal(None, "P3"),
        rg.InvalidInput,
        "start must be a GraspState or a Grasp, got None",
    ),
    "plan_removal: unknown contact": (
        lambda: rg.plan_removal(STATE, "P4"),
        rg.InvalidInput,
        "no contact 'P4' in this grasp; it has P1, P2, P3",
    ),
    "plan_removal: no duration": (
        lambda: rg.plan_removal(STATE, "P3", duration=0),
        rg.InvalidInput,
        "duration must be greater than 0, got 0",
    ),
    "plan_removal: scaling of no kind": (
        lambda: rg.plan_removal(STATE, "P3", scaling="spline"),
        rg.InvalidInput,
        "scaling must be a TimeScaling, got 'spline'",
    ),
    "plan_removal: end with the finger": (
        lambda: rg.plan_removal(STATE, "P3", end=STATE),
        rg.InvalidInput,
        "end: P3 must carry no force, got [0.7199, -3.919]",
    ),
    "plan_removal: end of other contacts": (
        lambda: rg.plan_removal(STATE, "P3", end=STATE.without("P1")),
        rg.InvalidInput,
        re.compile(
            r"end must be a GraspState of P1, P2, or of the whole grasp with P3 idle, under the start's "
            r"load; got GraspState under .*"
        ),
    ),
    "plan_removal: escape": (
        lambda: rg.plan_removal(STATE, "P1"),
        rg.Infeasible,
        "no forces of P2, P3 inside their friction cones balance Wrench(force=(-1.5, -3.5), torque=0): "
        "the object escapes by turning counter-clockwise about (4.13793, -5.7931); with a friction of at "
        "least 0.308 at every contact, it would do",
    ),
    "plan_removal: the last finger": (
        lambda: rg.plan_removal(rg.Grasp([P1]), "P1", load=LOAD),
        rg.InvalidInput,
        "the last contact, 'P1', cannot be taken from a grasp",
    ),
    "plan_addition: name for a contact": (
        lambda: rg.plan_addition(STATE.without("P3"), "P3"),
        rg.InvalidInput,
        "contact must be the Contact that arrives, got 'P3'",
    ),
    "plan_addition: where a finger is": (
        lambda: rg.plan_addition(TWO, rg.Contact([-4, -4], [1, 1], 0.3, name="Q"), load=LOAD),
        rg.InvalidInput,
        "contacts 'P1' and 'Q' coincide at [-4.0, -4.0]; place them at different points",
    ),
    "plan_addition: start far from equilibrium": (
        lambda: rg.plan_addition(rg.GraspState(TWO, LOAD, [[1, 1], [0, 1]]), P3),
        rg.InvalidInput,
        NO_EQUILIBRIUM.format("1.48", "1.414"),
    ),
    "TimeScaling: no duration": (
        lambda: rg.TimeScaling.linear(-1),
        rg.InvalidInput,
        "duration must be greater than 0, got -1",
    ),
    "TimeScaling: rising": (
        lambda: rg.TimeScaling.spline(1, (1, 0.2, 0.4, 0)),
        rg.InvalidInput,
        "control values must fall from 1 to 0, got (1.0, 0.2, 0.4, 0.0)",
    ),
    "TimeScaling: degree too high": (
        lambda: rg.TimeScaling(1, (1, 0), 2),
        rg.InvalidInput,
        "degree must be from 1 to 1, got 2",
    ),
    "TimeScaling: no rate": (
        lambda: rg.TimeScaling.fastest([[1, 0]], 0),
        rg.InvalidInput,
        "rate_limit must be greater than 0, got 0",
    ),
    "TimeScaling: nothing limited": (
        lambda: rg.TimeScaling.fastest([[1, 0]], inf),
        rg.InvalidInput,
        "no force that changes has a rate limit, so no shortest duration follows",
    ),
    "TimeScaling: rates of other fingers": (
        lambda: rg.TimeScaling.fastest([[1, 0], [0, 1]], [1, 2, 3]),
        rg.InvalidInput,
        "rate_limit must be a number or have shape (2,), got [1, 2, 3]",
    ),
    "Transition: after the end": (
        lambda: REMOVAL.forces(1.5),
        rg.InvalidInput,
        "t must lie in [0, 1] s, got 1.5",
    ),
    "Transition: NaN": (
        lambda: REMOVAL.forces([0.0, nan]),
        rg.InvalidInput,
        "t must lie in [0, 1] s, got [0.0, nan]",
    ),
    "Transition: words": (
        lambda: REMOVAL.forces("now"),
        rg.InvalidInput,
        "t must be numbers, got 'now'",
    ),
    "Transition: no rate": (
        lambda: REMOVAL.times(0),
        rg.InvalidInput,
        "rate must be greater than 0, got 0",
    ),
}


@pytest.mark.parametrize("name", CALLS)
def test_bad_call(name: str) -> None:
    check_error(*CALLS[name])

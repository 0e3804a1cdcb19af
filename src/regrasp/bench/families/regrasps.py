"""All states of a whole regrasp in one program."""

from collections.abc import Iterator

import numpy as np

from regrasp.bench.families.grasps import planar
from regrasp.bench.families.truth import certified
from regrasp.bench.problems.problem import BenchProblem, Family
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.planning.regrasps.joint_states import SequenceState, sequence_program
from regrasp.planning.states.solving import force_unit

_STEPS = (4, 8, 16, 32, 64)
_LIMIT = 10.0


def _problems() -> Iterator[BenchProblem]:
    for number, steps in enumerate(_STEPS):
        rng = np.random.default_rng([4, number])
        whole, load = planar(rng, 3)
        unit = force_unit(whole, load)
        states, contacts = [], list(enumerate(whole))
        for step in range(steps):
            if step:  # one finger goes on a little along the boundary
                finger = step % 3
                _, old = contacts[finger]
                moved = Contact(old.position * rng.uniform(0.97, 1.03), old.normal, old.friction)
                contacts[finger] = (3 + step, moved)
            places, grasp = (
                tuple(place for place, _ in contacts),
                Grasp(c.named(f"P{p}") for p, c in contacts),
            )
            states.append(
                SequenceState(grasp, load, places, grasp.frictions.tolist(), [_LIMIT * unit] * 3, (True,) * 3)
            )
        program = sequence_program(states, unit)
        yield BenchProblem(f"regrasps/margin/{steps:03d}", "regrasps", program, certified(program))


REGRASPS = Family(
    "regrasps",
    "the states of a regrasp in which one of three fingers moves at a time, 4 to 64 states",
    "maximise the worst distance to the cones over all states, subject to equilibrium, cones and force "
    "limits of each (second order)",
    _problems,
)

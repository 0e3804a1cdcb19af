"""The program of a path, row by row, against conditions and costs in loops over fingers and instants."""

from itertools import pairwise
from math import inf

import numpy as np
import pytest

import regrasp as rg
from regrasp.planning.changes.path_program import OBJECTIVES, PathTask, path_program
from regrasp.planning.states.faces import cone_faces, round_faces
from regrasp.programs import Cone
from space import random_grasp

pytestmark = pytest.mark.oracle

RULES = ([[1.0, 0.5], [0.2, -1.0]], [2.0, 3.0])  # a normal and a side force


def fingers(kind: str, rng: np.random.Generator) -> list[rg.Contact]:
    """Four, the second smooth, the third and last with linear limits."""
    if kind == "plane":
        points, normals = rng.normal(size=(2, 4, 2))
        found = [rg.Contact(p, n, m) for p, n, m in zip(points, normals, [0.3, 0.0, 0.7, 1.4], strict=True)]
        rules = RULES
    else:
        found = list(random_grasp(rng, 4))
        found[1] = found[1].changed(friction=0.0)
        rules = ([[1.0, 0.5, 0.1], [0.2, -1.0, 0.3]], [2.0, 3.0])
    if kind == "soft":
        found[0] = found[0].changed(torsion=0.4)
        found[2] = found[2].changed(torsion=0.2)
        rules = ([[*row, 0.25] for row in rules[0]], rules[1])
        return [found[0], found[1], found[2].changed(limits=rules), found[3]]
    return [*found[:2], *(finger.changed(limits=rules) for finger in found[2:])]


def task(kind: str, rng: np.random.Generator, **changes) -> PathTask:
    """Everything that a path may be asked to keep, of some fingers each."""
    grasp, K = rg.Grasp(fingers(kind, rng)), 6
    wide = grasp.width
    active = np.ones((K, 4), dtype=bool)
    active[2:, 3] = active[3, 1] = False
    times = np.cumsum(rng.uniform(0.1, 1.0, K))
    phases = np.concatenate([[0.0], np.sort(rng.uniform(0.1, 0.9, K - 2)), [1.0]])
    given = {
        "grasp": grasp, "times": times - times[0], "loads": rng.normal(size=(K, len(grasp.lengths))),
        "start": rng.normal(size=(4, wide)), "end": rng.normal(size=(4, wide)), "active": active,
        "phases": phases, "frictions": 0.9 * grasp.frictions, "limits": np.array([3.0, inf, 4.0, 5.0]),
        "rates": np.array([inf, 2.0, 3.0, 4.0]), "least_normals": np.array([0.2, 0.1, 0.0, 0.3]),
        "stays": np.array([True, True, True, False]), "unit": 2.5,
        "row_bounds": None if grasp.limit_rows is None else 0.8 * grasp.limit_rows.bounds,
        "set_back": rng.uniform(0.1, 0.5, (4, 2)) if kind == "plane" else None,
    }  # fmt: skip
    return PathTask(**given | changes)


def all_forces(asked: PathTask, x: np.ndarray) -> np.ndarray:
    """(K, n, w) what unknowns stand for: counted from the straight path, instant by instant."""
    forces, at = np.zeros((len(asked.times), *asked.start.shape)), 0
    forces[0], forces[-1] = asked.start, asked.end
    for k in range(1, len(forces) - 1):
        for i in np.flatnonzero(asked.active[k]):
            s, w = asked.phases[k], asked.grasp.width
            forces[k, i] = (1 - s) * asked.start[i] + s * asked.end[i] + asked.unit * x[at : at + w]
            at += w
    return forces


def split(asked: PathTask, i: int, f: np.ndarray) -> tuple[float, np.ndarray]:
    """The normal force of a finger and what is across it, a soft finger's torque by the rule mu / e."""
    n = asked.grasp[i].normal
    push = float(n @ f[: n.size])
    return push, np.append(f[: n.size] - push * n, f[n.size :])


def expected(
    asked: PathTask, objective: str, x: np.ndarray, least: float, facets: int | None = None
) -> dict[Cone, list]:
    """The conditions: what must be 0, what must not be negative, and radii with vectors inside them."""
    forces, K, n = all_forces(asked, x), len(asked.times), len(asked.grasp)
    grasp, t = asked.grasp, float(x[-1]) * asked.unit
    zero, positive, inside = [], [], []
    margin = least + t if objective == "force" else least
    for k in range(1, K - 1):
        total = asked.loads[k].copy()
        for i in range(n):
            f, r, d = forces[k, i], grasp[i].position, grasp.dimension
            total[:d] += f[:d]
            total[d:] += r[0] * f[1] - r[1] * f[0] if d == 2 else np.cross(r, f[:3])
            if grasp.width == 4:
                total[3:] += (
                    f[3] * (grasp[i].torsion / grasp[i].friction if grasp[i].torsion else 0) * grasp[i].normal
                )
            if not asked.active[k, i]:
                continue
            push, across = split(asked, i, f)
            mu = asked.frictions[i]
            kept = margin * np.sqrt(1 + mu * mu) if asked.stays[i] else 0.0
            if mu == 0:
                positive.append(push)
                tangents = grasp.cones.tangents[i]
                zero += (tangents @ f).tolist()
            elif d == 2:
                side = float(grasp.tangents[i] @ f)
                back = (0, 0) if asked.set_back is None else asked.set_back[i]
                positive += [mu * push - side - kept - back[0], mu * push + side - kept - back[1]]
            elif facets is None:
                inside.append((mu * push - kept, across))
            else:
                positive += (cone_faces(grasp, asked.frictions, facets)[i] @ f - kept).tolist()
            if asked.least_normals[i] > 0:
                positive.append(push - asked.least_normals[i])
            if asked.limits[i] < inf:
                inside.append((asked.limits[i], f))
            if objective == "peak":
                inside.append((t, f))
            if grasp.limit_rows is not None and asked.row_bounds is not None:
                rows = grasp.limit_rows
                for m in np.flatnonzero(rows.contacts == i):
                    positive.append(asked.row_bounds[m] - rows.rows[m] @ f)
        zero += (total / grasp.lengths).tolist()
    if objective == "force":
        margins = []
        for ends in (asked.start, asked.end):
            for i in np.flatnonzero(asked.stays):
                push, across = split(asked, i, ends[i])
                mu = asked.frictions[i]
                margins.append((mu * push - np.linalg.norm(across)) / np.sqrt(1 + mu * mu))
        positive.append(min(margins) - t)
    for k, (before, after) in enumerate(pairwise(forces)):
        for i in np.flatnonzero((asked.active[k] | asked.active[k + 1]) & (asked.rates < inf)):
            room = asked.rates[i] * (asked.times[k + 1] - asked.times[k])
            room *= t / asked.unit if objective == "rate" else 1.0
            inside.append((room, after[i] - before[i]))
    if facets is not None:
        directions, cosines = round_faces(facets, grasp.dimension)
        positive += [c * r - u @ v for r, v in inside for u, c in zip(directions, cosines, strict=True)]
        inside = []
    lengths = [(r, np.linalg.norm(v)) for r, v in inside]
    return {Cone.ZERO: np.abs(zero), Cone.NONNEGATIVE: positive, Cone.SECOND_ORDER: lengths}


def found(program, x: np.ndarray) -> dict[Cone, list]:
    """What is left of each row."""
    s, at = program.b - program.A @ x, 0
    every: dict[Cone, list] = {cone: [] for cone in Cone}
    for block in program.blocks:
        rows = s[at : at + block.rows]
        at += block.rows
        if block.cone is Cone.SECOND_ORDER:
            every[block.cone] += [(r[0], np.linalg.norm(r[1:])) for r in rows.reshape(-1, block.size)]
        else:
            every[block.cone] += np.abs(rows).tolist() if block.cone is Cone.ZERO else rows.tolist()
    return every


def cost(asked: PathTask, objective: str, x: np.ndarray) -> float:
    if objective not in ("change", "effort"):
        return -x[-1] if objective == "force" else x[-1]
    forces = all_forces(asked, x) / asked.unit
    if objective == "change":
        steps = zip(pairwise(forces), np.diff(asked.phases), strict=True)
        return sum(((after - before) ** 2).sum() / share for (before, after), share in steps)
    shares = (asked.times[2:] - asked.times[:-2]) / 2 / asked.times[-1]
    return sum((f**2).sum() * share for f, share in zip(forces[1:-1], shares, strict=True))


@pytest.mark.parametrize(
    ("kind", "facets"), [("plane", None), ("plane", 5), ("space", None), ("space", 4), ("soft", None)]
)
@pytest.mark.parametrize("objective", OBJECTIVES)
def test_every_row_is_a_condition_and_every_condition_a_row(
    kind: str, facets: int | None, objective: str
) -> None:
    rng = np.random.default_rng(OBJECTIVES.index(objective))
    asked = task(kind, rng)
    least = 0.0 if objective == "force" else 0.3
    program = path_program(asked, objective, least_margin=least, facets=facets)
    x, y = rng.normal(size=(2, program.q.size))
    want, have = expected(asked, objective, x, least, facets), found(program, x)
    for cone in Cone:
        assert len(want[cone]) == len(have[cone])
        assert np.array(sorted(have[cone])) * asked.unit == pytest.approx(
            np.array(sorted(want[cone])), rel=1e-9
        )
    values = [z @ (program.P @ z) / 2 + program.q @ z for z in (x, y)]
    costs = [cost(asked, objective, z) for z in (x, y)]
    assert values[0] - values[1] == pytest.approx(costs[0] - costs[1], rel=1e-9)
    assert program.size == 1.0


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_what_is_not_asked_has_no_row(objective: str) -> None:
    """No limits, no rates, no least normal forces, and linear limits that are let go."""
    for kind in ("plane", "space"):
        none = np.full(4, inf)
        free = {
            "limits": none,
            "rates": none,
            "least_normals": np.zeros(4),
            "row_bounds": None,
            "set_back": None,
        }
        asked = task(kind, np.random.default_rng(1), **free)
        program = path_program(asked, objective)
        want = expected(asked, objective, np.zeros(program.q.size), 0.0)
        assert {cone: len(rows) for cone, rows in found(program, 0 * program.q).items()} == {
            cone: len(rows) for cone, rows in want.items()
        }


def test_an_objective_has_its_word() -> None:
    with pytest.raises(
        rg.InvalidInput, match=r"objective of a path must be one of change, effort, .*; got 'jerk'"
    ):
        path_program(task("plane", np.random.default_rng(0)), "jerk")

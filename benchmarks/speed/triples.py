"""Three fingers in space: speed of the triple graph beside one Clarabel solve each, and what pyramids lose.

Rows of ``space.py``. Answers are compared before times are.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from time import perf_counter

import clarabel
import numba
import numpy as np
from scipy import sparse

import regrasp as rg
from closed_form import QUICK as QUICK_EFFORT
from closed_form import Effort as Times
from regrasp.planning.holds.triples import TripleGraph, directions
from report import Measure, Row
from timing import Side

FRICTION = 0.5
AXES = np.array([1.0, 0.8, 0.5])


@dataclass(frozen=True)
class Effort:
    """How much to measure: points and directions of the table, programs solved for time and for losses."""

    times: Times
    points: int = 60
    directions: int = 100
    sample: int = 200
    judged: int = 4_000


FULL = Effort(Times(rounds=5))
QUICK = Effort(replace(QUICK_EFFORT, rounds=2), points=10, directions=6, sample=10, judged=60)

Program = tuple[object, ...]
"""Arguments of ``clarabel.DefaultSolver``."""


def triple_graph(effort: Effort, facets: int) -> TripleGraph:
    """Points spread at random over an ellipsoid, their normals its own, under forces in all directions."""
    on_ball = np.random.default_rng(0).normal(size=(effort.points, 3))
    on_ball /= np.linalg.norm(on_ball, axis=1)[:, None]
    contacts = [rg.Contact(p * AXES, -p / AXES, FRICTION) for p in on_ball]
    return TripleGraph(tuple(contacts), directions(effort.directions), facets=facets)


def exact_program(graph: TripleGraph, t: int, o: int) -> Program:
    """The feasibility of one triple over its exact cones, ready for Clarabel: G f = -w, f_i in K_i."""
    grasp = rg.Grasp([graph.contacts[i] for i in graph.triples[t]])
    rows, cones = [grasp.matrix], [clarabel.ZeroConeT(6)]
    for i, contact in enumerate(grasp):
        n = contact.normal
        cone = np.zeros((4, 9))
        cone[0, 3 * i : 3 * i + 3] = -contact.friction * n
        cone[1:, 3 * i : 3 * i + 3] = np.outer(n, n) - np.eye(3)
        rows.append(cone)
        cones.append(clarabel.SecondOrderConeT(4))
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    right = np.r_[-graph.loads[o], np.zeros(12)]
    matrix = sparse.csc_matrix(np.vstack(rows))
    return sparse.csc_matrix((9, 9)), np.zeros(9), matrix, right, cones, settings


def holds_by_clarabel(program: Program) -> bool:
    """Clarabel's verdict."""
    return str(clarabel.DefaultSolver(*program).solve().status) in ("Solved", "AlmostSolved")


def picked(graph: TripleGraph, count: int) -> list[tuple[int, int]]:
    """Places (o, t): half of them hold, half do not."""
    rng, holds = np.random.default_rng(1), graph.holds
    chosen = [rng.choice(np.argwhere(holds == v), count // 2, replace=False) for v in (True, False)]
    return [(o, t) for o, t in np.vstack(chosen).tolist()]


def rows(effort: Effort) -> Iterator[Row]:
    """The verdict on one triple under one load against Clarabel; the whole table with margins."""
    threads = numba.get_num_threads()
    for facets in (8, 16):
        graph = triple_graph(effort, facets)
        places = picked(graph, effort.sample)
        programs = [exact_program(graph, t, o) for o, t in places]
        theirs = [holds_by_clarabel(program) for program in programs]
        if any(graph.holds[o, t] and not exact for (o, t), exact in zip(places, theirs, strict=True)):
            raise RuntimeError("a pyramid holds what its cone does not")
        size = graph.holds.size
        clarabel_side = Side(lambda _, all_=programs: [holds_by_clarabel(p) for p in all_], len(programs))
        for count in sorted({1, threads}):

            def verdicts(g: TripleGraph, count: int = count) -> None:
                numba.set_num_threads(count)
                _ = g.holds
                numba.set_num_threads(threads)

            ours = Side(verdicts, graph.holds.size, lambda m=facets: triple_graph(effort, m))
            table = f"{effort.points} points x {effort.directions} loads, {facets} facets"
            yield Row.of(
                f"triples_{facets}_{count}", f"{table}, verdict of a triple, threads: {count}",
                "one Clarabel solve over the exact cones, prebuilt",
                effort.times.of(ours, clarabel_side), Measure.FASTER, 30.0,
                "all rows are tried for every load that no known motion refutes",
            )  # fmt: skip
    graph = triple_graph(effort, 8)
    began = perf_counter()
    size = graph.margins.size
    yield Row.alone(
        "triples_margins", f"all margins, {size / 1e6:.3g} million, 8 facets, threads: {threads}",
        perf_counter() - began, Measure.SECONDS, 10.0, "some fourteen programs for each triple that holds",
    )  # fmt: skip


def losses(effort: Effort) -> Iterator[Row]:
    """Of the triples that hold in their exact cones, the share that pyramids of so many facets miss."""
    graphs = {facets: triple_graph(effort, facets) for facets in (4, 8, 16, 32)}
    graph = graphs[4]
    rng = np.random.default_rng(2)
    places = rng.integers((len(graph.loads), len(graph.triples)), size=(effort.judged, 2))
    exact = np.array([holds_by_clarabel(exact_program(graph, t, o)) for o, t in places.tolist()])
    what = f"of {exact.sum():,} random triples that hold in their cones, missed by pyramids of"
    for facets, inner in graphs.items():
        missed = 1 - inner.holds[tuple(places[exact].T)].mean()
        yield Row.alone(f"missed_{facets}", f"{what} {facets} facets", 100 * missed, Measure.PERCENT)

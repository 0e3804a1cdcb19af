"""Regions on drawings with rounded corners, attacked by linear programs that share nothing with them.

    python benchmarks/placing/regions/hostile_fillets.py [--count 300] [--seed 1]

Polygons of three to seven vertices, some of them hollow, whose corners are arcs from a thousandth to all of
the room that there is, half of the shorter side; read from SVG, so that arcs are chords that turn by two
degrees at most. Two to four fingers, half of them on arcs, hold one to six random loads with friction 0.1 to
1.5, with or without a limit. Within the regions placements are drawn, at ends of arcs, beside vertices and
anywhere, and the least largest force of each is bounded from both sides by linear programs over directions of
forces: one that needs more than ``max_force`` is a lie. Then each end that no side's end stops is moved out
by a share of its arc, and is called sharp where a placement at the ends then needs more.
"""

import argparse
from collections import Counter
from itertools import product
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time

import numpy as np
from scipy.optimize import linprog

import regrasp as rg

INSIDE, COARSE, FINE = 24, 33, 513  # placements of a region; directions of forces
AT_END, BESIDE, ROUNDING = 2e-6, 1e-9, 1e-9  # of the length, and of a force
WIDER = (0.01, 0.1, 0.5)  # of an arc


def drawing(rng: np.random.Generator) -> str:
    """A polygon with rounded corners, as SVG."""
    count = int(rng.integers(3, 8))
    angles = 2 * np.pi * (np.arange(count) + rng.uniform(-0.35, 0.35, count)) / count
    corners = rng.uniform(30, 100, (count, 1)) * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    sides = np.roll(corners, -1, axis=0) - corners
    lengths = np.hypot(*sides.T)
    words = []
    for i in range(count):
        back, ahead = sides[i - 1] / lengths[i - 1], sides[i] / lengths[i]
        turn = float(np.arctan2(back[0] * ahead[1] - back[1] * ahead[0], back @ ahead))
        room = 0.499 * min(lengths[i - 1], lengths[i]) * 10 ** rng.uniform(-3, 0)
        (x, y), (to_x, to_y), radius = (
            corners[i] - room * back,
            corners[i] + room * ahead,
            room / abs(np.tan(turn / 2)),
        )
        begin = "L" if words else "M"
        words.append(f"{begin} {x:.17g} {y:.17g} A {radius:.17g} {radius:.17g} 0 0 {int(turn > 0)}")
        words.append(f"{to_x:.17g} {to_y:.17g}")
    path = " ".join(words)
    return f'<svg xmlns="http://www.w3.org/2000/svg"><path d="{path} Z"/></svg>'


class Boundary:
    """Points and inward normals of a polygon, about its centre of mass, by its vertices alone."""

    def __init__(self, shape: rg.Outline) -> None:
        self.vertices = np.asarray(shape.polygon())
        self.sides = np.roll(self.vertices, -1, axis=0) - self.vertices
        self.lengths = np.hypot(*self.sides.T)
        self.starts = np.concatenate([[0.0], np.cumsum(self.lengths)])
        self.size = float(self.starts[-1])

    def at(self, s: float) -> tuple[np.ndarray, np.ndarray]:
        """The point [m] and the normal at an arc length [m]."""
        s %= self.size
        edge = min(int(np.searchsorted(self.starts, s, "right")) - 1, len(self.sides) - 1)
        along = self.sides[edge] / self.lengths[edge]
        return self.vertices[edge] + (s - self.starts[edge]) * along, np.array([-along[1], along[0]])


def least_force(
    boundary: Boundary, places: np.ndarray, load: np.ndarray, mu: float, count: int
) -> tuple[float, float]:
    """From below and from above, the least largest force at places that balances a load [N].

    Forces are mixtures of so many directions of each cone; those of the length 1 reach beyond by 1 / cos.
    """
    angles = np.arctan(mu) * np.linspace(-1, 1, count)
    columns, owners = [], []
    for i, s in enumerate(places.tolist()):
        point, n = boundary.at(s)
        force = np.cos(angles)[:, None] * n + np.sin(angles)[:, None] * np.array([n[1], -n[0]])
        columns.append(
            np.column_stack([force, (point[0] * force[:, 1] - point[1] * force[:, 0]) / boundary.size])
        )
        owners += [i] * count
    wrenches, k = np.concatenate(columns).T, len(places)
    wanted = -load / [1, 1, boundary.size]
    size = np.abs(wanted).max()
    sums = np.zeros((k, k * count + 1))
    sums[owners, np.arange(k * count)], sums[:, -1] = 1.0, -1.0
    cost = np.zeros(k * count + 1)
    cost[-1] = 1.0
    balance = np.column_stack([wrenches, np.zeros(3)])
    for method in ("highs-ds", "highs-ipm"):  # where the one does not know, the other does
        found = linprog(cost, sums, np.zeros(k), balance, wanted / size, method=method)
        if found.status == 2:
            return np.inf, np.inf
        if found.status == 0:
            break
    else:
        return 0.0, np.inf
    most = float(found.fun) * size
    return most * float(np.cos((angles[1] - angles[0]) / 2)), most


def needs_more(boundary: Boundary, places: np.ndarray, loads: np.ndarray, mu: float, limit: float) -> bool:
    """Whether some load surely needs a force above a limit [N]."""
    for load in loads:
        for count in (COARSE, FINE):
            below, above = least_force(boundary, places, load, mu, count)
            if above <= limit:
                break
            if below > limit * (1 + ROUNDING):
                return True
    return False


def task(
    rng: np.random.Generator, file: Path
) -> tuple[rg.Outline, rg.Grasp, np.ndarray, float | None] | None:
    """A random drawing with a random grasp that holds random loads; None where none was found."""
    file.write_text(drawing(rng), encoding="utf-8")
    try:
        shape = rg.Outline.from_file(file)
    except rg.InvalidInput:
        return None
    boundary = Boundary(shape)
    fingers = int(rng.choice([2, 3, 4], p=[0.45, 0.45, 0.1]))
    mu = float(10 ** rng.uniform(-1, np.log10(1.5)))
    middle = rng.normal(size=2)
    loads = np.array(
        [
            [*(middle + 0.4 * rng.normal(size=2)), 0.05 * boundary.size / 4 * rng.normal()]
            for _ in range(rng.integers(1, 7 if fingers < 4 else 4))
        ]
    )
    short = np.flatnonzero(boundary.lengths < 0.05 * boundary.size)
    for _ in range(150):
        places = rng.uniform(0, boundary.size, fingers)
        for i in np.flatnonzero(rng.uniform(size=fingers) < 0.5) if short.size else ():
            edge = rng.choice(short)
            places[i] = boundary.starts[edge] + rng.uniform(0.1, 0.9) * boundary.lengths[edge]
        needed = max(least_force(boundary, places, load, mu, COARSE)[1] for load in loads)
        if needed < 50 * np.abs(loads).max():
            try:
                grasp = rg.Grasp(shape.contact_at(s, friction=mu) for s in places)
            except rg.InvalidInput:
                continue
            limit = None if rng.uniform() < 0.5 else float(rng.uniform(1.05, 5) * needed)
            return shape, grasp, loads, limit
    return None


def drawn_within(rng: np.random.Generator, boundary: Boundary, arcs: np.ndarray) -> np.ndarray:
    """(k,) arc lengths, each at an end of its arc, beside a vertex within it, or anywhere."""
    places = rng.uniform(*arcs.T)
    for i, (lo, hi) in enumerate(arcs):
        way = rng.uniform()
        if way < 0.4:
            places[i] = (lo, hi)[int(rng.integers(2))]
        elif way < 0.7:
            turns = np.concatenate([boundary.starts[:-1] + turn * boundary.size for turn in (-1, 0, 1)])
            inside = turns[(lo < turns) & (turns < hi)]
            if inside.size:
                places[i] = rng.choice(inside) + rng.choice([-1, 1]) * BESIDE * boundary.size
    return np.clip(places, *arcs.T)


def main() -> None:
    """Attack so many regions and say what was found."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    rng, seen, took, sharp = (
        np.random.default_rng(given.seed),
        Counter[str](),
        [],
        Counter[tuple[str, float]](),
    )
    with TemporaryDirectory() as folder:
        while seen["calls"] < given.count:
            state = rng.bit_generator.state["state"]["state"]
            if (found := task(rng, Path(folder) / "shape.svg")) is None:
                continue
            shape, grasp, loads, limit = found
            seen["calls"] += 1
            boundary, mu = Boundary(shape), float(grasp.frictions[0])
            asked = [rg.Wrench.from_vector(load) for load in loads]
            start = process_time()
            try:
                regions = rg.contact_regions(
                    shape, grasp, asked[0] if len(asked) == 1 else rg.LoadSet.hull(asked), max_force=limit
                )
            except rg.Infeasible as refused:
                seen["refused"] += 1
                print(f"refused: {refused}", flush=True)
                continue
            took.append(process_time() - start)
            kind = "on one side each" if regions.spans is None else "past vertices"
            seen[kind] += 1
            seen["verified"] += (sound := rg.verify(regions).ok)
            if not sound:
                print(f"not verified: task {seen['calls']} {rg.verify(regions)}", flush=True)
            arcs, most = np.asarray(regions.arcs), regions.max_force
            if limit is not None and most > limit * (1 + 1e-12):
                print(f"LIMIT: task {seen['calls']} {most!r} {limit!r}")
            for _ in range(INSIDE):
                places = drawn_within(rng, boundary, arcs)
                seen["placements"] += 1
                if needs_more(boundary, places, loads, mu, most):
                    seen["lies"] += 1
                    print(f"LIE: task {seen['calls']} state {state} {places.tolist()}", flush=True)
            vertices = np.append(boundary.starts, boundary.size)
            for i, end in product(range(len(grasp)), range(2)):
                if np.abs(arcs[i, end] % boundary.size - vertices).min() < AT_END * boundary.size:
                    continue  # a side ends there
                if abs(arcs[i, end] - regions.places[i]) > 0.2499 * boundary.size:
                    continue  # or the quarter of the outline that is looked at
                seen[f"free ends, {kind}"] += 1
                for wider in WIDER:
                    out = arcs.copy()
                    out[i, end] += (2 * end - 1) * wider * (arcs[i, 1] - arcs[i, 0])
                    at = (np.where(np.arange(len(out)) == i, out[:, end], corner) for corner in product(*out))
                    if any(needs_more(boundary, places, loads, mu, most) for places in at):
                        sharp[kind, wider] += 1
                        break
            if seen["calls"] % 10 == 0:
                print(dict(seen), dict(sharp), flush=True)
    print(f"{dict(seen)}; processor time of a call {np.median(took):.2f} s, at most {max(took):.1f} s")
    for kind in ("on one side each", "past vertices"):
        for wider in WIDER:
            count = sum(sharp[kind, less] for less in WIDER if less <= wider)
            print(
                f"{kind}: {count} of {seen[f'free ends, {kind}']} free ends sharp within {wider:g} of the arc"
            )


if __name__ == "__main__":
    main()

"""Random choices within regions on faces, and within wider ones: what holds the loads, by cvxpy's cones.

    python benchmarks/placing/regions/missed_places.py [--count 100000] [--only box]

Each placement of fingers, anywhere within the regions, is asked once whether forces within cones and limits
balance all loads: first by mixing the corners' forces and repairing what is left, which shows that it holds;
where that does not, by a cone program.
"""

import argparse
from itertools import product
from time import process_time

import numpy as np

import regrasp as rg
from regrasp.mesh import parts

BOX = rg.Mesh.box(0.04, 0.03, 0.05)
CASES = {
    "bracket, 3 fingers, 6 loads": (
        parts.bracket(),
        3,
        [([x, y, -1.8], None) for x, y in ((0, 0), (0.5, 0), (-0.5, 0), (0, 0.5), (0, -0.5))]
        + [([0, 0, -1.8], [0.005, 0, 0])],
        0.6,
    ),
    "box, 3 fingers, 4 loads": (
        BOX,
        3,
        [([0.5, 0, -2], None), ([-0.5, 0, -2], None), ([0, 0.5, -2], None), ([0, -0.5, -2], None)],
        0.5,
    ),
    "box, 4 fingers, 1 load": (BOX, 4, [([0, 0.5, -2], [0.005, 0, 0])], 0.5),
}


def first_of(chosen: rg.ChosenGrasp, loads: rg.Wrench | rg.LoadSet) -> tuple[rg.FaceRegions, float]:
    """The regions of the best grasp that has some, and in what time [s]: the very best may be on an edge."""
    for grasp in (chosen.grasp, *(other.grasp for other in chosen.others)):
        start = process_time()
        try:
            return rg.contact_regions(chosen.shape, grasp, loads), process_time() - start
        except rg.Infeasible:
            print("the best is on an edge, a grasp passed over is taken")
    raise RuntimeError("no grasp has regions")


def holds(grasp: rg.Grasp, loads: list[rg.Wrench], limit: float) -> bool:
    """Whether some forces hold all loads."""
    for load in loads:
        try:
            rg.choose_state(grasp, load, "peak", max_force=limit)
        except rg.Infeasible:
            return False
    return True


def within(patches: list[np.ndarray], factor: float, rng: np.random.Generator) -> list[np.ndarray]:
    """A point of each polygon, widened about its middle; a third of the time near corners."""
    points = []
    for patch in patches:
        share = rng.dirichlet(np.full(len(patch), rng.choice([0.05, 0.3, 1.0])))
        middle = patch.mean(axis=0)
        points.append(middle + factor * (share @ patch - middle))
    return points


def mixed(regions: rg.FaceRegions, points: list[np.ndarray], loads: list[rg.Wrench]) -> bool:
    """Whether least squares about the forces of the nearest corner show that the placement holds."""
    normals, mu = regions.grasp.normals, regions.grasp.frictions[0]
    matrix = rg.Grasp(
        rg.Contact(p, n, mu, name=f"F{i}") for i, (p, n) in enumerate(zip(points, normals, strict=True))
    ).matrix
    corners = np.array(list(product(*regions.patches)))
    away = np.linalg.norm(corners - np.array(points), axis=2).sum(axis=1)
    weights = np.exp(-away / (away.mean() or 1.0))
    inverse = np.linalg.pinv(matrix)
    for number, load in enumerate(loads):
        f = np.tensordot(weights / weights.sum(), regions.forces[number].mean(axis=1), 1)
        f = (f.ravel() + inverse @ (-load.vector - matrix @ f.ravel())).reshape(-1, 3)
        along = (f * normals).sum(axis=1)
        if not (np.linalg.norm(f - along[:, None] * normals, axis=1) <= mu * along).all():
            return False
        if np.linalg.norm(f, axis=1).max() > regions.max_force:
            return False
    return True


def main() -> None:
    """Count, and print a line for each case and factor."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--count", type=int, default=100_000)
    parser.add_argument("--only", default="", help="cases whose names have this")
    given = parser.parse_args()
    count = given.count
    rng = np.random.default_rng(1)
    for name in (case for case in CASES if given.only in case):
        mesh, fingers, pushes, friction = CASES[name]
        loads = [rg.Wrench(f, t) for f, t in pushes]
        asked = loads[0] if len(loads) == 1 else rg.LoadSet.hull(loads)
        chosen = rg.choose_grasp(mesh, fingers, asked, friction=friction, objective="peak", tolerance=0.05)
        regions, took = first_of(chosen, asked)
        held = [rg.Wrench.from_vector(w) for w in regions.loads]
        print(f"{name}: {1e3 * regions.radius:.3g} mm all, {1e3 * regions.radii} by finger,")
        print(f"  {took:.1f} s of a processor, verified: {rg.verify(regions).ok}")
        for factor, of in ((1.0, count), (1.5, count // 50), (2.0, count // 50), (3.0, count // 50)):
            failed = programs = 0
            for _ in range(of):
                points = within(list(regions.patches), factor, rng)
                if mixed(regions, points, held):
                    continue
                programs += 1
                grasp = rg.Grasp(
                    rg.Contact(p, c.normal, c.friction, name=c.name)
                    for p, c in zip(points, regions.grasp, strict=True)
                )
                failed += not holds(grasp, held, regions.max_force)
            print(
                f"  {factor:g} times as wide: {failed} of {of} choices fail ({programs} by programs)",
                flush=True,
            )


if __name__ == "__main__":
    main()

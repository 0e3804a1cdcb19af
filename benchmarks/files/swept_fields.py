"""Each number of chosen grasps a little more and a little less: what ``verify`` lets pass, field by field.

    python benchmarks/files/swept_fields.py [--each 4] [--seconds 60] [--only circle]

Of each field so many numbers, drawn, are changed by a thousandth and by a millionth, up and down (0 to these,
indices by one), with digests that fit again. What passes is printed, to be judged: it must be true, or
no claim.
"""

import argparse
import json
from collections import Counter, defaultdict
from collections.abc import Iterator
from time import process_time
from typing import Any

import numpy as np

import regrasp as rg
from regrasp.planning.placement.levels import searching

BRACKET = rg.Outline([[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]])
TILTED = rg.LoadSet.hull(
    [rg.Wrench([0, -1], 0.2), rg.Wrench([0, -1], -0.2), rg.Wrench([0.3, -1]), rg.Wrench([-0.3, -1])]
)
IN_SPACE = rg.LoadSet.hull([rg.Wrench([0.6, 0, -1], [0, 0, 0]), rg.Wrench([-0.6, 0, -1], [0, 0.004, 0])])
NONE, ROUND = rg.Wrench([0, 0]), rg.LoadSet.turned(rg.Wrench([0, -1]))
INDICES = ("arcs", "children", "number", "by_side", "movers", "pairs", "fingers", "spans", "halves", "boxes")
UNSEEN = (".normal", "others.grasp")  # normals are made unit ones; grasps passed over have their own test
Path = tuple[Any, ...]


def by_side() -> rg.ChosenGrasp:
    """A polygon of many sides, each excluded by one of several twists."""
    around = np.pi * np.arange(12) / 6
    shape = rg.Outline(
        np.column_stack([np.cos(around), np.sin(around)]) * (1 + 0.1 * np.cos(5 * around))[:, None]
    )
    turns = np.repeat(np.arange(6) * np.pi / 3, 2)
    loads = np.column_stack([np.cos(turns), np.sin(turns), np.tile([0.5, -0.5], 6)])
    searching.MANY = 8
    return rg.choose_grasp(
        shape, 3, rg.LoadSet.hull(map(rg.Wrench.from_vector, loads)), friction=0.4, objective="friction_use",
        max_force=4.0, from_corners=0.0, tolerance=0.1,
    )  # fmt: skip


def bracket(objective: str, load: rg.Wrench | rg.LoadSet, **more: float) -> rg.ChosenGrasp:
    """Two fingers on the bracket."""
    return rg.choose_grasp(BRACKET, 2, load, friction=0.4, objective=objective, **more)  # type: ignore[arg-type]


CASES = {
    "by side": by_side,
    "ball": lambda: bracket("wrench_ball", NONE, max_force=2.0, length=1.5),
    "circle": lambda: rg.choose_grasp(
        rg.Outline.ellipse(1, 1), 2, ROUND, friction=0.4, objective="peak", tolerance=0.1
    ),
    "limits, sum_normal": lambda: bracket("sum_normal", TILTED, max_force=0.7, min_normal=0.3),
    "limits, effort": lambda: bracket("effort", TILTED, max_force=1.0, min_normal=0.3),
    "limits, peak": lambda: bracket("peak", TILTED, min_normal=0.5),
    "effort in space": lambda: rg.choose_grasp(
        rg.Mesh.box(0.04, 0.03, 0.05), 3, IN_SPACE, friction=0.5, objective="effort", tolerance=0.1
    ),
}


def leaves(data: Any, path: Path = ()) -> Iterator[tuple[Path, float]]:
    """Every number of plain data, and the way to it."""
    if isinstance(data, dict | list):
        for key, value in data.items() if isinstance(data, dict) else enumerate(data):
            yield from leaves(value, (*path, key))
    elif isinstance(data, int | float) and not isinstance(data, bool):
        yield path, data


def passes(data: dict[str, Any], proof: Any) -> bool:
    """Whether it verifies, with digests of its own."""
    try:
        digest = proof._checked(data["certificate"]).digest
        return rg.verify(
            rg.ChosenGrasp.from_dict({**data, "certificate": {**data["certificate"], "digest": digest}})
        ).ok
    except rg.InvalidInput:
        return False


def sweep(chosen: rg.ChosenGrasp, each: int, seconds: float) -> None:
    """Print what passes, field by field."""
    data = json.loads(json.dumps(chosen.to_dict()))
    del data["digest"], data["certificate"]["digest"]
    proof, fields = type(chosen.certificate), defaultdict(list)
    assert passes(data, proof)
    for path, value in leaves(data):
        fields[".".join(key for key in path if isinstance(key, str))].append((path, value))
    rng, end, tried = np.random.default_rng(0), process_time() + seconds, 0
    for name, numbers in fields.items():
        if name.endswith(UNSEEN[0]) or name.startswith(UNSEEN[1]):
            continue
        found: Counter[str] = Counter()
        some = rng.permutation(len(numbers))[:each]
        for path, value in (numbers[i] for i in some):
            if process_time() > end:
                print(f"  ended at {name}")
                return
            parent = data
            for key in path[:-1]:
                parent = parent[key]
            whole = name.split(".")[-1] in INDICES
            for by in (1, -1) if whole else (1e-3, -1e-3, 1e-6, -1e-6):
                parent[path[-1]] = value + by * (1 if whole else abs(value) or 1.0)
                found[f"{by:+g}"] += passes(data, proof)
                tried += 1
            parent[path[-1]] = value
        if any(found.values()):
            print(f"  {name}, {len(some)} numbers: {dict(+found)}", flush=True)
    print(f"  {tried} changes, all fields")


def main() -> None:
    """Every case, or one."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--each", type=int, default=4)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--only", choices=CASES)
    given = parser.parse_args()
    for name, case in CASES.items():
        if given.only in (None, name):
            chosen = case()
            print(f"{name}: {chosen.certificate.leaves} boxes, gap {chosen.gap:.2g}", flush=True)
            sweep(chosen, given.each, given.seconds)


if __name__ == "__main__":
    main()

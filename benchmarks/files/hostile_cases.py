"""Plans of every kind as plain data: how each is read and judged, and what is true of an edit of it."""

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

import regrasp as rg
from placement_truth import chosen_lies, region_lies, state_lies
from plan_truth import truth
from regrasp.files import read_plan, read_regions, write_plan, write_regions, write_setpoints
from regrasp.files.plans.setpoints import checked, read_setpoints
from regrasp.verification.exact import check_state

HEADER = ("format", "version")

GRASP = rg.Grasp(
    rg.Contact(r, n, 0.3, name=name)
    for name, r, n in (("P1", [-4, -4], [1, 1]), ("P2", [4, -5], [-1, 2]), ("P3", [0, 8], [0, -1]))
)
BALL = rg.Grasp(
    rg.Contact(p, [-x for x in p], 0.7)
    for p in ([1, 0, 0], [-0.5, 0.8, 0.1], [-0.5, -0.8, -0.1], [0, 0.1, 1])
)
LOAD, WEIGHT = rg.Wrench([-1.5, -3.5]), rg.Wrench([0, 0, -1.0])
ELLIPSE = rg.Outline.ellipse(2, 1)
BRACKET = rg.Outline([[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]])


def _limited(grasp: rg.Grasp, most: float) -> rg.Grasp:
    return rg.Grasp(c.changed(max_force=most) for c in grasp)


def _ruled(grasp: rg.Grasp) -> rg.Grasp:
    limits = rg.ForceLimits([[1.0, 0.2], [0.1, 1.0]], [9.0, 2.0])
    return rg.Grasp(c.changed(limits=limits) for c in grasp)


def _soft() -> rg.Grasp:
    return rg.Grasp(
        rg.Contact([x, 0, 0], [-x, 0, 0], 0.9, torsion=0.8, max_force=9.0, name=name)
        for x, name in ((-1, "A"), (1, "B"))
    )


def _on(shape: rg.Outline, *places: float) -> rg.Grasp:
    return rg.Grasp(shape.contact_at(s * shape.length, friction=0.5) for s in places)


def _swinging(t: float) -> rg.Wrench:
    return rg.Wrench([-1.5 + t, -3.5 - 2 * t * (1 - t)])


def _regrasp() -> rg.RegraspPlan:
    return rg.plan_regrasp(
        ELLIPSE, _on(ELLIPSE, 0.02, 0.35, 0.7), _on(ELLIPSE, 0.2, 0.5, 0.85), rg.Wrench([0, -3.0]),
        friction=0.5, orientations=24, candidates=60, goal_orientation=np.pi / 6,
    )  # fmt: skip


def _regrasp_in_space() -> rg.RegraspPlan:
    angle = 0.3
    away = rg.plan_removal(BALL, "P4", load=WEIGHT)
    turn = rg.plan_rotation(away.end.without("P4"), angle, axis=[1, 0, 0])
    back = rg.plan_addition(turn.end, BALL["P4"], load=turn.end.load)
    c, s = np.cos(angle), np.sin(angle)
    turned = [[1.0, 0, 0], [0, c, -s], [0, s, c]]
    margin = min(away.end.margins.least_angle, turn.end.margins.least_angle)
    rotations = np.array([np.eye(3), np.eye(3), turned, turned])
    return rg.RegraspPlan((away, turn, back), (0.0, 0.0, angle, angle), margin, rotations=rotations)


TWO = GRASP.without("P3")
FOUR = rg.Grasp(
    [*GRASP, rg.Contact([-6, 0], [1, 0], 0.3, name="P4"), rg.Contact([6, 0], [-1, 0], 0.3, name="P5")]
)
PLANS: dict[str, Callable[[], Any]] = {
    "removal": lambda: rg.plan_removal(_limited(GRASP, 7.0), "P3", load=LOAD),
    "removal, least normals": lambda: rg.plan_removal(GRASP, "P3", load=LOAD, min_normal=0.5),
    "removal, linear limits": lambda: rg.plan_removal(_ruled(GRASP), "P3", load=LOAD, objective="effort"),
    "removal of two": lambda: rg.plan_removal(FOUR, ["P4", "P5"], load=LOAD),
    "addition": lambda: rg.plan_addition(_limited(TWO, 9.0), GRASP["P3"].changed(max_force=9.0), load=LOAD),
    "exchange": lambda: rg.plan_exchange(GRASP, "P3", rg.Contact([1, 8], [0, -1], 0.3, name="P4"), load=LOAD),
    "hold": lambda: rg.plan_hold(GRASP, _swinging, instants=4),
    "sampled": lambda: rg.plan_removal(GRASP, "P3", load=_swinging, instants=4),
    "rates": lambda: rg.plan_removal(
        GRASP, "P3", load=LOAD, rate_limit=10.0, min_normal=0.5, duration=1.0, instants=4
    ),
    "turn": lambda: rg.plan_rotation(_limited(TWO, 6.0), -0.2, load=LOAD),
    "turn with torque": lambda: rg.plan_rotation(TWO, 0.1, load=rg.Wrench([-1.5, -3.5], 0.5)),
    "space": lambda: rg.plan_removal(BALL, "P4", load=WEIGHT),
    "turn in space": lambda: rg.plan_rotation(BALL, 0.5, axis=[1, 0, 0.5], load=WEIGHT),
    "turn of soft fingers": lambda: rg.plan_rotation(
        _soft(), 0.3, axis=[1, 0, 0], load=rg.Wrench([0, -3.0, 0])
    ),
    "regrasp": _regrasp,
    "regrasp in space": _regrasp_in_space,
}  # fmt: skip
CHOSEN: dict[str, Callable[[], rg.ChosenGrasp]] = {
    "grasp, sum of normals": lambda: _chosen("sum_normal"),
    "grasp, peak": lambda: _chosen("peak"),
    "grasp, effort": lambda: _chosen("effort", max_force=9.0, min_normal=0.01),
    "grasp, friction used": lambda: _chosen("friction_use", max_force=4.0),
    "grasp, angle": lambda: _chosen("angle", max_force=4.0, min_distance=0.3),
    "grasp, answered": lambda: _chosen(
        "answered", max_force=5.0,
        disturbance=rg.LoadSet.hull([rg.Wrench([1, 0]), rg.Wrench([-1, 0]), rg.Wrench([0, 0], 0.3)]),
    ),
    "grasp, wrench ball": lambda: rg.choose_grasp(
        BRACKET, 2, rg.Wrench([0, 0]), friction=0.4, objective="wrench_ball", max_force=2.0, length=1.5,
        tolerance=0.05,
    ),
    "grasp on a curve": lambda: rg.choose_grasp(
        ELLIPSE, 2, rg.Wrench([0, -1]), friction=0.5, objective="peak", tolerance=0.05
    ),
    "grasp on a mesh": lambda: rg.choose_grasp(
        rg.Mesh.box(0.04, 0.03, 0.05), 3, rg.Wrench([0, 0, -2]), friction=0.5, objective="peak", tolerance=0.2
    ),
}  # fmt: skip


def _chosen(objective: str, **options: Any) -> rg.ChosenGrasp:
    return rg.choose_grasp(
        BRACKET, 2, rg.Wrench([0, -1], 0.1), friction=0.5, objective=objective, tolerance=0.05, **options
    )


STATES: dict[str, Callable[[], rg.GraspState]] = {
    "state": lambda: rg.choose_state(GRASP, LOAD),
    "state in space": lambda: rg.choose_state(BALL, WEIGHT),
    "state of soft fingers": lambda: rg.choose_state(_soft(), rg.Wrench([0, -3.0, 0], [0.5, 0, 0])),
}


@dataclass(frozen=True)
class Case:
    """Plain data of one plan, how it is read and judged, and what is true of an edit of it.

    told: what is said of data: nothing for verified. true: None where the oracle cannot tell.
    """

    name: str
    data: Any
    told: Callable[[Any], str]
    true: Callable[[Any, bool], bool | None]
    kept: tuple[str, ...] = HEADER


def cases(folder: Path) -> Iterator[Case]:
    """Every kind, one after the other."""
    for name, make in PLANS.items():
        yield of_plan(name, make(), folder)
    for name, make in CHOSEN.items():
        yield of_choice(name, make(), folder)
    yield regions(folder)
    for name, make in STATES.items():
        yield of_state(name, make())
    for name in ("removal", "turn", "regrasp"):
        yield of_setpoints(f"set-points, {name}", PLANS[name](), folder)
    import hostile_ways

    yield from hostile_ways.cases(folder)


def regions(folder: Path) -> Case:
    """Of three fingers on a polygon."""
    found = rg.contact_regions(BRACKET, _on(BRACKET, 0.12, 0.37, 0.7), LOAD)
    return of_regions("regions", found, folder)


def _saved(plan: Any, folder: Path) -> Any:
    write_plan(plan, folder / "plan.json")
    return json.loads((folder / "plan.json").read_text(encoding="utf-8"))


def _reread(data: Any, folder: Path) -> str:
    file = folder / "edited.json"
    file.write_text(json.dumps(data), encoding="utf-8")
    return "\n".join(rg.verify(read_plan(file)).violations)


def of_plan(name: str, plan: Any, folder: Path) -> Case:
    """A transition or a regrasp, as a file."""
    return Case(name, _saved(plan, folder), lambda data: _reread(data, folder), lambda data, ok: truth(data))


def of_choice(name: str, chosen: rg.ChosenGrasp, folder: Path) -> Case:
    """A chosen grasp, as a file, whose proof a forger may have signed."""
    good = _saved(chosen, folder)
    del good["digest"]  # of the whole: a file of before has none
    kind = type(chosen.certificate)

    def told(data: Any) -> str:
        proof = data.get("certificate")
        if isinstance(proof, dict) and len(json.dumps(data)) % 2:  # a forger knows how digests are made
            try:
                names = [f for f in kind.__dataclass_fields__ if proof.get(f) is not None]
                values = {f: np.array(v) if isinstance(v := proof[f], list) else v for f in names}
                proof["digest"] = replace(chosen.certificate, **values).digest
            except (TypeError, ValueError, AttributeError):
                pass
        return _reread(data, folder)

    def true(data: Any, ok: bool) -> bool | None:
        if ok:
            return not chosen_lies(data)
        same = {key: value for key, value in good.items() if key not in ("value", "bound", "others")}
        if any(data.get(key) != value for key, value in same.items()):
            return None
        numbers = [data.get(key) for key in ("value", "bound")]
        if data.get("others") != good["others"] or not all(type(x) is float for x in numbers):
            return None
        (value, bound), way = numbers, -1 if chosen.objective in ("angle", "answered", "wrench_ball") else 1
        weaker = value == good["value"] and way * (bound - good["bound"]) <= 0
        return True if weaker and abs(bound) < np.inf else None

    return Case(name, good, told, true)


def of_regions(name: str, regions: rg.ContactRegions, folder: Path) -> Case:
    """Regions, as a file, which a forger may have signed."""
    file = folder / "regions.json"
    write_regions(regions, file)
    good = json.loads(file.read_text(encoding="utf-8"))

    def told(data: Any) -> str:
        if len(json.dumps(data)) % 2:  # a forger knows how digests are made
            signed = {key: value for key, value in data.items() if key not in (*HEADER, "digest")}
            data["digest"] = sha256(repr(signed).encode()).hexdigest()
        file.write_text(json.dumps(data), encoding="utf-8")
        return "\n".join(rg.verify(read_regions(file)).violations)

    return Case(name, good, told, lambda data, ok: not region_lies(data) if ok else None)


def of_state(name: str, state: rg.GraspState) -> Case:
    """A state as plain data."""

    def told(data: Any) -> str:
        return "\n".join(check_state(rg.GraspState.from_dict(data), "state")[2])

    return Case(name, state.to_dict(), told, lambda data, ok: not state_lies(data) if ok else None, ())


def of_setpoints(name: str, plan: Any, folder: Path) -> Case:
    """A table of set-points."""
    file = folder / "setpoints.csv"
    write_setpoints(plan, file, 8.0)
    header, *rows = [line.split(",") for line in file.read_text(encoding="utf-8").splitlines()]
    good = {"header": header, "rows": [[float(x) for x in row] for row in rows]}

    def told(data: Any) -> str:
        if not all(isinstance(data.get(k), list) for k in good) or not all(map(_is_row, data["rows"])):
            return "no table"
        lines = [data["header"], *data["rows"]]
        text = "\n".join(",".join("" if x is None else str(x) for x in line) for line in lines)
        file.write_text(text, encoding="utf-8")
        return "\n".join(v for part in read_setpoints(file, plan) for v in checked(plan, part).violations)

    return Case(name, good, told, lambda data, ok: _same_rows(good, data), ())


def _is_row(row: Any) -> bool:
    return isinstance(row, list) and not any(isinstance(x, (list, dict)) for x in row)


def _same_rows(good: dict[str, Any], data: Any) -> bool | None:
    """Whether rows are those of the plan but for rounding; None where it is near."""
    try:
        one, other = (np.array(table["rows"], dtype=float) for table in (good, data))
    except (KeyError, TypeError, ValueError, OverflowError):
        return False
    if data.get("header") != good["header"]:
        return None
    if one.shape != other.shape:
        evenly = other.ndim == 2 and len(other) > 1 and np.ptp(np.diff(other[:, 0])) < 1e-9
        return None if evenly else False
    size = np.abs(one).max(axis=0).max()
    off = np.abs(one - other)
    off[:, 0] = np.where(off[:, 0] > 0, np.maximum(off[:, 0], 1e-10), 0)  # times may be a little off
    worst = float(off.max())
    idle = bool((off[one == 0] > 0).any())  # nothing is what stays so to the last bit
    return True if worst <= 1e-15 * size and not idle else False if not worst < 1e-5 * size else None

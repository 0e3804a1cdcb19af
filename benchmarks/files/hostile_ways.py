"""Cuts that prove that no regrasp exists and set-points of motions, as plain data."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

import regrasp as rg
from cut_truth import cut_truth, outline_cut_lies
from hostile_cases import ELLIPSE, HEADER, Case, _on
from regrasp.files import read_cut, read_motions, write_cut, write_motions
from regrasp.motions import Motions, plan_motions
from regrasp.verification import verify_motion_rows

BOWL = rg.Outline([[0, 0], [4, 0], [6, 4], [5, 4], [2, 1], [-1, 4], [-2, 4]])
SMALL = rg.Outline.ellipse(0.04, 0.02)


def cases(folder: Path) -> Iterator[Case]:
    """Every kind, one after the other."""
    for name, options in (("margin", {"least_margin": 0.4637}), ("distance", {"min_distance": 5.0})):
        yield of_cut(f"cut, {name}", contacts_cut(**options), folder)
    for name, options in (("outline", {}), ("outline, limits", {"max_force": 4.0, "min_normal": 0.5}),
                          ("outline, turns", {"turns": (-0.05, 0.05)})):  # fmt: skip
        yield of_cut(f"cut, {name}", outline_cut(**options), folder)
    yield of_motions("motions", motions(), folder)


def contacts_cut(**options: Any) -> rg.RegraspCut:
    """Of contacts on an ellipse."""
    try:
        rg.plan_regrasp(
            ELLIPSE, _on(ELLIPSE, 0.02, 0.35, 0.7), _on(ELLIPSE, 0.2, 0.5, 0.85), rg.Wrench([0, -3.0]),
            friction=0.5, candidates=12, **options,
        )  # fmt: skip
    except rg.Infeasible as refused:
        return refused.certificate.cut
    raise AssertionError("a regrasp that was to be refused")


def outline_cut(**options: Any) -> rg.OutlineCut:
    """Of holds on a bowl in two parts."""
    friction = 0.4 if "max_force" in options else 0.2
    start, goal = (
        rg.Grasp(BOWL.contact_at(s, friction=friction) for s in places)
        for places in ((3.39, 9.01, 12.0), (0.44, 18.46, 12.0))
    )
    found = rg.regrasps_on_outline(BOWL, start, goal, rg.Wrench([-1.0, -3.0]), friction=friction, **options)
    assert found.certificate is not None
    return found.certificate


def motions() -> Motions:
    """Of a finger that leaves in the plane."""
    grasp = rg.Grasp(SMALL.contact_at(p * SMALL.length, friction=0.5) for p in (0.0, 0.5, 0.75))
    plan = rg.plan_removal(grasp, "P3", load=rg.Wrench([0, -1.0]), duration=0.2)
    return plan_motions(plan, SMALL, tip_radius=0.003, clearance=0.002)


def of_cut(name: str, cut: Any, folder: Path) -> Case:
    """A cut, as a file."""
    file = folder / "cut.json"
    write_cut(cut, file)

    def told(data: Any) -> str:
        file.write_text(json.dumps(data), encoding="utf-8")
        return "\n".join(rg.verify(read_cut(file)).violations)

    def true(data: Any, ok: bool) -> bool | None:
        if "contacts" in data:
            return cut_truth(data)
        return not outline_cut_lies(data) if ok else None

    return Case(name, json.loads(file.read_text(encoding="utf-8")), told, true, HEADER)


def of_motions(name: str, moved: Motions, folder: Path) -> Case:
    """Set-points of positions and forces."""
    file = folder / "motions.csv"
    write_motions(moved, file, rate=150.0)
    header, *rows = [line.split(",") for line in file.read_text(encoding="utf-8").splitlines()]
    good = {"header": header, "rows": [[float(x) for x in row] for row in rows]}

    def told(data: Any) -> str:
        if not all(isinstance(data.get(k), list) for k in good):
            return "no table"
        lines = [data["header"], *data["rows"]]
        if not all(
            isinstance(row, list) and not any(isinstance(x, (list, dict)) for x in row) for row in lines
        ):
            return "no table"
        text = "\n".join(",".join("" if x is None else str(x) for x in line) for line in lines)
        file.write_text(text, encoding="utf-8", errors="surrogatepass")
        return "\n".join(verify_motion_rows(moved.plan, read_motions(file, moved.plan)).violations)

    return Case(name, good, told, lambda data, ok: _as_planned(good, data), ())


def _as_planned(good: dict[str, Any], data: Any) -> bool | None:
    """Whether rows are those written; None for what is near, and where another way may serve as well."""
    try:
        one, other = (np.array(table["rows"], dtype=float) for table in (good, data))
    except (KeyError, TypeError, ValueError, OverflowError):
        return False
    if data.get("header") != good["header"] or one.shape != other.shape:
        return None
    if not np.isfinite(other).all():
        return False
    off = np.abs(one - other)
    if not off.any():
        return True
    names = good["header"]
    forces = np.array([name.endswith(("_fx", "_fy")) for name in names])
    places = np.array([name.endswith(("_x", "_y")) for name in names])
    if off[:, forces].max() > 1e-5 * np.abs(one[:, forces]).max() and not off[:, :3].any():
        return False
    moved = off[:, places] > 1e-3 * np.abs(one[:, places]).max()
    if (moved.sum(axis=0) == 1).any() and not off[:, :3].any():  # there and back within two rows
        return False
    return None

"""Whether a grasp chosen on an outline or a mesh, or contact regions, say what is so, from plain data alone.

States are judged by ``plan_truth``. That a bound is too good is shown by a placement that is better, with
forces from linear programs over inner pyramids; that it is good cannot be seen from here. ``lies`` returns
what is not so, in words, the empty string where nothing was found. No name of regrasp is imported.
"""

from math import acos, atan, cos, hypot, inf, pi, sin

import numpy as np
from scipy.optimize import linprog

from plan_truth import Judge, _state

CLOSE = 3e-9
NORMS = {
    "sum_normal": ("normal", "sum"), "peak_normal": ("normal", "largest"), "peak": ("force", "largest"),
    "effort": ("force", "squares"), "friction_use": ("force", "largest"), "angle": ("force", "largest"),
    "answered": ("force", "largest"), "wrench": ("force", "largest"), "wrench_ball": ("normal", "largest"),
}  # fmt: skip
LEVELS = ("friction_use", "angle", "answered", "wrench", "wrench_ball")


def state_lies(state: dict) -> str:
    """What is wrong with a state of plain data."""
    judge, state = Judge(), plainly(state)
    load = state["load"]
    try:
        _state(judge, state["grasp"]["contacts"], state["forces"], vector(load))
    except (KeyError, TypeError, ValueError, IndexError, ArithmeticError):
        return "a state has no form"
    return "a state is out of balance, its cones or its limits" if judge.false else ""


def chosen_lies(data: dict) -> str:
    """What is wrong with a chosen grasp of plain data that was read."""
    data = plainly(data)
    proof, word, value, bound = data["certificate"], data["objective"], data["value"], data["bound"]
    contacts = data["grasp"]["contacts"]
    for state in data["states"]:
        if not _same(state["grasp"], data["grasp"]):
            return "a state is of other contacts"
        if lie := state_lies(state):
            return lie
        sizes = forces_of(state)
        if measure(sizes, *NORMS[word]) > (inf if word in LEVELS else value) * (1 + CLOSE):
            return "the value is less than a state needs"
        limit = inf if word == "wrench_ball" or data.get("max_force") is None else data["max_force"]
        if max(full for _, full in sizes) > limit * (1 + CLOSE):
            return "a force is above the limit"
        if min(push for push, _ in sizes) < data.get("min_normal", 0.0) * (1 - CLOSE):
            return "a finger pushes with too little"
        margins = [atan(c["friction"]) - angle for c, angle in zip(contacts, angles_of(state), strict=True)]
        uses = [
            np.tan(angle) / max(c["friction"], 1e-300)
            for c, angle in zip(contacts, angles_of(state), strict=True)
        ]
        if word == "friction_use" and max(uses) > value + CLOSE:
            return "more friction is used than said"
        if word == "angle" and min(margins) < value - CLOSE:
            return "the margin is larger than a state's"
    better = bound < value * (1 - CLOSE) if word in ("angle", "answered", "wrench", "wrench_ball") else (
        bound > value * (1 + CLOSE))  # fmt: skip
    if better:
        return "the bound is worse than the value"
    if lie := _loads_shown(data, proof, word):
        return lie
    if lie := _off_places(data, contacts):
        return lie
    if word in LEVELS or "fingers" not in proof:
        return ""
    least = _reached(proof, contacts)
    power = 2 if word == "effort" else 1
    return "a placement is better than the bound" if least**power < bound * (1 - 1e-6) else ""


def plainly(data):
    """The same with what a contact may leave out."""
    if isinstance(data, list):
        return [plainly(value) for value in data]
    if not isinstance(data, dict):
        return data
    data = {key: plainly(value) for key, value in data.items()}
    if "friction" in data and "position" in data:
        return {"max_force": None, "name": None} | data
    return data


def _unit(normal) -> list[float]:
    size = hypot(*normal)
    return [x / size for x in normal]


def _same(one: dict, other: dict) -> bool:
    """Whether two grasps are the same: normals may have any length."""
    rows = [
        [{**c, "normal": [round(x, 12) for x in _unit(c["normal"])]} for c in g["contacts"]]
        for g in (one, other)
    ]
    return rows[0] == rows[1]


def forces_of(state: dict) -> list[tuple[float, float]]:
    """(push, size) of every finger."""
    return [
        (sum(a * b for a, b in zip(f, _unit(c["normal"]), strict=True)), hypot(*f))
        for c, f in zip(state["grasp"]["contacts"], state["forces"], strict=True)
    ]


def angles_of(state: dict) -> list[float]:
    return [acos(min(push / size, 1.0)) if size > 0 else 0.0 for push, size in forces_of(state)]


def measure(sizes: list[tuple[float, float]], size: str, norm: str) -> float:
    some = [push if size == "normal" else full for push, full in sizes]
    return {"sum": sum(some), "largest": max(some), "squares": sum(x * x for x in some)}[norm]


def _loads_shown(data: dict, proof: dict, word: str) -> str:
    """Each load of the proof is that of a state, or between those of two."""
    if word in ("answered", "wrench", "wrench_ball"):
        return ""
    shown = np.array([vector(state["load"]) for state in data["states"]])
    scale = np.abs(shown).max() or 1.0
    for load in np.array(proof["loads"]):
        best = inf
        for a in shown:
            for b in shown:
                side, away = b - a, load - a
                t = np.clip(away @ side / (side @ side), 0, 1) if side.any() else 0.0
                best = min(best, np.abs(away - t * side).max())
        if best > 1e-6 * scale:
            return "a load of the proof has no state"
    return ""


def vector(load: dict) -> list[float]:
    torque = load.get("torque")
    torque = [0.0] * (2 * len(load["force"]) - 3) if torque is None else torque
    return [*load["force"], *(torque if isinstance(torque, list) else [torque])]


def _off_places(data: dict, contacts: list[dict]) -> str:
    """Contacts are on the shape, at the arc lengths that are said."""
    shape = data["shape"]
    if "vertices" in shape and "faces" not in shape:
        ring = np.array(shape["vertices"], dtype=float)
        lengths = np.hypot(*(np.roll(ring, -1, axis=0) - ring).T)
        starts, size = np.concatenate([[0.0], np.cumsum(lengths)]), float(np.abs(ring).max())
        centre = np.array(data["certificate"]["centre_of_mass"])
        for contact, place in zip(contacts, data["places"], strict=True):
            s = place % starts[-1]
            k = min(int(np.searchsorted(starts, s, side="right")) - 1, len(ring) - 1)
            at = ring[k] + (s - starts[k]) / lengths[k] * (np.roll(ring, -1, axis=0)[k] - ring[k])
            if np.abs(at - centre - contact["position"]).max() > 1e-6 * size:
                return "a finger is not at its place"
    if "faces" in shape:
        offsets = np.array(data["places"]) - [c["position"] for c in contacts]
        if np.ptp(offsets, axis=0).max() > 1e-6 * np.abs(np.array(shape["vertices"])).max():
            return "a finger is not at its place"
    return ""


def _reached(proof: dict, contacts: list[dict], tries: int = 6) -> float:
    """The least norm of some placements under all loads: the one given, and others by chance."""
    rng, size, norm = np.random.default_rng(0), proof["size"], proof["norm"]
    mu, best = proof["friction"], inf
    placements = [[(np.array(c["position"]), np.array(c["normal"])) for c in contacts]]
    placements += [[_anywhere(proof, rng) for _ in contacts] for _ in range(tries)]
    for placement in placements:
        points = [p for p, _ in placement]
        apart = min(np.linalg.norm(p - q) for k, p in enumerate(points) for q in points[:k])
        if len(placement) != proof["fingers"] or apart < proof["min_distance"]:
            continue
        worst = 0.0
        for load in proof["loads"]:
            worst = max(worst, _least(placement, mu, np.array(load), size, norm))
            if worst >= best:
                break
        best = min(best, worst)
    return best


def _anywhere(proof: dict, rng) -> tuple[np.ndarray, np.ndarray]:
    """A place that the proof is about, and its inward normal."""
    if "sides" not in proof:
        k = rng.integers(len(proof["normals"]))
        weights = rng.dirichlet([1, 1, 1])
        return weights @ np.array(proof["corners"][k]), np.array(proof["normals"][k])
    edge, lo, hi = proof["sides"][rng.integers(len(proof["sides"]))]
    k, t = int(edge), rng.uniform(lo, hi) - int(edge)
    centre = np.array(proof["centre_of_mass"])
    if proof.get("control") is None:
        p, q = (np.array(proof["vertices"][i % len(proof["vertices"])]) for i in (k, k + 1))
        at, along = p + t * (q - p), q - p
    else:
        c = np.array(proof["control"][k])
        at = (1 - t) ** 3 * c[0] + 3 * (1 - t) ** 2 * t * c[1] + 3 * (1 - t) * t**2 * c[2] + t**3 * c[3]
        d = np.diff(c, axis=0)
        along = (1 - t) ** 2 * d[0] + 2 * (1 - t) * t * d[1] + t**2 * d[2]
    return at - centre, np.array([-along[1], along[0]]) / np.hypot(*along)


def _cross(r, f):
    return r[0] * f[1] - r[1] * f[0] if len(r) == 2 else np.cross(r, f)


def _least(placement, mu: float, load: np.ndarray, size: str, norm: str) -> float:
    """The norm of forces that hold a load, of the least largest or summed weight; infinite for none."""
    edges, columns = [], []
    for point, normal in placement:
        tangents = np.linalg.svd(normal[None])[2][1:]
        ways = [(1.0,), (-1.0,)] if len(normal) == 2 else [
            (cos(2 * pi * k / 12), sin(2 * pi * k / 12)) for k in range(12)]  # fmt: skip
        some = [normal + mu * np.array(way) @ tangents for way in ways]
        edges.append(some)
        columns += [np.append(f, _cross(point, f)) for f in some]
    n, per = len(columns), len(edges[0])
    G = np.array(columns).T
    weights = np.ones(n) if size == "normal" else np.linalg.norm(np.concatenate(edges), axis=1)
    if norm == "sum":
        found = linprog(weights, A_eq=G, b_eq=-load, method="highs")
    else:
        rows = np.kron(np.eye(len(placement)), np.ones(per)) * weights
        found = linprog(
            np.append(np.zeros(n), 1.0), A_ub=np.column_stack([rows, -np.ones(len(rows))]),
            b_ub=np.zeros(len(rows)), A_eq=np.column_stack([G, np.zeros(len(G))]), b_eq=-load, method="highs",
        )  # fmt: skip
    if found.status != 0:
        return inf
    shares = np.maximum(found.x[:n], 0).reshape(len(placement), per)
    forces = [share @ np.array(some) for share, some in zip(shares, edges, strict=True)]
    sizes = [(float(f @ normal), float(np.linalg.norm(f)))
             for f, (_, normal) in zip(forces, placement, strict=True)]  # fmt: skip
    result = measure(sizes, size, norm)
    return float(np.sqrt(result)) if norm == "squares" else result


def region_lies(data: dict) -> str:
    """What is wrong with contact regions on a polygon without holes, of plain data."""
    for state in data["corners"]:
        if lie := state_lies(state):
            return lie
        if max(full for _, full in forces_of(state)) > data["max_force"] * (1 + CLOSE):
            return "a force is above the limit"
    ring = np.array(data["shape"]["vertices"], dtype=float)
    ends = np.roll(ring, -1, axis=0)
    twice = ring[:, 0] * ends[:, 1] - ends[:, 0] * ring[:, 1]
    ring = ring - (twice @ (ring + ends)) / (3 * twice.sum())  # about the centre of mass
    ends = np.roll(ring, -1, axis=0)
    lengths = np.hypot(*(ends - ring).T)
    starts, size = np.concatenate([[0.0], np.cumsum(lengths)]), float(np.abs(ring).max())
    arcs, places, half = np.array(data["arcs"]), np.array(data["places"]), data["half_width"]
    if (arcs[:, 0] > arcs[:, 1]).any():
        return "an arc ends before it begins"

    def at(s: float) -> np.ndarray:
        s = s % starts[-1]
        k = min(int(np.searchsorted(starts, s, side="right")) - 1, len(ring) - 1)
        return ring[k] + (s - starts[k]) / lengths[k] * (ends[k] - ring[k])

    for contact, place in zip(data["grasp"]["contacts"], places, strict=True):
        if np.abs(at(place) - contact["position"]).max() > 1e-6 * size:
            return "a finger is not at its place"
    loads = {tuple(vector(state["load"])) for state in data["corners"]}
    for load in loads:
        here = [s for s in data["corners"] if tuple(vector(s["load"])) == load]
        for corner in np.stack(np.meshgrid(*arcs), axis=-1).reshape(-1, len(arcs)):
            points = [at(s) for s in corner]
            if not any(
                np.abs(np.array([c["position"] for c in s["grasp"]["contacts"]]) - points).max()
                <= 1e-6 * size
                for s in here
            ):
                return "a corner has no state"
    for (lo, hi), place in zip(arcs, places, strict=True):
        k = min(int(np.searchsorted(starts, place % starts[-1], side="right")) - 1, len(ring) - 1)
        turn = place - place % starts[-1]
        least, most = starts[k] + turn, starts[k + 1] + turn
        if max(place - half, least) < lo - 1e-6 * size or min(place + half, most) > hi + 1e-6 * size:
            return "the half width is wider than an arc"
    return ""

"""Whether a plan file tells the truth, decided from its JSON alone: the rules of docs/facts.md written anew.

Rational arithmetic on the file's own doubles; sines, cosines and square roots are doubles. No name of
regrasp is imported. ``truth`` is True, False, or None where a number lies so near to a tolerance that
rounding decides.
"""

from fractions import Fraction
from itertools import pairwise
from math import atan, atan2, cos, hypot, inf, sin, sqrt

EPS = Fraction(1, 2**40)
OBJECTIVES = {
    "angle", "force", "effort", "peak", "peak_normal", "friction_use", "sum_normal", "wrench",
}  # fmt: skip
PATHS = {None, "change", "effort", "force", "peak"}


class Judge:
    """Collects what was found: a lie, or a number too near to its tolerance to tell."""

    def __init__(self) -> None:
        self.false, self.near = False, False

    def needs(self, holds: bool) -> None:
        self.false |= not holds

    def at_most(self, value, limit, blur=Fraction(1, 10**12)) -> None:
        """``value <= limit``, both at least 0; unknown where they differ by less than ``blur`` of them."""
        value, limit = Fraction(value), Fraction(limit)
        if abs(value - limit) <= blur * max(abs(value), abs(limit)) and value != limit:
            self.near = True
        else:
            self.needs(value <= limit)

    @property
    def verdict(self) -> bool | None:
        return False if self.false else None if self.near else True


def truth(plan: dict) -> bool | None:
    judge = Judge()
    try:
        if plan.get("kind") == "regrasp":
            _regrasp(judge, plan)
        else:
            _transition(judge, plan)
    except (KeyError, TypeError, IndexError, ValueError, AttributeError, ArithmeticError):
        judge.false = True  # of no form
    return judge.verdict


def exact(values) -> list[Fraction]:
    if any(isinstance(v, (bool, str)) or v is None for v in values):
        raise TypeError
    return [Fraction(v) for v in values]


def dot(a, b) -> Fraction:
    return sum((x * y for x, y in zip(a, b, strict=True)), start=Fraction(0))


def cross(r, f) -> list[Fraction]:
    if len(r) == 2:
        return [r[0] * f[1] - r[1] * f[0]]
    return [r[1] * f[2] - r[2] * f[1], r[2] * f[0] - r[0] * f[2], r[0] * f[1] - r[1] * f[0]]


def _state(judge: Judge, contacts: list[dict], forces, load) -> None:
    d = len(contacts[0]["position"])
    load, width = exact(load), d + any(c.get("torsion") is not None for c in contacts)
    judge.needs(len(load) == 3 * (d - 1) and len(forces) == len(contacts))
    total, arm2, scale2 = list(load), Fraction(0), dot(load[:d], load[:d])
    for contact, row in zip(contacts, forces, strict=True):
        r, n, numbers = exact(contact["position"]), exact(contact["normal"]), exact(row)
        judge.needs(len(r) == len(n) == d and len(numbers) == width)
        f, m = numbers[:d], sum(numbers[d:])
        judge.needs(contact["friction"] >= 0 and dot(n, n) > 0)
        push, used2 = dot(f, n), dot(f, f) + _spun(contact, m) ** 2
        mu = max(exact([contact["friction"]])[0], EPS)
        judge.needs(push >= 0)
        judge.at_most(used2 * dot(n, n), (1 + mu * mu) * push**2)
        judge.needs(m == 0 or contact.get("torsion") is not None)
        if contact["max_force"] is not None:
            judge.needs(contact["max_force"] > 0)
            judge.at_most(used2, Fraction(contact["max_force"]) ** 2, 0)
        for work, most in _rows(contact, f):
            judge.at_most(max(work, Fraction(0)), most, Fraction(1, 10**13))
        for k, value in enumerate([*f, *cross(r, f)]):
            total[k] += value
        if m:
            total[d:] = [a + m * b for a, b in zip(total[d:], _unit(n), strict=True)]
        arm2, scale2 = max(arm2, dot(r, r)), max(scale2, dot(f, f))
    scale2 = max(scale2, dot(load[d:], load[d:]) / (arm2 or 1))
    off2 = max(dot(total[:d], total[:d]), dot(total[d:], total[d:]) / (arm2 or 1))
    judge.at_most(off2, EPS**2 * scale2, Fraction(1, 100))
    asked2 = max(dot(load[:d], load[:d]), dot(load[d:], load[d:]) / (arm2 or 1))
    if asked2:
        judge.at_most(off2, asked2 / 2**20, Fraction(1, 100))


def _unit(n: list[Fraction]) -> list[Fraction]:
    """Normals may have any length; one that is nearly 1 is taken as it is."""
    length = sqrt(dot(n, n))
    return n if abs(length - 1) < 1e-14 else [x / Fraction(length) for x in n]


def _spun(contact: dict, m: Fraction) -> Fraction:
    """The tangential force that uses as much friction as a soft finger's torque."""
    mu, torsion = exact([contact["friction"], contact.get("torsion") or 1])
    return Fraction(0) if contact.get("torsion") is None else max(mu, EPS) * m / torsion


def _rows(contact: dict, f) -> list[tuple[Fraction, Fraction]]:
    """(a . f, b) of the linear limits of a planar contact, in the frame of its normal."""
    limits, (nx, ny, *_) = contact.get("limits"), _unit(exact(contact["normal"]))
    given = [] if limits is None else zip(limits["rows"], exact(limits["bounds"]), strict=True)
    return [(dot(exact(row), (dot(f, [nx, ny]), dot(f, [-ny, nx]))), most) for row, most in given]


def _transition(judge: Judge, plan: dict) -> None:
    contacts, record, scaling = plan["contacts"], plan["record"], plan["scaling"]
    names = [c["name"] for c in contacts]
    judge.needs(all(isinstance(n, str) and n.strip() for n in names) and len(set(names)) == len(names))
    places = [tuple(c["position"]) for c in contacts]
    judge.needs(len(set(places)) == len(places))
    idle = _moving(judge, plan)
    for end, gone in zip(("start", "end"), idle, strict=True):
        judge.needs(all(not any(plan[end][names.index(name)]) for name in gone))
    control = exact(scaling["control"])
    judge.needs(control[0] == 1 and control[-1] == 0 and all(a >= b for a, b in pairwise(control)))
    judge.needs(isinstance(scaling["degree"], int) and 1 <= scaling["degree"] < len(control))
    judge.needs(exact([scaling["duration"]])[0] > 0)
    for end in ("start", "end"):
        judge.needs(len(plan[end]) == len(contacts))
    course, turn = plan.get("course"), plan.get("turn")
    judge.needs(course is None or turn is None)
    if turn is not None:
        states = _turn(judge, plan, turn)
    elif course is not None:
        states = _course(judge, plan, course)
    else:
        states = [plan["start"], plan["end"]]
        for state in states:
            _state(judge, contacts, state, plan["load"])
    _record(judge, plan, record, states, idle)


def _moving(judge: Judge, plan: dict) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The fingers that carry nothing at the start and at the end, of the kind that the plan says."""
    kind, names = plan["kind"], [plan["contact"], plan.get("arrival")]
    leaving, arriving = (() if n is None else (n,) for n in (names[::-1] if kind == "addition" else names))
    if plan.get("leaving") is not None or plan.get("arriving") is not None:
        leaving, arriving = (tuple(plan.get(key) or ()) for key in ("leaving", "arriving"))
    wanted = {"removal": (1, 0), "addition": (0, 1), "exchange": (1, 1), "rotation": (0, 0), "hold": (0, 0)}
    judge.needs((bool(leaving), bool(arriving)) == wanted[kind])
    judge.needs(not set(leaving) & set(arriving))
    judge.needs(all(len(set(names)) == len(names) for names in (leaving, arriving)))
    return arriving, leaving


def _course(judge: Judge, plan: dict, course: dict) -> list:
    times, forces, loads = exact(course["times"]), course["forces"], course["loads"]
    judge.needs(times[0] == 0 and times[-1] == plan["scaling"]["duration"])
    judge.needs(all(a < b for a, b in pairwise(times)) and len(times) == len(forces) == len(loads))
    judge.needs(forces[0] == plan["start"] and forces[-1] == plan["end"] and loads[0] == plan["load"])
    for row, load in zip(forces, loads, strict=True):
        _state(judge, plan["contacts"], row, load)
    rates = plan["record"].get("rate_limits") or []
    for i, rate in enumerate(rates):
        for k in range(len(times) - 1):
            change = [x - y for x, y in zip(exact(forces[k + 1][i]), exact(forces[k][i]), strict=True)]
            if rate is not None:
                most = (exact([rate])[0] * (times[k + 1] - times[k]) * (1 + EPS)) ** 2
                judge.at_most(dot(change, change), most, 0)
    return forces


def _turn(judge: Judge, plan: dict, turn: dict) -> list:
    angles, forces, middles = turn["angles"], turn["forces"], turn.get("middles")
    steps = [b - a for a, b in pairwise(angles)]
    exact(angles)
    judge.needs(angles[0] == 0 and (all(s > 0 for s in steps) or all(s < 0 for s in steps)))
    judge.needs(max(map(abs, steps)) <= 3.14159 and len(angles) == len(forces))
    judge.needs(forces[0] == plan["start"] and forces[-1] == plan["end"])
    d = len(plan["load"]) // 3 + 1
    axis = turn.get("axis")
    judge.needs((axis is None) == (d == 2))
    if axis is not None:
        length = hypot(*map(float, exact(axis)))
        judge.needs(len(axis) == 3 and length > 0)
        axis = [x / length for x in axis]
    load = [float(x) for x in exact(plan["load"])]
    seen = turned(load, angles[-1], axis)
    for part in (slice(0, d), slice(d, None)):
        off = [a - b for a, b in zip(exact(turn["end_load"])[part], exact(seen)[part], strict=True)]
        size2 = dot(exact(seen)[part], exact(seen)[part])
        judge.at_most(dot(off, off), EPS**2 * size2, Fraction(1, 100))
    for angle, row in zip(angles, forces, strict=True):
        _state(judge, plan["contacts"], row, turned(load, angle, axis))
    arm = sqrt(max(dot(r, r) for r in (exact(c["position"]) for c in plan["contacts"])))
    still = parts(load, axis)[0]
    rest = max(hypot(*still[:d]), hypot(*still[d:]) / arm)
    judge.needs(middles is not None or rest <= float(EPS) * max(hypot(*load[:d]), hypot(*load[d:]) / arm))
    if middles is not None:
        judge.needs(len(middles) == len(steps))
        for (a, b), row in zip(pairwise(angles), middles, strict=True):
            _state(judge, plan["contacts"], row, turned(load, (a + b) / 2, axis, 1 / cos((b - a) / 2)))
        return [*forces, *middles]
    for i, contact in enumerate(plan["contacts"]):
        if contact["max_force"] is not None:
            for k, step in enumerate(steps):
                f, g = forces[k][i], forces[k + 1][i]
                shares = [
                    (sin(step * (1 - s / 999)) / sin(step), sin(step * s / 999) / sin(step))
                    for s in range(1000)
                ]
                if len(f) > d:
                    f, g = ([*row[:d], float(_spun(contact, exact(row[d:])[0]))] for row in (f, g))
                most = max(hypot(*(a * x + b * y for x, y in zip(f, g, strict=True))) for a, b in shares)
                judge.at_most(most, contact["max_force"], Fraction(1, 10**6))
    return forces


def parts(load, axis):
    """(still, along, across) of a load that turns about an axis: w = still + cos along + sin across."""
    if axis is None:
        fx, fy, tau = load
        return [0.0, 0.0, tau], [fx, fy, 0.0], [fy, -fx, 0.0]
    still, across = [], []
    for v in (load[:3], load[3:]):
        along = sum(a * b for a, b in zip(axis, v, strict=True))
        still += [along * a for a in axis]
        x, y, z = axis
        across += [-(y * v[2] - z * v[1]), -(z * v[0] - x * v[2]), -(x * v[1] - y * v[0])]
    return still, [a - b for a, b in zip(load, still, strict=True)], across


def turned(load, angle, axis, stretch=1.0) -> list[float]:
    c, s = cos(angle) * stretch, sin(angle) * stretch
    return [a + c * b + s * q for a, b, q in zip(*parts(load, axis), strict=True)]


def _record(judge: Judge, plan: dict, record: dict, states: list, idle) -> None:
    contacts = plan["contacts"]
    judge.needs(0 <= exact([record["reserve"]])[0] < 1 and exact([record["balancing"]])[0] >= 0)
    judge.needs(record.get("path_objective") in PATHS and record.get("path", "x") != "")
    rates, least = record.get("rate_limits") or [], record.get("least_normals") or []
    judge.needs(len(rates) in (0, len(contacts)) and len(least) in (0, len(contacts)))
    judge.needs(all(rate is None or rate > 0 for rate in rates))
    if plan.get("course") is None:
        judge.needs(all(rate is None for rate in rates))
    for i, wanted in enumerate(least):
        judge.needs(exact([wanted])[0] >= 0)
        n = exact(contacts[i]["normal"])
        for row in states:
            push = dot(exact(row[i]), n)
            if wanted > 0:
                judge.at_most(Fraction(wanted) * (1 - EPS), max(push, Fraction(0)), Fraction(1, 10**14))
    for choice in record["choices"]:
        judge.needs(choice["end"] in ("start", "end") and choice["objective"] in OBJECTIVES)
        judge.needs(isinstance(choice["method"], str) and choice["method"] != "")
        used = [i for i, c in enumerate(contacts) if c["name"] not in idle[choice["end"] == "end"]]
        judge.needs(len(choice["force_limits"]) == len(used))
        for i, limit in zip(used, choice["force_limits"], strict=True):
            if limit is not None:
                f = exact(plan[choice["end"]][i])
                judge.needs(limit > 0)
                judge.at_most(dot(f, f), (exact([limit])[0] * (1 + EPS)) ** 2, Fraction(1, 10**14))


def _regrasp(judge: Judge, plan: dict) -> None:
    steps, angles = plan["steps"], plan["orientations"]
    judge.needs(len(steps) > 0 and len(angles) == len(steps) + 1)
    exact(angles)
    d = len(steps[0]["contacts"][0]["position"])
    rotations = plan.get("rotations")
    judge.needs((rotations is None) == (d == 2))
    for step in steps:
        _transition(judge, step)
        judge.needs(len(step["contacts"]) <= d + 1 and len(step["contacts"][0]["position"]) == d)
    first = [float(x) for x in exact(steps[0]["load"])]
    for k, step in enumerate(steps):
        turn = step.get("turn")
        by = turn["angles"][-1] if turn else 0
        off = abs(Fraction(angles[k + 1]) - Fraction(angles[k]) - Fraction(by))
        judge.at_most(off, EPS * max(1, abs(Fraction(by)), abs(Fraction(angles[k]))), Fraction(1, 100))
        for at, load in ((k, step["load"]), (k + 1, (turn or {}).get("end_load", step["load"]))):
            if d == 2:
                seen = turned(first, angles[at] - angles[0], None)[:2]
            else:
                world = [sum(a * b for a, b in zip(row, first, strict=False)) for row in rotations[0]]
                seen = [sum(rotations[at][i][j] * world[i] for i in range(3)) for j in range(3)]
            off = [a - b for a, b in zip(exact(load)[:d], exact(seen), strict=True)]
            judge.at_most(dot(off, off), EPS**2 * dot(exact(seen), exact(seen)), Fraction(1, 100))
            judge.needs(not any(load[d:]))
        if d == 3:
            _rotations(judge, rotations[k], rotations[k + 1], turn)
    for before, after in pairwise(steps):
        one, other = (
            {tuple(map(str, _where(c))): f for c, f in zip(s["contacts"], s[end], strict=True)}
            for s, end in ((before, "end"), (after, "start"))
        )
        judge.needs({k: f for k, f in one.items() if any(f)} == {k: f for k, f in other.items() if any(f)})
        judge.needs(len(one.keys() & other.keys()) >= min(len(one), len(other)) - 1)
    _margin(judge, plan, d)


def _where(contact: dict) -> list:
    may = [contact.get(key) for key in ("torsion", "limits")]
    return [*(contact[key] for key in ("name", "position", "normal", "friction", "max_force")), *may]


def _rotations(judge: Judge, before, after, turn) -> None:
    for matrix in (before, after):
        square = [[sum(matrix[k][i] * matrix[k][j] for k in range(3)) for j in range(3)] for i in range(3)]
        skew = max(abs(square[i][j] - (i == j)) for i in range(3) for j in range(3))
        judge.at_most(skew, EPS, Fraction(1, 100))
        judge.needs(dot(cross(*map(exact, matrix[:2])), exact(matrix[2])) > 0)
    if turn is None:
        off = max(abs(a - b) for x, y in zip(before, after, strict=True) for a, b in zip(x, y, strict=True))
    else:
        c, s, (x, y, z) = cos(turn["angles"][-1]), sin(turn["angles"][-1]), turn["axis"]
        k = [[0, -z, y], [z, 0, -x], [-y, x, 0]]
        r = [
            [c * (i == j) + (1 - c) * turn["axis"][i] * turn["axis"][j] + s * k[i][j] for j in range(3)]
            for i in range(3)
        ]
        way = [[sum(before[i][m] * r[m][j] for m in range(3)) for j in range(3)] for i in range(3)]
        off = max(abs(way[i][j] - after[i][j]) for i in range(3) for j in range(3))
    judge.at_most(off, EPS, Fraction(1, 100))


def _margin(judge: Judge, plan: dict, d: int) -> None:
    least = max(atan(c["friction"]) for step in plan["steps"] for c in step["contacts"])
    for step in plan["steps"][:-1]:
        sizes = [hypot(*f) for f in step["end"]]
        used = [k for k, size in enumerate(sizes) if size > float(EPS) * max(sizes)]
        if len(used) <= d:
            for k in used:
                c, f = step["contacts"][k], step["end"][k]
                push = sum(a * b for a, b in zip(f, c["normal"], strict=True))
                across = hypot(*(a - push * b for a, b in zip(f, c["normal"], strict=True)))
                least = min(least, atan(c["friction"]) - atan2(across, push))
    margin = exact([plan["margin"]])[0]
    judge.at_most(margin, max(Fraction(least) + EPS, Fraction(0)), Fraction(1, 10**13))
    assert least < inf

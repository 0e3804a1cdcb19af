"""The map of the house, made from its imports: python docs/architecture.py writes picture and list."""

import sys
from collections import Counter
from collections.abc import Callable
from functools import cache
from hashlib import sha256
from itertools import pairwise, permutations
from pathlib import Path

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "kit"))
from imports import imported, sources
from places import ROOT

IMAGES = ROOT / "docs" / "images"
PICTURE, LIST = IMAGES / "architecture.svg", IMAGES / "architecture.txt"
OWN = "the public names"
"""What stands for ``regrasp`` itself, whose ``__init__`` imports them."""

Edges = dict[str, Counter[str]]
"""Room -> how many imports it has of each other room; a module right below a floor is in the floor's own."""


def room_imports() -> Edges:
    """The imports between rooms today."""
    modules = sources(ROOT / "src" / "regrasp")
    folders = {".".join(name.split(".")[1:3]) for name in modules if name.count(".") > 2}
    folders |= {".".join(name.split(".")[1:3]) for name in modules if f"regrasp.{name}" in folders}

    def room(module: str) -> str:
        parts = module.split(".")[1:]
        whole = ".".join(parts[:2])
        return whole if whole in folders else (parts[0] if parts else OWN)

    edges: Edges = {room(module): Counter() for module in modules}
    for module in modules:
        for name in imported(module, modules):
            if name.split(".")[0] == "regrasp" and room(name) != room(module):
                edges[room(module)][room(name)] += 1
    return edges


def listed(edges: Edges) -> str:
    """Rooms and what they import, a line each."""
    return "".join(f"{room}: {', '.join(sorted(edges[room]))}".rstrip() + "\n" for room in sorted(edges))


def fingerprint(text: str) -> str:
    """What the picture carries to say which list it was drawn from."""
    return sha256(text.encode()).hexdigest()


def floor(room: str) -> str:
    """The floor that a room is on."""
    return room.partition(".")[0]


def between(edges: Edges, floor_of_both: str | None) -> dict[str, set[str]]:
    """Imports between floors, or between the rooms of one floor; of rooms that import each other the more."""
    found: dict[str, set[str]] = {}
    for a, others in edges.items():
        for b, count in others.items():
            if floor_of_both is None:
                a_, b_ = floor(a), floor(b)
                found.setdefault(a_, set()).update({b_} - {a_})
                found.setdefault(b_, set())
            elif floor(a) == floor(b) == floor_of_both and "." in a and "." in b:
                found.setdefault(a, set()).update({b} if (count, a) > (edges[b][a], b) else ())
    return found


def reduced(graph: dict[str, set[str]]) -> list[tuple[str, str]]:
    """The imports that do not follow from a chain of others."""

    @cache
    def below(a: str) -> frozenset[str]:
        return frozenset(graph.get(a, ())).union(*(below(b) for b in graph.get(a, ())))

    return sorted((a, b) for a in graph for b in graph[a] if not any(b in below(c) for c in graph[a]))


def levels(graph: dict[str, set[str]], nodes: list[str]) -> list[list[str]]:
    """Nodes by the longest chain of imports below them, the top first."""

    @cache
    def level(a: str) -> int:
        return 1 + max((level(b) for b in graph.get(a, ())), default=-1)

    rows: dict[int, list[str]] = {}
    for node in sorted(nodes):
        rows.setdefault(level(node), []).append(node)
    return [rows[k] for k in sorted(rows, reverse=True)]


# -- the picture: inches, y downwards ---------------------------------------------------------------------

WIDTH, GAP, HIGH, LETTER = 5.2, 0.32, 0.21, 0.068
TITLE, ROOM_GAP = 0.27, 0.2
DRAWN = "#b3541e", "#7a8ea3"
"""Colours of arrows between floors and between rooms."""
Points = list[tuple[float, float]]


class Rows:
    """Boxes in rows by what imports what; ``a>b`` is where an arrow from a to b passes through a row."""

    def __init__(
        self, widths: dict[str, float], graph: dict[str, set[str]], limit: float | None = None
    ) -> None:
        self.widths, self.arrows = widths, reduced(graph)
        rows: list[list[str]] = []
        for level in levels(graph, list(widths)):
            row: list[str] = []
            for name in sorted(level, key=lambda n: -widths[n]):
                if row and limit and sum(widths[n] + 0.3 for n in (*row, name)) > limit:
                    rows.append(row)
                    row = []
                row.append(name)
            rows.append(row)
        self.row_of = {name: k for k, row in enumerate(rows) for name in row}
        links: list[tuple[int, str, str]] = []  # from an item of row k to one of the row below
        for a, b in self.arrows:
            through = range(self.row_of[a] + 1, self.row_of[b])
            chain = [a, *(f"{a}>{b}" for _ in through), b]
            links += [(k, *pair) for k, pair in enumerate(pairwise(chain), start=self.row_of[a])]
            for k in through:
                rows[k].append(f"{a}>{b}")
        wide = max((sum(self._wide(name) + 0.1 for name in row) + 0.06 for row in rows), default=0.0)
        self.width = limit or wide
        self.rows = [self._spread(tuple(row)) for row in rows]
        for k in [*range(len(rows)), *reversed(range(len(rows)))] * 3:
            sides = [
                [(upper, lower) for j, upper, lower in links if j == k],
                [(lower, upper) for j, upper, lower in links if j == k - 1],
            ]
            near = [{} if not links else self.rows[j] for j in (min(k + 1, len(rows) - 1), k - 1)]
            self.rows[k] = self._best_order(rows[k], self.rows[k], lambda x, s=sides, n=near: _cost(x, s, n))

    def _best_order(
        self, row: list[str], now: dict[str, float], cost: Callable[[dict[str, float]], float]
    ) -> dict[str, float]:
        """Of few items the best of all orders; of more, each in turn goes where it costs least."""
        if len(row) <= 6:
            return min(map(self._spread, permutations(row)), key=cost)
        order = list(now)
        for name in row:
            rest = [other for other in order if other != name]
            places = [[*rest[:i], name, *rest[i:]] for i in range(len(order))]
            order = min(places, key=lambda items: cost(self._spread(tuple(items))))
        return self._spread(tuple(order))

    def _wide(self, name: str) -> float:
        return self.widths.get(name, 0.04)

    def _spread(self, order: tuple[str, ...]) -> dict[str, float]:
        """The middles of items side by side over the whole width."""
        free = (self.width - sum(map(self._wide, order))) / len(order)
        place, x = {}, 0.0
        for name in order:
            place[name] = x + (free + self._wide(name)) / 2
            x += free + self._wide(name)
        return place

    def routes(
        self, tops: list[float], heights: dict[str, float], gap: float
    ) -> dict[tuple[str, str], Points]:
        """The way of every arrow: down to the end of its row, through the rows between, to its box."""
        found = {}
        for a, b in self.arrows:
            x, first, last = self.rows[self.row_of[a]][a], self.row_of[a], self.row_of[b]
            points = [(x, tops[first] + heights[a]), (x, tops[first + 1] - gap * 0.8)]
            for k in range(first + 1, last):
                x = self.rows[k][f"{a}>{b}"]
                points += [(x, tops[k] - gap * 0.2), (x, tops[k + 1] - gap * 0.8)]
            found[a, b] = [*points, (self.rows[last][b], tops[last])]
        return found


def _cost(x: dict[str, float], sides: list[list[tuple[str, str]]], near: list[dict[str, float]]) -> float:
    """Crossings of arrows to the rows above and below, then how far they lead aside."""
    ends = [[(x[a], there[b]) for a, b in side] for side, there in zip(sides, near, strict=True)]
    crossed = sum((p[0] - q[0]) * (p[1] - q[1]) < 0 for side in ends for p in side for q in side)
    return 2 * crossed + sum(abs(p - q) for side in ends for p, q in side)


class Floor:
    """A floor's box: its name, and its rooms in rows."""

    def __init__(self, name: str, edges: Edges) -> None:
        rooms = [room for room in edges if floor(room) == name and "." in room]
        widths = {room: LETTER * len(room.partition(".")[2]) + 0.1 for room in rooms}
        self.rooms = Rows(widths, between(edges, name))
        self.width = max(LETTER * 1.15 * len(name) + 0.16, self.rooms.width)
        self.tops = [TITLE + k * (HIGH + ROOM_GAP) for k in range(len(self.rooms.rows))]
        self.height = self.tops[-1] + HIGH + 0.1 if rooms else TITLE
        self.arrows = self.rooms.routes(self.tops, dict.fromkeys(rooms, HIGH), ROOM_GAP)
        self.mutual = {(a, b) for a, b in self.arrows if edges[b][a]}


def figure(edges: Edges) -> Figure:
    """The map of a set of imports."""
    graph = between(edges, None)
    floors = {name: Floor(name, edges) for name in graph}
    rows = Rows({name: f.width for name, f in floors.items()}, graph, WIDTH)
    heights = {name: f.height for name, f in floors.items()}
    tops, y = [], 0.08
    for row in rows.rows:
        tops.append(y)
        y += max(heights[name] for name in row if name in floors) + GAP
    y += 0.08 - GAP
    drawing = Figure((WIDTH, y))
    ax = drawing.add_axes((0, 0, 1, 1))
    ax.set(xlim=(0, WIDTH), ylim=(y, 0))
    ax.axis("off")
    for points in rows.routes(tops, heights, GAP).values():
        _arrow(ax, points, DRAWN[0])
    for row, top in zip(rows.rows, tops, strict=True):
        for name, x in row.items():
            if name in floors:
                _draw_floor(ax, name, floors[name], x, top)
    return drawing


def _draw_floor(ax: Axes, name: str, shown: Floor, x: float, top: float) -> None:
    _box(ax, x, top, shown.width, shown.height, "#eef3f8", "#48688a")
    ax.text(x, top + TITLE / 2, name, ha="center", va="center", size=9, weight="bold", color="#1d3550")
    left = x - shown.rooms.width / 2
    for pair, points in shown.arrows.items():
        _arrow(ax, [(left + px, top + py) for px, py in points], DRAWN[1], both=pair in shown.mutual)
    for row, down in zip(shown.rooms.rows, shown.tops, strict=True):
        for room, at in row.items():
            if room in shown.rooms.widths:
                _box(ax, left + at, top + down, shown.rooms.widths[room], HIGH, "white", "#8aa3bd")
                middle = left + at, top + down + HIGH / 2
                ax.text(*middle, room.partition(".")[2], ha="center", va="center", size=8)


def _box(ax: Axes, x: float, top: float, width: float, height: float, face: str, edge: str) -> None:
    style = "round,pad=0,rounding_size=0.05"
    ax.add_patch(FancyBboxPatch((x - width / 2, top), width, height, style, fc=face, ec=edge, lw=0.8))


def _arrow(ax: Axes, points: Points, colour: str, both: bool = False) -> None:
    ax.plot(*zip(*points[:-1], strict=True), color=colour, lw=0.9)
    style = {"arrowstyle": "-|>", "color": colour, "lw": 0.9, "shrinkA": 0, "shrinkB": 0, "mutation_scale": 7}
    ax.annotate("", points[-1], points[-2], arrowprops=style)
    if both:
        ax.annotate("", points[0], points[1], arrowprops=style)


def draw() -> None:
    """Write the list and the picture of today's imports."""
    edges = room_imports()
    text = listed(edges)
    LIST.write_text(text, encoding="utf-8")
    with rc_context({"svg.hashsalt": "regrasp"}):
        figure(edges).savefig(PICTURE, metadata={"Date": None, "Description": fingerprint(text)})


if __name__ == "__main__":
    draw()

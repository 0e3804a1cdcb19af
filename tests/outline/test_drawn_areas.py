"""Areas of a hundred random drawings against Green's theorem on what was drawn, and against other readers."""

from pathlib import Path

import ezdxf
import numpy as np
import pytest
import shapely
from ezdxf import path as dxf_path
from svgpathtools import parse_path

import regrasp as rg
from drawings import (
    Arc,
    Cubic,
    Line,
    area,
    ellipse,
    mapped,
    path_data,
    random_loop,
    random_transform,
    rectangle,
)

pytestmark = pytest.mark.oracle

FINE = 1e-5


def cells(rng: np.random.Generator, count: int) -> list[tuple[float, float]]:
    """Places for holes of half extent 0.9 within 3.6 of the origin."""
    grid = [(x, y) for x in (-2.0, 0.0, 2.0) for y in (-2.0, 0.0, 2.0)]
    return [grid[i] for i in rng.permutation(9)[:count]]


def check(path: Path, expected: float, holes: int) -> rg.Outline:
    """Exactly with fine chords, as near as chords are by default."""
    fine = rg.Outline.from_file(path, tolerance=FINE)
    assert fine.area == pytest.approx(expected, rel=1e-5)
    assert len(fine.holes) == holes
    coarse = rg.Outline.from_file(path)
    assert coarse.area == pytest.approx(expected, rel=2e-3)
    return fine


# -- SVG ----------------------------------------------------------------------------------------------------


def hole_element(rng: np.random.Generator, at: tuple[float, float], number: int) -> tuple[str, float]:
    """A hole as an element, and its area."""
    x, y = at
    a, b = rng.uniform(0.3, 0.85, 2)
    kind = rng.integers(7)
    if kind == 0:
        return f'<circle cx="{x}" cy="{y}" r="{a}"/>', np.pi * a**2
    if kind == 1:
        return f'<ellipse cx="{x}" cy="{y}" rx="{a}" ry="{b}"/>', np.pi * a * b
    if kind == 2:
        r = 0.3 * min(a, b)
        body = f'<rect x="{x - a}" y="{y - b}" width="{2 * a}" height="{2 * b}" rx="{r}"/>'
        return body, 4 * a * b - (4 - np.pi) * r**2
    if kind == 3:
        loop = random_loop(rng, 0.85, at)
        return f'<path style="fill:red" d="{path_data(rng, loop, close="")}"/>', area(loop)
    if kind == 4:
        loop = random_loop(rng, 0.85, (0, 0))
        d = path_data(rng, loop)
        return f'<defs><path id="h{number}" d="{d}"/></defs><use href="#h{number}" x="{x}" y="{y}"/>', area(
            loop
        )
    if kind == 5:
        loop = random_loop(rng, 8.0, (10, 10))
        inner = f'<svg x="{x - 1}" y="{y - 1}" width="2" height="2" viewBox="0 0 20 20">'
        return f'{inner}<path d="{path_data(rng, loop)}"/></svg>', area(loop) / 100
    loop = random_loop(rng, 0.85)
    turn = f"transform: translate({x}px, {y}px) scale({a:.3f})"
    return f'<path style="{turn}" d="{path_data(rng, loop)}"/>', area(loop) * float(f"{a:.3f}") ** 2


@pytest.mark.parametrize("seed", range(50))
def test_svg_under_any_map(tmp_path: Path, seed: int) -> None:
    rng = np.random.default_rng(seed)
    outer = random_loop(rng, 10.0)
    holes = [hole_element(rng, at, k) for k, at in enumerate(cells(rng, int(rng.integers(0, 6))))]
    body = f'<path d="{path_data(rng, outer)}"/>' + "".join(text for text, _ in holes)
    factor, depth = 1.0, int(rng.integers(1, 4))
    for _ in range(depth):
        text, matrix = random_transform(rng)
        factor *= abs(np.linalg.det(matrix[:, :2]))
        body = f'<g transform="{text}">{body}</g>'
    drawing = tmp_path / "drawing.svg"
    drawing.write_text(f'<svg xmlns="http://www.w3.org/2000/svg">{body}</svg>')
    expected = factor * (area(outer) - sum(size for _, size in holes))
    check(drawing, expected, len(holes))


@pytest.mark.parametrize("seed", range(10))
def test_path_data_as_another_reader_has_it(tmp_path: Path, seed: int) -> None:
    """Without transforms, under which its arcs are wrong, svgpathtools is a second witness."""
    rng = np.random.default_rng(1000 + seed)
    data = path_data(rng, random_loop(rng, 10.0))
    drawing = tmp_path / "drawing.svg"
    drawing.write_text(f'<svg xmlns="http://www.w3.org/2000/svg"><path d="{data}"/></svg>')
    theirs = parse_path(data)
    points = np.array([piece.point(t) for piece in theirs for t in np.linspace(0, 1, 400, endpoint=False)])
    dense = shapely.Polygon(np.column_stack([points.real, -points.imag])).area
    assert rg.Outline.from_file(drawing, tolerance=FINE).area == pytest.approx(dense, rel=1e-5)


# -- DXF ----------------------------------------------------------------------------------------------------


def draw(space, rng: np.random.Generator, loop: list) -> None:
    """A loop as one polyline with bulges, or piece by piece in any order and direction."""
    if len(loop) == 1:
        (arc,) = loop
        if np.hypot(*arc.u) == np.hypot(*arc.v):
            space.add_circle(arc.centre, np.hypot(*arc.u))
        else:
            space.add_ellipse(arc.centre, (*arc.u, 0), np.hypot(*arc.v) / np.hypot(*arc.u))
        return
    if not any(isinstance(segment, Cubic) for segment in loop) and rng.integers(2):
        rows = [(*s.a, np.tan((s.end - s.start) / 4) if isinstance(s, Arc) else 0.0) for s in loop]
        add = space.add_lwpolyline if rng.integers(2) else space.add_polyline2d
        add(rows, format="xyb", close=True)
        return
    for k in rng.permutation(len(loop)):
        segment = loop[k]
        if isinstance(segment, Line):
            ends = [segment.a, segment.b]
            space.add_line(*ends[:: rng.choice([1, -1])])
        elif isinstance(segment, Cubic):
            space.add_open_spline([(*p, 0) for p in segment.control], degree=3)
        else:
            begin = np.arctan2(segment.u[1], segment.u[0])
            ends = np.degrees([begin, begin + segment.end - segment.start])
            space.add_arc(segment.centre, np.hypot(*segment.u), *sorted(ends))


def reference(rng: np.random.Generator) -> tuple[dict, float]:
    """Attributes of a random insert and the determinant of its map."""
    sx, sy = rng.uniform(0.4, 2.5, 2) * rng.choice([-1, 1], 2)
    attributes = {"xscale": sx, "yscale": sy, "zscale": 1.0, "rotation": rng.uniform(0, 360)}
    if rng.integers(3) == 0:
        attributes["extrusion"] = (0, 0, -1)
    return attributes, abs(sx * sy)


def nested(doc, rng: np.random.Generator) -> tuple[float, int]:
    """Draw a part in blocks within blocks; its area and how many holes it has."""
    part = doc.blocks.new("PART", base_point=rng.uniform(-5, 5, 2))
    outer = random_loop(rng, 10.0, kinds="LCB")
    draw(part, rng, outer)
    expected, count = area(outer), 0
    if rng.integers(2):  # an array of holes, turned with its insert and not scaled
        hole = doc.blocks.new("HOLE")
        loop = ellipse((0, 0), 0.5, 0.3) if rng.integers(2) else rectangle(-0.4, -0.3, 0.8, 0.6)
        draw(hole, rng, loop)
        rows, columns = (int(k) for k in rng.integers(1, 4, 2))
        scales = rng.uniform(0.5, 1.2, 2) * rng.choice([-1, 1], 2)
        turn = rng.uniform(0, 2 * np.pi)
        first = -0.75 * np.array([columns - 1, rows - 1])
        c, s = np.cos(turn), np.sin(turn)
        part.add_blockref("HOLE", np.array([[c, -s], [s, c]]) @ first, {
            "rotation": np.degrees(turn), "xscale": scales[0], "yscale": scales[1],
            "row_count": rows, "column_count": columns, "row_spacing": 1.5, "column_spacing": 1.5,
        })  # fmt: skip
        expected -= rows * columns * area(loop) * abs(scales[0] * scales[1])
        count += rows * columns
    else:
        for at in cells(rng, int(rng.integers(0, 6))):
            loop = random_loop(rng, 0.85, at, kinds="LCB") if rng.integers(2) else ellipse(at, 0.6, 0.6)
            draw(part, rng, loop)
            expected, count = expected - area(loop), count + 1
    inner = "PART"
    for depth in range(int(rng.integers(1, 4))):
        attributes, factor = reference(rng)
        place = (
            doc.modelspace() if depth == 2 else doc.blocks.new(f"B{depth}", base_point=rng.uniform(-9, 9, 2))
        )
        place.add_blockref(inner, rng.uniform(-50, 50, 2), attributes)
        expected, inner = expected * factor, f"B{depth}"
    if inner != "B2":
        attributes, factor = reference(rng)
        doc.modelspace().add_blockref(inner, (0, 0), attributes)
        expected *= factor
    return expected, count


@pytest.mark.parametrize("seed", range(40))
def test_dxf_in_blocks_in_blocks(tmp_path: Path, seed: int) -> None:
    rng = np.random.default_rng(seed)
    doc = ezdxf.new()
    expected, count = nested(doc, rng)
    doc.saveas(tmp_path / "drawing.dxf")
    check(tmp_path / "drawing.dxf", expected, count)


def periodic(points: np.ndarray, weights: np.ndarray) -> float:
    """The area inside the closed uniform cubic B-spline of control points, by dense points of its basis."""
    t = np.linspace(0, 1, 1000, endpoint=False)
    basis = np.stack([(1 - t) ** 3, 3 * t**3 - 6 * t**2 + 4, -3 * t**3 + 3 * t**2 + 3 * t + 1, t**3]) / 6
    control = np.column_stack([points[:, :2] * weights[:, None], weights])
    n = len(control)
    dense = np.concatenate([basis.T @ control[np.arange(i, i + 4) % n] for i in range(n)])
    return shapely.Polygon(dense[:, :2] / dense[:, 2:]).area


@pytest.mark.parametrize("seed", range(12))
def test_dxf_splines_and_part_ellipses(tmp_path: Path, seed: int) -> None:
    """Fitted splines against ezdxf's flattening, closed ones, on which it errs, against their basis."""
    rng = np.random.default_rng(seed)
    doc = ezdxf.new()
    space = doc.modelspace()
    turn = np.arange(9) * 2 * np.pi / 9
    points = rng.uniform(7, 10, 9)[:, None] * np.column_stack([np.cos(turn), np.sin(turn), 0 * turn])
    weights = rng.uniform(0.5, 2, 9) if seed % 3 == 2 else np.ones(9)
    if seed % 3 == 0:
        spline = space.add_spline([*points, points[0]])
        expected = flattened(spline)
    else:
        spline = space.add_spline()
        if seed % 3 == 1:
            spline.set_closed(points, degree=3)
        else:
            spline.set_closed_rational(points, weights, degree=3)
        expected = periodic(points, weights)
    hole = space.add_ellipse((0, 0), (2, 1, 0), rng.uniform(0.3, 1), 0.3, 0.3 + 4)
    space.add_line(*hole.vertices([0.3, 4.3]))
    doc.saveas(tmp_path / "drawing.dxf")
    found = rg.Outline.from_file(tmp_path / "drawing.dxf", tolerance=FINE)
    assert found.area == pytest.approx(expected - flattened(hole), rel=1e-5)


def flattened(entity) -> float:
    """The area inside an entity as ezdxf has it."""
    return shapely.Polygon([(p.x, p.y) for p in dxf_path.make_path(entity).flattening(1e-6, 200)]).area


def test_the_generator_knows_its_areas() -> None:
    rng = np.random.default_rng(0)
    assert area(ellipse((3, 4), 2, 1)) == pytest.approx(2 * np.pi)
    assert area(rectangle(1, 2, 3, 4)) == pytest.approx(12)
    for _ in range(20):
        loop, m = random_loop(rng, 10.0), rng.normal(size=(2, 2))
        assert area(mapped(loop, m, rng.normal(size=2))) == pytest.approx(area(loop) * abs(np.linalg.det(m)))

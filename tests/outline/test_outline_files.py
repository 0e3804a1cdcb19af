"""Outlines written by the test come back from SVG, DXF and coordinates; what is no outline is refused."""

import sys
from collections.abc import Callable
from math import pi
from pathlib import Path

import ezdxf
import numpy as np
import pytest

import regrasp as rg
from regrasp.outline import parts
from regrasp.outline.chains import joined
from regrasp.outline.flatten import Curve, flattened

pytestmark = pytest.mark.contract

TRAPEZIUM = np.array([[1.0, 2.0], [5.0, 2.0], [4.0, 5.0], [1.0, 4.0]])
HOLE = np.array([[2.0, 2.5], [3.0, 2.5], [3.0, 3.5]])
EXPECTED = rg.Outline(TRAPEZIUM, [HOLE])


def svg(folder: Path, body: str) -> Path:
    path = folder / "drawing.svg"
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 9 9">{body}</svg>')
    return path


def dxf(folder: Path, draw: Callable) -> Path:
    drawing = ezdxf.new()
    draw(drawing.modelspace())
    drawing.saveas(folder / "drawing.dxf")
    return folder / "drawing.dxf"


def text(folder: Path, content: str, name: str = "drawing.csv") -> Path:
    (folder / name).write_text(content)
    return folder / name


def flipped(points: np.ndarray) -> str:
    return " ".join(f"{x},{-y}" for x, y in points)


def measures(outline: rg.Outline) -> list[float]:
    return [outline.length, outline.area, *outline.centre_of_mass]


# -- coordinates ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("separator", [",", " ", ";", "\t", ", "])
@pytest.mark.parametrize("name", ["a.csv", "a.txt", "a.DAT"])
def test_coordinates(tmp_path: Path, separator: str, name: str) -> None:
    rings = ["\n".join(f"{x}{separator}{y}" for x, y in ring) for ring in (HOLE, TRAPEZIUM)]
    found = rg.Outline.from_file(
        text(tmp_path, "# of mine\nx,y\n" + "\n\n\n".join(rings) + " # last\n", name)
    )
    assert found == EXPECTED


def test_scale(tmp_path: Path) -> None:
    path = text(tmp_path, "0 0\n40 0\n40 20\n0 20")
    assert rg.Outline.from_file(str(path), scale=0.5) == rg.Outline([[0, 0], [20, 0], [20, 10], [0, 10]])


@pytest.mark.parametrize("name", parts.PARTS)
def test_a_part_comes_back(tmp_path: Path, name: str) -> None:
    part = parts.PARTS[name]()
    rings = [ring + part.centre_of_mass for ring in (part.polygon(), *part.hole_polygons())]
    np.savetxt(tmp_path / "part.txt", np.vstack([row for ring in rings for row in (ring, [[np.nan] * 2])]))
    content = (tmp_path / "part.txt").read_text().replace("nan nan", "")
    found = rg.Outline.from_file(text(tmp_path, content))
    np.testing.assert_allclose(measures(found), measures(part), rtol=1e-3, atol=1e-6)
    assert len(found.holes) == len(part.holes)


# -- SVG --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "body",
    [
        f'<polygon points="{flipped(TRAPEZIUM)}"/><polygon points="{flipped(HOLE)}"/>',
        f'<g><path d="M {flipped(TRAPEZIUM)} Z M {flipped(HOLE)} Z"/></g>',
        f'<path d="M {flipped(HOLE)} Z"/><g transform="translate(3 4)"><g transform="scale(0.5)">'
        f'<polygon points="{flipped(2 * (TRAPEZIUM - (3, -4)))}"/></g></g>',
        f'<polyline points="{flipped(np.vstack([TRAPEZIUM, TRAPEZIUM[:1]]))}"/>'
        f'<polygon points="{flipped(HOLE)}"/>',
        '<line x1="1" y1="-2" x2="5" y2="-2"/><line x1="4" y1="-5" x2="5" y2="-2"/>'
        '<path d="M 1,-2 1,-4 4,-5"/>' + f'<polygon points="{flipped(HOLE)}"/>',
    ],
    ids=["polygons", "path", "transforms", "polyline", "lines"],
)
def test_straight_svg(tmp_path: Path, body: str) -> None:
    found = rg.Outline.from_file(svg(tmp_path, body))
    np.testing.assert_allclose(measures(found), measures(EXPECTED), rtol=1e-12)
    assert found.boundary.vertices.shape == (4, 2)


CURVED = {
    "circle": ('<circle cx="1" cy="-2" r="3"/>', 6 * pi, 9 * pi, [1, 2]),
    "ellipse": ('<ellipse cx="1" cy="-2" rx="3" ry="3" transform="scale(1 1)"/>', 6 * pi, 9 * pi, [1, 2]),
    "turned": ('<ellipse rx="2" ry="1" transform="rotate(30) scale(2 4)"/>', 8 * pi, 16 * pi, [0, 0]),
    "rounded": (
        '<rect x="1" y="-4" width="6" height="4" rx="1"/>', 12 + 2 * pi, 20 + pi, [4, 2],
    ),
    "holed": ('<circle r="2"/><circle r="1"/>', 4 * pi, 3 * pi, [0, 0]),
    "arcs": ('<path d="M0,-2 A2,2 0 0 1 0,2 L0,-2"/>', 2 * pi + 4, 2 * pi, [8 / (3 * pi), 0]),
    "parabola": ('<path d="M-1,0 Q0,-2 1,0 Z"/>', 4.957885715, 4 / 3, [0, 0.4]),
}  # fmt: skip


@pytest.mark.parametrize("name", CURVED)
def test_curved_svg(tmp_path: Path, name: str) -> None:
    body, length, area, centre = CURVED[name]
    found = rg.Outline.from_file(svg(tmp_path, body))
    assert found.length == pytest.approx(length, rel=2e-4)
    assert found.area == pytest.approx(area, rel=4e-4)
    np.testing.assert_allclose(found.centre_of_mass, centre, atol=1e-3)
    finer = rg.Outline.from_file(tmp_path / "drawing.svg", tolerance=1e-7)
    assert finer.area == pytest.approx(area, rel=1e-6)


def test_svg_turns_y_up(tmp_path: Path) -> None:
    found = rg.Outline.from_file(svg(tmp_path, '<polygon points="0,0 4,0 0,3"/>'))
    assert found == rg.Outline([[0, 0], [4, 0], [0, -3]])


# -- DXF --------------------------------------------------------------------------------------------------


def stadium(space) -> None:
    """Two half circles and two lines, in no order, a circular hole, and what is not an outline."""
    space.add_line((0, 1), (3, 1))
    space.add_arc((3, 0), 1, 270, 90)
    space.add_arc((0, 0), 1, 90, 270)
    space.add_line((3, -1), (0, -1))
    space.add_circle((0, 0), 0.5)
    space.add_text("stadium")
    space.add_point((9, 9))


def bulged(space) -> None:
    space.add_lwpolyline([(0, -1, 0), (3, -1, 1), (3, 1, 0), (0, 1, 1)], format="xyb", close=True)
    space.add_ellipse((0, 0), (0.5, 0), 1)


def old_polyline(space) -> None:
    space.add_polyline2d([(0, -1, 0), (3, -1, 1), (3, 1, 0), (0, 1, 1)], format="xyb", close=True)
    space.add_arc((0, 0), 0.5, 0, 180)
    space.add_arc((0, 0), 0.5, 180, 360)


def block(space) -> None:
    stadium(space.doc.blocks.new("PART"))
    space.add_blockref("PART", (0, 0))


@pytest.mark.parametrize("draw", [stadium, bulged, old_polyline, block])
def test_dxf(tmp_path: Path, draw: Callable) -> None:
    found = rg.Outline.from_file(dxf(tmp_path, draw), tolerance=1e-6)
    area = 6 + pi - pi / 4
    assert found.length == pytest.approx(6 + 2 * pi, rel=1e-6)
    assert found.area == pytest.approx(area, rel=1e-6)
    np.testing.assert_allclose(found.centre_of_mass, [1.5 * (6 + pi) / area, 0], atol=1e-5)


def test_a_dxf_ellipse_and_spline(tmp_path: Path) -> None:
    ellipse = rg.Outline.from_file(
        dxf(tmp_path, lambda space: space.add_ellipse((1, 1), (2, 2), 0.5)), tolerance=1e-6
    )
    assert ellipse.area == pytest.approx(pi * 8 / 2, rel=1e-6)
    points = [(0, 0), (3, 0), (4, 2), (1, 3), (0, 0)]
    spline = rg.Outline.from_file(dxf(tmp_path, lambda space: space.add_spline(points)), tolerance=1e-6)
    for point in points:
        foot = spline.points(spline.nearest(point)) + spline.centre_of_mass
        np.testing.assert_allclose(foot, point, atol=1e-5)


# -- chords and chains ------------------------------------------------------------------------------------


@pytest.mark.parametrize("tolerance", [1e-2, 1e-5])
def test_chords_stay_near_and_turn_little(tolerance: float) -> None:
    circle = Curve(lambda t: np.column_stack([np.cos(t), np.sin(t)]), 0.0, 2 * pi)
    chords = flattened(circle, tolerance)
    middles = (chords[1:] + chords[:-1]) / 2
    assert 1 - np.hypot(*middles.T).min() <= tolerance
    outline = rg.Outline(chords)
    assert outline.boundary.corners.size == 0
    assert len(chords) > 180


def test_pieces_join_in_any_order_and_direction() -> None:
    rng = np.random.default_rng(0)
    for _ in range(50):
        rings = [TRAPEZIUM, HOLE]
        pieces = [np.array([a, b]) for ring in rings for a, b in zip(ring, np.roll(ring, -1, 0), strict=True)]
        pieces = [piece[:: rng.choice([1, -1])] + 1e-4 * rng.random((2, 2)) for piece in pieces]
        rng.shuffle(order := np.arange(len(pieces)))
        found = sorted(
            (rg.Outline(ring) for ring in joined([pieces[i] for i in order], 1e-3)), key=lambda o: o.area
        )
        assert [o.area for o in found] == pytest.approx([0.5, rg.Outline(TRAPEZIUM).area], abs=2e-3)


def test_steps_shorter_than_the_tolerance_do_not_close_a_ring() -> None:
    turn = np.linspace(0, 2 * pi, 500)
    circle = np.column_stack([np.cos(turn), np.sin(turn)])
    (ring,) = joined([circle[i : i + 2] for i in range(499)], 0.1)
    assert len(ring) == 499


# -- what is refused --------------------------------------------------------------------------------------

RING = '<polygon points="0,0 4,0 4,3 0,3"/>'


@pytest.mark.parametrize(
    ("body", "says"),
    [
        ("", "the drawing is empty: it has no lines or curves that could be an outline"),
        ("<text>part</text>", "the drawing is empty: it has no lines or curves that could be an outline"),
        (
            '<path fill="none" stroke="black" d="M0,0 4,0 4,-3 0,-3"/>',
            "the outline is open: it ends at (0, 3), 3 from its start (0, 0); "
            "ends within 0.0004 would be joined",
        ),
        ('<polygon points="0,0 2,-2 2,0 0,-2"/>',
            "outline crosses or touches itself near (1, 1); "
            "it must be a simple closed curve"),
        (RING + '<circle cx="9" cy="9" r="1"/>',
            "there are several outlines: one at (8, -9) is outside the largest; "
            "keep one object in a file"),
        (RING + '<circle cx="4" cy="2" r="1"/>', "hole 0 must lie inside the outline without touching it"),
        (RING + '<circle cx="2" cy="1.5" r="1"/><circle cx="2" cy="1.5" r="0.5"/>',
            "there is a closed curve at (1.5, -1.5) inside a hole: what is inside a hole is another object; "
            "if the outermost curve is the frame of a sheet, leave it out of the file"),
        (RING + '<circle cx="2" cy="1.5" r="0.6"/><circle cx="2.8" cy="1.5" r="0.5"/>',
            "holes 0 and 1 overlap or touch; give their union as one hole"),
        ("<g>", "the file cannot be read as SVG: mismatched tag: line 1, column 63"),
        ('<circle r="wide"/>', "the file cannot be read as SVG: could not convert string to float: 'wide'"),
        (f'<g transform="spin(3)">{RING}</g>', "the file cannot be read as SVG: "),
    ],
)  # fmt: skip
def test_svg_refused(tmp_path: Path, body: str, says: str) -> None:
    path = svg(tmp_path, body)
    with pytest.raises(rg.InvalidInput) as caught:
        rg.Outline.from_file(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: {says}")
    assert "\n" not in message
    assert message == f"{path}: {says}" or says.endswith(": ")


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ("", "the file is empty: it has no lines of two numbers, x and y"),
        ("# nothing\n\n", "the file is empty: it has no lines of two numbers, x and y"),
        ("0 0\n1 0\n1 one\n", "line 3 must be two numbers, x and y; got '1 one'"),
        ("0 0\n1 0 0\n", "line 2 must be two numbers, x and y; got '1 0 0'"),
        ("x y\na b\n", "line 2 must be two numbers, x and y; got 'a b'"),
        ("0 0\n1 0\n", "outline needs three different points or more, got 2"),
        ("0 0\n1 0\nnan 1\n", "outline must be finite"),
        ("0 0\n1 1\n1 0\n0 1\n", "outline crosses or touches itself near (0.5, 0.5)"),
    ],
)
def test_coordinates_refused(tmp_path: Path, content: str, says: str) -> None:
    path = text(tmp_path, content)
    with pytest.raises(rg.InvalidInput) as caught:
        rg.Outline.from_file(path)
    assert str(caught.value).startswith(f"{path}: {says}")


def test_files_refused(tmp_path: Path) -> None:
    (tmp_path / "bytes.csv").write_bytes(b"\xff\xfe\x00")
    (tmp_path / "words.dxf").write_text("no drawing")
    for path, says in {
        tmp_path / "none.svg": "expected a file with an outline, found none",
        tmp_path: "expected a file with an outline, found none",
        text(
            tmp_path, "", "part.step"
        ): "the kind of file must be one of .svg, .dxf, .csv, .txt, .dat; got '.step'",
        tmp_path / "bytes.csv": "the file cannot be read as text: ",
        tmp_path / "words.dxf": "the file cannot be read as DXF: ",
        dxf(tmp_path, lambda space: None): "the drawing is empty",
    }.items():
        with pytest.raises(rg.InvalidInput) as caught:
            rg.Outline.from_file(path)
        assert str(caught.value).startswith(f"{path}: {says}")


def test_an_open_dxf_says_where(tmp_path: Path) -> None:
    path = dxf(tmp_path, lambda space: space.add_lwpolyline([(0, 0), (4, 0), (4, 3), (0.5, 0)]))
    with pytest.raises(rg.InvalidInput, match=r"it ends at \(0.5, 0\), 0.5 from its start \(0, 0\)"):
        rg.Outline.from_file(path)
    assert rg.Outline.from_file(path, tolerance=0.6).area > 4


def test_without_the_extra(tmp_path: Path, monkeypatch) -> None:
    path = text(tmp_path, "", "part.dxf")
    drawn = svg(tmp_path, RING)
    for package in ("svgpathtools", "ezdxf"):
        for module in [name for name in sys.modules if name.split(".")[0] == package] + [package]:
            monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(ImportError, match=r"^reading DXF needs ezdxf: pip install 'regrasp\[outlines\]'$"):
        rg.Outline.from_file(path)
    assert rg.Outline.from_file(drawn).area == 12  # SVG needs no extra

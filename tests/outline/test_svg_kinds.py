"""What is seen in an SVG is read, the rest left out and said so."""

from math import pi
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import regrasp as rg
from drawing_files import RECT, svg
from refusals import refused

pytestmark = pytest.mark.contract


HOLE = '<circle cx="5" cy="5" r="2"/>'


HOLED = 200 - 4 * pi


ARC20 = "A20 10 45 1 1 "


CORNER = "14.142135623730951"


SEEN = {
    "flipped ellipse": (
        f'<path transform="scale(1,-1)" d="M-{CORNER} -{CORNER} {ARC20}{CORNER} {CORNER} '
        f'{ARC20}-{CORNER} -{CORNER} Z"/>',
        200 * pi,
    ),
    "arc under unequal scale": (
        '<path transform="scale(1,2)" d="M0,0 A 10,10 45 0,1 10,10z"/>', 50 * pi - 100,
    ),
    "use": ('<defs><circle id="h" cx="5" cy="5" r="2"/></defs>' + RECT + '<use xlink:href="#h"/>', HOLED),
    "use of a use": (
        f'<defs><g id="a">{HOLE}</g><use id="b" href="#a" x="1"/></defs>{RECT}<use href="#b" y="1"/>', HOLED,
    ),
    "symbol": (
        '<symbol id="s" viewBox="0 0 10 10"><circle cx="5" cy="5" r="5"/></symbol>'
        + RECT + '<use href="#s" x="3" y="3" width="4" height="4"/>', HOLED,
    ),
    "style transform": ('<rect width="20" height="10" style="transform:scale(2)"/>', 800),
    "style transform in units": (
        '<rect width="20" height="10" style="transform: rotate(90deg) scale(1.5, 2)"/>', 600,
    ),
    "transform about an origin": (
        '<rect width="20" height="10"/>'
        '<circle cx="5" cy="5" r="2" style="transform-origin:5px 5px;transform:scale(.5)"/>',
        200 - pi,
    ),
    "style sheet": (
        "<style>/* old */ .part > rect { transform: scale(2) } @media print { rect { display: none } }"
        "</style>"
        f'<g class="part">{RECT}</g>', 800,
    ),
    "the style attribute before the sheet": (
        '<style>rect{transform:scale(9)}</style><rect width="20" height="10" style="transform:none"/>', 200,
    ),
    "rounding more than half a side": ('<rect width="20" height="10" rx="50" ry="5"/>', 50 * pi),
    "rounding by one radius": ('<rect width="20" height="10" ry="5"/>', 200 - (100 - 25 * pi)),
    "nested": ('<svg x="0" y="0" width="40" height="20" viewBox="0 0 20 10">' + RECT + "</svg>", 800),
    "nested, fitted": ('<svg width="40" height="40" viewBox="0 0 20 10">' + RECT + "</svg>", 800),
    "nested, stretched": (
        f'<svg width="40" height="40" viewBox="0 0 20 10" preserveAspectRatio="none">{RECT}</svg>', 1600,
    ),
    "filled and open": ('<path d="M0 0H20V10H0"/>', 200),
    "filled and open twice": ('<path d="M0 0H20V10H0M3 3V7H7V3"/>', 184),
    "not filled, joined": (
        '<g fill="none" stroke="red"><path d="M0 0H20V10"/><path d="M0 0V10H20"/></g>', 200,
    ),
    "units": ('<rect width="20mm" height="1cm"/>', 200 * (96 / 25.4) ** 2),
    "flags without spaces": ('<path d="M0 0a10 10 0 0120 0z"/>', 50 * pi),
    "arc that ends where it begins": ('<path d="M0 0A5 5 0 1 1 0 0H20V10H0Z"/>', 200),
    "arc too small to reach": ('<path d="M0 0A1 1 0 0 1 20 0Z"/>', 50 * pi),
    "a size that is none": (f'<svg width="20" height="10" viewBox="none">{RECT}</svg>', 200),
    "utf-8 names": (f'<g id="größe">{RECT}</g>', 200),
}  # fmt: skip


@pytest.mark.parametrize("name", SEEN)
def test_svg_is_read_as_it_is_seen(tmp_path: Path, name: str) -> None:
    body, area = SEEN[name]
    found = rg.Outline.from_file(svg(tmp_path, body), tolerance=1e-5)
    assert found.area == pytest.approx(area, rel=2e-6)


HIDDEN = [
    '<circle cx="5" cy="5" r="2" style="display:none"/>',
    '<g display="none"><g><circle cx="5" cy="5" r="2"/></g></g>',
    '<g visibility="hidden"><circle cx="5" cy="5" r="2"/></g>',
    '<style>.off{display:none}</style><circle class="on off" cx="5" cy="5" r="2"/>',
    '<style>#no{visibility:collapse}</style><circle id="no" cx="5" cy="5" r="2"/>',
    '<style>circle{display:none !important}</style><circle style="display:inline" cx="5" cy="5" r="2"/>',
    '<circle cx="5" cy="5" r="2" fill="none"/>',
    '<circle cx="5" cy="5" r="2" opacity="0"/>',
    '<circle cx="5" cy="5" r="2" fill-opacity="0%" stroke="red" stroke-width="0"/>',
    '<clipPath id="c"><rect x="30" width="5" height="5"/></clipPath>'
    '<circle cx="5" cy="5" r="2" clip-path="url(#c)"/>',
]  # fmt: skip


@pytest.mark.parametrize("hidden", HIDDEN)
def test_what_svg_hides_is_no_hole(tmp_path: Path, hidden: str) -> None:
    found = rg.Outline.from_file(svg(tmp_path, RECT + hidden))
    assert found.area == pytest.approx(200)
    assert any("left out" in note for note in found.notes)


def test_what_is_shown_again_inside_hidden_is_seen(tmp_path: Path) -> None:
    body = f'{RECT}<g visibility="hidden"><g visibility="visible">{HOLE}</g></g>'
    assert rg.Outline.from_file(svg(tmp_path, body)).area == pytest.approx(HOLED, rel=1e-4)


def test_a_drawing_without_paint_is_read(tmp_path: Path) -> None:
    found = rg.Outline.from_file(svg(tmp_path, f'<g fill="none">{RECT}</g>'))
    assert (found.area, found.notes) == (
        200,
        ("nothing else is drawn, so read: 1 curve with neither fill nor stroke",),
    )


def test_a_clip_is_followed_or_said(tmp_path: Path) -> None:
    clip = (
        '<clipPath id="c"><rect x="-1" y="-1" width="{}" height="50"/></clipPath><g clip-path="url(#c)">'
        + RECT
        + "</g>"
    )
    assert rg.Outline.from_file(svg(tmp_path, clip.format(50))).notes == ()
    assert rg.Outline.from_file(svg(tmp_path, clip.format(10))).area == pytest.approx(90)
    inside = (
        HOLE.replace("<circle", '<circle clip-path="url(#c)"') + RECT
    )  # within the shape: it is cut to the clip
    around = '<clipPath id="c"><rect x="4" y="4" width="2" height="2"/></clipPath>'
    assert rg.Outline.from_file(svg(tmp_path, around + inside)).area == pytest.approx(196)
    overlapping = clip.replace("</clipPath>", '<rect x="5" width="9" height="5"/></clipPath>').format(10)
    with pytest.warns(UserWarning, match="cut by a clip-path, which is not followed: 1 rect") as warned:
        assert rg.Outline.from_file(svg(tmp_path, overlapping)).area == 200
    assert warned[0].filename == __file__


def polygon_within(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Sutherland and Hodgman: what the half-planes left of a convex polygon's edges leave of another."""
    for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        side = (b - a)[0] * (points - a)[:, 1] - (b - a)[1] * (points - a)[:, 0]
        kept = []
        for p, q, s, t in zip(points, np.roll(points, -1, axis=0), side, np.roll(side, -1), strict=True):
            kept += [p] if s >= 0 else []
            kept += [p + s / (s - t) * (q - p)] if s * t < 0 else []
        points = np.array(kept).reshape(-1, 2)
    return points


@pytest.mark.parametrize("seed", range(8))
def test_what_a_clip_path_cuts_off_is_off(tmp_path: Path, seed: int) -> None:
    """Ellipses under random affine maps, cut by a turned rectangle: area against dense flattening."""
    rng = np.random.default_rng(seed)
    (a, c), (b, d) = matrix = np.eye(2) + 0.4 * rng.normal(size=(2, 2))
    turn, w, h = rng.uniform(0, 360), *rng.uniform(12, 25, 2)
    body = (
        f'<g transform="matrix({a} {b} {c} {d} 7 -3)"><clipPath id="c"><rect x="-8" y="-6" width="{w}" '
        f'height="{h}" transform="rotate({turn})"/></clipPath>'
        '<ellipse rx="15" ry="9" clip-path="url(#c)"/></g>'
    )
    t = np.linspace(0, 2 * pi, 20001)[:-1]
    ellipse = np.column_stack([15 * np.cos(t), 9 * np.sin(t)])
    at = np.array([[-8, -6], [w - 8, -6], [w - 8, h - 6], [-8, h - 6]])
    r = np.radians(turn)
    left = polygon_within(ellipse, at @ np.array([[np.cos(r), np.sin(r)], [-np.sin(r), np.cos(r)]]))
    x, y = left.T
    area = abs(np.linalg.det(matrix)) * (x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2
    found = rg.Outline.from_file(svg(tmp_path, body), tolerance=1e-4)
    assert found.area == pytest.approx(area, rel=3e-4, abs=1e-4 * 60)  # chords within the tolerance
    assert any("cut off at a clip-path: 1 ellipse" in note for note in found.notes)


def test_everything_hidden_says_so(tmp_path: Path) -> None:
    assert "the drawing is empty" in (
        says := refused(rg.Outline.from_file, svg(tmp_path, f'<g style="display:none">{RECT}</g>'))
    )
    assert "hidden, left out: 1 g" in says


def test_layers_of_svg(tmp_path: Path) -> None:
    layers = (
        f'<g inkscape:groupmode="layer" inkscape:label="Part" id="layer1">{RECT}</g>'
        f'<g id="holes" style="display:none">{HOLE}</g>'
        '<g id="frame"><rect x="-50" y="-50" width="200" height="90"/></g>'
    )
    path = svg(tmp_path, layers)
    assert rg.Outline.from_file(path, layers="part").area == 200
    assert rg.Outline.from_file(path, layers=["Part", "holes"]).area == pytest.approx(HOLED, rel=1e-4)
    assert "there is no layer 'parts'; the drawing has 'Part', 'holes', 'frame'" in refused(
        rg.Outline.from_file, path, layers="parts"
    )
    for wrong in ([], 3, [3], b"Part"):
        with pytest.raises(rg.InvalidInput, match="layers must be a"):
            rg.Outline.from_file(path, layers=wrong)


@pytest.mark.parametrize(
    "attributes", ['width="main"', 'width="auto" height="x"', 'viewBox="0 0 100%"', 'width="%"']
)
def test_a_page_of_no_size_is_no_fault(tmp_path: Path, attributes: str) -> None:
    found = rg.Outline.from_file(svg(tmp_path, RECT, attributes))
    assert (found.area, found.notes) == (200, ())


ISLAND = '<path fill-rule="evenodd" d="M0 0H20V20H0Z M5 5V15H15V5Z M8 8H12V12H8Z"/>'


@pytest.mark.parametrize(
    ("body", "says"),
    [
        (ISLAND, "there is a closed curve at (8, -8) inside a hole: what is inside a hole is another object"),
        (RECT + RECT, "a closed curve is drawn twice, at (0, 0); keep one of the two"),
        (RECT + HOLE + HOLE, "a closed curve is drawn twice, at (3, -5)"),
        ('<g fill="none" stroke="red"><path d="M0 0H20V10"/><path d="M0 0H20V10"/><path d="M0 0V10H20"/></g>',
            "1 lines or curves are drawn twice, one from (0, 0) to (20, -10); keep one of each"),
        ('<g id="a"><use href="#a"/></g>', "'#a' uses itself"),
        ('<path d="M0 0H20V"/>', "the path has its end where a number of V is expected"),
        ('<path d="M0 0 foo"/>', "the path has 'foo' where a number of L is expected"),
        ('<rect width="-1" height="2"/>', "the width or height of rect is negative"),
        ('<g style="rotate: 30deg"><rect width="1" height="2"/></g>',
            "the style property rotate is not followed"),
    ],
)  # fmt: skip
def test_svg_refused_with_the_cause(tmp_path: Path, body: str, says: str) -> None:
    assert says in refused(rg.Outline.from_file, svg(tmp_path, body))


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_any_text_as_path_data_is_read_or_refused_in_one_line(tmp_path_factory, data) -> None:
    words = st.sampled_from([*"MmLlHhVvCcSsQqTtAaZz", "1", "-2.5", "1e3", ".5", ",", " ", "0", "1e400", "x"])
    path = svg(
        tmp_path_factory.mktemp("fuzz"), f'<path d="{"".join(data.draw(st.lists(words, max_size=30)))}"/>'
    )
    try:
        area = rg.Outline.from_file(path).area
    except rg.InvalidInput as error:
        says = str(error)
    else:
        says = "" if 0 < area < np.inf else f"area {area}\n"
    assert "\n" not in says

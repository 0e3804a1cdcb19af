"""Any file or device is judged in one line, within seconds and bounded memory."""

import os
import subprocess
import sys
import time
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import regrasp as rg
from regrasp.outline.svg.path import subpaths

pytestmark = pytest.mark.contract

SECONDS = 10.0


def refusal(call, *args, **options) -> str:
    begun = time.process_time()
    with pytest.raises(rg.InvalidInput) as caught:
        call(*args, **options)
    assert time.process_time() - begun < SECONDS
    says = str(caught.value)
    assert says.isprintable()
    assert len(says) < 1000
    return says


def svg(folder: Path, body: str, head: str = "") -> Path:
    path = folder / "drawing.svg"
    path.write_text(f'{head}<svg xmlns="http://www.w3.org/2000/svg">{body}</svg>')
    return path


def entities(text: str) -> str:
    return f"<!DOCTYPE svg [{text}]>"


DOUBLED = "".join(f'<g id="a{i}">' + f'<use href="#a{i - 1}"/>' * 9 + "</g>" for i in range(1, 12))
BOMBS = {
    "uses of uses": (
        '<g id="a0"><rect width="1" height="1"/></g>' + DOUBLED, "", "there are more than 40000 pieces",
    ),
    "entities of entities": (
        "<text>&b;</text>", entities('<!ENTITY a "aaaa"><!ENTITY b "&a;&a;">'), "'b' stands for other",
    ),
    "a long entity often": (
        "<text>" + "&a;" * 20_000 + "</text>", entities(f'<!ENTITY a "{"x" * 9000}">'), "too much text",
    ),
    "deep": ("<g>" * 5000 + "</g>" * 5000, "", "nested more than 200 deep"),
    "elements": ("<g/>" * 250_000, "", "more than 200000 elements"),
    "pieces": ('<rect width="1" height="1"/>' * 45_000, "", "more than 40000 pieces"),
    "closed curves": ('<path d="' + "M0 0H1V1Z" * 11_000 + '"/>', "", "11000 closed curves, more than 10000"),
    "points": ('<polygon points="' + "1 2 " * 1_100_000 + '"/>', "", "more than 1000000 points"),
    "selectors": (
        "<style>" + ".a g g .b{fill:red}" * 3000 + "</style>" + '<g class="a">' * 30
        + '<rect class="b" width="1" height="1"/>' * 3000 + "</g>" * 30, "", "too many style rules",
    ),
    "a star": (
        '<path fill="none" stroke="red" d="'
        + "".join(f"M0 0L{i} 1" for i in range(99)) + '"/>', "", "99 ends of lines meet at (0, 0)",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", BOMBS)
def test_svg_without_end(tmp_path: Path, name: str) -> None:
    body, head, says = BOMBS[name]
    assert says in refusal(rg.Outline.from_file, svg(tmp_path, body, head))


NUMBERS = ["1e308", "1e999", "-1e400", "1e200", "1e-200", "nan", "inf", "1_0"]


@pytest.mark.parametrize("number", NUMBERS)
@pytest.mark.parametrize(
    "body",
    [
        '<path d="M0 0H{0}V{0}H0Z"/>',
        '<circle r="{0}"/>',
        '<polygon points="0 0 {0} 0 {0} {0}"/>',
        '<rect width="1" height="1" transform="scale({0})"/>',
        '<path d="M0 0A{0} {0} 0 0 1 {0} {0}Z"/>',
    ],
)
def test_svg_of_impossible_numbers(tmp_path: Path, number: str, body: str) -> None:
    refusal(rg.Outline.from_file, svg(tmp_path, body.format(number)))


@pytest.mark.parametrize("data", ["Z", "M0 0Z", "", "z z z", "M1 1"])
def test_paths_of_nothing_are_empty(tmp_path: Path, data: str) -> None:
    assert "the drawing is empty" in refusal(rg.Outline.from_file, svg(tmp_path, f'<path d="{data}"/>'))


def test_straight_pieces_of_a_path_are_one_curve(tmp_path: Path) -> None:
    """As a polygon of the same corners is, to the bit, under any transform; between curves, too."""
    corners = 9 * np.random.default_rng(4).normal(size=(40, 2)).cumsum(axis=0)
    corners = corners[np.argsort(np.arctan2(*(corners - corners.mean(axis=0)).T))]  # a star: no crossing
    text = " ".join(f"{x!r},{y!r}" for x, y in corners.tolist())
    place = 'transform="rotate(31) scale(0.7, 1.3)"'
    path = rg.Outline.from_file(svg(tmp_path, f'<path {place} d="M{text.replace(" ", " L")}Z"/>'))
    polygon = rg.Outline.from_file(svg(tmp_path, f'<polygon {place} points="{text}"/>'))
    assert path.to_dict() == polygon.to_dict()
    (part,) = subpaths("M0 0 H1 L2 0 V1 Q1 3 0 1 L0 .5 Z")
    assert [len(curve.breaks) for curve in part.curves] == [4, 2, 3]
    assert [curve.straight for curve in part.curves] == [True, False, True]
    (open_part,) = subpaths("M0 0 L1 0 1 1")
    assert not open_part.closed
    assert open_part.curves[0].at(np.array([2.0])).tolist() == [[1, 1]]


def test_more_curves_than_a_drawing_has_are_refused_as_they_are_read(tmp_path: Path) -> None:
    path = svg(tmp_path, f'<path d="M0 0c1 1 2 0 3 0a1 1 0 0 1 2 0{"t2 0" * 19_999}"/>')
    assert "more than 20000 curves" in refusal(rg.Outline.from_file, path)


def saved(folder: Path, draw) -> Path:
    document = ezdxf.new()
    draw(document, document.modelspace())
    document.saveas(folder / "drawing.dxf")
    return folder / "drawing.dxf"


def nest(document, space) -> None:
    document.blocks.new("B0").add_circle((0, 0), 1)
    for i in range(1, 10):
        block = document.blocks.new(f"B{i}")
        for _ in range(9):
            block.add_blockref(f"B{i - 1}", (0, 0))
    space.add_blockref("B9", (0, 0))


def itself(document, space) -> None:
    one, other = document.blocks.new("A"), document.blocks.new("B")
    one.add_blockref("B", (0, 0))
    other.add_blockref("A", (0, 0))
    space.add_blockref("A", (0, 0))


def grid(document, space) -> None:
    document.blocks.new("A").add_circle((0, 0), 1)
    size = {"row_count": 30_000, "column_count": 30_000, "row_spacing": 3, "column_spacing": 3}
    space.add_blockref("A", (0, 0), size)


@pytest.mark.parametrize(
    ("draw", "says"),
    [(nest, "more than 40000 pieces"), (itself, "inserts itself"), (grid, "more than 40000 pieces")],
)
def test_dxf_without_end(tmp_path: Path, draw, says: str) -> None:
    assert says in refusal(rg.Outline.from_file, saved(tmp_path, draw))


@pytest.mark.parametrize("number", [np.nan, np.inf, -np.inf, 1e200, 1e-200, 1e308])
@pytest.mark.parametrize(
    "draw",
    [
        lambda space, x: space.add_circle((0, 0), x),
        lambda space, x: space.add_arc((0, x), x, 0, 360),
        lambda space, x: space.add_lwpolyline([(0, 0), (x, 0), (x, x)], close=True),
        lambda space, x: space.add_open_spline([(0, 0), (x, 0), (x, x), (0, 0)]),
        lambda space, x: space.add_line((0, 0), (x, x)),
    ],
)
def test_dxf_of_impossible_numbers(tmp_path: Path, number: float, draw) -> None:
    refusal(rg.Outline.from_file, saved(tmp_path, lambda _, space: draw(space, number)))


@settings(max_examples=40, deadline=None)
@given(
    st.binary(max_size=300), st.sampled_from([".svg", ".dxf", ".csv", ".stl", ".obj", ".ply"]), st.booleans()
)
def test_any_bytes(tmp_path_factory, content: bytes, kind: str, begun: bool) -> None:
    heads = {
        ".svg": b"<svg>",
        ".dxf": b"  0\nSECTION\n  2\nENTITIES\n",
        ".stl": b"solid \n",
        ".ply": b"ply\n",
    }
    path = tmp_path_factory.mktemp("any") / f"part{kind}"
    path.write_bytes((heads.get(kind, b"") if begun else b"") + content)
    read = rg.Mesh.from_file if kind in (".stl", ".obj", ".ply") else rg.Outline.from_file
    try:
        read(path)
    except rg.InvalidInput as error:
        says = str(error)
    else:
        says = ""
    assert says.isprintable() or says == ""


READERS = [(rg.Outline.from_file, ".svg"), (rg.Outline.from_file, ".csv"), (rg.Mesh.from_file, ".stl")]


@pytest.mark.parametrize(("read", "kind"), READERS)
def test_devices_and_pipes_are_no_files(tmp_path: Path, read, kind: str) -> None:
    for target in ("/dev/zero", "/dev/random", "/dev/full"):
        link = tmp_path / f"{Path(target).name}{kind}"
        link.symlink_to(target)
        assert "this is a device, whose end nobody knows" in refusal(read, link)
        assert "this is a device" in refusal(read, target)
    os.mkfifo(tmp_path / f"pipe{kind}")
    assert "this is a device" in refusal(read, tmp_path / f"pipe{kind}")
    assert "expected a file with" in refusal(read, tmp_path)


@pytest.mark.parametrize(("read", "kind"), READERS)
def test_names_that_are_no_files(tmp_path: Path, read, kind: str) -> None:
    for wrong in (None, 3, b"part.svg", 1.5, [], object()):
        assert "a path must be text or a Path that names a file, got" in refusal(read, wrong)
    for name in (
        "",
        "a\0b" + kind,
        "x" * 5000 + kind,
        "new\nline" + kind,
        "\ud800" + kind,
        "/dev/null/x" + kind,
    ):
        with pytest.raises(rg.InvalidInput) as caught:
            read(name)
        assert "\n" not in str(caught.value)


@pytest.mark.parametrize(("read", "kind"), READERS)
def test_long_files_are_not_read_to_their_end(tmp_path: Path, read, kind: str) -> None:
    path = tmp_path / f"long{kind}"
    with path.open("wb") as file:
        file.truncate(1 << 40)  # a hole of a terabyte
    assert "the file is longer than the" in refusal(read, path)


@pytest.mark.parametrize("size", [1e200, 1e-200, 1e61, 1e-61])
def test_sizes_whose_areas_are_no_numbers_are_refused(size: float) -> None:
    square = size * np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    for make in (rg.Outline, rg.Outline.smooth):
        assert "must be between 1e-60 and 1e+60 in size" in refusal(make, square)
    assert "in size" in refusal(rg.Outline.ellipse, size, size)
    assert "in size" in refusal(rg.Mesh.box, size, size, size)


@pytest.mark.parametrize("size", [1e59, 1e-59])
def test_sizes_up_to_that_have_areas(size: float) -> None:
    square = rg.Outline(size * np.array([[0, 0], [1, 0], [1, 1], [0, 1]]))
    assert square.area == pytest.approx(size**2)
    assert square.inertia == pytest.approx(size**4 / 6)
    assert rg.Outline.ellipse(size, size).inertia == pytest.approx(np.pi / 2 * size**4)
    assert rg.Mesh.box(size, size, size).inertia[0, 0] == pytest.approx(size**5 / 6, rel=1e-9)


def test_memory_is_bounded(tmp_path: Path) -> None:
    """In a process that may have 1 GiB more than it has before it reads."""
    path = svg(tmp_path, '<path d="M0 0' + "L1 1" * 3_000_000 + '"/>')
    code = (
        "import resource, sys, regrasp as rg, regrasp.outline.outline\n"
        "rg.Outline([[0, 0], [1, 0], [0, 1]])\n"
        "held = int(open('/proc/self/statm').read().split()[0]) * resource.getpagesize()\n"
        "resource.setrlimit(resource.RLIMIT_AS, (held + (1 << 30),) * 2)\n"
        "try:\n    rg.Outline.from_file(sys.argv[1])\n"
        "except rg.InvalidInput as error:\n    print(error)\n"
    )
    done = subprocess.run([sys.executable, "-c", code, str(path)], capture_output=True, text=True, check=True)
    assert "more than 300000 commands" in done.stdout


@pytest.mark.parametrize("text", ["0\nSECTION", "0\nSECTION\n2\n", "0", "999\n"])
def test_a_dxf_that_ends_at_once_is_refused(text: str, tmp_path: Path) -> None:
    path = tmp_path / "short.dxf"
    path.write_text(text)
    assert "cannot be read as DXF" in refusal(rg.Outline.from_file, path)

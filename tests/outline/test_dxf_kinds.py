"""What is seen in a DXF is read, the rest left out and said so; damage is mended, units are converted."""

from math import pi
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import regrasp as rg
from drawing_files import RECT, svg
from refusals import refused
from regrasp.outline.dxf.curves import turned

pytestmark = pytest.mark.contract


def dxf(folder: Path, draw) -> Path:
    document = ezdxf.new(setup=True)
    document.units = 4
    draw(document, document.modelspace())
    document.saveas(folder / "drawing.dxf")
    return folder / "drawing.dxf"


def plate(space, **attributes) -> None:
    space.add_lwpolyline([(0, 0), (60, 0), (60, 40), (0, 40)], close=True, dxfattribs=attributes)


def off(document, space) -> None:
    document.layers.add("OFF").off()
    plate(space)
    space.add_circle((10, 10), 2, {"layer": "OFF"})


def frozen_insert(document, space) -> None:
    document.layers.add("ICE").freeze()
    document.layers.add("ON")
    document.blocks.new("HOLE").add_circle((0, 0), 2, {"layer": "ON"})
    plate(space)
    space.add_blockref("HOLE", (10, 10), {"layer": "ICE"})


def off_by_insert(document, space) -> None:
    document.layers.add("OFF").off()
    document.blocks.new("HOLE").add_circle((0, 0), 2)
    plate(space)
    space.add_blockref("HOLE", (10, 10), {"layer": "OFF"})


def invisible(document, space) -> None:
    plate(space)
    space.add_circle((10, 10), 2, {"invisible": 1})


def centre_lines(document, space) -> None:
    plate(space)
    space.add_line((-5, 20), (65, 20), {"linetype": "CENTER"})
    document.layers.add("AXES", linetype="DASHDOT2")
    space.add_circle((30, 20), 15, {"layer": "AXES"})
    space.add_lwpolyline(
        [(-9, -9), (70, -9), (70, 50), (-9, 50)], close=True, dxfattribs={"linetype": "PHANTOM"}
    )


def dimensions(document, space) -> None:
    plate(space)
    space.add_linear_dim((0, -10), (0, 0), (60, 0)).render()
    space.add_text("plate")
    document.layers.add("Center-Lines")
    space.add_line((0, 20), (60, 20), {"layer": "Center-Lines"})
    space.add_line((0, 50), (60, 50), {"layer": "DIM"})


@pytest.mark.parametrize("draw", [off, frozen_insert, off_by_insert, invisible, centre_lines, dimensions])
def test_what_dxf_hides_or_marks_is_left_out_and_said(tmp_path: Path, draw) -> None:
    found = rg.Outline.from_file(dxf(tmp_path, draw))
    assert found.area == pytest.approx(2400)
    assert any("left out" in note for note in found.notes)
    assert "the file's unit is mm" in found.notes


def test_marks_are_named(tmp_path: Path) -> None:
    notes = "; ".join(rg.Outline.from_file(dxf(tmp_path, centre_lines)).notes)
    for word in (
        "LINE of line type CENTER",
        "CIRCLE of line type DASHDOT2",
        "LWPOLYLINE of line type PHANTOM",
    ):
        assert word in notes
    assert "DIMENSION" in "; ".join(rg.Outline.from_file(dxf(tmp_path, dimensions)).notes)


def test_an_outline_of_centre_lines_alone_is_read(tmp_path: Path) -> None:
    found = rg.Outline.from_file(dxf(tmp_path, lambda _, space: plate(space, linetype="CENTER")))
    assert (found.area, found.notes[0]) == (
        2400,
        "nothing else is drawn, so read: 1 LWPOLYLINE of line type CENTER",
    )


def test_a_side_drawn_as_a_centre_line_is_needed(tmp_path: Path) -> None:
    def draw(_, space) -> None:
        space.add_lwpolyline([(0, 0), (60, 0), (60, 40), (0, 40)])
        space.add_line((0, 40), (0, 0), {"linetype": "CENTER"})

    found = rg.Outline.from_file(dxf(tmp_path, draw))
    assert (found.area, found.notes[0]) == (
        2400,
        "read, since the rest is no outline: 1 LINE of line type CENTER",
    )


def test_layers_of_dxf(tmp_path: Path) -> None:
    def draw(document, space) -> None:
        for name in ("PART", "HOLES", "SHEET"):
            document.layers.add(name)
        document.layers.get("HOLES").off()
        plate(space, layer="PART")
        document.blocks.new("HOLE").add_circle((0, 0), 2)
        space.add_blockref("HOLE", (10, 10), {"layer": "HOLES"})
        space.add_line((0, 0), (99, 99), {"layer": "SHEET"})

    path = dxf(tmp_path, draw)
    assert "choose from its layers 'PART', 'SHEET' with layers=" in refused(rg.Outline.from_file, path)
    assert rg.Outline.from_file(path, layers="part").area == 2400
    assert rg.Outline.from_file(path, layers=("PART", "HOLES")).area == pytest.approx(2400 - 4 * pi, rel=1e-4)
    assert "there is no layer 'part1'" in refused(rg.Outline.from_file, path, layers="part1")


def test_arrayed_holes_and_bodies(tmp_path: Path) -> None:
    def holes(document, space) -> None:
        document.blocks.new("H").add_circle((0, 0), 2)
        plate(space)
        grid = {"row_count": 2, "column_count": 3, "row_spacing": 20, "column_spacing": 20}
        space.add_blockref("H", (10, 10), grid)

    def bodies(document, space) -> None:
        plate(document.blocks.new("P"))
        space.add_blockref("P", (0, 0), {"column_count": 2, "column_spacing": 90})

    found = rg.Outline.from_file(dxf(tmp_path, holes), tolerance=1e-5)
    assert (len(found.holes), found.area) == (6, pytest.approx(2400 - 24 * pi, rel=1e-6))
    assert "there are several outlines: one at (90, 0) is outside the largest" in refused(
        rg.Outline.from_file, dxf(tmp_path, bodies)
    )


@given(st.floats(-50, 50), st.integers(-2, 2), st.floats(-1e-9, 1e-6))
def test_a_turn_and_a_little_is_a_full_turn(start: float, turns: int, more: float) -> None:
    end = start + 2 * pi * turns + (more if turns else min(abs(more), 1e-10))
    assert turned(start, end)[1] == 2 * pi


@given(st.floats(0, 6), st.floats(1e-4, 6.28))
def test_less_is_not(start: float, turn: float) -> None:
    assert turned(start, start + turn)[1] == pytest.approx(turn, abs=1e-12)
    assert turned(start + 2 * pi, start + turn)[1] == pytest.approx(turn, abs=1e-12)


@pytest.mark.parametrize("more", [0.0, 1.24e-10, -1.24e-10, 1e-8, 1e-7])
def test_full_turns_are_closed(tmp_path: Path, more: float) -> None:
    def draw(_, space) -> None:
        space.add_ellipse((0, 0), (4, 1), 0.5, 0.3, 0.3 + 2 * pi + more)
        space.add_arc((0, 0), 1, 20, 380 + np.degrees(more))

    found = rg.Outline.from_file(dxf(tmp_path, draw), tolerance=1e-6)
    assert found.area == pytest.approx(pi * (17 / 2 - 1), rel=1e-6)


@pytest.mark.parametrize("sides", [12, 40, 100])
def test_the_frame_of_a_spline_fit_is_no_outline(tmp_path: Path, sides: int) -> None:
    turn = np.arange(sides) * 2 * pi / sides
    curve = 5 + 3 * np.column_stack([np.cos(turn), np.sin(turn)])

    def draw(_, space) -> None:
        line = space.add_polyline2d([])
        line.append_formatted_vertices([(0, 0), (10, 0), (10, 10), (0, 10)], "xy", {"flags": 16})
        line.append_formatted_vertices(curve, "xy", {"flags": 8})
        line.dxf.flags = 5

    found = rg.Outline.from_file(dxf(tmp_path, draw))
    assert found.area == pytest.approx(4.5 * sides * np.sin(2 * pi / sides), rel=1e-9)


def test_units_are_converted_where_the_file_has_them(tmp_path: Path) -> None:
    drawn = dxf(tmp_path, lambda _, space: plate(space))
    assert rg.Outline.from_file(drawn, unit="m").area == pytest.approx(2400e-6)
    assert rg.Outline.from_file(drawn, unit="in", scale=25.4).area == pytest.approx(2400)
    assert rg.Outline.from_file(
        svg(tmp_path, RECT, 'width="100mm" viewBox="0 0 500 500"'), unit="mm"
    ).area == pytest.approx(8)
    assert rg.Outline.from_file(
        svg(tmp_path, RECT, 'width="10cm" height="10cm"'), unit="in"
    ).area == pytest.approx(200 / 96**2)
    assert "the file does not say its unit: give scale in place of unit" in refused(
        rg.Outline.from_file, svg(tmp_path, RECT), unit="mm"
    )
    (tmp_path / "a.csv").write_text("0 0\n1 0\n0 1\n")
    assert "does not say its unit" in refused(rg.Outline.from_file, tmp_path / "a.csv", unit="mm")
    with pytest.raises(rg.InvalidInput, match="unit must be one of um, mm, cm"):
        rg.Outline.from_file(drawn, unit="metre")


DAMAGE = {
    "no end": lambda text: text.replace("  0\nEOF\n", ""),
    "cut off after the entities": lambda text: text[: text.index("OBJECTS")],
    "commas in numbers": lambda text: text.replace("10.0", "10,0", 2),
    "odd line ends": lambda text: text.replace("\n", "\r\r\n"),
}


@pytest.mark.parametrize("damage", DAMAGE)
def test_damaged_files_are_recovered_and_said_so(tmp_path: Path, capfd, damage: str) -> None:
    path = dxf(tmp_path, lambda _, space: plate(space))
    path.write_bytes(DAMAGE[damage](path.read_text()).encode())
    with pytest.warns(UserWarning, match="the file is damaged .*: look at what was read") as warned:
        found = rg.Outline.from_file(path)
    assert warned[0].filename == __file__
    assert found.area == pytest.approx(2400)
    assert found.notes[0].startswith("the file is damaged")
    assert capfd.readouterr() == ("", "")


def test_a_frame_around_a_part_is_named(tmp_path: Path) -> None:
    def draw(_, space) -> None:
        space.add_lwpolyline([(-90, -90), (330, -90), (330, 207), (-90, 207)], close=True)
        plate(space)
        space.add_circle((20, 20), 5)

    assert "if the outermost curve is the frame of a sheet, leave it out" in refused(
        rg.Outline.from_file, dxf(tmp_path, draw)
    )

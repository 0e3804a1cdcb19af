"""Outlines and meshes."""

import regrasp as rg
from values import SQUARE, ellipse, mesh
from wrong_calls.row import Row


def rows() -> dict[str, Row]:
    outline, box = ellipse(), mesh()
    return {
        "Outline": Row(rg.Outline, {"vertices": SQUARE}, {"vertices": "ring", "holes": "holes"}),
        "Outline.smooth": Row(rg.Outline.smooth, {"points": SQUARE}, {"points": "ring", "holes": "holes"}),
        "Outline.ellipse": Row(
            rg.Outline.ellipse,
            {"a": 2.0, "b": 1.0},
            {"a": "positive", "b": "positive", "centre": "planar vector", "holes": "holes"},
        ),
        "Outline.from_dict": Row(rg.Outline.from_dict, {"data": outline.to_dict()}),
        "Outline.polygon": Row(outline.polygon, {}),
        "Outline.hole_polygons": Row(rg.Outline(SQUARE, [[[1, 1], [2, 1], [2, 2]]]).hole_polygons, {}),
        "Outline.points": Row(outline.points, {"s": 0.5}, {"s": "numbers"}),
        "Outline.normals": Row(outline.normals, {"s": 0.5}, {"s": "numbers"}),
        "Outline.contact_at": Row(
            outline.contact_at, {"arc_length": 0.5, "friction": 0.5}, {"arc_length": "number"}
        ),
        "Outline.nearest": Row(outline.nearest, {"position": [1.0, 1.0]}, {"position": "planar vector"}),
        "Outline.sample": Row(outline.sample, {"count": 9}),
        "Mesh": Row(
            rg.Mesh,
            {"vertices": box.vertices, "faces": box.faces},
            {"vertices": "vertices", "faces": "faces"},
        ),
        "Mesh.box": Row(rg.Mesh.box, {"a": 1.0, "b": 1.0, "c": 1.0}, dict.fromkeys("abc", "positive")),
        "Mesh.cylinder": Row(
            rg.Mesh.cylinder, {"radius": 1.0, "height": 1.0}, dict.fromkeys(("radius", "height"), "positive")
        ),
        "Mesh.sphere": Row(rg.Mesh.sphere, {"radius": 1.0}, {"radius": "positive"}),
        "Mesh.extruded": Row(rg.Mesh.extruded, {"outline": outline, "height": 1.0}, {"height": "positive"}),
        "Mesh.nearest": Row(box.nearest, {"points": [[0.0, 0.0, 0.0]]}, {"points": "space points"}),
        "Mesh.normals": Row(box.normals, {"points": box.sample(2)}, {"points": "space points"}),
        "Mesh.contact_at": Row(
            box.contact_at, {"point": box.sample(1)[0], "friction": 0.5}, {"point": "space vector"}
        ),
        "Mesh.sample": Row(box.sample, {"count": 3}),
        "Mesh.contacts": Row(box.contacts, {"count": 3, "friction": 0.5}),
        "Outline.from_file": Row(rg.Outline.from_file, {"path": "none.svg"}),
        "Mesh.from_file": Row(rg.Mesh.from_file, {"path": "none.stl"}),
        "Mesh.save_stl": Row(box.save_stl, {}),
    }

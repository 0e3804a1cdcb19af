"""Grasps that are chosen on a shape."""

import regrasp as rg
from values import SQUARE_OUTLINE, VALUES, WEIGHT, WEIGHT_IN_PLANE, mapped, on_faces, placed
from wrong_calls.row import Row


def rows() -> dict[str, Row]:
    return {
        "choose_grasp": Row(
            rg.choose_grasp,
            {"shape": SQUARE_OUTLINE, "fingers": 2, "load": WEIGHT_IN_PLANE, "friction": 0.5},
            {
                "shape": "value",
                "fingers": "count",
                "from_corners": "not negative",
                "load_offset": "not negative",
                "length": "positive",
                "min_distance": "positive",
                "disturbance": "value",
                "arcs": "table",
                "tip_radius": "not negative",
                "min_normal": "not negative",
                "keep": "function",
                "removable": "flag",
                "in_holes": "flag",
                "most_boxes": "count",
                "progress": "function",
            },
        ),
        "placement_map": Row(
            rg.placement_map,
            {"shape": SQUARE_OUTLINE, "load": WEIGHT_IN_PLANE, "friction": 0.5, "count": 8},
            {
                "shape": "value",
                "disturbance": "value",
                "fixed": "some places",
                "free": "count",
                "length": "positive",
                "min_normal": "not negative",
                "keep": "function",
                "arcs": "table",
                "tip_radius": "not negative",
                "in_holes": "flag",
                "min_distance": "positive",
                "from_corners": "not negative",
            },
        ),
        "surface_map": Row(
            rg.surface_map,
            {"shape": mapped().shape, "fingers": 3, "load": WEIGHT, "friction": 0.5, "count": 8},
            {"shape": "value", "fingers": "count"},
        ),
        "contact_regions": Row(
            rg.contact_regions,
            {"shape": SQUARE_OUTLINE, "grasp": placed().grasp, "load": WEIGHT_IN_PLANE},
            {"shape": "value", "widest": "word"},
        ),
        "ContactRegions.from_dict": Row(
            rg.ContactRegions.from_dict, {"data": VALUES["ContactRegions"]().to_dict()}
        ),
        "FaceRegions.from_dict": Row(rg.FaceRegions.from_dict, {"data": on_faces().to_dict()}),
        "ChosenGrasp.from_dict": Row(rg.ChosenGrasp.from_dict, {"data": placed().to_dict()}),
    }

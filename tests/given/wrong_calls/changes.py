"""Fingers that leave and arrive, and objects that turn."""

import regrasp as rg
from paper import GRASP, STATE
from values import removal
from wrong_calls.row import Row


def rows() -> dict[str, Row]:
    transition = removal()
    return {
        "plan_removal": Row(rg.plan_removal, {"start": STATE, "contact": "P3"}, {"load": "load"}),
        "plan_addition": Row(
            rg.plan_addition,
            {"start": transition.end.without("P3"), "contact": GRASP["P3"]},
            {"contact": "value", "load": "load"},
        ),
        "plan_hold": Row(rg.plan_hold, {"start": STATE}, {"load": "load"}),
        "plan_exchange": Row(
            rg.plan_exchange,
            {"start": STATE, "leaving": "P3", "arriving": rg.Contact([9, 9], [1, 0], 1, name="P4")},
            {"leaving": "contact of", "arriving": "value", "load": "load"},
        ),
        "plan_rotation": Row(rg.plan_rotation, {"start": transition.end.without("P3"), "angle": 0.1}),
    }

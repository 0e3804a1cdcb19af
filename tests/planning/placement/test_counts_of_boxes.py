"""How many boxes searches need: no proof tells of a search that became weaker."""

import pytest

import regrasp as rg

pytestmark = pytest.mark.contract

SHAPES = {
    "bracket": rg.Outline([[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]]),
    "ellipse": rg.Outline.ellipse(2, 1),
}
PUSHES = rg.LoadSet.hull([rg.Wrench([1, -1]), rg.Wrench([-1, -1]), rg.Wrench([0, -1], 0.3)])
LIMITS = {
    "friction_use": {"max_force": 2.0},
    "answered": {"max_force": 3.0, "disturbance": PUSHES},
}


@pytest.mark.parametrize(
    ("shape", "fingers", "objective", "boxes"),
    [
        ("bracket", 2, "peak", 120),
        ("bracket", 3, "peak", 93),
        ("bracket", 3, "sum_normal", 67),
        ("bracket", 3, "effort", 111),
        ("bracket", 2, "friction_use", 76),
        ("bracket", 2, "answered", 108),
        ("ellipse", 2, "peak", 77),
        ("ellipse", 3, "peak", 831),
        ("ellipse", 2, "friction_use", 271),
        ("ellipse", 2, "answered", 95),
    ],
)
def test_a_search_needs_no_more_boxes_than_it_did(
    shape: str, fingers: int, objective: str, boxes: int
) -> None:
    """Up to a fifth more, which other bounds as good may take: so many were needed when this was written."""
    load = rg.Wrench([0, -1]) if objective == "answered" else PUSHES
    asked = {"friction": 0.5, "objective": objective, "tolerance": 1e-2} | LIMITS.get(objective, {})
    found = rg.choose_grasp(SHAPES[shape], fingers, load, **asked)
    assert abs(found.bound - found.value) <= 1.01e-2 * abs(found.value) + 1e-12
    assert len(found.certificate.children) <= 1.2 * boxes

"""What pictures of an escape say in words, colours and marks."""

from math import isinf
from typing import Any

from matplotlib.lines import Line2D

from regrasp.mechanics.escape import EscapeTwist
from regrasp.plots.look.style import PALETTE, literal, quantity
from regrasp.plots.look.units import Units

HELPLESS, OPPOSES, MOTION = PALETTE[1], PALETTE[0], PALETTE[2]
HELPLESS_LOOK: dict[str, Any] = {
    "marker": "X",
    "color": HELPLESS,
    "markeredgecolor": "white",
    "markersize": 9,
}
OPPOSES_LOOK: dict[str, Any] = {"marker": "o", "color": OPPOSES, "markeredgecolor": "white", "markersize": 8}


def labels(twist: EscapeTwist, units: Units) -> list[str]:
    """The contacts' names, with the most work that those which can oppose can do."""
    unit = units.torque if twist.turns else units.force
    found = []
    for name, most in zip(twist.grasp.names, twist.resistances, strict=True):
        bound = "without limit" if isinf(most) else f"\N{LESS-THAN OR EQUAL TO} {quantity(most, unit, 3)}"
        found.append(f"{literal(name)}\n{bound}" if most else literal(name))
    return found


def title(twist: EscapeTwist, units: Units) -> str:
    """The explanation in short."""
    unit, per = (units.torque, "rad") if twist.turns else (units.force, units.length)
    verb = "escapes" if twist.is_proof else "does not escape"
    way = "sliding"
    if twist.grasp.dimension == 3 and twist.turns:
        pitch = 0.0 if abs(twist.pitch) < 1e-9 * twist.grasp.size else twist.pitch
        way = f"turning, pitch {quantity(pitch, f'{units.length}/rad', 3)}"
    elif twist.turns:
        way = "turning clockwise" if twist.twist[2] < 0 else "turning counter-clockwise"
    total = sum(twist.resistances)
    most = "without limit" if isinf(total) else f"at most {quantity(total, unit, 3)}" if total else "nothing"
    drive = quantity(twist.drive, unit, 3)
    return f"{verb} {way}\nthe load does {drive} of work per {per}\nthe contacts oppose {most}"


def key(twist: EscapeTwist) -> list[Line2D]:
    """What colours and marks mean."""
    keys = [Line2D([], [], color=MOTION, linewidth=1.8, label="motion")]
    if any(twist.helpless):
        keys.append(Line2D([], [], linestyle="none", label="cannot oppose", **HELPLESS_LOOK))
    if not all(twist.helpless):
        label = "opposes too little" if twist.is_proof else "opposes"
        keys.append(Line2D([], [], linestyle="none", label=label, **OPPOSES_LOOK))
    return keys

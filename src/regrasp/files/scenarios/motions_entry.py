"""The fingers of a scenario in the air."""

from typing import Any

from pydantic import Field

from regrasp.files.scenarios.keys import AnyVector, Positive
from regrasp.files.strict import Strict


class MotionsEntry(Strict):
    """How free fingers go from contact to contact; read where ways are asked for, by ``--motions``."""

    tip_radius: Positive = Field(description="[m], of fingertips, discs in the plane and spheres in space")
    clearance: Positive = Field(description="[m], that fingers keep from the object and from one another")
    speed: Positive = Field(0.1, description="[m/s], largest of a tip in the object's frame")
    acceleration: Positive = Field(1.0, description="[m/s^2], largest of a tip in the object's frame")
    capsule: AnyVector | None = Field(
        None, description="[m], from each tip's centre to its finger's other end, in the object's frame"
    )

    @property
    def options(self) -> dict[str, Any]:
        """What ``plan_motions`` takes."""
        return {
            "tip_radius": self.tip_radius,
            "clearance": self.clearance,
            "speed": self.speed,
            "acceleration": self.acceleration,
            "capsules": self.capsule,
        }

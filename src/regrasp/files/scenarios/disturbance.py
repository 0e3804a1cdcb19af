"""The load with what may come on top of it: ``[load]`` and ``[load.disturbance]``."""

from functools import cached_property
from math import radians
from typing import Annotated

import numpy as np
from pydantic import Field, model_validator

from regrasp.files.scenarios.keys import Load
from regrasp.files.strict import Strict
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.wrench import Wrench

_NotNegative = Annotated[float, Field(ge=0)]


class Disturbance(Strict):
    """Deviations of the load that states withstand: a ball or an ellipsoid, a tilt of the load, or a hull."""

    force: _NotNegative = Field(0.0, description="radius of a ball of deviations of the force [N]")
    torque: _NotNegative = Field(0.0, description="radius of its deviations of the torque [N m]")
    tilt_degrees: Annotated[float, Field(gt=0, le=180)] | None = Field(
        None, description="in the place of a ball: the load's force turns by up to this angle, any way"
    )
    axes: Annotated[list[Load], Field(min_length=1)] | None = Field(
        None, description="in the place of a ball: half axes of an ellipsoid, each with force and torque"
    )
    hull: Annotated[list[Load], Field(min_length=1)] | None = Field(
        None, description="in the place of a ball: deviations, each with force and torque, and all between"
    )

    def around(self, load: Wrench) -> LoadSet:
        """The set of deviations from a load."""
        if self.tilt_degrees is not None:
            return LoadSet.tilted(load, radians(self.tilt_degrees)).deviations
        none = 0.0 * load
        if self.hull is not None:
            return LoadSet.hull([entry.wrench for entry in self.hull], center=none)
        if self.axes is not None:
            return LoadSet.ellipsoid(none, np.column_stack([entry.wrench.vector for entry in self.axes]))
        return LoadSet.ball(none, force=self.force, torque=self.torque)

    @model_validator(mode="after")
    def _is_one_set(self) -> "Disturbance":
        others = (self.tilt_degrees, self.axes, self.hull)
        if bool(self.force or self.torque) + sum(way is not None for way in others) != 1:
            raise ValueError(
                "expected force or torque above 0, tilt_degrees, axes or hull, one of these four"
            )
        return self


class DisturbedLoad(Load):
    """The external wrench on the object, and what may come on top of it."""

    disturbance: Disturbance | None = Field(
        None, description="deviations that the states withstand when fingers answer with their stiffness"
    )

    @cached_property
    def deviations(self) -> LoadSet | None:
        """What may come on top of the load."""
        return None if self.disturbance is None else self.disturbance.around(self.wrench)

    @model_validator(mode="after")
    def _is_of_one_dimension(self) -> "DisturbedLoad":
        for key in ("hull", "axes"):
            entries = getattr(self.disturbance, key, None) or ()
            if any(len(entry.force) != len(self.force) for entry in entries):
                raise ValueError(
                    f"disturbance.{key}: expected forces of {len(self.force)} numbers, as the load's"
                )
        return self

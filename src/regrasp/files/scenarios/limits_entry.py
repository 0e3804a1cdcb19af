"""Linear limits of a finger's force in a scenario: rows, or the torques of its joints."""

from collections.abc import Sequence

from pydantic import Field, model_validator

from regrasp.errors import InvalidInput
from regrasp.files.scenarios.keys import PerFinger
from regrasp.files.strict import Strict
from regrasp.mechanics.limits.force_limits import ForceLimits, torque_limits


class LimitsEntry(Strict):
    """Rows A f <= b in the contact's frame, or a Jacobian and the largest torques of the joints."""

    rows: list[list[float]] | None = Field(
        None, description="A: along the normal, then across it (as Grasp.tangents has it), one row a limit"
    )
    bounds: list[float] | None = Field(None, description="b, one for each row, greater than 0")
    jacobian: list[list[float]] | None = Field(
        None,
        description="tip velocity per joint rate, by rows x, y and in space z of the object frame [m/rad]",
    )
    torques: PerFinger | None = Field(
        None, description="largest torque of every joint either way [N m], one number or one for each"
    )

    def value(self, normal: Sequence[float]) -> ForceLimits:
        """The limits of a contact with this normal, object frame."""
        if self.rows is not None:
            return ForceLimits(self.rows, [] if self.bounds is None else self.bounds)
        assert self.jacobian is not None
        assert self.torques is not None
        return torque_limits(self.jacobian, self.torques, normal=normal)

    @model_validator(mode="after")
    def _is_one_of_two(self) -> "LimitsEntry":
        by_rows = self.rows is not None and self.bounds is not None
        by_joints = self.jacobian is not None and self.torques is not None
        given = [x for x in (self.rows, self.bounds, self.jacobian, self.torques) if x is not None]
        if len(given) != 2 or not (by_rows or by_joints):
            raise ValueError("limits: expected rows and bounds, or jacobian and torques")
        try:
            if by_rows:
                _ = self.value([])
        except InvalidInput as error:
            raise ValueError(str(error)) from None
        return self

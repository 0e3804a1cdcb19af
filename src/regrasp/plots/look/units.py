"""The names of units on axes and in labels."""

from typing import NamedTuple


class Units(NamedTuple):
    """What one unit of the numbers drawn is called; the numbers stay as they are.

    Nothing is converted: with contacts in millimetres and forces in newtons, ``Units("mm", "N")`` makes the
    labels say so, torques in N mm. Units must be consistent, as everywhere in regrasp.

    Args:
        length: such as mm.
        force: such as kN.
        time: such as ms.
    """

    length: str = "m"
    force: str = "N"
    time: str = "s"

    def of(self, unit: str) -> str:
        """The unit of an objective, given in terms of N, by these names.

        Args:
            unit: in terms of N, such as N^2.
        """
        return {"N": self.force, "N^2": rf"{self.force}$^2$"}.get(unit, unit)

    @property
    def torque(self) -> str:
        """Of a torque or of work: force times length."""
        return f"{self.force} {self.length}"


SI = Units()

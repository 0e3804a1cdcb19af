"""The solid object of a scenario in space."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field, PrivateAttr, ValidationInfo, model_validator

from regrasp.errors import InvalidInput
from regrasp.files.scenarios.keys import Positive
from regrasp.files.strict import Strict

if TYPE_CHECKING:
    from regrasp.mesh.mesh import Mesh


class ObjectEntry(Strict):
    """A solid of uniform density, from a file or a part that comes with regrasp."""

    mesh: Annotated[str, Field(min_length=1)] | None = Field(
        None, description="STL, OBJ or PLY file, relative to the scenario"
    )
    part: Literal["bracket", "wrench", "cam", "nut", "bottle"] | None = Field(
        None, description="a part that comes with regrasp"
    )
    scale: Positive | None = Field(None, description="metres per unit of the file; 1 if absent")
    smooth: bool = Field(False, description="whether normals are interpolated, of a file of a curved surface")

    _value: "Mesh" = PrivateAttr()

    @property
    def value(self) -> "Mesh":
        """The mesh."""
        return self._value

    @model_validator(mode="after")
    def _is_an_object(self, info: ValidationInfo) -> "ObjectEntry":
        if (self.mesh is None) == (self.part is None):
            found = "neither" if self.mesh is None else "both"
            raise ValueError(f"expected either mesh or part, found {found}")
        if self.mesh is None and (self.scale is not None or self.smooth):
            raise ValueError(f"{'smooth' if self.scale is None else 'scale'} goes with mesh, found part")
        try:
            self._value = self._made((info.context or {}).get("folder", Path()))
        except (InvalidInput, ImportError) as error:
            raise ValueError(str(error)) from None
        return self

    def _made(self, folder: Path) -> "Mesh":
        from regrasp.mesh import Mesh, parts

        if self.part is not None:
            return parts.PARTS[self.part]()
        scale = 1.0 if self.scale is None else self.scale
        return Mesh.from_file(folder / str(self.mesh), scale=scale, smooth=self.smooth)

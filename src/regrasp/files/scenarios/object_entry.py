"""The solid object of a scenario in space."""

from functools import cache
from math import radians
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field, PrivateAttr, ValidationInfo, model_validator

from regrasp.errors import InvalidInput
from regrasp.files.scenarios.keys import Positive
from regrasp.files.strict import Strict

if TYPE_CHECKING:
    from regrasp.mesh.mesh import Mesh

_OF_FILES = ("scale", "smooth", "crease_degrees", "bodies", "close_holes")


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
    crease_degrees: Annotated[float, Field(gt=0, lt=90)] | None = Field(
        None, description="largest turn between triangles over which they are; 35 if absent"
    )
    bodies: Literal["one", "largest", "fuse"] | None = Field(
        None, description="of several closed surfaces: refuse them (if absent), take the largest, unite them"
    )
    close_holes: Annotated[float, Field(ge=0)] | None = Field(
        None, description="holes up to this part of the largest side across are closed"
    )

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
        of_files = [key for key in _OF_FILES if getattr(self, key) not in (None, False)]
        if self.mesh is None and of_files:
            raise ValueError("\n".join(f"{key} goes with mesh, found part" for key in of_files))
        try:
            self._value = self._made((info.context or {}).get("folder", Path()))
        except (InvalidInput, ImportError) as error:
            raise ValueError(str(error)) from None
        return self

    def _made(self, folder: Path) -> "Mesh":
        from regrasp.mesh import Mesh

        if self.part is not None:
            return _part(self.part)
        asked = {key: getattr(self, key) for key in ("scale", "bodies", "close_holes")}
        if self.crease_degrees is not None:
            asked["crease"] = radians(self.crease_degrees)
        given = {key: value for key, value in asked.items() if value is not None}
        return Mesh.from_file(folder / str(self.mesh), smooth=self.smooth, **given)


@cache
def _part(name: str) -> "Mesh":
    """A part as it is by default; every scenario of a study has the same."""
    from regrasp.mesh import parts

    return parts.PARTS[name]()

"""Words of a plan's record that a file must spell as planning does."""

from typing import Annotated

from pydantic import AfterValidator, Field

from regrasp.errors import shown
from regrasp.planning.changes.joining import PATH_OBJECTIVES
from regrasp.planning.states.objectives.known import JOINT, OBJECTIVES


def _objective(value: str) -> str:
    if value.startswith("own:") and value[4:].isprintable() and value[4:].strip():
        return value  # of a user's own: a name says all there is to say
    return _one_of(value, (*OBJECTIVES, JOINT))


def _path_objective(value: str) -> str:
    return _one_of(value, PATH_OBJECTIVES)


def _one_of(value: str, known: tuple[str, ...]) -> str:
    if value not in known:
        raise ValueError(f"expected {', '.join(known[:-1])} or {known[-1]}, got {shown(value)}")
    return value


Objective = Annotated[str, AfterValidator(_objective)]
PathObjective = Annotated[str, AfterValidator(_path_objective)]
Method = Annotated[str, Field(min_length=1)]
"""``closed-form`` or a back end, which need not be installed here."""

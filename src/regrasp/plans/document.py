"""Plans to and from plain data: the same document that a plan file holds."""

from collections.abc import Mapping
from importlib import import_module
from typing import Any, Self

from regrasp.errors import InvalidInput

# The floor that knows the document stands above this one, and imports pydantic: it is looked up when asked.
_KEPT_BY = "regrasp.files.plans.plan_file"


class Documented:
    """A plan that goes to plain data and comes back equal, bit for bit."""

    __slots__ = ()

    def to_dict(self) -> dict[str, Any]:
        """The plan as plain data, which JSON can hold: what ``write_plan`` writes."""
        document: dict[str, Any] = import_module(_KEPT_BY).plan_document(self)
        return document

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Self:
        """The plan of plain data. ``InvalidInput`` as of ``read_plan``, and for another kind of plan.

        Whatever path the data tells of, the plan has it: a ``Transition`` also where it is asked of one.
        """
        plan = import_module(_KEPT_BY).plan_of(data)
        if not isinstance(plan, cls):
            raise InvalidInput(
                f"expected the data of a {cls.__name__}, found that of a {type(plan).__name__}"
            )
        return plan

"""Ways through the air: how fingers without force go from contact to contact, clear of everything."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from regrasp.motions.shut_in import ShutIn
from regrasp.motions.value import Motion, Motions

if TYPE_CHECKING:
    from regrasp.motions.plan import plan_motions

# Loaded when they are asked for: values of motions are read without what plans them.
_LATER = {"plan_motions": "regrasp.motions.plan"}

__all__ = ["Motion", "Motions", "ShutIn", "plan_motions"]


def __getattr__(name: str) -> Any:
    if name in _LATER:
        return getattr(import_module(_LATER[name]), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")

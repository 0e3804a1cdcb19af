"""The explorer: contacts to drag, and what regrasp says of them at once, in a browser or a notebook."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from regrasp.explore.widget import Explorer, explorer

__all__ = ["Explorer", "explorer"]


def __getattr__(name: str) -> Any:
    if name in __all__:  # needs anywidget, which the server does not
        from regrasp.explore import widget

        return getattr(widget, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")

"""Types in signatures lead to the public name of what is documented; other types are plain text."""

from docutils import nodes
from sphinx.util.nodes import make_refnode

import regrasp


def resolved(app, env, node, contnode) -> nodes.Node | None:
    """A link for `regrasp.mechanics.grasp.Grasp`, which is documented as `regrasp.Grasp`; else the text."""
    if node.get("refdomain") != "py":
        return None
    module, _, name = node["reftarget"].rpartition(".")
    if name in regrasp.__all__:
        if module == "regrasp":
            return None  # it ought to be there: a warning
        objects = env.get_domain("py").objects
        if entry := objects.get(f"regrasp.{name}"):
            return make_refnode(app.builder, node["refdoc"], entry.docname, entry.node_id, contnode)
    return contnode


def setup(app):
    """Answer what autodoc could not find."""
    app.connect("missing-reference", resolved)
    return {"parallel_read_safe": True}

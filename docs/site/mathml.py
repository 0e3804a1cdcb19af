"""Formulas as MathML, which browsers draw by themselves: no script and no font is fetched."""

from docutils.utils.math.latex2mathml import tex2mathml


def inline(writer, node) -> None:
    """One formula in a line of text."""
    writer.body.append(tex2mathml(node.astext()))
    raise _skip()


def display(writer, node) -> None:
    """One formula on lines of its own."""
    writer.body.append(f'<div class="math">{tex2mathml(node.astext(), as_block=True)}</div>')
    raise _skip()


def _skip():
    from docutils.nodes import SkipNode

    return SkipNode()


def setup(app):
    """Let pages choose this by default."""
    app.add_html_math_renderer("mathml", (inline, None), (display, None))
    app.config.html_math_renderer = "mathml"
    return {"parallel_read_safe": True}

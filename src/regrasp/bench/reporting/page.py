"""A report as one HTML page that needs nothing else: no network, no script, pictures inside."""

import re
from base64 import b64encode
from collections.abc import Sequence
from html import escape

from regrasp.bench.reporting.document import Block, Heading, Paragraph, Picture, Points, Table

_STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; color: #222; }
body { max-width: 64rem; margin: 2rem auto; padding: 0 1rem; }
h1, h2, h3 { line-height: 1.2; margin: 2rem 0 .7rem; }
code { font-size: .9em; background: #f2f2f2; padding: 0 .2em; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-size: .85rem; }
th { border-bottom: 2px solid #767676; vertical-align: bottom; }
td { border-bottom: 1px solid #ececec; }
th, td { text-align: right; padding: .25rem .7rem; font-variant-numeric: tabular-nums; }
td { white-space: nowrap; }
.word { text-align: left; white-space: normal; }
figure { margin: 1.5rem 0; }
figcaption { font-size: .9rem; color: #595959; }
img { max-width: 100%; }
nav { columns: 2; font-size: .9rem; }
"""


def page(blocks: Sequence[Block]) -> str:
    """The blocks as a page; its title is the first heading, and it opens with links to the others."""
    title = next(block.text for block in blocks if isinstance(block, Heading))
    body: list[str] = []
    for number, block in enumerate(blocks):
        body.append(_element(block, f"part-{number}"))
        if number == 0:
            body.append(_contents(blocks))
    return (
        f'<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n<title>{escape(title)}</title>\n'
        f'<meta name="viewport" content="width=device-width">\n<style>{_STYLE}</style>\n</head>\n<body>\n'
        + "\n".join(body)
        + "\n</body>\n</html>\n"
    )


def _contents(blocks: Sequence[Block]) -> str:
    links = [
        f'<a href="#part-{number}">{escape(block.text)}</a><br>'
        for number, block in enumerate(blocks)
        if isinstance(block, Heading) and block.level == 2
    ]
    return f"<nav>{''.join(links)}</nav>"


def _element(block: Block, name: str) -> str:
    if isinstance(block, Heading):
        return f'<h{block.level} id="{name}">{escape(block.text)}</h{block.level}>'
    if isinstance(block, Paragraph):
        return f"<p>{_inline(block.text)}</p>"
    if isinstance(block, Points):
        return f"<ul>{''.join(f'<li>{_inline(text)}</li>' for text in block.texts)}</ul>"
    if isinstance(block, Picture):
        data = b64encode(block.svg.encode()).decode()
        words = escape(block.words)
        image = f'<img alt="{words}" src="data:image/svg+xml;base64,{data}">'
        return f"<figure>{image}<figcaption>{words}</figcaption></figure>"
    assert isinstance(block, Table)
    head = _row("th", block.header, block.words)
    rows = "\n".join(_row("td", row, block.words) for row in block.rows)
    return f'<div class="wide"><table>\n<thead>{head}</thead>\n<tbody>\n{rows}\n</tbody></table></div>'


def _row(tag: str, cells: Sequence[str], words: int) -> str:
    shown = (
        f'<{tag} class="word">{_inline(text)}</{tag}>' if place < words else f"<{tag}>{_inline(text)}</{tag}>"
        for place, text in enumerate(cells)
    )
    return f"<tr>{''.join(shown)}</tr>"


def _inline(text: str) -> str:
    return re.sub(r"`([^`]+)`", r"<code>\1</code>", escape(text))

"""A report as a value: headings, paragraphs, tables and pictures; here it becomes Markdown."""

from collections.abc import Sequence
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Heading:
    """A heading; level 1 is the title."""

    text: str
    level: int = 2


@dataclass(frozen=True)
class Paragraph:
    """Running text; words between backquotes are names."""

    text: str


@dataclass(frozen=True)
class Points:
    """A list of sentences."""

    texts: Sequence[str]


@dataclass(frozen=True)
class Table:
    """Rows of cells under a header; the first ``words`` columns are of words, the others of numbers."""

    header: Sequence[str]
    rows: Sequence[Sequence[str]]
    words: int = 1


@dataclass(frozen=True)
class Picture:
    """A picture of a file name, with words for those who do not see it."""

    name: str
    words: str
    svg: str = field(repr=False)


Block = Heading | Paragraph | Points | Table | Picture


def markdown(blocks: Sequence[Block]) -> str:
    """The blocks in Markdown; pictures are referred to by their names."""
    return "\n\n".join(_written(block) for block in blocks) + "\n"


def _written(block: Block) -> str:
    if isinstance(block, Heading):
        return f"{'#' * block.level} {block.text}"
    if isinstance(block, Paragraph):
        return block.text
    if isinstance(block, Points):
        return "\n".join(f"- {text}" for text in block.texts)
    if isinstance(block, Picture):
        return f"![{block.words}]({block.name})"
    ruler = ["---"] * block.words + ["---:"] * (len(block.header) - block.words)
    lines = [block.header, ruler, *([_cell(text) for text in row] for row in block.rows)]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ")

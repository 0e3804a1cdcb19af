"""Small drawings as files."""

from pathlib import Path

RECT = '<rect width="20" height="10"/>'


def svg(folder: Path, body: str, attributes: str = "") -> Path:
    path = folder / "drawing.svg"
    names = 'xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"'
    label = 'xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"'
    path.write_text(f"<svg {names} {label} {attributes}>{body}</svg>")
    return path

"""Mesh files as trimesh reads them: one encoding, honest counts, no textures, absolute indices."""

import re

from regrasp.errors import InvalidInput
from regrasp.outline.opening import decoded

MOST_FACES = 1_100_000
_MOST_LINES = 3_000_000
_FACE = 50  # bytes of a binary STL
_SIZES = {
    "char": 1, "uchar": 1, "int8": 1, "uint8": 1, "short": 2, "ushort": 2, "int16": 2, "uint16": 2,
    "float16": 2, "int": 4, "uint": 4, "int32": 4, "uint32": 4, "float": 4, "float32": 4,
    "double": 8, "float64": 8, "int64": 8, "uint64": 8,
}  # fmt: skip


def prepared(data: bytes, kind: str) -> tuple[bytes, list[str]]:
    """The same mesh, and words on what was mended.

    Raises ``InvalidInput`` where the file holds less than it says, or too much.
    """
    if kind == "stl":
        return _stl(data)
    return (_obj(data) if kind == "obj" else _ply(data)), []


def check_count(count: int) -> None:
    """Raise ``InvalidInput`` for more faces than are read."""
    if count > MOST_FACES:
        raise InvalidInput(f"there are {count} faces, more than {MOST_FACES}; simplify the mesh")


def _stl(data: bytes) -> tuple[bytes, list[str]]:
    count, held = int.from_bytes(data[80:84], "little"), (len(data) - 84) / _FACE
    if len(data) >= 84 and count == held:
        check_count(count)
        title = data[:80].replace(b"\0", b" ").decode("ascii", "replace").encode("ascii", "replace")
        return title + data[80:], []
    if b"\0" in data and b"facet" not in data[:4096].lower() and data[:2] not in (b"\xff\xfe", b"\xfe\xff"):
        raise InvalidInput(
            f"the file is damaged: its header says {count} faces, its bytes hold {max(held, 0.0):.6g}"
        )
    text = _lines(decoded(data))
    check_count(len(re.findall(r"\bvertex\b", text, re.IGNORECASE)) // 3)
    return _text_stl(text)


def _text_stl(text: str) -> tuple[bytes, list[str]]:
    """The facets of all solids as one, the last one ended where the file is cut."""
    notes = []
    names = re.findall(r"^[ \t]*(end)?solid\b", text, re.IGNORECASE | re.MULTILINE)
    if names.count("") != len(names) - names.count("") or not names:
        notes.append("mended: a first or last line (solid, endsolid) that is missing")
    facets = re.sub(r"^[ \t]*(end)?solid\b.*$", "", text, flags=re.IGNORECASE | re.MULTILINE)
    last = max((m.start() for m in re.finditer(r"\bfacet\b", facets, re.IGNORECASE)), default=0)
    if last and names[-1:] != ["end"] and not re.search(r"\bendfacet\b", facets[last:], re.IGNORECASE):
        whole = len(re.findall(r"\bvertex(?:\s+[-+.\deE]+){3}\s", facets[last:], re.IGNORECASE)) == 3
        ended = re.sub(r"\s*end\w*\s*$", "", facets[last:], flags=re.IGNORECASE) + "\nendloop\nendfacet\n"
        facets = facets[:last] + (ended if whole else "")
        notes.append("mended: the file ends within a facet" + ("" if whole else ", which is left out"))
    return f"solid\n{facets}\nendsolid\n".encode(), notes


def _lines(text: str) -> str:
    """Text with one kind of line break."""
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _obj(data: bytes) -> bytes:
    """Only vertices and faces: groups and materials do not part a body, textures and normals are not used."""
    text = _lines(decoded(data)).encode().replace(b"\\\n", b" ")
    check_count(len(re.findall(rb"^[ \t]*f[ \t]", text, re.MULTILINE)))
    lines = re.findall(rb"^[ \t]*[vf][ \t][^\r\n#]*", text, re.MULTILINE)
    if len(lines) > _MOST_LINES:
        raise InvalidInput(f"there are {len(lines)} vertices and faces, more than {_MOST_LINES}")
    plain = re.sub(rb"(?<=\d)/[-+/\d]*", b"", b"\n".join(_absolute(lines)) + b"\n")
    _check_corners(plain)
    return plain


def _check_corners(text: bytes) -> None:
    """Raise ``InvalidInput`` for a face whose corners are no numbers of vertices, counted from 1."""
    faces = re.findall(rb"^[ \t]*f[ \t].*$", text, re.MULTILINE)
    count = len(re.findall(rb"^[ \t]*v[ \t]", text, re.MULTILINE))
    try:
        corners = list(map(int, b" ".join(face.split(b"f", 1)[1] for face in faces).split()))
        wrong = not corners or min(corners) < 1 or max(corners) > count
    except ValueError:
        wrong = True
    for face in faces if wrong else ():
        words = face.split()[1:]
        if not all(word.isdigit() for word in words):
            raise InvalidInput(f"a face must be f with numbers of vertices, got {_shown(face)}")
        if not all(1 <= int(word[:20]) <= count for word in words):
            raise InvalidInput(
                f"a face names a vertex that is not there, {_shown(face)}: they are counted from 1 to {count}"
            )


def _absolute(lines: list[bytes]) -> list[bytes]:
    """Faces by numbers from the first vertex: -1 is the last so far."""
    result, count = [], 0
    for line in lines:
        if line.lstrip()[:1] == b"v":
            count += 1
        elif b"-" in line:
            try:
                corners = [int(corner.split(b"/", 1)[0]) for corner in line.split()[1:]]
            except ValueError:
                raise InvalidInput(f"a face must be f with numbers of vertices, got {_shown(line)}") from None
            if any(corner < -count for corner in corners):
                raise InvalidInput(
                    f"a face names a vertex before the first, {_shown(line)}; there are {count} so far"
                )
            line = b"f " + b" ".join(b"%d" % (c if c >= 0 else count + 1 + c) for c in corners)
        result.append(line)
    return result


def _shown(line: bytes) -> str:
    """A line to show."""
    return ascii(line[:60].decode("utf-8", "replace").strip())


def _ply(data: bytes) -> bytes:
    found = re.search(rb"(?:^|[\r\n])end_header[ \t]*(\r\n|\n|\r)", data)
    if not found or not data[:3].lower() == b"ply":
        raise InvalidInput("the file cannot be read as PLY: its header does not begin with ply or has no end")
    lines = [line.decode("latin-1").strip() for line in data[: found.start()].splitlines()]
    kept = [line for line in lines if line and line.split()[0] not in ("comment", "obj_info")]
    body = data[found.end() :]
    is_text = any(line.startswith("format") and "ascii" in line for line in kept)
    least = _least_size(kept, is_text)
    if least > len(body) + 1:
        raise InvalidInput(
            f"the file is damaged: its header says {least} bytes or more, there are {len(body)}"
        )
    if is_text:
        body = decoded(body).encode()
    head = "\n".join([*kept, "end_header"]) + "\n"
    return head.encode("ascii", "replace") + body


def _least_size(header: list[str], is_text: bool) -> int:
    """How many bytes the elements of a header need, if every list is empty."""
    total, count, each = 0, 0, 0
    for line in [*header, "element end 0"]:
        words = line.split()
        if words[0] == "element":
            total += count * each
            if len(words) != 3 or not words[2].isdigit():
                raise InvalidInput(f"the file cannot be read as PLY: its header has {line[:60]!r}")
            count, each = int(words[2][:20]), 0
            if words[1] == "face":
                check_count(count)
        elif words[0] == "property" and len(words) > 2:
            size = _SIZES.get(words[2] if words[1] == "list" else words[1])
            if size is None:
                raise InvalidInput(f"the file cannot be read as PLY: its header has {line[:60]!r}")
            each += 2 if is_text else size
    return total

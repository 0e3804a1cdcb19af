"""Single changes of a module's source, each a slip that a person could make."""

import ast
import copy
from collections.abc import Iterator
from dataclasses import dataclass

_COMPARED = {
    ast.Lt: (ast.LtE, ast.GtE), ast.LtE: (ast.Lt, ast.Gt),
    ast.Gt: (ast.GtE, ast.LtE), ast.GtE: (ast.Gt, ast.Lt),
    ast.Eq: (ast.NotEq,), ast.NotEq: (ast.Eq,), ast.Is: (ast.IsNot,), ast.IsNot: (ast.Is,),
    ast.In: (ast.NotIn,), ast.NotIn: (ast.In,),
}  # fmt: skip
_COMPUTED = {
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.FloorDiv: ast.Mult,
    ast.Pow: ast.Mult, ast.BitAnd: ast.BitOr, ast.BitOr: ast.BitAnd, ast.MatMult: ast.Mult,
}  # fmt: skip
_CALLED = {
    "min": "max", "max": "min", "minimum": "maximum", "maximum": "minimum", "any": "all", "all": "any",
    "argmin": "argmax", "argmax": "argmin", "fmin": "fmax", "fmax": "fmin", "sin": "cos", "cos": "sin",
}  # fmt: skip
_SKIPPED = ("annotation", "returns", "decorator_list", "type_comment", "args", "bases", "target")
_DROPPED = ("abs", "sqrt", "root")  # f(x) becomes x


@dataclass(frozen=True)
class Change:
    """One change: where it is, what stood there and what stands there now."""

    function: str
    line: int
    before: str
    after: str
    source: str
    path: "Path"
    new: ast.AST | None

    @property
    def tree(self) -> ast.Module:
        """The whole module, changed."""
        tree = ast.parse(self.source)
        _put(tree, self.path, self.new)
        return ast.fix_missing_locations(tree)

    @property
    def key(self) -> str:
        """A name that does not move with the lines above it."""
        return f"{self.function}: {self.before}  ->  {self.after}"


def changes(source: str) -> Iterator[Change]:
    """Every change of a module, in order."""
    tree, other = ast.parse(source), ast.parse(source)
    for path, function in _places(tree):
        node, kept, at = _at(tree, path), _at(other, path), _statement(tree, path)
        whole = _at(tree, at)
        line = getattr(node, "lineno", getattr(whole, "lineno", 0))
        for new in _instead(node):
            _put(other, path, new)
            texts = _around(_text(whole), _text(_at(other, at)))
            _set(other, path, kept)
            yield Change(function, line, *texts, source, path, new)


Path = tuple[tuple[str, int | None], ...]


def _places(tree: ast.AST) -> Iterator[tuple[Path, str]]:
    """Every node that may be changed and the function it is in: no annotation, text or import."""

    def walk(node: ast.AST, path: Path, function: str) -> Iterator[tuple[Path, str]]:
        if isinstance(node, (ast.Import, ast.ImportFrom, ast.JoinedStr, ast.Raise)):
            return
        if isinstance(node, ast.keyword) and node.arg == "strict":  # lengths of zip that are equal anyway
            return
        if isinstance(node, ast.ClassDef) and any("Protocol" in ast.unparse(b) for b in node.bases):
            return
        if path:
            yield path, function
        inside = function
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            inside = f"{function}.{node.name}".lstrip(".")
        for field, value in ast.iter_fields(node):
            if field in _SKIPPED and not (field == "args" and isinstance(value, list)):
                continue
            for k, child in enumerate(value) if isinstance(value, list) else [(None, value)]:
                if isinstance(child, ast.AST):
                    yield from walk(child, (*path, (field, k)), inside)

    yield from walk(tree, (), "")


def _instead(node: ast.AST) -> Iterator[ast.AST | None]:
    """What may stand in the place of a node."""
    if isinstance(node, ast.Compare):
        for k, op in enumerate(node.ops):
            for other in _COMPARED.get(type(op), ()):
                yield ast.Compare(node.left, [*node.ops[:k], other(), *node.ops[k + 1 :]], node.comparators)
    elif isinstance(node, ast.BoolOp):
        yield ast.BoolOp(ast.And() if isinstance(node.op, ast.Or) else ast.Or(), node.values)
        if len(node.values) > 1:
            for k in range(len(node.values)):
                rest = [*node.values[:k], *node.values[k + 1 :]]
                yield rest[0] if len(rest) == 1 else ast.BoolOp(node.op, rest)
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.Not, ast.USub, ast.Invert)):
        yield node.operand
    elif isinstance(node, ast.BinOp) and type(node.op) in _COMPUTED:
        yield ast.BinOp(node.left, _COMPUTED[type(node.op)](), node.right)
    elif isinstance(node, ast.AugAssign):
        if type(node.op) in _COMPUTED:
            yield ast.AugAssign(node.target, _COMPUTED[type(node.op)](), node.value)
        yield ast.Pass()
    elif isinstance(node, ast.Constant):
        yield from map(ast.Constant, _numbers(node.value))
    elif isinstance(node, ast.Call):
        yield from _calls(node)
    elif isinstance(node, (ast.If, ast.IfExp)):
        for value in (True, False):
            yield _with(node, test=ast.Constant(value))
    elif isinstance(node, ast.comprehension) and node.ifs:
        yield _with(node, ifs=[])
    elif isinstance(node, ast.Slice) and (node.lower or node.upper):
        yield ast.Slice(None, None, node.step)
    elif isinstance(node, ast.Continue):
        yield ast.Break()
    elif isinstance(node, ast.Expr) and isinstance(node.value, ast.Call):
        yield ast.Pass()


def _numbers(value: object) -> list[object]:
    if isinstance(value, bool):
        return [not value]
    if isinstance(value, int):
        return [value + 1]
    if isinstance(value, float):
        return [value * 1.001, 1.0] if value else [1.0]
    return []


def _calls(node: ast.Call) -> Iterator[ast.AST]:
    name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
    if name in _CALLED:
        other = _CALLED[name]
        function = (
            ast.Attribute(node.func.value, other, ast.Load())
            if isinstance(node.func, ast.Attribute)
            else ast.Name(other, ast.Load())
        )
        yield ast.Call(function, node.args, node.keywords)
    if name in _DROPPED and len(node.args) == 1:
        yield node.args[0]
    if name in ("min", "max") and len(node.args) > 1:
        for k in range(len(node.args)):
            rest = [*node.args[:k], *node.args[k + 1 :]]
            yield (
                rest[0]
                if len(rest) == 1 and not isinstance(rest[0], ast.Starred)
                else ast.Call(node.func, rest, node.keywords)
            )


def _with(node: ast.AST, **fields: object) -> ast.AST:
    other = copy.copy(node)
    for name, value in fields.items():
        setattr(other, name, value)
    return other


def _at(tree: ast.AST, path: Path) -> ast.AST:
    for field, k in path:
        tree = getattr(tree, field) if k is None else getattr(tree, field)[k]
    return tree


def _put(tree: ast.AST, path: Path, new: ast.AST | None) -> None:
    new, old = copy.deepcopy(new), _at(tree, path)
    for name in ("lineno", "col_offset", "end_lineno", "end_col_offset"):
        if hasattr(old, name) and new is not None:
            setattr(new, name, getattr(old, name))
    _set(tree, path, new)


def _set(tree: ast.AST, path: Path, new: ast.AST | None) -> None:
    *way, (field, k) = path
    parent = _at(tree, tuple(way))
    if k is None:
        setattr(parent, field, new)
    else:
        getattr(parent, field)[k] = new


def _statement(tree: ast.AST, path: Path) -> Path:
    """The innermost statement around a place, but no more of it than its own line."""
    for end in range(len(path), 0, -1):
        if isinstance(_at(tree, path[:end]), ast.stmt):
            return path[:end]
    return path[:1]


def _text(node: ast.AST) -> str:
    if isinstance(node, (ast.If, ast.While, ast.For, ast.With, ast.FunctionDef, ast.ClassDef, ast.Try)):
        node = copy.copy(node)
        for field in ("body", "orelse", "finalbody", "handlers"):
            if getattr(node, field, None):
                setattr(node, field, [ast.Pass()] if field == "body" else [])
        return ast.unparse(node).replace(":\n    pass", "")
    return " ".join(ast.unparse(node).split())


def _around(before: str, after: str, room: int = 24) -> tuple[str, str]:
    """What differs of two texts, with a little around it."""
    first = next((k for k, (a, b) in enumerate(zip(before, after, strict=False)) if a != b), 0)
    last = 0
    while last < min(len(before), len(after)) - first and before[-1 - last] == after[-1 - last]:
        last += 1
    lo, hi = max(first - room, 0), max(last - room, 0)
    return before[lo : len(before) - hi], after[lo : len(after) - hi]

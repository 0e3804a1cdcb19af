"""Strict models of what a file holds, and their errors in words that name file and key."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar, get_args

from pydantic import BaseModel, ConfigDict, ValidationError

from regrasp.errors import InvalidFile, shown


class Strict(BaseModel):
    """Every key is known, every number a finite number and nothing is converted from another type."""

    # Of some fifty models a file needs a few: each is built when it is first asked.
    model_config = ConfigDict(strict=True, extra="forbid", frozen=True, allow_inf_nan=False, defer_build=True)


Model = TypeVar("Model", bound=Strict)

# What was expected, by pydantic's type of error; the braces are filled from its context.
_EXPECTED = {
    "finite_number": "a finite number",
    "float_type": "a number",
    "greater_than": "a number greater than {gt:g}",
    "greater_than_equal": "a number of at least {ge:g}",
    "less_than": "a number less than {lt:g}",
    "less_than_equal": "a number of at most {le:g}",
    "list_type": "a list",
    "literal_error": "{expected}",
    "model_attributes_type": "a table",
    "model_type": "a table",
    "multiple_of": "a multiple of {multiple_of:g}",
    "string_too_short": "some text",
    "string_type": "text",
    "too_long": "at most {max_length} entries",
    "too_short": "at least {min_length} entries",
}


def validated(model: type[Model], data: Any, file: str | Path) -> Model:
    """``data`` as a ``model``. Raises one ``InvalidInput`` that lists every problem, a line each.

    Validators find the folder of ``file`` in their context.
    """
    try:
        return model.model_validate(data, context={"folder": Path(file).parent})
    except ValidationError as error:
        lines = [
            f"{file}: {line}" for problem in error.errors() for line in _in_words(model, problem).splitlines()
        ]
        raise InvalidFile("\n".join(lines)) from None


def _in_words(model: type[BaseModel], problem: Mapping[str, Any]) -> str:
    kind, context, given = problem["type"], problem.get("ctx", {}), _shown(problem["input"])
    where, models = _place(model, problem["loc"])
    if kind == "value_error":  # one of our own validators; each of its lines may name its own key
        return "\n".join(where + line for line in str(context["error"]).splitlines())
    if kind == "missing":
        return f"{where}a required key is missing"
    if kind == "extra_forbidden":
        return f"{where}unknown key; known here: {', '.join(models[0].model_fields)}"
    if kind in ("union_tag_invalid", "union_tag_not_found"):
        tags = [*(_tag(m) for m in models), *getattr(model, "other_kinds", ())]
        name = context["discriminator"].strip("'")
        got = f", got {_shown(context['tag'])}" if "tag" in context else ", found no such key"
        return f"{where.removesuffix(': ')}.{name}: expected {' or '.join(map(repr, tags))}{got}"
    if kind in _EXPECTED:
        return f"{where}expected {_EXPECTED[kind].format(**context)}, got {given}"
    return f"{where}{problem['msg']}, got {given}"


def _place(model: type[BaseModel], location: Sequence[int | str]) -> tuple[str, list[type[BaseModel]]]:
    """The key path in a file's own terms, ``contacts[1].normal: ``, and the models that may stand there.

    pydantic's location names the variant of a table as well, which no file shows.
    """
    path, models = "", [model]
    for part in location:
        chosen = [m for m in models if len(models) > 1 and _tag(m) == part]
        if chosen:
            models = chosen
        elif isinstance(part, int):
            path += f"[{part}]"
        elif models or not path:  # else the name of a shape that a plain value may have
            path += f".{part}" if path else part
            field = models[0].model_fields.get(part) if models else None
            models = _models_in(field.annotation) if field else models
    return (f"{path}: " if path else ""), models


def _models_in(annotation: Any) -> list[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [model for part in get_args(annotation) for model in _models_in(part)]


def _tag(model: type[BaseModel]) -> Any:
    """What chooses a variant of a table: the value of its ``kind``, or the name of the shape it comes in."""
    field = model.model_fields.get("kind")
    return get_args(field.annotation)[0] if field else getattr(model, "shape", None)


def _shown(value: Any) -> str:
    text = shown(value)
    return text if len(text) <= 60 else f"{text[:57]}..."

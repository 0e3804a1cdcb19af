"""Compiling the functions of modules from their own code, so that every formula is written once."""

from hashlib import sha256
from types import FunctionType, ModuleType
from typing import Any

import numpy as np
from numba import njit

INNER: dict[str, Any] = {"error_model": "numpy", "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
"""Options of functions that only compiled code calls: with no way in from outside they compile faster."""
VIEWS: dict[str, Any] = {**INNER, "_nrt": False}
"""Of those, functions that make no arrays, which need not count who uses them: faster still."""


def compiled(modules: tuple[ModuleType, ...], *, inline: bool = True, **options: Any) -> dict[str, Any]:
    """All functions of the modules; they call one another through this dictionary of names.

    inline: into their callers, which makes short loops fast and the compilation of long functions slow.
    """
    names: dict[str, Any] = {"__builtins__": __builtins__}
    for module in modules:
        # a whole number of Python's would be a type of its own, and a function compiled for each it is given
        names.update({k: np.int64(v) if type(v) is int else v for k, v in vars(module).items()})
    for module in modules:
        for name, function in vars(module).items():
            if isinstance(function, FunctionType) and function.__module__ == module.__name__:
                mine = FunctionType(function.__code__, names, name, function.__defaults__)
                names[name] = njit(**INNER, forceinline=inline, **options)(mine)
    return names


def digest(modules: tuple[ModuleType, ...]) -> str:
    """Of the sources: in a loop's closure, it makes Numba's cache watch them as it does the loop's file."""
    return sha256(b"".join(map(_source, modules))).hexdigest()


def _source(module: ModuleType) -> bytes:
    """Of a module from anywhere, an archive too; without sources its byte code."""
    loader: Any = module.__loader__
    data: bytes = loader.get_data(module.__file__)
    return data

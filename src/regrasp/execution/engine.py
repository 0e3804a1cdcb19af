"""The simulator, imported when it is used."""

from types import ModuleType


def engine(what: str) -> ModuleType:
    """MuJoCo, or an ``ImportError`` that says what needs it and how to get it."""
    try:
        import mujoco
    except ImportError:
        raise ImportError(f"{what} needs MuJoCo: pip install 'regrasp[mujoco]'") from None
    module: ModuleType = mujoco
    return module

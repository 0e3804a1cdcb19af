"""A study in its folder: how far it is, and its rows as tables."""

from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import choice, file_path
from regrasp.studies.folder import read_definition
from regrasp.studies.parts import parts_in, read_part
from regrasp.studies.task import ANSWERED, VERDICTS

if TYPE_CHECKING:
    import pandas
    import xarray

FORMS = ("pandas", "xarray")


@dataclass(frozen=True)
class Study:
    """How far a study is.

    folder: where its rows are. cases: how many it has. verdicts: how many rows of each verdict. earlier: rows
    of cases that it no longer has. seconds: all cases together took [s].
    """

    folder: Path
    cases: int
    verdicts: dict[str, int]
    earlier: int
    seconds: float

    @property
    def rows(self) -> int:
        """Rows that are there."""
        return sum(self.verdicts.values())

    @property
    def left(self) -> int:
        """Cases without a row."""
        return self.cases - (self.rows - self.earlier)

    def read(self, form: str = "pandas") -> Any:
        """The rows, as ``read_study`` gives them.

        Args:
            form: ``pandas``, or ``xarray`` for a dataset over the grid.
        """
        return read_study(self.folder, form)

    def __str__(self) -> str:
        words = [f"{word} {self.verdicts[word]}" for word in VERDICTS if word in self.verdicts]
        earlier = f" ({self.earlier} of cases that it no longer has)" if self.earlier else ""
        return (
            f"{self.folder}: {self.rows} rows{earlier} of {self.cases} cases, {self.left} left"
            f"{': ' if words else ''}{', '.join(words)}"
        )


def study_in(folder: str | Path) -> Study:
    """How far the study of a folder is; while it runs, too.

    Args:
        folder: of a study.

    Raises:
        InvalidInput: For a folder that is none's.
        ImportError: Without pyarrow, the extra ``regrasp[study]``.
    """
    path = file_path(folder)
    about = read_definition(path)
    verdicts: Counter[str] = Counter()
    seconds = 0.0
    for part in parts_in(path):
        rows = read_part(part, ["verdict", "seconds"])
        verdicts.update(rows["verdict"].to_pylist())
        seconds += sum(rows["seconds"].to_pylist())
    return Study(path, about["study"]["grid"]["cases"], dict(verdicts), about["earlier"], seconds)


def read_study(folder: str | Path, form: str = "pandas") -> "pandas.DataFrame | xarray.Dataset":
    """The rows of a study, while it runs, too.

    Args:
        folder: of a study, as ``sweep`` filled it.
        form: ``pandas``: a data frame with a row for each case; ``xarray``: a dataset over the keys of the
            grid, with a variable for each output, nothing where there is no row yet.

    Raises:
        InvalidInput: For a folder that is none's, and for ``xarray`` of cases that are no product of values.
        ImportError: Without pandas, xarray or pyarrow.
    """
    path = file_path(folder)
    choice(form, "form", FORMS)
    about = read_definition(path)
    try:
        import pandas
    except ImportError:
        raise ImportError("reading studies needs pandas: pip install 'regrasp[study]'") from None
    parts = [read_part(part).to_pandas() for part in parts_in(path)]
    if not parts:
        raise InvalidInput(f"{path} has no rows yet; fill it with sweep")
    frame = pandas.concat(parts, ignore_index=True).drop_duplicates("key", ignore_index=True)
    return frame if form == "pandas" else _over_grid(frame, about["study"]["grid"], path)


def _over_grid(frame: Any, grid: dict[str, Any], path: Path) -> Any:
    try:
        import xarray
    except ImportError:
        raise ImportError("datasets over the grid need xarray: pip install xarray") from None
    axes = grid["axes"]
    if grid["zipped"]:
        raise InvalidInput(f"the cases in {path} are no product of values; read them with pandas")
    if any(isinstance(value, list) for values in axes.values() for value in values):
        raise InvalidInput(
            f"a key of {path} has lists for values, which are no coordinates; read with pandas"
        )
    return xarray.Dataset.from_dataframe(frame.set_index(list(axes))).reindex(axes)


__all__ = ["ANSWERED", "FORMS", "Study", "read_study", "study_in"]

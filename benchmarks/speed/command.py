"""The command line that every benchmark has."""

import argparse
from collections.abc import Callable, Iterable
from pathlib import Path

from report import Report, Row


def command(name: str, about: str, measure: Callable[[bool], Iterable[Row]], packages: Iterable[str]) -> None:
    """Measure, print and write. measure: the rows, of a quick run or a whole one."""
    parser = argparse.ArgumentParser(description=about, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="a short run; needs -o")
    parser.add_argument("-o", "--output", type=Path, metavar="DIR", help="folder to write to")
    options = parser.parse_args()
    if options.quick and options.output is None:
        parser.error("a quick run is no measurement: say where to write it with -o DIR")
    report = Report.of(name, options.quick, measure(options.quick), packages)
    report.write(options.output or Path(__file__).parents[1])
    print(report.markdown())

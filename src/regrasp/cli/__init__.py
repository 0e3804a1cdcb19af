"""The command line. Everything but click is imported inside the commands, when they need it."""

from regrasp.cli.entry import main

__all__ = ["main"]

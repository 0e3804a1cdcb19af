"""The command line. Everything but click is imported inside the commands, when they need it."""

import os
import sys

_MESSAGE = "Interrupted."
_STATUS = 130


def main() -> None:
    """Run the command line and exit with its status; an error is one message on stderr.

    An interrupt ends it at once while modules are imported, in the program it is an error that clears up, and
    once its work is done there is nothing left to interrupt.
    """
    try:
        import atexit
        import signal

        before = signal.getsignal(signal.SIGINT)
        listens = before is signal.default_int_handler and _is_main_thread()
        if listens:
            signal.signal(signal.SIGINT, _quit)
        from regrasp.cli.entry import run

        if listens:
            atexit.register(signal.signal, signal.SIGINT, signal.SIG_IGN)
            signal.signal(signal.SIGINT, before)
        try:
            run()
        finally:
            exec("")  # Python ends by the signal where an interrupt once left any text that was executed
    except KeyboardInterrupt:  # between two lines that see to it
        _quit()


def _is_main_thread() -> bool:
    from threading import current_thread, main_thread

    return current_thread() is main_thread()


def _quit(*_: object) -> None:
    """End, with nothing to clear up; no traceback of half a module."""
    _write(2, _MESSAGE)
    if "--json" in sys.argv[1:]:
        _write(1, f'{{"status": "interrupted", "exit": {_STATUS}, "message": "{_MESSAGE}"}}')
    os._exit(_STATUS)


def _write(descriptor: int, text: str) -> None:
    try:  # noqa: SIM105, contextlib is not loaded yet
        os.write(descriptor, f"{text}\n".encode())
    except OSError:
        pass


__all__ = ["main"]

"""Process of a call: signals that end it, and standard streams that are closed or full."""

import errno
import io
import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType


@contextmanager
def ended_by_signals() -> Iterator[None]:
    """Have a request to end raise SystemExit within the block, so that what is half-written is removed."""
    numbers = [getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name)]
    if threading.current_thread() is not threading.main_thread():
        numbers = []  # only the main thread may set signal handlers
    before = {number: signal.getsignal(number) for number in numbers}
    usual = [number for number in numbers if before[number] is signal.SIG_DFL]
    try:
        for number in usual:
            signal.signal(number, _end)
        yield
    finally:
        for number in usual:
            signal.signal(number, signal.SIG_DFL)


def _end(number: int, _frame: FrameType | None) -> None:
    raise SystemExit(128 + number)


def occupy_closed_streams() -> None:
    """Open the null device in place of closed standard streams, whose numbers the next opened file would get."""
    for number in (0, 1, 2):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: PTH123, SIM115  for the whole run


def escape_unprintable() -> None:
    """Escape what stdout and stderr cannot print, and read stdin as UTF-8 text whatever bytes it holds."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    if isinstance(sys.stdin, io.TextIOWrapper):
        sys.stdin.reconfigure(encoding="utf-8", errors="replace")


def stdout_fault() -> str | None:
    """Write what waits for stdout; return what the system says if that cannot be, and give the rest up then."""
    try:
        sys.stdout.flush()
    except OSError as error:
        give_up_stdout()
        return None if error.errno == errno.EPIPE else error.strerror or str(error)
    except ValueError:  # closed by the program that called
        return None
    return None


def give_up_stdout() -> None:
    """Lead stdout to the null device, so that nothing is tried again when Python ends."""
    try:
        number = sys.stdout.fileno()
    except (OSError, ValueError):  # none of the system
        return
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, number)
    os.close(null)

"""The words for a file that cannot be written."""

import errno
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from pdr_est.errors import OutputError

_DISK_FULL = (errno.ENOSPC, errno.EDQUOT)
_DISK_FULL_WORDS = ("no space left", "os error 28", "disk quota", "errno = 28")  # of libraries that give no number


def output_error(place: Path | str, error: OSError) -> OutputError:
    """Make the error for a place that the system does not let us write to.

    Parameters
    ----------
    place
        File or folder as the user named it.
    error
        What the system said.
    """
    words = str(error).lower()
    if error.errno in _DISK_FULL or any(known in words for known in _DISK_FULL_WORDS):
        return OutputError(f"{place}: the disk is full: free some space or choose another place")
    reason = " ".join((error.strerror or str(error)).split())
    return OutputError(
        f"{place}: cannot be written ({reason}): check that the folder exists and is writable, or choose another one"
    )


@contextmanager
def output_errors(place: Path | str) -> Iterator[None]:
    """Turn what the system says while the block writes into an OutputError that names a place."""
    try:
        yield
    except OSError as error:
        raise output_error(place, error) from error

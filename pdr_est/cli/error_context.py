"""Errors that name the file they are about."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from pdr_est.errors import PdrError


@contextmanager
def prefix_errors(path: Path | str) -> Iterator[None]:
    """Prefix the messages of errors raised in this context with the path of the recording."""
    try:
        yield
    except PdrError as error:
        raise type(error)(f"{path}: {error}") from error

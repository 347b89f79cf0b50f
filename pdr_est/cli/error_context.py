"""Errors that name the file they are about."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from pdr_est.errors import PdrError


@contextmanager
def naming(path: Path | str) -> Iterator[None]:
    """Errors of what knows a recording by its name only are told with its path."""
    try:
        yield
    except PdrError as error:
        raise type(error)(f"{path}: {error}") from error

"""Compute checksums of input files, so that a result tells exactly what it was made from."""

import hashlib
from pathlib import Path

from pdr_est.errors import RecordingError


def file_digests(path: Path) -> dict[str, str]:
    """Compute the SHA-256 of a file, or of every file in a folder, by relative name.

    Raises
    ------
    RecordingError
        When a file cannot be read.
    """
    if path.is_file():
        return {path.name: _digest(path)}
    return {str(file.relative_to(path)): _digest(file) for file in sorted(path.rglob("*")) if file.is_file()}


def _digest(path: Path) -> str:
    try:
        with path.open("rb") as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
    except OSError as error:
        raise RecordingError(f"{path}: cannot be read ({error.strerror}); check its permissions") from error

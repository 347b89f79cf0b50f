"""Checksums of input files, so that a result says exactly what it was made from."""

import hashlib
from pathlib import Path


def file_digests(path: Path) -> dict[str, str]:
    """SHA-256 of a file, or of every file in a folder by its relative name."""
    if path.is_file():
        return {path.name: _digest(path)}
    return {str(file.relative_to(path)): _digest(file) for file in sorted(path.rglob("*")) if file.is_file()}


def _digest(path: Path) -> str:
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()

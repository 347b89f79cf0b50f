"""JSON files that carry the SHA-256 of their own content, so that a changed file is noticed and none is executed."""

import hashlib
import json
from pathlib import Path
from typing import Any

from pdr_est.errors import ConfigError
from pdr_est.output.atomic_output import write_text

Json = dict[str, Any]

_CHECKSUM_KEY = "sha256"


def content_sha256(content: Json) -> str:
    """Compute the SHA-256 of the canonical text of a document: keys in order, no blanks."""
    text = json.dumps(content, sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


def write_checksummed(path: Path, content: Json) -> str:
    """Write a document with its checksum, one top-level key a line; the same content gives the same bytes.

    Returns
    -------
    str
        The checksum.

    Raises
    ------
    OutputError
        If the file cannot be written.
    """
    checksum = content_sha256(content)
    lines = [f"{json.dumps(key)}: {json.dumps(value)}" for key, value in {**content, _CHECKSUM_KEY: checksum}.items()]
    write_text(path, "{\n" + ",\n".join(lines) + "\n}\n")
    return checksum


def read_checksummed(path: Path, kind: str, version: int, remedy: str) -> Json:
    """Read the document in a file, without its checksum.

    Parameters
    ----------
    path : Path
        The file.
    kind, version : str, int
        Values that the document's keys `format` and `version` must have.
    remedy : str
        Advice on how to get a good file, for messages.

    Raises
    ------
    ConfigError
        If the file cannot be read, is damaged, is of another kind or version, or was changed.
    """
    content = _parse(path, remedy)
    if not isinstance(content, dict) or content.get("format") != kind:
        raise ConfigError(f"{path}: is no file of format {kind!r}: {remedy}")
    found = content.get("version")
    if found != version:
        raise ConfigError(
            f"{path}: version {found!r} of {kind}, this program reads {version}: update it, or {remedy}"
        )
    stored = content.pop(_CHECKSUM_KEY, None)
    if stored != _sha256_or_none(content):
        raise ConfigError(
            f"{path}: its content does not match its {_CHECKSUM_KEY} {stored!r}, it was changed: {remedy}"
        )
    return content


def _sha256_or_none(content: Json) -> str | None:
    """Compute the checksum; None for content that has none: NaN, infinity, halves of characters."""
    try:
        return content_sha256(content)
    except ValueError:
        return None


def _parse(path: Path, remedy: str) -> Any:
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read ({error.strerror}): check the path, or {remedy}") from error
    except (ValueError, RecursionError) as error:
        reason = " ".join(str(error).split())
        raise ConfigError(f"{path}: is no valid JSON ({reason}), perhaps cut short: {remedy}") from error

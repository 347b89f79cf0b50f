"""JSON files that carry the SHA-256 of their own content, so that a changed file is noticed and none is executed."""

import hashlib
import json
from pathlib import Path
from typing import Any

from pdr_est.errors import ConfigError, OutputError

Json = dict[str, Any]

_SEAL = "sha256"


def content_sha256(content: Json) -> str:
    """SHA-256 of the canonical text of a document: keys in order, no blanks."""
    text = json.dumps(content, sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


def write_checksummed(path: Path, content: Json) -> str:
    """Write a document with its digest, one top key a line, and return the digest; same content, same bytes.

    Raises OutputError when the file cannot be written.
    """
    seal = content_sha256(content)
    lines = [f"{json.dumps(key)}: {json.dumps(value)}" for key, value in {**content, _SEAL: seal}.items()]
    try:
        path.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8", newline="\n")
    except OSError as error:
        raise OutputError(f"{path}: cannot be written ({error.strerror}): choose another folder") from error
    return seal


def read_checksummed(path: Path, kind: str, version: int, remedy: str) -> Json:
    """The document in a file, less its digest.

    kind, version: what the document's `format` and `version` must say. remedy: how to get a good file, for messages.
    Raises ConfigError for a file that cannot be read, is damaged, of another kind or version, or was changed.
    """
    content = _parsed(path, remedy)
    if not isinstance(content, dict) or content.get("format") != kind:
        raise ConfigError(f"{path}: is no file of format {kind!r}: {remedy}")
    found = content.get("version")
    if found != version:
        raise ConfigError(
            f"{path}: version {found!r} of {kind}, this program reads {version}: update it, or {remedy}"
        )
    told = content.pop(_SEAL, None)
    if told != _digest_or_none(content):
        raise ConfigError(f"{path}: its content does not match its {_SEAL} {told!r}, it was changed: {remedy}")
    return content


def _digest_or_none(content: Json) -> str | None:
    """The digest, None for what no digest can be made of: NaN, infinity, halves of characters."""
    try:
        return content_sha256(content)
    except ValueError:
        return None


def _parsed(path: Path, remedy: str) -> Any:
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read ({error.strerror}): check the path, or {remedy}") from error
    except (ValueError, RecursionError) as error:
        reason = " ".join(str(error).split())
        raise ConfigError(f"{path}: is no valid JSON ({reason}), perhaps cut short: {remedy}") from error

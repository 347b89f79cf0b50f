"""Bytes of a saved state: a mark, a header that names versions and checksum, and the compressed data."""

import json
import zlib
from collections.abc import Collection, Mapping
from hashlib import sha256
from importlib.metadata import version
from typing import TypeVar

from pdr_est.errors import EstimationError
from pdr_est.online.saved_state.table_format import NOTHING_OUTSIDE, ObjectTableError
from pdr_est.online.saved_state.table_reader import decoded
from pdr_est.online.saved_state.table_writer import encoded

T = TypeVar("T")

_MARK = b"pdr_est saved state\n"
_FORMAT = 1
_LARGEST_BYTES = 1 << 30
_LEVEL = 1  # of the compression: fast
_REMEDY = "give all bytes that Tracker.state of this version made"


def pack(root: object, outside: Mapping[str, object] = NOTHING_OUTSIDE) -> bytes:
    """Write an object and everything that it holds, except some objects that `unpack` is given again by their names.

    Raises
    ------
    EstimationError
        For an object that is no data, such as an open file, which it names.
    """
    try:
        table = encoded(root, outside)
    except ObjectTableError as error:
        raise EstimationError(f"the state cannot be saved: {error}") from error
    # The name of a file may have bytes that are no text, which Python keeps as lone surrogates.
    text = json.dumps(table, separators=(",", ":"), ensure_ascii=False).encode("utf-8", "surrogatepass")
    header = {"format": _FORMAT, "pdr_est": version("pdr_est"), "bytes": len(text)}
    content = json.dumps(header).encode() + b"\n" + zlib.compress(text, _LEVEL)
    return _MARK + _checksum(content) + b"\n" + content


def unpack(
    state: bytes, wanted: type[T], modules: Collection[str] = (), outside: Mapping[str, object] = NOTHING_OUTSIDE
) -> T:
    """Make an object again from what `pack` wrote.

    Parameters
    ----------
    state
        The bytes.
    wanted
        Class of the object.
    modules
        Names of modules outside this package whose classes may occur.
    outside
        Objects that were not written, by name.

    Raises
    ------
    EstimationError
        For bytes that are damaged, foreign or of another version.
    """
    if not isinstance(state, bytes | bytearray | memoryview):
        raise EstimationError(f"the state is a {type(state).__name__}, not bytes: {_REMEDY}")
    text = _text(bytes(state))
    try:
        root = decoded(json.loads(text), modules, outside)
    except ObjectTableError as error:
        raise EstimationError(f"the state cannot be read: {error}; {_REMEDY}") from error
    except (ValueError, RecursionError) as error:
        raise EstimationError(f"the state is damaged ({error}): {_REMEDY}") from error
    if not isinstance(root, wanted):
        raise EstimationError(f"the state is that of a {type(root).__name__}: {_REMEDY}")
    return root


def _checksum(content: bytes) -> bytes:
    return sha256(content).hexdigest().encode()


def _text(state: bytes) -> bytes:
    """Check mark, checksum and versions; return the inflated data."""
    if not state.startswith(_MARK):
        raise EstimationError(f"the state is not a saved state of pdr_est: {_REMEDY}")
    checksum, _, content = state[len(_MARK) :].partition(b"\n")
    if checksum != _checksum(content):
        raise EstimationError(f"the state is damaged (its checksum differs): {_REMEDY}")
    line, _, body = content.partition(b"\n")
    try:
        header = json.loads(line)
        written, program, size = (header[key] for key in ("format", "pdr_est", "bytes"))
    except (ValueError, TypeError, KeyError) as error:
        raise EstimationError(f"the header of the state is damaged: {_REMEDY}") from error
    if (written, program) != (_FORMAT, version("pdr_est")):
        raise EstimationError(
            f"the state was saved by pdr_est {program} (format {written}), this is {version('pdr_est')} "
            f"(format {_FORMAT}): {_REMEDY}"
        )
    if not isinstance(size, int) or not 0 < size <= _LARGEST_BYTES:
        raise EstimationError(f"the state claims {size!r} bytes, 1 to {_LARGEST_BYTES} are possible: {_REMEDY}")
    inflater = zlib.decompressobj()
    try:
        text = inflater.decompress(body, size)
    except zlib.error as error:
        raise EstimationError(f"the state is damaged ({error}): {_REMEDY}") from error
    if len(text) != size or not inflater.eof:
        raise EstimationError(f"the state does not have the {size} bytes that it claims: {_REMEDY}")
    return text

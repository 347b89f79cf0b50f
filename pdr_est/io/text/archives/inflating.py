"""Unpack compressed data piece by piece, never beyond a limit, whatever the data claim."""

import bz2
import io
import lzma
import zlib
from collections.abc import Iterable, Iterator
from typing import Protocol

from pdr_est.errors import RecordingError

GZIP_MAGIC = b"\x1f\x8b"
PIECE_BYTES = 1 << 20
"""Largest piece of unpacked data."""

_PACKED_PIECE_BYTES = 1 << 16

# Ours: tables of recordings become 3 to 20 times smaller by compression, a file of one repeated row 300 times.
_HARMLESS_BYTES = 64 * 1024**2
_LARGEST_RATIO = 100


class Inflater(Protocol):
    """Decompressor of one stream, such as those of `bz2` and `lzma`."""

    @property
    def eof(self) -> bool:
        """True at the end of the stream."""

    @property
    def needs_input(self) -> bool:
        """True when more data are needed to go on."""

    def decompress(self, data: bytes, max_length: int = -1, /) -> bytes:
        """Take data, and return at most max_length bytes."""


class Deflate:
    """Decompressor of deflate data with the interface of those of `bz2` and `lzma`. wbits: as in `zlib`."""

    def __init__(self, wbits: int) -> None:
        self._inflater = zlib.decompressobj(wbits)
        self._has_more = False

    @property
    def eof(self) -> bool:
        """True at the end of the stream."""
        return self._inflater.eof

    @property
    def needs_input(self) -> bool:
        """True when more data are needed to go on."""
        return not self._has_more

    @property
    def unused_data(self) -> bytes:
        """Data behind the end of the stream."""
        return self._inflater.unused_data

    def decompress(self, data: bytes, max_length: int = -1, /) -> bytes:
        """Take data, and return at most max_length bytes."""
        out = self._inflater.decompress(self._inflater.unconsumed_tail + data, max_length)
        self._has_more = bool(self._inflater.unconsumed_tail) or len(out) == max_length
        return out


def is_bomb(packed_bytes: int, unpacked_bytes: int) -> bool:
    """Tell whether data are packed so much tighter than any recording that they only waste memory."""
    return unpacked_bytes > _HARMLESS_BYTES and unpacked_bytes > _LARGEST_RATIO * packed_bytes


def inflate(inflater: Inflater, packed: Iterable[bytes]) -> Iterator[bytes]:
    """Unpack a stream in pieces of at most 1 MiB.

    Raises
    ------
    EOFError
        When the data end before the stream does.
    zlib.error, OSError, lzma.LZMAError
        For damaged data.
    """
    for data in packed:
        rest = data
        while True:
            piece = inflater.decompress(rest, PIECE_BYTES)
            rest = b""
            if piece:
                yield piece
            if inflater.eof:
                return
            if inflater.needs_input and len(piece) < PIECE_BYTES:
                break
    raise EOFError("the data end too early")


def member_inflater(method: int, unpacked_bytes: int, options: bytes) -> tuple[Inflater | None, int]:
    """Make the decompressor for a compression method of zip archives; None for data that are stored as they are.

    Parameters
    ----------
    method
        Number of the method.
    unpacked_bytes
        Largest size of the unpacked data.
    options
        First bytes of the packed data, in which LZMA has its properties.

    Returns
    -------
    inflater : Inflater or None
        The decompressor.
    skipped : int
        Number of bytes of the properties, before the packed data.

    Raises
    ------
    NotImplementedError
        For any other method.
    """
    if method == 0:
        return None, 0
    if method == 8:
        return Deflate(-15), 0
    if method == 12:
        return bz2.BZ2Decompressor(), 0
    if method == 14 and len(options) >= 9:
        length = int.from_bytes(options[2:4], "little")
        rest, lc = divmod(options[4], 9)
        pb, lp = divmod(rest, 5)
        # A dictionary larger than the data is never used, but would be allocated.
        size = min(int.from_bytes(options[5:9], "little"), max(unpacked_bytes, 4096))
        chain = [{"id": lzma.FILTER_LZMA1, "dict_size": max(size, 4096), "lc": lc, "lp": lp, "pb": pb}]
        return lzma.LZMADecompressor(lzma.FORMAT_RAW, filters=chain), 4 + length
    raise NotImplementedError(f"compression method {method}")


def gunzip(raw: bytes, limit_bytes: int, place: str) -> bytes:
    """Unpack gzip data of one or more parts.

    Raises
    ------
    RecordingError
        For damaged data, and for more than the limit or much more than any recording is packed to.
    """
    whole = io.BytesIO()
    at = 0
    try:
        while raw[at : at + 2] == GZIP_MAGIC:
            inflater = Deflate(31)
            taken = _Pieces(raw, at)
            for piece in inflate(inflater, taken):
                whole.write(piece)
                refuse_large(taken.end, whole.tell(), limit_bytes, place)
            at = taken.end - len(inflater.unused_data)
            while raw[at : at + 1] == b"\0":
                at += 1
    except EOFError as error:
        raise RecordingError(f"{place}: truncated gzip data; copy or download it again") from error
    except zlib.error as error:
        raise RecordingError(f"{place}: damaged gzip data ({error}); copy or download it again") from error
    return whole.getvalue()


def gunzip_head(raw: bytes, n_bytes: int, place: str) -> bytes:
    """Unpack the first n_bytes of gzip data, of which raw is the beginning.

    Raises RecordingError for damaged data.
    """
    inflater = Deflate(31)
    try:
        head = inflater.decompress(raw, n_bytes)
    except zlib.error as error:
        raise RecordingError(f"{place}: damaged gzip data ({error}); copy or download it again") from error
    if not head and not inflater.eof:
        raise RecordingError(f"{place}: truncated gzip data; copy or download it again")
    return head


def refuse_large(packed_bytes: int, unpacked_bytes: int, limit_bytes: int, place: str) -> None:
    """Raise RecordingError for data that unpack to more than the limit, or to much more than any recording does."""
    if unpacked_bytes > limit_bytes:
        raise RecordingError(
            f"{place}: unpacks to more than the limit of {format_size(limit_bytes)}; give a smaller recording"
        )
    if is_bomb(packed_bytes, unpacked_bytes):
        raise RecordingError(
            f"{place}: unpacks to more than {_LARGEST_RATIO} times its size, as no recording does; unpack it and "
            "look at what is inside"
        )


def format_size(n_bytes: int) -> str:
    """Format a size for a message."""
    return f"{n_bytes / 1024**3:.1f} GiB" if n_bytes >= 1024**3 // 10 else f"{n_bytes} bytes"


class _Pieces:
    """Pieces of data from a position on. end: position behind the last piece that was taken."""

    def __init__(self, data: bytes, at: int) -> None:
        self._data = data
        self.end = at

    def __iter__(self) -> Iterator[bytes]:
        while self.end < len(self._data):
            piece = self._data[self.end : self.end + _PACKED_PIECE_BYTES]
            self.end += len(piece)
            yield piece

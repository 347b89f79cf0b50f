"""List the members of a zip archive once, and read one of them safely."""

import io
import lzma
import re
import struct
import zipfile
import zlib
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import IO

from pdr_est.errors import RecordingError
from pdr_est.io.text.archives.inflating import format_size, inflate, is_bomb, member_inflater, refuse_large

_DRIVE_LETTER = re.compile(r"^[A-Za-z]:")
_LOCAL_HEADER = struct.Struct("<4s22xHH")  # mark, and the lengths of name and further fields that follow
_LOCAL_MAGIC = b"PK\x03\x04"
_PACKED_PIECE_BYTES = 1 << 16
_MOST_MEMBERS = 100_000


@dataclass(frozen=True)
class ZipMember:
    """Entry of the directory of an archive.

    Attributes
    ----------
    header_offset
        Position of its local header.
    method
        Compression method.
    packed_bytes, unpacked_bytes
        Sizes as stated.
    checksum
        CRC-32 of the content.
    """

    header_offset: int
    method: int
    packed_bytes: int
    unpacked_bytes: int
    checksum: int


def zip_members(path: Path, limit_bytes: int) -> dict[str, ZipMember]:
    """List the files in an archive by name, after checking by its directory alone that it is safe to unpack.

    Raises
    ------
    RecordingError
        For a damaged archive, one that claims to be too large, and members that are encrypted, have one name or
        point outside the archive.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            infos = [info for info in archive.infolist() if not info.is_dir()]
    except (zipfile.BadZipFile, OSError, EOFError, ValueError, NotImplementedError) as error:
        raise RecordingError(
            f"{path}: damaged or truncated zip archive ({error}); export or copy it again"
        ) from error
    if len(infos) > _MOST_MEMBERS:
        raise RecordingError(f"{path}: contains more than {_MOST_MEMBERS} files; give the recording itself")
    _refuse_large_claims(infos, path, limit_bytes)
    for name, count in Counter(info.filename for info in infos).items():
        if count > 1:
            raise RecordingError(
                f"{path}: contains {count} members of the name {name!r}, and it is unknown which one counts; pack "
                "the recording again"
            )
    for info in infos:
        parts = info.filename.replace("\\", "/").split("/")
        if ".." in parts or parts[0] == "" or _DRIVE_LETTER.match(info.filename):
            raise RecordingError(
                f"{path}: member {info.filename!r} points outside the archive; pack the recording again"
            )
        if info.flag_bits & 0x1:
            raise RecordingError(f"{path}: member {info.filename!r} is encrypted; unpack it with its password first")
    return {
        info.filename: ZipMember(info.header_offset, info.compress_type, info.compress_size, info.file_size, info.CRC)
        for info in infos
    }


def _refuse_large_claims(infos: list[zipfile.ZipInfo], path: Path, limit_bytes: int) -> None:
    declared = sum(info.file_size for info in infos)
    if declared > limit_bytes:
        raise RecordingError(
            f"{path}: claims to unpack to {format_size(declared)}, the limit is {format_size(limit_bytes)}; "
            "give a smaller recording"
        )
    if is_bomb(path.stat().st_size, declared):
        refuse_large(path.stat().st_size, declared, limit_bytes, str(path))


def read_member(path: Path, member: ZipMember, place: str, n_bytes: int | None = None) -> bytes:
    """Read a member of an archive, all of it or its first n_bytes.

    Raises
    ------
    RecordingError
        When it is damaged, or larger than the directory of the archive states.
    """
    whole = io.BytesIO()
    try:
        with path.open("rb") as stream:
            for piece in _unpacked(stream, member):
                whole.write(piece)
                if whole.tell() > member.unpacked_bytes:
                    raise RecordingError(
                        f"{place}: damaged archive: holds more than the {member.unpacked_bytes} bytes that its "
                        "directory states; export or copy it again"
                    )
                if n_bytes is not None and whole.tell() >= n_bytes:
                    whole.seek(0)
                    return whole.read(n_bytes)
    except (zipfile.BadZipFile, zlib.error, lzma.LZMAError, EOFError, NotImplementedError, ValueError) as error:
        raise RecordingError(f"{place}: damaged archive ({error}); export or copy it again") from error
    content = whole.getvalue()
    if len(content) != member.unpacked_bytes or zlib.crc32(content) != member.checksum:
        raise RecordingError(f"{place}: damaged archive (wrong size or checksum); export or copy it again")
    return content if n_bytes is None else content[:n_bytes]


def _unpacked(stream: IO[bytes], member: ZipMember) -> Iterator[bytes]:
    """Unpack the content of a member in pieces."""
    stream.seek(member.header_offset)
    header = stream.read(_LOCAL_HEADER.size)
    if len(header) < _LOCAL_HEADER.size or header[:4] != _LOCAL_MAGIC:
        raise zipfile.BadZipFile("no header where the directory says")
    _, name_bytes, extra_bytes = _LOCAL_HEADER.unpack(header)
    begin = member.header_offset + _LOCAL_HEADER.size + name_bytes + extra_bytes
    stream.seek(begin)
    inflater, skipped = member_inflater(member.method, member.unpacked_bytes, stream.read(9))
    stream.seek(begin + skipped)
    packed = _packed(stream, member.packed_bytes - skipped)
    try:
        # Some writers end LZMA data by the stated size alone.
        yield from packed if inflater is None else inflate(inflater, packed)
    except EOFError:
        if member.method != zipfile.ZIP_LZMA:
            raise
    except OSError as error:  # of bzip2 data; those of the file itself have a number
        if error.errno is not None:
            raise
        raise zipfile.BadZipFile(str(error)) from error


def _packed(stream: IO[bytes], n_bytes: int) -> Iterator[bytes]:
    while n_bytes > 0:
        piece = stream.read(min(n_bytes, _PACKED_PIECE_BYTES))
        if not piece:
            return
        n_bytes -= len(piece)
        yield piece

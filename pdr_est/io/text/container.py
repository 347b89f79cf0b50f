"""Open one input of the readers: a file, a folder or a zip archive, plain or gzipped, seen as named members.

Everything about an input that can be dangerous or damaged is dealt with here, so that a format module only sees names
and bytes: archives that claim to unpack to enormous sizes, members that point outside their archive, encrypted or
truncated archives, empty files.
"""

import os
import posixpath
import re
import zipfile
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from pathlib import Path, PurePosixPath

from pdr_est.errors import RecordingError

UNPACKED_LIMIT_BYTES = 2 * 1024**3

ZIP_MAGICS = (b"PK\x03\x04", b"PK\x05\x06")
"""First bytes of a zip archive, of an empty one the second."""

_GZIP_MAGIC = b"\x1f\x8b"
_DRIVE_LETTER = re.compile(r"^[A-Za-z]:")
_CHUNK_BYTES = 1 << 16
_MAX_MEMBERS = 100_000
_KEPT_HEAD_BYTES = 8192


class SourceKind(StrEnum):
    """Kind of an input on the disk."""

    FILE = "file"
    FOLDER = "folder"
    ZIP = "zip"


@dataclass(frozen=True)
class Source:
    """Input with its members.

    Attributes
    ----------
    path
        The file, folder or archive.
    kind
        Whether that is a file, a folder or a zip archive.
    stored
        Logical member name -> name inside the folder or archive. Logical names are relative, with "/" between the
        parts, without a trailing `.gz` and without a single top folder that wraps everything.
    limit_bytes
        No member is ever inflated beyond this size.
    """

    path: Path
    kind: SourceKind
    stored: Mapping[str, str]
    limit_bytes: int = UNPACKED_LIMIT_BYTES
    _heads: dict[str, bytes] = field(default_factory=dict, compare=False, repr=False)

    @classmethod
    def open(cls, path: str | Path, limit_bytes: int = UNPACKED_LIMIT_BYTES) -> "Source":
        """List the members of a path without unpacking anything.

        Raises
        ------
        RecordingError
            When the path is missing, unreadable or empty, or an unsafe or damaged archive.
        """
        place = Path(path)
        try:
            if place.is_dir():
                return cls(place, SourceKind.FOLDER, _logical_names(place, _folder_members(place)), limit_bytes)
            if not place.exists():
                fault = "a symbolic link to a missing file" if place.is_symlink() else "no such file or folder"
                raise RecordingError(f"{place}: {fault}; check the path")
            if not place.is_file():
                raise RecordingError(f"{place}: neither a file nor a folder; give the file, folder or zip of a walk")
            with place.open("rb") as stream:
                magic = stream.read(4)
        except OSError as error:
            raise RecordingError(f"{place}: cannot be read ({error.strerror}); check its permissions") from error
        if not magic:
            raise RecordingError(f"{place}: the file is empty (0 bytes); export it again")
        if magic in ZIP_MAGICS:
            return cls(place, SourceKind.ZIP, _logical_names(place, _zip_members(place, limit_bytes)), limit_bytes)
        return cls(place, SourceKind.FILE, {_without_gz(place.name): place.name}, limit_bytes)

    @property
    def name(self) -> str:
        """Return the name of the input without a trailing `.gz`."""
        return _without_gz(self.path.name)

    @property
    def members(self) -> tuple[str, ...]:
        """Return the logical names of the members, sorted."""
        return tuple(sorted(self.stored))

    def place(self, member: str) -> str:
        """Describe where a member lies, for messages."""
        if self.kind is SourceKind.ZIP:
            return f"{self.path}, member {self.stored[member]}"
        return str(self._disk_path(member))

    def folder_name(self, member: str) -> str:
        """Return the name of the folder that a member lies in, also above the source's own path."""
        if self.kind is SourceKind.ZIP:
            return PurePosixPath(self.stored[member]).parent.name or self.path.stem
        return self._disk_path(member).absolute().parent.name

    def read(self, member: str) -> bytes:
        """Read the whole content of a member, gunzipped if it is gzip data.

        Raises
        ------
        RecordingError
            When the member is damaged or unpacks beyond the limit.
        """
        raw = self._stored_bytes(member, None)
        if not raw.startswith(_GZIP_MAGIC):
            return raw
        data, complete = _gunzip(raw, self.limit_bytes, self.place(member))
        if not complete:
            raise RecordingError(
                f"{self.place(member)}: unpacks to more than the limit of {_format_size(self.limit_bytes)}; "
                "give a smaller recording"
            )
        if data[:4] in ZIP_MAGICS:
            raise RecordingError(f"{self.place(member)}: a zip archive inside gzip; unpack the gzip layer first")
        return data

    def head(self, member: str, n_bytes: int = 4096) -> bytes:
        """Read at most the first n_bytes of a member, gunzipped; cheap, and kept because every format asks for it."""
        if n_bytes > _KEPT_HEAD_BYTES:
            return self._read_head(member, n_bytes)
        if member not in self._heads:
            self._heads[member] = self._read_head(member, _KEPT_HEAD_BYTES)
        return self._heads[member][:n_bytes]

    def _read_head(self, member: str, n_bytes: int) -> bytes:
        # Deflate may expand incompressible data by a few bytes a block; the margin keeps the head complete.
        raw = self._stored_bytes(member, n_bytes + 1024)
        if not raw.startswith(_GZIP_MAGIC):
            return raw[:n_bytes]
        return _gunzip_head(raw, n_bytes, self.place(member))

    def with_only(self, member: str) -> "Source":
        """Return the same source with one member only."""
        return replace(self, stored={member: self.stored[member]})

    def sibling(self, member: str, relative: str) -> "Source | None":
        """Find a file relative to the folder of a member, such as `tango1.csv` or `../xml/walk.xml`.

        Returns
        -------
        Source or None
            Source of that file alone, also if it is gzipped; None when there is none. Inside an archive only its own
            members are found.
        """
        if self.kind is SourceKind.ZIP:
            name = posixpath.normpath(posixpath.join(posixpath.dirname(self.stored[member]), relative))
            found = [logical for logical, stored in self.stored.items() if _without_gz(stored) == name]
            return self.with_only(found[0]) if found else None
        beside = self._disk_path(member).parent / relative
        for candidate in (beside, beside.with_name(beside.name + ".gz")):
            if candidate.is_file():
                stored = {_without_gz(candidate.name): candidate.name}
                return Source(candidate, SourceKind.FILE, stored, self.limit_bytes)
        return None

    def _disk_path(self, member: str) -> Path:
        return self.path if self.kind is SourceKind.FILE else self.path / self.stored[member]

    def _stored_bytes(self, member: str, n_bytes: int | None) -> bytes:
        """Read the stored bytes of a member, all or the first n_bytes, not gunzipped."""
        place = self.place(member)
        try:
            if self.kind is SourceKind.ZIP:
                with zipfile.ZipFile(self.path) as archive, archive.open(self.stored[member]) as stream:
                    return stream.read() if n_bytes is None else stream.read(n_bytes)
            path = self._disk_path(member)
            if n_bytes is None and path.stat().st_size > self.limit_bytes:
                raise RecordingError(f"{place}: larger than the limit of {_format_size(self.limit_bytes)}; split it")
            with path.open("rb") as file:
                return file.read() if n_bytes is None else file.read(n_bytes)
        except OSError as error:
            raise RecordingError(f"{place}: cannot be read ({error.strerror or error}); check the file") from error
        except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError) as error:
            raise RecordingError(f"{place}: damaged archive ({error}); export or copy it again") from error


def _without_gz(name: str) -> str:
    return name[:-3] if name.lower().endswith(".gz") and len(name) > 3 else name


def _format_size(n_bytes: int) -> str:
    return f"{n_bytes / 1024**3:.1f} GiB" if n_bytes >= 1024**3 // 10 else f"{n_bytes} bytes"


def _is_hidden(name: str) -> bool:
    """Tell whether a member is a hidden file or part of the shadow tree that macOS puts into archives."""
    return any(part.startswith(".") or part == "__MACOSX" for part in name.split("/"))


def _folder_members(folder: Path) -> list[str]:
    """List the files below a folder, except pipes and devices, which may never end."""

    def refuse(error: OSError) -> None:
        raise error

    names = []
    for root, _, files in os.walk(folder, onerror=refuse):
        at = Path(root)
        relative = at.relative_to(folder)
        names += [(relative / file).as_posix() for file in files if not _is_special(at / file)]
        if len(names) > _MAX_MEMBERS:
            raise RecordingError(f"{folder}: contains more than {_MAX_MEMBERS} files; give the recording itself")
    return names


def _is_special(path: Path) -> bool:
    return path.exists() and not path.is_file()


def _zip_members(path: Path, limit_bytes: int) -> list[str]:
    """List the files in an archive, after checking by its directory alone that it is safe to unpack."""
    try:
        with zipfile.ZipFile(path) as archive:
            infos = [info for info in archive.infolist() if not info.is_dir()]
    except (zipfile.BadZipFile, OSError, EOFError, ValueError, NotImplementedError) as error:
        raise RecordingError(
            f"{path}: damaged or truncated zip archive ({error}); export or copy it again"
        ) from error
    declared = sum(info.file_size for info in infos)
    if declared > limit_bytes:
        raise RecordingError(
            f"{path}: claims to unpack to {_format_size(declared)}, the limit is {_format_size(limit_bytes)}; "
            "give a smaller recording"
        )
    for info in infos:
        parts = info.filename.replace("\\", "/").split("/")
        if ".." in parts or parts[0] == "" or _DRIVE_LETTER.match(info.filename):
            raise RecordingError(
                f"{path}: member {info.filename!r} points outside the archive; pack the recording again"
            )
        if info.flag_bits & 0x1:
            raise RecordingError(f"{path}: member {info.filename!r} is encrypted; unpack it with its password first")
    return [info.filename for info in infos]


def _logical_names(path: Path, stored: list[str]) -> dict[str, str]:
    """Map stored names to logical names: no hidden files, no wrapping folder, no `.gz`."""
    names = {name: name.replace("\\", "/") for name in stored}
    kept = {name: logical for name, logical in names.items() if not _is_hidden(logical)}
    if not kept:
        raise RecordingError(f"{path}: contains no files; give the file, folder or zip of a recording")
    wrap = posixpath.commonpath([posixpath.dirname(logical) for logical in kept.values()])
    result: dict[str, str] = {}
    for name, full in kept.items():
        logical = _without_gz(posixpath.relpath(full, wrap) if wrap else full)
        if logical in result:
            raise RecordingError(f"{path}: contains both {result[logical]} and {name}; remove one of them")
        result[logical] = name
    return result


def _gunzip(raw: bytes, limit_bytes: int, place: str) -> tuple[bytes, bool]:
    """Inflate gzip data of one or more parts; the flag is False when it goes beyond the limit."""
    parts: list[bytes] = []
    total = 0
    rest = raw
    while rest.startswith(_GZIP_MAGIC):
        inflater = zlib.decompressobj(wbits=31)
        try:
            part = inflater.decompress(rest, limit_bytes - total + 1)
        except zlib.error as error:
            raise RecordingError(f"{place}: damaged gzip data ({error}); copy or download it again") from error
        total += len(part)
        if total > limit_bytes:
            return b"", False
        if not inflater.eof:
            raise RecordingError(f"{place}: truncated gzip data; copy or download it again")
        parts.append(part)
        rest = inflater.unused_data.lstrip(b"\0")
    return b"".join(parts), True


def _gunzip_head(raw: bytes, n_bytes: int, place: str) -> bytes:
    """Inflate the beginning of gzip data."""
    inflater = zlib.decompressobj(wbits=31)
    try:
        head = inflater.decompress(raw, n_bytes)
    except zlib.error as error:
        raise RecordingError(f"{place}: damaged gzip data ({error}); copy or download it again") from error
    if not head and not inflater.eof:
        raise RecordingError(f"{place}: truncated gzip data; copy or download it again")
    return head

"""Open one input of the readers: a file, a folder or a zip archive, plain or gzipped, seen as named members.

Everything about an input that can be dangerous or damaged is dealt with here, so that a format module only sees names
and bytes: archives that claim to unpack to enormous sizes, members that point outside their archive, encrypted or
truncated archives, empty files.
"""

import os
import posixpath
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from pathlib import Path, PurePosixPath

from pdr_est.errors import RecordingError
from pdr_est.io.text.archives.inflating import GZIP_MAGIC, format_size, gunzip, gunzip_head
from pdr_est.io.text.archives.zip_files import ZipMember, read_member, zip_members
from pdr_est.output.call_inputs import remember_input

UNPACKED_LIMIT_BYTES = 2 * 1024**3

ZIP_MAGICS = (b"PK\x03\x04", b"PK\x05\x06")
"""First bytes of a zip archive, of an empty one the second."""

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
    _packed: Mapping[str, ZipMember] = field(default_factory=dict, compare=False, repr=False)
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
            packed = zip_members(place, limit_bytes)
            return cls(place, SourceKind.ZIP, _logical_names(place, list(packed)), limit_bytes, packed)
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
        if not raw.startswith(GZIP_MAGIC):
            return raw
        data = gunzip(raw, self.limit_bytes, self.place(member))
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
        if not raw.startswith(GZIP_MAGIC):
            return raw[:n_bytes]
        return gunzip_head(raw, n_bytes, self.place(member))

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
            if n_bytes is None:  # heads are also read of files that turn out to be no recording
                remember_input(self.path if self.kind is SourceKind.ZIP else self._disk_path(member))
            if self.kind is SourceKind.ZIP:
                return read_member(self.path, self._packed[self.stored[member]], place, n_bytes)
            path = self._disk_path(member)
            if n_bytes is None and path.stat().st_size > self.limit_bytes:
                raise RecordingError(f"{place}: larger than the limit of {format_size(self.limit_bytes)}; split it")
            with path.open("rb") as file:
                return file.read() if n_bytes is None else file.read(n_bytes)
        except OSError as error:
            raise RecordingError(f"{place}: cannot be read ({error.strerror or error}); check the file") from error


def _without_gz(name: str) -> str:
    return name[:-3] if name.lower().endswith(".gz") and len(name) > 3 else name


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


def _logical_names(path: Path, stored: list[str]) -> dict[str, str]:
    """Map stored names to logical names: no hidden files, no wrapping folder, no `.gz`."""
    names = {name: name.replace("\\", "/") for name in stored}
    kept = {name: logical for name, logical in names.items() if not _is_hidden(logical)}
    if not kept:
        raise RecordingError(f"{path}: contains no files; give the file, folder or zip of a recording")
    wrap = posixpath.commonpath([posixpath.dirname(logical) for logical in kept.values()])
    result: dict[str, str] = {}
    for name, full in kept.items():
        logical = _without_gz(posixpath.relpath(full, wrap) if wrap else posixpath.normpath(full))
        if logical in result:
            raise RecordingError(f"{path}: contains both {result[logical]} and {name}; remove one of them")
        result[logical] = name
    return result

"""Find the walks that the arguments of a command name: recordings, folders of recordings, and patterns."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from pdr_est.cli.call_paths import is_pattern, matching_paths
from pdr_est.errors import RecordingError, SeveralWalksError
from pdr_est.io import read
from pdr_est.io.formats.walks_in_folder import walks_in_folder
from pdr_est.io.tables.mapping import TableMapping
from pdr_est.types.recording import Recording

_EXTENSION = re.compile(r"\.[a-z][a-z0-9]{0,7}", re.IGNORECASE)
_MANY = 3  # recordings; two that were made at different times may be phones with a wrong date
_LARGEST_ZONE_S = 14.0 * 3600.0  # difference between local time and UTC


@dataclass(frozen=True)
class NamedPath:
    """Recording of a walk with a name that no other walk of the call has.

    Attributes
    ----------
    name
        Name of the walk, for result folders and tables: the last parts of its path, with "/" between them.
    path
        Path of the recording.
    """

    name: str
    path: Path


def expand_paths(arguments: Sequence[Path], mapping: TableMapping | None = None) -> tuple[Path, ...]:
    """Replace patterns by the files that they match, and folders of several recordings by these; each counts once.

    Parameters
    ----------
    arguments
        Files, folders and patterns.
    mapping
        What the columns of the tables mean; None to find it out.

    Raises
    ------
    RecordingError
        For a pattern without a match.
    """
    return distinct_paths(path for one in arguments for path in expand_argument(one, mapping))


def expand_argument(argument: Path, mapping: TableMapping | None = None) -> tuple[Path, ...]:
    """Return the recordings that one argument stands for (see `expand_paths`)."""
    return distinct_paths(path for match in _matches(argument) for path in _inside(match, mapping))


def distinct_paths(paths: Iterable[Path]) -> tuple[Path, ...]:
    """Return the first path to each file or folder, in order."""
    first: dict[Path, Path] = {}
    for path in paths:
        first.setdefault(_resolved(path), path)
    return tuple(first.values())


def _resolved(path: Path) -> Path:
    try:
        return path.resolve()
    except (OSError, RuntimeError):  # such as a loop of links: reading it says so
        return path.absolute()


def named_paths(paths: Sequence[Path]) -> tuple[NamedPath, ...]:
    """Name recordings by as many of the last parts of their paths as make the names different."""
    parts = [_without_extensions(path.absolute()).parts for path in paths]
    if len(set(parts)) < len(set(paths)):  # such as walk.csv and walk.txt
        parts = [path.absolute().parts for path in paths]
    names = [_distinct_end(own, parts) for own in parts]
    if any(other.startswith(f"{name}/") for name in names for other in names):
        names = [name.replace("/", "_") for name in names]  # no folder of results inside another one
    return tuple(NamedPath(name, path) for name, path in zip(names, paths, strict=True))


def _distinct_end(own: tuple[str, ...], others: Sequence[tuple[str, ...]]) -> str:
    """Return the last parts of a path that no other path has."""
    for count in range(1, len(own)):
        if all(other == own or other[-count:] != own[-count:] for other in others):
            return "/".join(own[-count:])
    return "/".join(own[1:])


def are_separate_walks(
    paths: Sequence[Path], mapping: TableMapping | None = None, devices: Sequence[str] = ()
) -> bool:
    """Tell whether several recordings, by their dates, were all made at different times.

    Parameters
    ----------
    paths
        The recordings.
    mapping
        What the columns of their tables mean; None to find it out.
    devices
        Names of the devices that are used; all without names.

    Raises
    ------
    RecordingError
        If one cannot be read.
    """
    if len(paths) < _MANY:
        return False
    spans: list[tuple[bool, float, float]] = []
    for path in paths:
        span = _dated_span_s(read(path, mapping, devices))
        if span is None or any(_may_overlap(span, other) for other in spans):
            return False
        spans.append(span)
    return True


def _dated_span_s(recording: Recording) -> tuple[bool, float, float] | None:
    """Return whether a recording knows its time zone, and the dates of its first and last sample, s since 1970."""
    local = recording.epoch_s is None and recording.tells_local_date
    epoch_s = recording.local_epoch_s if local else recording.epoch_s
    if epoch_s is None or recording.span_s is None:
        return None
    begin_s, end_s = recording.span_s
    return not local, epoch_s + begin_s, epoch_s + end_s


def _may_overlap(one: tuple[bool, float, float], other: tuple[bool, float, float]) -> bool:
    """Tell whether two spans overlap, or may do so because only one knows its time zone."""
    margin_s = 0.0 if one[0] == other[0] else _LARGEST_ZONE_S
    return one[1] < other[2] + margin_s and other[1] < one[2] + margin_s


def _matches(argument: Path) -> list[Path]:
    if not is_pattern(argument):
        return [argument]
    found = matching_paths(argument)
    if not found:
        raise RecordingError(f"{argument}: no file has a name like that: check the pattern")
    return found


def _inside(path: Path, mapping: TableMapping | None) -> tuple[Path, ...]:
    try:
        if not path.is_dir():
            return (path,)
    except OSError:  # such as a name that is too long: reading it says so
        return (path,)
    try:
        return walks_in_folder(path, mapping)
    except SeveralWalksError as error:
        if error.by_device:  # reading it says so, unless --device names one of them
            return (path,)
        raise
    except RecordingError:  # reading it says so
        return (path,)


def _without_extensions(path: Path) -> Path:
    plain = path.with_suffix("") if path.suffix.lower() == ".gz" else path
    return plain.with_suffix("") if _EXTENSION.fullmatch(plain.suffix) and not path.is_dir() else plain

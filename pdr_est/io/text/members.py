"""Which member of a source is the recording: found by content, and never guessed when there are several."""

from collections.abc import Callable, Sequence

from pdr_est.errors import RecordingError
from pdr_est.io.text.container import Source

_HEAD_BYTES = 8192
_NAMED_IN_MESSAGE = 3


def find_members(source: Source, looks_right: Callable[[bytes], bool]) -> tuple[str, ...]:
    """The members whose first bytes look right."""
    return tuple(member for member in source.members if looks_right(source.head(member, _HEAD_BYTES)))


def require_single_walk(source: Source, walks: Sequence[str], format_name: str) -> str:
    """The one walk of a source. Raises RecordingError that names some of them when there are several."""
    if len(walks) == 1:
        return walks[0]
    if not walks:
        raise RecordingError(f"{source.path}: no {format_name} recording inside; give the recording itself")
    named = ", ".join(walks[:_NAMED_IN_MESSAGE]) + (", …" if len(walks) > _NAMED_IN_MESSAGE else "")
    raise RecordingError(f"{source.path}: {len(walks)} {format_name} recordings inside ({named}); pick one of them")


def member_stem(member: str) -> str:
    """Name of a member without folders and extension."""
    return member.rsplit("/", 1)[-1].rsplit(".", 1)[0]

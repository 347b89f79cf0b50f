"""Find the member of a source that holds the recording: by content, and without guessing when there are several."""

from collections.abc import Callable, Sequence

from pdr_est.errors import RecordingError, SeveralWalksError
from pdr_est.io.text.container import Source

_HEAD_BYTES = 8192
_NAMED_IN_MESSAGE = 3


def find_members(source: Source, looks_right: Callable[[bytes], bool]) -> tuple[str, ...]:
    """Find the members whose first bytes `looks_right` accepts."""
    return tuple(member for member in source.members if looks_right(source.head(member, _HEAD_BYTES)))


def require_single_walk(source: Source, walks: Sequence[str], format_name: str) -> str:
    """Return the only walk of a source.

    Raises
    ------
    RecordingError
        When there is none.
    SeveralWalksError
        When there are several, some of which it names.
    """
    if len(walks) == 1:
        return walks[0]
    if not walks:
        raise RecordingError(f"{source.path}: contains no {format_name} recording; give the recording itself")
    named = ", ".join(walks[:_NAMED_IN_MESSAGE]) + (", …" if len(walks) > _NAMED_IN_MESSAGE else "")
    raise SeveralWalksError(
        f"{source.path}: contains {len(walks)} {format_name} recordings ({named}); choose one of them", tuple(walks)
    )


def member_stem(member: str) -> str:
    """Return the name of a member without folders and extension."""
    return member.rsplit("/", 1)[-1].rsplit(".", 1)[0]

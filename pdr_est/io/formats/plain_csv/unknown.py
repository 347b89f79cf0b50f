"""Help with files that are not understood: say what was seen."""

from pdr_est.io.formats.sensor_files.grouping import files_without_time
from pdr_est.io.tables.header import understand_titles
from pdr_est.io.tables.recognition import describe_content
from pdr_est.io.tables.signals import HEAD_BYTES, layout_of
from pdr_est.io.text.cells import split_line
from pdr_est.io.text.container import Source
from pdr_est.io.text.encoding import as_utf8
from pdr_est.io.text.members import member_stem

_MEMBERS_NAMED = 3
_PACKINGS = {
    b"BZh": "a bzip2 file",
    b"\xfd7zXZ\0": "an xz file",
    b"\x28\xb5\x2f\xfd": "a zstd file",
    b"7z\xbc\xaf\x27\x1c": "a 7z archive",
    b"Rar!\x1a\x07": "a rar archive",
}
_TAR_MARK_AT, _TAR_MARK = 257, b"ustar"
_BINARY_SHARE = 0.1
_TEXT_BYTES = bytes({*range(32, 256), 9, 10, 13})


def describe_unknown(source: Source) -> str:
    """Say in one line what a source holds that no format is known for."""
    timeless = files_without_time(source)
    if timeless:
        named = ", ".join(timeless[:_MEMBERS_NAMED]) + (", …" if len(timeless) > _MEMBERS_NAMED else "")
        return (
            f"the rows of {named} have three axes and no time; a mapping can give the rate of each file, time: "
            "{rate_hz: 50}"
        )
    packed = _packed_as(source)
    if packed:
        return f"it is {packed}: unpack it, and give the file or folder inside"
    with_rows = [member for member in source.members if layout_of(source.head(member, HEAD_BYTES)) is not None]
    if len(source.members) == 1 and source.head(source.members[0], 1) in (b"{", b"["):
        return "it is JSON without records of a clock and the axes of a sensor, or text in brackets"
    if not with_rows and any(_has_titles_only(source.head(member, HEAD_BYTES)) for member in source.members):
        return "it has the titles of a table and no rows below them; record again"
    if not with_rows:
        if all(_is_binary(source.head(member, HEAD_BYTES)) for member in source.members):
            return "it is no text"
        return "no rows of numbers were found in it"
    described = [
        f"{member}: {describe_content(source.head(member, HEAD_BYTES), member_stem(member))}"
        for member in with_rows[:_MEMBERS_NAMED]
    ]
    more = len(with_rows) - len(described)
    text = described[0].split(": ", 1)[1] if len(source.members) == 1 else "; ".join(described)
    return f"{text}; and {more} more tables" if more else text


def _packed_as(source: Source) -> str:
    """Name the packing of a single file that no reader unpacks; "" for other sources."""
    if len(source.members) != 1:
        return ""
    head = source.head(source.members[0], _TAR_MARK_AT + len(_TAR_MARK))
    if head[_TAR_MARK_AT:] == _TAR_MARK:
        return "a tar archive"
    return next((name for magic, name in _PACKINGS.items() if head.startswith(magic)), "")


def _has_titles_only(head: bytes) -> bool:
    """Tell whether the first line names the columns of a table with motion."""
    first = as_utf8(head).decode("utf-8", "replace").strip().split("\n", 1)[0]
    return any(understand_titles(split_line(first, separator)).has_motion for separator in (",", ";", "\t"))


def _is_binary(head: bytes) -> bool:
    text = as_utf8(head)
    return len(text.translate(None, _TEXT_BYTES)) > _BINARY_SHARE * max(1, len(text))

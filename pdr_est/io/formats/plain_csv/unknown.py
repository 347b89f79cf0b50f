"""Help with files that are not understood: say what was seen, and draft the mapping that makes them readable."""

from pathlib import Path

from pdr_est.errors import RecordingError
from pdr_est.io.tables.header import understand_titles
from pdr_est.io.tables.headerless import guess_columns
from pdr_est.io.tables.mapping import TableMapping
from pdr_est.io.tables.mapping_file import draft_mapping
from pdr_est.io.tables.recognition import describe_content
from pdr_est.io.tables.signals import HEAD_BYTES, layout_of
from pdr_est.io.tables.titles import sensor_by_name
from pdr_est.io.text.container import Source
from pdr_est.io.text.encoding import as_utf8
from pdr_est.io.text.loose_table import read_loose_table
from pdr_est.io.text.members import member_stem
from pdr_est.io.text.single_archive import open_recording
from pdr_est.io.text.table_layout import TableLayout, split_line
from pdr_est.io.text.workbook import unpack_workbook
from pdr_est.output.atomic_output import staged_file

_MEMBERS_NAMED = 3
_BINARY_SHARE = 0.1
_TEXT_BYTES = bytes({*range(32, 256), 9, 10, 13})


def describe_unknown(source: Source) -> str:
    """Say in one line what a source holds that no format is known for."""
    with_rows = [member for member in source.members if layout_of(source.head(member, HEAD_BYTES)) is not None]
    if len(source.members) == 1 and source.head(source.members[0], 1) in (b"{", b"["):
        return "it is JSON; only that of Sensor Logger is known"
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


def write_map_draft(recording: Path, target: Path) -> None:
    """Write a mapping file with what is understood of the columns of a recording, to be completed by hand.

    Parameters
    ----------
    recording
        A table; of a folder or archive the first member that is one is taken.
    target
        The file to write.

    Raises
    ------
    RecordingError
        When the recording holds no table.
    OutputError
        When the file exists or cannot be written.
    """
    source = unpack_workbook(open_recording(recording))
    for member in source.members:
        head = as_utf8(source.head(member, HEAD_BYTES))
        layout = layout_of(head)
        if layout is not None:
            mapping = _understood(head, layout, member_stem(member))
            text = draft_mapping(mapping, layout.titles, layout.sample)
            break
    else:
        raise RecordingError(f"{recording}: no rows of numbers in columns, so there is nothing to map")
    with staged_file(target, overwrite=False, inputs=[recording]) as staging:
        staging.write_text(text, encoding="utf-8")


def _understood(head: bytes, layout: TableLayout, stem: str) -> TableMapping:
    hint = sensor_by_name(stem)
    if layout.has_header:
        return understand_titles(layout.titles, hint, layout.units)
    try:
        return guess_columns(read_loose_table(head[: head.rfind(b"\n") + 1], "", layout, (), layout.titles), hint)
    except RecordingError:
        return TableMapping()


def _has_titles_only(head: bytes) -> bool:
    """Tell whether the first line names the columns of a table with motion."""
    first = as_utf8(head).decode("utf-8", "replace").strip().split("\n", 1)[0]
    return any(understand_titles(split_line(first, separator)).has_motion for separator in (",", ";", "\t"))


def _is_binary(head: bytes) -> bool:
    text = as_utf8(head)
    return len(text.translate(None, _TEXT_BYTES)) > _BINARY_SHARE * max(1, len(text))

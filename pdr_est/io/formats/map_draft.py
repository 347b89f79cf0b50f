"""Write the draft of a mapping for a recording (`inspect --write-map`): what is understood of it, to be completed."""

from collections.abc import Sequence
from pathlib import Path

from pdr_est.errors import RecordingError, SeveralWalksError
from pdr_est.io.formats.named_tables import NamedTableFormat
from pdr_est.io.formats.plain_csv import reader as plain_csv
from pdr_est.io.formats.registry import format_of
from pdr_est.io.formats.sensor_files import reader as sensor_files
from pdr_est.io.tables.header import understand_titles
from pdr_est.io.tables.headerless import guess_columns
from pdr_est.io.tables.mapping import QuantityColumns, TableMapping
from pdr_est.io.tables.mapping_draft import draft_mapping, mapping_of_tables
from pdr_est.io.tables.quantities import AXES, Quantity
from pdr_est.io.tables.signals import HEAD_BYTES, TableSignals, layout_of
from pdr_est.io.tables.split.reader import DeviceTables, read_tables
from pdr_est.io.tables.split.respelt import respelt
from pdr_est.io.tables.split.sections import table_sections
from pdr_est.io.tables.split.tagged_log import tagged_separator
from pdr_est.io.tables.titles import sensor_by_name
from pdr_est.io.text.container import Source
from pdr_est.io.text.encoding import as_utf8
from pdr_est.io.text.loose_table import read_loose_table
from pdr_est.io.text.members import member_stem, require_single_walk
from pdr_est.io.text.single_archive import open_recording
from pdr_est.io.text.table_layout import TableLayout
from pdr_est.io.text.unpacked.workbook import unpack_workbook
from pdr_est.output.atomic_output import staged_file

_TITLE = "# Meaning of the columns, for --map; docs/recorder-formats.md describes the file.\n"


def write_map_draft(recording: Path, target: Path) -> None:
    """Write a mapping file with what is understood of the columns of a recording, to be completed by hand.

    With the draft of a recording that is understood, the same samples are read as without it.

    Parameters
    ----------
    recording
        A table, or a folder or archive of tables.
    target
        The file to write.

    Raises
    ------
    RecordingError
        When the recording holds no table or none that a mapping can describe.
    OutputError
        When the file exists or cannot be written.
    """
    text = _TITLE + _draft(unpack_workbook(open_recording(recording)))
    with staged_file(target, overwrite=False, inputs=[recording]) as staging:
        staging.write_text(text, encoding="utf-8")


def _draft(source: Source) -> str:
    known, source = format_of(source)
    if known is None:
        return _draft_of_unknown(source)
    if known is sensor_files:
        return _draft_of_sensor_files(source)
    member, hint, stated, sign = "", None, None, None
    if known is plain_csv:
        member = require_single_walk(source, plain_csv.tables_with_motion(source), known.NAME)
        hint = sensor_by_name(member_stem(member))
    elif isinstance(known, NamedTableFormat):
        member, stated, device = known.meaning_of(source)
        sign = device.sign
    else:
        raise RecordingError(
            f"{source.path}: it is read as {known.NAME}, which needs no mapping; a mapping is for tables whose "
            "columns are not understood"
        )
    _refuse_kinds(source, member)
    return _draft_of_file(source, member, mapping_of_tables(_tables(source, member, hint, stated), sign))


def _draft_of_sensor_files(source: Source) -> str:
    files = sensor_files.files_of_walk(source)
    found = [_tables(source, file.member, file.quantity, None) for file in files]
    mappings = mapping_of_tables([table for tables in found for table in tables], sensor_files.sign_of(source, files))
    drafts, first = {}, 0
    for file, tables in zip(files, found, strict=True):
        drafts[file.member] = _draft_of_file(source, file.member, mappings[first : first + len(tables)])
        first += len(tables)
    return _of_files(drafts)


def _refuse_kinds(source: Source, member: str) -> None:
    """Refuse files with several tables of their own titles each, which a mapping cannot describe."""
    text = respelt(as_utf8(source.read(member)))
    if table_sections(text):
        raise RecordingError(
            f"{source.place(member)}: it has tables one below the other, which a mapping cannot describe; save each "
            "as a file of its own in one folder"
        )
    layout = layout_of(text)
    if (layout is None or not layout.has_header) and tagged_separator(text[:HEAD_BYTES]) is not None:
        raise RecordingError(
            f"{source.place(member)}: its rows are of several kinds with columns of their own, which a mapping "
            "cannot describe; save each kind as a file of its own in one folder"
        )


def _tables(
    source: Source, member: str, hint: Quantity | None, mapping: TableMapping | None
) -> tuple[TableSignals, ...]:
    """Read the tables of a file; those of the first device or walk where it has several."""
    data, place = source.read(member), source.place(member)
    try:
        found: Sequence[DeviceTables] = read_tables(data, place, hint=hint, mapping=mapping)
    except SeveralWalksError as error:
        found = read_tables(data, place, hint=hint, mapping=mapping, chosen=error.walks[:1])
    return found[0].tables


def _draft_of_file(source: Source, member: str, mappings: Sequence[TableMapping]) -> str:
    layout = layout_of(respelt(as_utf8(source.head(member, HEAD_BYTES))))
    titles, sample = ((), ()) if layout is None else (layout.titles, layout.sample)
    mapping = mappings[0] if len(mappings) == 1 else TableMapping(parts=tuple(mappings))
    return draft_mapping(mapping, titles, sample)


def _of_files(drafts: dict[str, str]) -> str:
    lines = ["files:"]
    for member, text in drafts.items():
        lines.append(f"  {member!r}:" if member != member.strip() or ":" in member else f"  {member}:")
        lines += [f"    {line}" for line in text.splitlines()]
    return "\n".join(lines) + "\n"


def _draft_of_unknown(source: Source) -> str:
    """Draft a mapping from titles and first rows alone."""
    found: dict[str, tuple[TableLayout, TableMapping]] = {}
    for member in source.members:
        head = respelt(as_utf8(source.head(member, HEAD_BYTES)))
        layout = layout_of(head)
        if layout is not None:
            found[member] = layout, _guess(head, layout, member_stem(member))
    if not found:
        raise RecordingError(f"{source.path}: no rows of numbers in columns, so there is nothing to map")
    drafts = {
        member: draft_mapping(mapping, layout.titles, layout.sample) for member, (layout, mapping) in found.items()
    }
    named = {member: text for member, text in drafts.items() if sensor_by_name(member_stem(member)) is not None}
    return _of_files(named) if len(named) > 1 else next(iter(drafts.values()))


def _guess(head: bytes, layout: TableLayout, stem: str) -> TableMapping:
    hint = sensor_by_name(stem)
    if layout.has_header:
        return understand_titles(layout.titles, hint, layout.units)
    try:
        return guess_columns(read_loose_table(head[: head.rfind(b"\n") + 1], "", layout, (), layout.titles), hint)
    except RecordingError:
        axes = () if hint is None else layout.titles[: len(AXES[hint])]
        if hint is None or len(axes) < len(AXES[hint]):
            return TableMapping()
        return TableMapping(columns={hint: QuantityColumns(axes, (None,) * len(axes))})

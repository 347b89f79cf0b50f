"""A file whose tables are members of a source, so that every format can be in it."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from pdr_est.io.text.container import Source, SourceKind


@dataclass(frozen=True)
class TablesSource(Source):
    """File whose tables are members, as comma-separated text.

    Attributes
    ----------
    tables
        Member -> content.
    part
        What the file calls a table, for messages.
    """

    tables: Mapping[str, bytes] = field(default_factory=dict)
    part: str = "table"

    def place(self, member: str) -> str:
        """Describe where a table lies, for messages."""
        name = self.stored[member]
        return f"{self.path}, {self.part} {name}" if name else str(self.path)

    def folder_name(self, member: str) -> str:
        """Return the name of the folder that the file lies in."""
        return self.path.absolute().parent.name

    def read(self, member: str) -> bytes:
        """Return the content of a table."""
        return self.tables[member]

    def head(self, member: str, n_bytes: int = 4096) -> bytes:
        """Return the first bytes of a table."""
        return self.tables[member][:n_bytes]

    def sibling(self, member: str, relative: str) -> Source | None:
        """Return None: a table has no files beside it."""
        return None


def source_of_tables(source: Source, tables: Mapping[str, bytes], part: str) -> TablesSource:
    """Return a source with a member for each table.

    Parameters
    ----------
    source
        The file.
    tables
        Name of a table, "" for the only one of the file -> its comma-separated text.
    part
        What the file calls a table.
    """
    stored = {f"{name}.csv" if name else source.name: name for name in tables}
    kind = SourceKind.FILE if list(tables) == [""] else SourceKind.FOLDER
    contents = dict(zip(stored, tables.values(), strict=True))
    return TablesSource(source.path, kind, stored, source.limit_bytes, tables=contents, part=part)

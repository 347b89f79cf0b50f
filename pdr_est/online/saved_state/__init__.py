"""Saved states: objects as plain data, in a file format with a version and a checksum.

`table_writer` writes any object of this package as a table of numbers, texts and arrays (`table_format`),
`table_reader` makes it again without executing anything that the data name. `envelope` puts such a table into bytes,
and refuses bytes that are damaged, or that another version has written.
"""

from pdr_est.online.saved_state.envelope import pack, unpack

__all__ = ["pack", "unpack"]

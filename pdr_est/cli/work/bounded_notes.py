"""Bounds for what others send: lines that fit into the memory, and warnings that do not repeat for ever."""

import re
from collections import Counter
from collections.abc import Iterator
from typing import TextIO

import click

_FIRST = 3  # warnings of a kind that are all told (ours)
_MOST_KINDS = 1000
_LONGEST = 500  # characters


class BoundedNotes:
    """Warnings on stderr: the first few of each kind, and then every tenfold number.

    Warnings that differ in their numbers only are of one kind.
    """

    def __init__(self) -> None:
        self._told: Counter[str] = Counter()

    def tell(self, note: str) -> None:
        """Print a warning, or only count it."""
        note = note if len(note) <= _LONGEST else f"{note[:_LONGEST]}…"
        kind = re.sub(r"\d+", "#", note)
        if kind not in self._told and len(self._told) >= _MOST_KINDS:
            kind = ""  # all others together
        self._told[kind] += 1
        count = self._told[kind]
        if count <= _FIRST:
            click.echo(f"warning: {note}", err=True)
        elif re.fullmatch("10+", str(count)):
            click.echo(f"warning: {note} ({count} warnings of this kind)", err=True)


def bounded_lines(stream: TextIO, longest: int) -> Iterator[str]:
    """Yield the lines of a stream; of one that is longer, the first characters, one more than the longest has.

    Parameters
    ----------
    stream
        Text that others write.
    longest
        Number of characters.
    """
    while line := stream.readline(longest + 1):
        yield line
        while not line.endswith("\n") and (line := stream.readline(longest + 1)):
            pass  # the rest of a line that is too long

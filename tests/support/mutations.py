"""Random damage to files: a few small changes, each of which stays readable when a failure is reported."""

import json
import zlib
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from hypothesis import strategies as st

WORDS = (
    "",
    "0",
    "-1",
    "nan",
    "inf",
    "-inf",
    "1e308",
    "-1e308",
    "1e-320",
    "1e18",
    "1e30",
    "99999999999999999999",
    "-9999",
    "0x10",
    "1,5",
    "1.2.3",
    "None",
    "null",
    "true",
    "[]",
    "{}",
    '"',
    "'",
    ";",
    ",,,,",
    "\t",
    "\n",
    "\r\n",
    "\0",
    "ä",
    "時間",
    "\ufeff",
    "#",
    "=HYPERLINK(1)",
    "<script>",
    "2031-02-03 04:05:06",
    "1969-12-31",
    "x" * 300,
)
"""Texts that have broken readers of tables."""

KINDS = ("flip", "cut", "repeat", "truncate", "cell", "line away", "line again", "lines swapped", "column away")


@dataclass(frozen=True)
class Mutation:
    """One change of a file: place and other count the bytes, lines or cells in 65536ths, word is a text put there."""

    kind: str
    place: int
    other: int
    word: str

    def apply(self, data: bytes) -> bytes:
        """Return the changed content of a file."""
        if not data:
            return self.word.encode()
        if self.kind in ("flip", "cut", "repeat", "truncate"):
            return self._bytes(data)
        lines = data.split(b"\n")
        line = self.place * len(lines) // 65536
        if self.kind == "line away":
            return b"\n".join(lines[:line] + lines[line + 1 :])
        if self.kind == "line again":
            return b"\n".join([*lines[:line], lines[line], *lines[line:]])
        if self.kind == "lines swapped":
            other = self.other * len(lines) // 65536
            lines[line], lines[other] = lines[other], lines[line]
            return b"\n".join(lines)
        if self.kind == "column away":
            return b"\n".join(self._cells(one, None) for one in lines)
        lines[line] = self._cells(lines[line], self.word.encode(errors="surrogatepass"))
        return b"\n".join(lines)

    def _bytes(self, data: bytes) -> bytes:
        at, length = self.place * len(data) // 65536, 1 + self.other % 200
        if self.kind == "truncate":
            return data[:at]
        if self.kind == "cut":
            return data[:at] + data[at + length :]
        if self.kind == "repeat":
            return data[: at + length] + data[at:]
        return data[:at] + bytes([self.other % 256]) + data[at + 1 :]

    def _cells(self, line: bytes, word: bytes | None) -> bytes:
        cells = line.split(b",")
        cell = self.other * len(cells) // 65536
        return b",".join(cells[:cell] + ([] if word is None else [word]) + cells[cell + 1 :])


def mutations() -> st.SearchStrategy[Mutation]:
    """Make the strategy of single changes."""
    fraction = st.integers(0, 65535)
    return st.builds(Mutation, st.sampled_from(KINDS), fraction, fraction, st.sampled_from(WORDS))


def mutated(data: bytes, changes: Sequence[Mutation]) -> bytes:
    """Return the content of a file after changes, one after the other."""
    for change in changes:
        data = change.apply(data)
    return data


@dataclass(frozen=True)
class Attack:
    """One input of the fuzz test: what it attacks, the sound input that it begins with, and the changes of it."""

    target: str
    base: str
    changes: tuple[Mutation, ...] = ()
    values: tuple[tuple[str, Any], ...] = ()

    def save(self, folder: Path) -> Path:
        """Write the attack to the corpus, under a name of its content."""
        words = json.dumps(asdict(self), indent=1, ensure_ascii=True)
        path = folder / f"{self.target}-{zlib.crc32(words.encode()):08x}.json"
        path.write_text(words + "\n", encoding="utf-8")
        return path


def load_attack(path: Path) -> Attack:
    """Read an attack of the corpus."""
    found = json.loads(path.read_text(encoding="utf-8"))
    changes = tuple(Mutation(**change) for change in found["changes"])
    return Attack(found["target"], found["base"], changes, tuple((key, value) for key, value in found["values"]))

"""Walks of known length whose steps were counted by hand: a table beside the recordings."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.io.text.container import Source
from pdr_est.io.text.members import member_stem
from pdr_est.io.text.number_table import read_table


@dataclass(frozen=True)
class KnownDistance:
    """What is known of a walk. distance_m: walked; step_count: by hand."""

    distance_m: float
    step_count: int


def read_known_distances(path: str | Path) -> Mapping[str, KnownDistance]:
    """The walks of a table with the columns `file,distance_m,steps`, plain or gzipped, in the order of its rows.

    The key is the name of the recording's file without extension (`A` for `A.csv`). Raises RecordingError that names
    file, line and value when the table is missing or damaged, lists a file twice, or holds a distance or count that
    is not above zero.
    """
    source = Source.open(path)
    (member,) = _only_member(source)
    place = source.place(member)
    content = source.read(member)
    _refuse_separator(content, place)
    table = read_table(content, place, columns=("file", "distance_m", "steps"), text_columns=("file",))
    distance_m, steps = table.numbers("distance_m"), table.numbers("steps")
    walks: dict[str, KnownDistance] = {}
    for row, file in enumerate(table.texts("file")):
        line = f"{place}, line {row + 2}"
        name = member_stem(str(file).strip().removesuffix(".gz"))
        if not name:
            raise RecordingError(f"{line}: no file name; give the name of the recording")
        if name in walks:
            raise RecordingError(f"{line}: {file} is listed twice; remove one of its lines")
        if not (np.isfinite(distance_m[row]) and distance_m[row] > 0.0):
            raise RecordingError(f"{line}: distance_m = {distance_m[row]:g} is not above zero; give it in metres")
        if not (steps[row] >= 1.0 and steps[row].is_integer()):
            raise RecordingError(f"{line}: steps = {steps[row]:g} is not a number of steps; count them again")
        walks[name] = KnownDistance(float(distance_m[row]), int(steps[row]))
    return walks


def _refuse_separator(content: bytes, place: str) -> None:
    header = content.partition(b"\n")[0]
    for name, separator in (("semicolons", b";"), ("tabs", b"\t")):
        if separator in header and b"," not in header:
            raise RecordingError(f"{place}: its columns are separated by {name}; save it with commas")


def _only_member(source: Source) -> tuple[str, ...]:
    if len(source.members) != 1:
        raise RecordingError(f"{source.path}: holds {len(source.members)} files; give the truth table itself")
    return source.members

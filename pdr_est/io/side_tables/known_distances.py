"""Read a table of walks of known length whose steps were counted by hand."""

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
    """Ground truth of a walk.

    Attributes
    ----------
    distance_m
        Distance walked, m.
    step_count
        Number of steps, counted by hand.
    """

    distance_m: float
    step_count: int


def read_known_distances(path: str | Path) -> Mapping[str, KnownDistance]:
    """Read the walks of a table with the columns `file,distance_m,steps`, plain or gzipped.

    Returns
    -------
    Mapping
        Name of the recording's file without extension (`A` for `A.csv`) -> ground truth, in the order of the rows.

    Raises
    ------
    RecordingError
        When the table is missing or damaged, lists a file twice, or has a distance or count that is not above zero.
        The message names file, line and value.
    """
    source = Source.open(path)
    (member,) = _only_member(source)
    place = source.place(member)
    content = source.read(member)
    _check_separator(content, place)
    table = read_table(content, place, columns=("file", "distance_m", "steps"), text_columns=("file",))
    distance_m, steps = table.numbers("distance_m"), table.numbers("steps")
    walks: dict[str, KnownDistance] = {}
    for row, file in enumerate(table.texts("file")):
        line = f"{place}, line {row + 2}"
        name = member_stem(str(file).strip().removesuffix(".gz"))
        if not name:
            raise RecordingError(f"{line}: the file name is missing; give the name of the recording")
        if name in walks:
            raise RecordingError(f"{line}: {file} is listed twice; remove one of its lines")
        if not (np.isfinite(distance_m[row]) and distance_m[row] > 0.0):
            raise RecordingError(f"{line}: distance_m = {distance_m[row]:g} is not above zero; give it in metres")
        if not (steps[row] >= 1.0 and steps[row].is_integer()):
            raise RecordingError(
                f"{line}: steps = {steps[row]:g} is not a whole number of steps above zero; count them again"
            )
        walks[name] = KnownDistance(float(distance_m[row]), int(steps[row]))
    return walks


def _check_separator(content: bytes, place: str) -> None:
    header = content.partition(b"\n")[0]
    for name, separator in (("semicolons", b";"), ("tabs", b"\t")):
        if separator in header and b"," not in header:
            raise RecordingError(f"{place}: the columns are separated by {name}; save it with commas")


def _only_member(source: Source) -> tuple[str, ...]:
    if len(source.members) != 1:
        raise RecordingError(f"{source.path}: contains {len(source.members)} files; give the truth table itself")
    return source.members

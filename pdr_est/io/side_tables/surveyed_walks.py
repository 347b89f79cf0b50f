"""Read the ground truth of a surveyed walk from the files beside its recording.

Beside `NAME.csv` (plain or gzipped) lie, both optional and plain or gzipped,

* `NAME.truth.csv` with the columns `time_s, x_m, y_m`: true positions on the clock of the recording, in a frame of
  their own;
* `NAME.json` with any of `mode_true` (name of a carrying mode), `steps_true` (number of steps), `step_ends_s` (times
  of the foot contacts, in any order), `speed_mps` (belt of a treadmill), `truth_kind` (words; with "GPS" in them the
  true positions are those of a satellite receiver) and `sigma_m` (standard deviation of the true positions per
  axis). Other keys are read by `walk_description` only.
"""

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.io.text.container import Source
from pdr_est.io.text.number_table import read_table
from pdr_est.types.ground_truth import TrueModes, TruePositions, TrueSteps, Truth, are_dense
from pdr_est.types.steps import CarryingMode

TRUTH_SUFFIX = ".truth.csv"

_COLUMNS = ("time_s", "x_m", "y_m")
_WAYPOINT_SIGMA_M = 0.7  # per axis, of points that somebody tapped while passing


def read_truth_beside(recording: Path) -> Truth:
    """Read the ground truth of a recording from the files beside it; all of it is None where there are none.

    Positions that follow each other quickly (`are_dense`) count as recorded poses, which have no error unless
    `sigma_m` says so; others as waypoints with 0.7 m per axis.

    Raises
    ------
    RecordingError
        For a file that is damaged, or a value that cannot be right; the message names file and value.
    """
    described, place = _described(recording)
    ends_s = _step_ends_s(described, place)
    mode = described.get("mode_true")
    count = _positive(described, "steps_true", place)
    if count is not None and not count.is_integer():
        raise RecordingError(f"{place}: steps_true = {count:g} is not a whole number of steps: count them again")
    return Truth(
        positions=_positions(recording, described, place),
        steps=None if ends_s is None else TrueSteps(ends_s, np.full(len(ends_s), "")),
        step_count=None if count is None else int(count),
        modes=None if mode is None else TrueModes(np.array([-np.inf]), np.array([_mode(mode, place)], dtype=np.int8)),
        speed_mps=_positive(described, "speed_mps", place),
    )


def walk_description(recording: Path) -> Mapping[str, str]:
    """Return the texts of `NAME.json` by key, such as person and carrying position; empty without a readable file."""
    try:
        described, _ = _described(recording)
    except RecordingError:
        return {}  # the damage is reported where the truth is read
    return {key: value for key, value in described.items() if isinstance(value, str)}


def _described(recording: Path) -> tuple[Mapping[str, Any], str]:
    """Return the content of `NAME.json`, empty without one, and what to call it in messages."""
    source = _beside(recording, ".json")
    if source is None:
        return {}, f"{_stem(recording)}.json"
    place = str(source.path)
    try:
        content = json.loads(source.read(source.members[0]))
    except (ValueError, RecursionError) as error:
        raise RecordingError(f"{place}: is no JSON ({error}): correct it or remove it") from error
    if not isinstance(content, dict):
        raise RecordingError(f"{place}: holds no object with keys such as steps_true: correct it or remove it")
    return content, place


def _positions(recording: Path, described: Mapping[str, Any], described_in: str) -> TruePositions | None:
    source = _beside(recording, TRUTH_SUFFIX)
    if source is None:
        return None
    place = str(source.path)
    table = read_table(source.read(source.members[0]), place, columns=_COLUMNS)
    rows = table.stack(_COLUMNS)
    unusable = np.flatnonzero(~np.isfinite(rows).all(axis=1))
    if len(unusable):
        raise RecordingError(f"{place}, line {unusable[0] + 2}: a number is missing: remove the line or complete it")
    rows = rows[np.argsort(rows[:, 0], kind="stable")]
    time_s = rows[:, 0]
    is_dense = are_dense(time_s)
    is_gps = "gps" in str(described.get("truth_kind", "")).lower()
    sigma_m = _positive(described, "sigma_m", described_in)
    if sigma_m is None:
        sigma_m = 0.0 if is_dense else _WAYPOINT_SIGMA_M
    source_name = "gps" if is_gps else "poses" if is_dense else "waypoints"
    return TruePositions(time_s, rows[:, 1:], sigma_m, source_name)


def _step_ends_s(described: Mapping[str, Any], place: str) -> Array | None:
    ends = described.get("step_ends_s")
    if ends is None:
        return None
    if not isinstance(ends, list) or not ends or not all(_is_number(end) for end in ends):
        raise RecordingError(f"{place}: step_ends_s is no list of times in seconds: correct it or remove it")
    return np.sort(np.array(ends, dtype=np.float64))


def _positive(described: Mapping[str, Any], key: str, place: str) -> float | None:
    value = described.get(key)
    if value is None:
        return None
    if not _is_number(value) or value <= 0.0:
        raise RecordingError(f"{place}: {key} = {value!r} is not a number above zero: correct it or remove it")
    return float(value)


def _mode(name: Any, place: str) -> CarryingMode:
    known = [mode.name for mode in CarryingMode if mode not in (CarryingMode.UNKNOWN, CarryingMode.TRANS)]
    if name not in known:
        raise RecordingError(f"{place}: mode_true = {name!r} is not one of {', '.join(known)}: correct it")
    return CarryingMode[name]


def _is_number(value: Any) -> bool:
    if not isinstance(value, int | float) or isinstance(value, bool):
        return False
    try:
        return math.isfinite(value)
    except OverflowError:  # an integer beyond the range of floats
        return False


def _beside(recording: Path, suffix: str) -> Source | None:
    """Open the file of that suffix beside a recording, plain or gzipped; None if there is none."""
    stem = _stem(recording)
    for path in (stem.with_name(f"{stem.name}{suffix}"), stem.with_name(f"{stem.name}{suffix}.gz")):
        if path.is_file():
            return Source.open(path)
    return None


def _stem(recording: Path) -> Path:
    return (recording.with_suffix("") if recording.suffix == ".gz" else recording).with_suffix("")

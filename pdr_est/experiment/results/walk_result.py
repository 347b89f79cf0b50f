"""Result of one walk, and its file in the folder of an experiment."""

import gzip
import hashlib
import json
import zlib
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Any

import numpy as np

from pdr_est.experiment.suite import CalibrationCase
from pdr_est.output.atomic_output import staged_file
from pdr_est.types.outcome import TrackOutcome

_DIGITS = {"position_m": 2, "on_plan_m": 2, "truth_m": 2, "way_m": 1, "error_m": 3, "squared": 4}  # as plots show
SUFFIX = ".json.gz"


@dataclass(frozen=True)
class Failure:
    """Reason why a walk, or some metrics of it, could not be scored.

    Attributes
    ----------
    walk : str
        Name of the walk.
    reason : str
        One sentence.
    whole : bool
        True if no track of the walk was scored.
    """

    walk: str
    reason: str
    whole: bool = False


@dataclass(frozen=True)
class WalkResult:
    """Everything that was scored on one walk.

    Attributes
    ----------
    walk : str
        Name of the walk.
    tracks : tuple of TrackOutcome
        One row for each variant and track.
    failures : tuple of Failure
        What could not be scored.
    seconds : Mapping
        Variant -> CPU time of its chain.
    work_s : float
        CPU time of the whole walk, including reading or simulation.
    calibration_cases : tuple
        Calibration case of each track, None where it has none; they are not written to the file.
    """

    walk: str
    tracks: tuple[TrackOutcome, ...] = ()
    failures: tuple[Failure, ...] = ()
    seconds: Mapping[str, float] = field(default_factory=dict)
    work_s: float = 0.0
    calibration_cases: tuple[CalibrationCase | None, ...] = ()

    @classmethod
    def failed(cls, walk: str, reason: str) -> "WalkResult":
        """Make the result of a walk that could not be scored at all."""
        return cls(walk, failures=(Failure(walk, reason, whole=True),))


def encode(result: WalkResult) -> bytes:
    """Encode a result as the content of its file; the plotted lines are rounded, the metrics are not."""
    document = {
        "walk": result.walk,
        "tracks": [_track_document(track) for track in result.tracks],
        "failures": [asdict(failure) for failure in result.failures],
        "seconds": dict(result.seconds),
        "work_s": result.work_s,
    }
    text = json.dumps(document, allow_nan=False).encode()
    return gzip.compress(_digest_line(text) + text, compresslevel=3, mtime=0)


def decode(content: bytes) -> WalkResult:
    """Decode the content of a result file.

    Raises
    ------
    ValueError
        If the content is anything else, damaged or changed: it begins with its own checksum.
    """
    try:
        digest, _, text = gzip.decompress(content).partition(b"\n")
        if digest + b"\n" != _digest_line(text):
            raise ValueError("its checksum is another one")
        document = json.loads(text)
        return WalkResult(
            walk=document["walk"],
            tracks=tuple(_track(row) for row in document["tracks"]),
            failures=tuple(Failure(**row) for row in document["failures"]),
            seconds=document["seconds"],
            work_s=document["work_s"],
        )
    except (OSError, EOFError, zlib.error, ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise ValueError(f"is no complete result of a walk ({error})") from error


def _digest_line(text: bytes) -> bytes:
    return hashlib.sha256(text).hexdigest().encode() + b"\n"


def result_file(folder: Path, walk: str) -> Path:
    """Return the path of a walk's result; a digest separates walks whose names are equal as file names."""
    plain = "".join(sign if sign.isascii() and (sign.isalnum() or sign in "-_.") else "-" for sign in walk)
    return folder / f"{plain[-60:]}-{hashlib.sha256(walk.encode()).hexdigest()[:10]}{SUFFIX}"


def store(folder: Path, walk: str, content: bytes) -> None:
    """Write an encoded result, completely or not at all."""
    with staged_file(result_file(folder, walk), overwrite=True) as staging:
        staging.write_bytes(content)


def stored(folder: Path, walks: Iterable[str]) -> dict[str, WalkResult]:
    """Read the results that exist, by walk; files that cannot be read count as missing."""
    found: dict[str, WalkResult] = {}
    for walk in walks:
        try:
            result = decode(result_file(folder, walk).read_bytes())
        except (OSError, ValueError):
            continue
        if result.walk == walk:
            found[walk] = result
    return found


def _track_document(track: TrackOutcome) -> dict[str, Any]:
    row = {entry.name: getattr(track, entry.name) for entry in fields(track)}
    row |= {name: dict(value) for name, value in row.items() if isinstance(value, Mapping)}
    return row | {name: np.round(row[name], digits).tolist() for name, digits in _DIGITS.items()}


def _track(row: dict[str, Any]) -> TrackOutcome:
    shapes = dict.fromkeys(("position_m", "on_plan_m", "truth_m"), (-1, 2))
    lines = {name: np.array(row[name], dtype=np.float64).reshape(shapes.get(name, (-1,))) for name in _DIGITS}
    return TrackOutcome(**{**row, **lines})

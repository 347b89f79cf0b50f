"""What one walk gave, as one small file that is there complete or not at all."""

import gzip
import hashlib
import json
import os
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Any

import numpy as np

from pdr_est.types.outcome import TrackOutcome

_DIGITS = {"position_m": 2, "truth_m": 2, "way_m": 1, "error_m": 3, "squared": 4}  # a plot shows no more
SUFFIX = ".json.gz"


@dataclass(frozen=True)
class Failure:
    """What could not be told of a walk, and why. whole: nothing of the walk could be told."""

    walk: str
    reason: str
    whole: bool = False


@dataclass(frozen=True)
class WalkResult:
    """Everything of one walk. seconds: variant -> CPU time of its chain. work_s: CPU time of the whole walk, reading
    or simulating it included."""

    walk: str
    tracks: tuple[TrackOutcome, ...] = ()
    failures: tuple[Failure, ...] = ()
    seconds: Mapping[str, float] = field(default_factory=dict)
    work_s: float = 0.0


def encode(part: WalkResult) -> bytes:
    """The content of the part's file; the plotted lines are rounded, the metrics are not."""
    document = {
        "walk": part.walk,
        "tracks": [_plain(track) for track in part.tracks],
        "failures": [asdict(failure) for failure in part.failures],
        "seconds": dict(part.seconds),
        "work_s": part.work_s,
    }
    return gzip.compress(json.dumps(document, allow_nan=False).encode(), compresslevel=3, mtime=0)


def decode(content: bytes) -> WalkResult:
    """The part in the content of its file. Raises ValueError, KeyError or TypeError for anything else."""
    try:
        document = json.loads(gzip.decompress(content))
    except (OSError, EOFError) as error:
        raise ValueError("is no complete gzip file") from error
    return WalkResult(
        walk=document["walk"],
        tracks=tuple(_track(row) for row in document["tracks"]),
        failures=tuple(Failure(**row) for row in document["failures"]),
        seconds=document["seconds"],
        work_s=document["work_s"],
    )


def part_file(folder: Path, walk: str) -> Path:
    """Where the part of a walk lies; the digest keeps apart names that are alike as file names."""
    plain = "".join(sign if sign.isascii() and (sign.isalnum() or sign in "-_.") else "-" for sign in walk)
    return folder / f"{plain[-60:]}-{hashlib.sha256(walk.encode()).hexdigest()[:10]}{SUFFIX}"


def store(folder: Path, walk: str, content: bytes) -> None:
    """Write a part so that it is whole even if the process is killed meanwhile."""
    target = part_file(folder, walk)
    half = target.with_name(f".{target.name}.{os.getpid()}.half")
    half.write_bytes(content)
    half.replace(target)


def stored(folder: Path, walks: Iterable[str]) -> dict[str, WalkResult]:
    """The parts that are there, by walk; files that cannot be read count as missing."""
    found: dict[str, WalkResult] = {}
    for walk in walks:
        try:
            part = decode(part_file(folder, walk).read_bytes())
        except (OSError, ValueError, KeyError, TypeError):
            continue
        if part.walk == walk:
            found[walk] = part
    return found


def _plain(track: TrackOutcome) -> dict[str, Any]:
    row = {entry.name: getattr(track, entry.name) for entry in fields(track)}
    row |= {name: np.round(row[name], digits).tolist() for name, digits in _DIGITS.items()}
    row |= {name: dict(row[name]) for name in ("labels", "metrics", "mode_shares")}
    return row


def _track(row: dict[str, Any]) -> TrackOutcome:
    shapes = {"position_m": (-1, 2), "truth_m": (-1, 2)}
    lines = {name: np.array(row[name], dtype=np.float64).reshape(shapes.get(name, (-1,))) for name in _DIGITS}
    return TrackOutcome(**{**row, **lines})

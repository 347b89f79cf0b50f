"""Compares the variants of finished experiments walk by walk, from their tables of results."""

import csv
import io
import json
from collections.abc import Iterable, Mapping, Sequence
from itertools import combinations
from pathlib import Path

import numpy as np

from pdr_est.errors import ConfigError, OutputError
from pdr_est.evaluate.definitions import unit_of
from pdr_est.evaluate.paired import Paired, paired
from pdr_est.experiment.output import PROVENANCE, RESULTS
from pdr_est.io.parquet import read_parquet
from pdr_est.validation import nearest

Values = Mapping[str, Mapping[str, Mapping[str, float]]]
"""metric -> variant -> walk -> value, the mean over the tracks of the walk."""

HEADINGS = (
    "metric",
    "unit",
    "A",
    "B",
    "walks",
    "mean A",
    "mean B",
    "B - A",
    "low",
    "high",
    "A wins",
    "B wins",
    "ties",
)

TEXTS = 4  # of these columns, from the left, are words; the others are numbers


def read_values(folders: Sequence[Path], track: str | None = None) -> Values:
    """The results in the folders of experiments. With several folders a variant is called `FOLDER:VARIANT`.

    track: only that of this device, or of the person (`fused`), of walks with several phones; else a walk has the
    mean over its tracks. Raises OutputError for a folder without results, and for folders in which walks or data of
    one name differ: they cannot be compared walk by walk; ConfigError for a track that no folder has.
    """
    names = _names(folders)
    _refuse_other_walks(folders)
    collected: dict[str, dict[str, dict[str, list[float]]]] = {}
    tracks: dict[str, None] = {}
    for folder, prefix in zip(folders, names, strict=True):
        if not (folder / RESULTS).is_file():
            raise OutputError(f"{folder}: holds no {RESULTS}: run `pdr-est experiment CONFIG -o {folder}` to its end")
        table = read_parquet(folder / RESULTS)
        columns = (table[name] for name in ("metric", "variant", "walk", "track", "value"))
        for metric, variant, walk, of, value in zip(*columns, strict=True):
            tracks[str(of)] = None
            if track not in (None, of):
                continue
            name = f"{prefix}{variant}"
            walks = collected.setdefault(str(metric), {}).setdefault(name, {})
            if value is not None:
                walks.setdefault(str(walk), []).append(float(value))
    if track is not None and track not in tracks:
        raise ConfigError(f"unknown track {track!r}: {nearest(track, list(tracks))}")
    return {
        metric: {
            variant: {walk: float(np.mean(values)) for walk, values in walks.items()}
            for variant, walks in variants.items()
        }
        for metric, variants in collected.items()
    }


def _names(folders: Sequence[Path]) -> list[str]:
    """What to put before the names of each folder's variants."""
    if len(folders) == 1:
        return [""]
    short = [folder.name for folder in folders]
    words = short if len(set(short)) == len(short) else [str(folder) for folder in folders]
    return [f"{word}:" for word in words]


def _refuse_other_walks(folders: Sequence[Path]) -> None:
    seen: dict[str, tuple[str, Path]] = {}
    for folder in folders:
        try:
            document = json.loads((folder / PROVENANCE).read_text(encoding="utf-8"))
            sums = {**document["data"], **document["scenarios"]}
        except (OSError, ValueError, KeyError, TypeError):
            continue  # results that came without their provenance: nothing to check by
        for name, checksum in sums.items():
            known, where = seen.setdefault(name, (checksum, folder))
            if known != checksum:
                raise OutputError(f"{where} and {folder}: {name} is not the same in both: compare runs on equal data")


def compare_variants(values: Values, reference: str | None = None, metrics: Sequence[str] = ()) -> tuple[Paired, ...]:
    """Each pair of variants on each metric, or each variant with a reference only.

    metrics: only these, all if none is named. Raises ConfigError for an unknown metric or reference.
    """
    for metric in metrics:
        if metric not in values:
            raise ConfigError(f"unknown metric {metric!r}: {nearest(metric, list(values))}")
    found = []
    for metric in metrics or values:
        variants = list(values[metric])
        if reference is not None and reference not in variants:
            raise ConfigError(f"unknown variant {reference!r}: {nearest(reference, variants)}")
        pairs: Iterable[tuple[str, str]] = combinations(variants, 2)
        if reference is not None:
            pairs = ((reference, other) for other in variants if other != reference)
        for first, second in pairs:
            pair = paired(metric, first, second, values[metric][first], values[metric][second])
            found += [] if pair is None else [pair]
    return tuple(found)


def as_rows(pairs: Iterable[Paired]) -> list[tuple[str, ...]]:
    """The comparisons as texts under `HEADINGS`."""
    return [
        (
            pair.metric,
            unit_of(pair.metric),
            pair.first,
            pair.second,
            str(pair.n),
            *(_number(value) for value in (pair.mean_first, pair.mean_second, pair.difference, pair.low, pair.high)),
            str(pair.first_wins),
            str(pair.second_wins),
            str(pair.ties),
        )
        for pair in pairs
    ]


def as_csv(pairs: Iterable[Paired]) -> str:
    """The comparisons as a CSV table."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerows([HEADINGS, *as_rows(pairs)])
    return text.getvalue()


def as_markdown(pairs: Iterable[Paired]) -> str:
    """The comparisons as a Markdown table, with what its columns mean."""
    rows = [HEADINGS, tuple("---" if i < TEXTS else "---:" for i in range(len(HEADINGS))), *as_rows(pairs)]
    lines = ["| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in rows]
    return "\n".join(lines) + f"\n\n{NOTE}\n"


NOTE = (
    "B - A: mean over walks of how much farther B is from the metric's ideal value than A; negative: B is better. "
    "low, high: its 95 % bootstrap interval over walks, too narrow for fewer than about 20."
)


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.4f}"

"""Compares the variants of finished experiments walk by walk, from their tables of results."""

import csv
import io
import json
from collections.abc import Iterable, Mapping, Sequence
from itertools import combinations
from pathlib import Path

import numpy as np

from pdr_est.errors import ConfigError, OutputError
from pdr_est.evaluate.paired import Paired, paired
from pdr_est.experiment.output import PROVENANCE, RESULTS
from pdr_est.io.parquet import read_parquet
from pdr_est.validation import nearest

Values = Mapping[str, Mapping[str, Mapping[str, float]]]
"""metric -> variant -> walk -> value, the mean over the tracks of the walk."""

HEADINGS = ("metric", "A", "B", "walks", "mean A", "mean B", "B - A", "low", "high", "A wins", "B wins", "ties")


def read_values(folders: Sequence[Path]) -> Values:
    """The results in the folders of experiments. With several folders a variant is called `FOLDER:VARIANT`.

    Raises OutputError for a folder without results, and for folders in which walks or data of one name differ: they
    cannot be compared walk by walk.
    """
    names = _names(folders)
    _refuse_other_walks(folders)
    collected: dict[str, dict[str, dict[str, list[float]]]] = {}
    for folder, prefix in zip(folders, names, strict=True):
        if not (folder / RESULTS).is_file():
            raise OutputError(f"{folder}: holds no {RESULTS}: run `pdr-est experiment CONFIG -o {folder}` to its end")
        table = read_parquet(folder / RESULTS)
        columns = (table[name] for name in ("metric", "variant", "walk", "value"))
        for metric, variant, walk, value in zip(*columns, strict=True):
            name = f"{prefix}{variant}"
            walks = collected.setdefault(str(metric), {}).setdefault(name, {})
            if value is not None:
                walks.setdefault(str(walk), []).append(float(value))
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
    rows = [HEADINGS, tuple("---" if i < 3 else "---:" for i in range(len(HEADINGS))), *as_rows(pairs)]
    lines = ["| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in rows]
    return "\n".join(lines) + f"\n\n{NOTE}\n"


NOTE = (
    "B - A: mean over walks of how much farther B is from the metric's ideal value than A; negative: B is better. "
    "low, high: its 95 % bootstrap interval over walks."
)


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.4f}"

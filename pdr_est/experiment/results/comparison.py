"""Comparison of the variants of finished experiments walk by walk, from their tables of results."""

import csv
import html
import io
import json
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from itertools import combinations
from pathlib import Path
from typing import Any

from pdr_est.errors import ConfigError, OutputError
from pdr_est.evaluate.metric_definitions import ALIGNED_NOTE, marked, unit_of
from pdr_est.evaluate.paired_comparison import PairedComparison, PairedValues, compare_pairs
from pdr_est.experiment.results.result_folder import CONFIG, PROVENANCE, RESULTS
from pdr_est.experiment.scoring.positions import HELDOUT_METRICS
from pdr_est.experiment.variants.alignment import aligned_in_file
from pdr_est.io.writers.parquet import read_parquet
from pdr_est.output.csv_cells import harmless_cell
from pdr_est.params.validation_messages import nearest
from pdr_est.params.yaml_lines import load_yaml

Values = Mapping[str, Mapping[str, Mapping[str, float]]]
"""Metric -> variant -> walk -> mean value over the tracks of the walk."""

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

TEXTS = 4  # number of columns, from the left, that contain words; the others contain numbers


def read_values(folders: Sequence[Path], track: str | None = None, metrics: Sequence[str] = ()) -> Values:
    """Read the results of experiments; with several folders a variant is called `FOLDER:VARIANT`.

    Parameters
    ----------
    folders : sequence of Path
        Folders of results.
    track : str, optional
        Device, or "fused" for the person, whose tracks are read; by default a walk has the mean over its tracks.
    metrics : sequence of str
        Metrics to read; all if none is named.

    Raises
    ------
    OutputError
        For a folder without results, and for folders that cannot be compared walk by walk, because walks or data of
        one name differ, or the fixes of a metric.
    ConfigError
        For a track or a metric that no folder has, and for a folder that is given twice.
    """
    prefixes = _prefixes(folders)
    _refuse_other_walks(folders)
    collected: dict[str, dict[str, dict[str, list[float]]]] = {}
    tracks: dict[str, None] = {}
    known: set[str] = set()
    for folder, prefix in zip(folders, prefixes, strict=True):
        for metric, variant, walk, name, value in _rows(folder):
            tracks[str(name)] = None
            known.add(str(metric))
            if track not in (None, name) or (metrics and metric not in metrics):
                continue
            walks = collected.setdefault(str(metric), {}).setdefault(f"{prefix}{variant}", {})
            if value is not None:
                walks.setdefault(str(walk), []).append(float(value))
    if track is not None and track not in tracks:
        raise ConfigError(f"unknown track {track!r}: {nearest(track, list(tracks))}")
    _refuse_other_fixes(folders, [metric for metric in HELDOUT_METRICS if metric in collected])
    for metric in metrics:
        if metric not in collected:
            raise ConfigError(f"unknown metric {metric!r}: {nearest(metric, sorted(known))}")
    return {
        metric: {
            variant: {walk: sum(values) / len(values) for walk, values in walks.items()}
            for variant, walks in collected[metric].items()
        }
        for metric in metrics or collected
    }


def _rows(folder: Path) -> Iterator[tuple[str | float | None, ...]]:
    """Return metric, variant, walk, track and value of each row of the results in a folder."""
    if not (folder / RESULTS).is_file():
        raise OutputError(f"{folder}: holds no {RESULTS}: run `pdr-est experiment CONFIG -o {folder}` to its end")
    table = read_parquet(folder / RESULTS)
    names = ("metric", "variant", "walk", "track", "value")
    missing = [name for name in names if name not in table]
    if missing:
        raise OutputError(f"{folder / RESULTS}: has no column {missing[0]!r}: it is none of `pdr-est experiment`")
    return zip(*(table[name] for name in names), strict=True)


def _refuse_other_fixes(folders: Sequence[Path], metrics: Sequence[str]) -> None:
    """Raise OutputError if the folders used different fixes, which metrics at held-out positions depend on."""
    given: dict[str, Path] = {}
    for folder in folders if metrics else ():
        if (folder / CONFIG).is_file():
            document = load_yaml(folder / CONFIG)
            fixes = document.get("fixes") if isinstance(document, dict) else None
            given.setdefault(json.dumps(fixes, sort_keys=True), folder)
    if len(given) > 1:
        first, second, *_ = given.values()
        raise OutputError(
            f"{first} and {second}: {', '.join(metrics)} are of different fixes: compare runs with equal `fixes`, or "
            "other metrics (--metric)"
        )


def _prefixes(folders: Sequence[Path]) -> list[str]:
    """Return what stands before the names of the variants of each folder."""
    if len(folders) == 1:
        return [""]
    resolved = [folder.resolve() for folder in folders]
    for number, folder in enumerate(folders):
        if resolved[number] in resolved[:number]:
            raise ConfigError(f"{folder}: is given twice: give it once")
    short = [folder.name for folder in folders]
    words = short if len(set(short)) == len(short) else [str(folder) for folder in folders]
    return [f"{word}:" for word in words]


def _refuse_other_walks(folders: Sequence[Path]) -> None:
    """Raise OutputError if a recording or a scenario of one name differs between the folders."""
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


def compare_variants(values: Values, reference: str | None = None) -> tuple[PairedComparison, ...]:
    """Compare each pair of variants on each metric, or each variant with a reference only.

    Raises
    ------
    ConfigError
        For an unknown reference, and if there is only one variant.
    """
    if all(len(of_metric) < 2 for of_metric in values.values()):
        raise ConfigError("there is one variant only: give several, or the folders of several experiments")
    found: list[PairedValues] = []
    for metric in values:
        variants = list(values[metric])
        if reference is not None and reference not in variants:
            raise ConfigError(f"unknown variant {reference!r}: {nearest(reference, variants)}")
        pairs: Iterable[tuple[str, str]] = combinations(variants, 2)
        if reference is not None:
            pairs = ((reference, other) for other in variants if other != reference)
        found += [
            PairedValues(metric, first, second, values[metric][first], values[metric][second])
            for first, second in pairs
        ]
    return compare_pairs(found)


def read_aligned(folders: Sequence[Path]) -> frozenset[str]:
    """Read which variants know the fixes only by an alignment, with the names of `read_values`."""
    return frozenset(
        f"{prefix}{variant}"
        for folder, prefix in zip(folders, _prefixes(folders), strict=True)
        for variant in aligned_in_file(_variants_of(folder))
    )


def _variants_of(folder: Path) -> Mapping[str, Any]:
    """Return the variants in the resolved experiment file of a folder; none if there is no such file."""
    document = load_yaml(folder / CONFIG) if (folder / CONFIG).is_file() else None
    variants = document.get("variants") if isinstance(document, dict) else None
    return variants if isinstance(variants, dict) else {}


def has_aligned(pairs: Iterable[PairedComparison], aligned: Collection[str]) -> bool:
    """Tell whether `ALIGNED_NOTE` applies to any of the pairs."""
    return any(marked(name, pair.metric, aligned) != name for pair in pairs for name in (pair.first, pair.second))


def as_rows(pairs: Iterable[PairedComparison], aligned: Collection[str] = ()) -> list[tuple[str, ...]]:
    """Format the comparisons as texts under `HEADINGS`; the names of aligned variants are marked."""
    return [
        (
            pair.metric,
            unit_of(pair.metric),
            marked(pair.first, pair.metric, aligned),
            marked(pair.second, pair.metric, aligned),
            str(pair.n),
            *(_number(value) for value in (pair.mean_first, pair.mean_second, pair.difference, pair.low, pair.high)),
            str(pair.first_wins),
            str(pair.second_wins),
            str(pair.ties),
        )
        for pair in pairs
    ]


def as_csv(pairs: Iterable[PairedComparison]) -> str:
    """Format the comparisons as a CSV table."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(HEADINGS)
    # Numbers may begin with a minus, as formulas do.
    writer.writerows([*map(harmless_cell, row[:TEXTS]), *row[TEXTS:]] for row in as_rows(pairs))
    return text.getvalue()


def as_markdown(pairs: Sequence[PairedComparison], aligned: Collection[str] = ()) -> str:
    """Format the comparisons as a Markdown table, with an explanation of its columns and of marked variants."""
    rule = tuple("---" if i < TEXTS else "---:" for i in range(len(HEADINGS)))
    rows = [HEADINGS, rule, *as_rows(pairs, aligned)]
    lines = ["| " + " | ".join(map(_markdown_cell, row)) + " |" for row in rows]
    footnote = f"\n\\{ALIGNED_NOTE}\n" if has_aligned(pairs, aligned) else ""
    return "\n".join(lines) + f"\n\n{NOTE}\n{footnote}"


def _markdown_cell(text: str) -> str:
    """Escape what would end a cell or be taken for HTML or a link."""
    escaped = html.escape(text, quote=False).replace("\n", " ")
    return re.sub(r"([|\[\]`])", r"\\\1", escaped)


NOTE = (
    "B - A: mean over walks of how much farther B is from the metric's ideal value than A; negative: B is better. "
    "low, high: its 95 % bootstrap interval over walks, too narrow for fewer than about 20."
)


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.4f}"

"""Work of `pdr-est evaluate`: read two trajectories, score one against the other, print and write the result."""

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import click

from pdr_est.cli.call_paths import input_paths
from pdr_est.errors import ConfigError, RecordingError
from pdr_est.evaluate.metric_definitions import unit_of
from pdr_est.evaluate.trajectories.common_clock import require_one_clock
from pdr_est.evaluate.trajectories.common_frame import in_one_frame
from pdr_est.evaluate.trajectories.foreign_track import track_of_trajectory, true_positions_of
from pdr_est.evaluate.trajectories.person import person_in
from pdr_est.evaluate.trajectories.scores import Alignment, score_trajectory
from pdr_est.io.trajectories import Trajectory, read_trajectory
from pdr_est.io.writers.checksums import file_digests
from pdr_est.output.atomic_output import staged_folder, write_text
from pdr_est.report.evaluation.document import Evaluation, evaluation_document, metric_rows, missing_rows
from pdr_est.types.recording import GeoOrigin

REPORT, DOCUMENT = "report.html", "evaluation.json"


def evaluate_track(
    track: Path,
    truth: Path,
    output: Path | None,
    align: str | None,
    time_offset_s: float | None,
    standing_s: float,
    origin: tuple[float, float] | None,
    truth_sigma_m: float | None,
    overwrite: bool,
    quiet: bool,
) -> None:
    """Score a trajectory against the truth."""
    _refuse_not_finite(time_offset_s, standing_s, truth_sigma_m)
    place = None if origin is None else _origin_of(*origin)
    evaluation = _scored(
        read_trajectory(track),
        person_in(read_trajectory(truth)),
        align,
        time_offset_s,
        standing_s,
        place,
        truth_sigma_m,
    )
    evaluation = replace(evaluation, inputs=_digests_of(track, truth))
    document = evaluation_document(evaluation)
    if output is not None:
        with staged_folder(output, overwrite, input_paths()) as folder:
            from pdr_est.report.evaluation.page import render_evaluation  # matplotlib is slow to load

            write_text(folder / DOCUMENT, json.dumps(document, indent=2, ensure_ascii=False) + "\n")
            write_text(folder / REPORT, render_evaluation(evaluation, document))
    for remark in document["remarks"]:
        click.echo(f"warning: {remark}", err=True)
    if not quiet:
        _print(document)
        if output is not None:
            click.echo(f"-> {output / REPORT}")


def _scored(
    track: Trajectory,
    truth: Trajectory,
    align: str | None,
    time_offset_s: float | None,
    standing_s: float,
    origin: GeoOrigin | None,
    truth_sigma_m: float | None,
) -> Evaluation:
    """Bring both to one clock and one frame, and score each device of the track."""
    require_one_clock(track, truth, time_offset_s, standing_s)
    alignment, reason = _alignment(align, track.in_degrees and truth.in_degrees)
    track_m, truth_m, origin = in_one_frame(track, truth, origin)
    true = true_positions_of(truth_m, truth_m.time_s, truth_sigma_m)
    offset_s = time_offset_s or 0.0
    placed = track_of_trajectory(track_m, track_m.time_s + offset_s)
    scores = [
        score_trajectory(placed.of_device(name), true, alignment, standing_s, f"{track.place} ({name})")
        for name in placed.devices
    ]
    return Evaluation(
        track_file=track,
        truth_file=truth,
        track=placed,
        truth=true,
        scores=scores,
        alignment=alignment,
        alignment_reason=reason,
        time_offset_s=offset_s,
        standing_s=standing_s,
        origin=origin,
        inputs={},
    )


def _alignment(chosen: str | None, on_earth: bool) -> tuple[Alignment, str]:
    if chosen is not None:
        return Alignment(chosen), "as asked for"
    if on_earth:
        return Alignment.NONE, "both files have latitude and longitude"
    return Alignment.RIGID, "no file says that both are in one frame; --align none if they are"


def _origin_of(latitude_deg: float, longitude_deg: float) -> GeoOrigin:
    if not (abs(latitude_deg) <= 90.0 and abs(longitude_deg) <= 360.0):
        raise ConfigError(
            f"--origin {latitude_deg:g} {longitude_deg:g}: is no latitude and longitude in degrees: give both, "
            "latitude first"
        )
    return GeoOrigin(latitude_deg, longitude_deg)


def _refuse_not_finite(*numbers: float | None) -> None:
    for number in numbers:
        if number is not None and not math.isfinite(number):
            raise ConfigError(
                f"{number} is not a number of seconds or metres: correct --time-offset, --standing or --truth-sigma"
            )


def _digests_of(*paths: Path) -> dict[str, str]:
    """Compute the checksum of each file by its path, since both may have the same name."""
    found = {}
    for path in paths:
        if not path.is_file():
            raise RecordingError(f"{path}: is no file: give the file of the trajectory itself")
        found[str(path)] = file_digests(path)[path.name]
    return found


def _print(document: dict[str, Any]) -> None:
    """Print the values of each device, how the track was aligned, and what has no value."""
    names = [device["device"] for device in document["devices"]]
    rows = [["metric", *names, "alignment"]]
    rows += [[name, *map(_number_of(name), values), aligned] for name, aligned, _, values in metric_rows(document)]
    for part in ("mean", "median", "p90", "max"):
        errors = [device["error_after_alignment_m"][part] for device in document["devices"]]
        rows.append([f"error {part}", *map(_number_of("_m"), errors), document["alignment"]["name"]])
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    for row in rows:
        click.echo("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip())
    alignment = document["alignment"]
    click.echo(f"alignment {alignment['name']}: {alignment['meaning']} ({alignment['reason']})")
    truth = document["truth"]
    click.echo(f"truth: {truth['positions']} {truth['kind']}, {truth['sigma_m']:.2f} m per axis")
    for line in missing_rows(document):
        click.echo(f"no value: {line}")


def _number_of(metric: str) -> Any:
    unit = unit_of(metric)
    return lambda value: "-" if value is None else f"{value:.3f} {unit}".rstrip()

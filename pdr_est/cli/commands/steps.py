"""`pdr-est steps`: number of steps in a recording, also in one without gyroscope."""

import json
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import click

from pdr_est import pipeline
from pdr_est.cli.error_context import prefix_errors
from pdr_est.cli.options import (
    PATH,
    config_option,
    detector_option,
    given_paths,
    map_option,
    overwrite_option,
    resolve_config,
)
from pdr_est.config import Config
from pdr_est.evaluate.carrying_modes import mode_shares
from pdr_est.io import read
from pdr_est.io.tables.mapping import TableMapping
from pdr_est.io.writers.atomic_output import staged_file
from pdr_est.io.writers.track_files import write_steps_csv
from pdr_est.pipeline import DeviceWalk
from pdr_est.pipeline.warnings import warnings_of
from pdr_est.types.steps import Step


@click.command("steps")
@click.argument("recordings", type=PATH, nargs=-1, required=True, metavar="RECORDING...")
@detector_option
@config_option
@map_option
@click.option(
    "-o", "--output", type=PATH, metavar="FILE.csv", help="Write the table of steps to this file; for one RECORDING."
)
@overwrite_option
@click.option("--json", "as_json", is_flag=True, help="Print JSON: a list with one object for each device.")
def steps_command(
    recordings: tuple[Path, ...],
    output: Path | None,
    overwrite: bool,
    as_json: bool,
    detector: str | None,
    config_file: Path | None,
    mapping: TableMapping | None,
) -> None:
    """Find the steps in each RECORDING: their number, the cadence, and how the phone was carried.

    An accelerometer is enough; how the phone was carried is recognised only with a gyroscope.
    """
    if output is not None and len(recordings) > 1:
        raise click.UsageError(
            f"-o takes the steps of one RECORDING, but {len(recordings)} are given: run the command once for each"
        )
    config = resolve_config(config_file, detector=detector)
    with ExitStack() as stack:
        inputs = given_paths(*recordings, config_file)
        table = None if output is None else stack.enter_context(staged_file(output, overwrite, inputs))
        found = [(path, walk) for path in recordings for walk in _walks(path, config, mapping)]
        if table is not None:
            write_steps_csv({walk.device: walk.steps for _, walk in found}, table)
    documents = [_document(path, walk) for path, walk in found]
    if as_json:
        click.echo(json.dumps(documents, indent=2, ensure_ascii=False, allow_nan=False))
        return
    for document in documents:
        click.echo(_format_line(document))


def _walks(path: Path, config: Config, mapping: TableMapping | None) -> Sequence[DeviceWalk]:
    """Run the front end on a recording; warnings go to stderr."""
    recording = read(path, mapping)
    with prefix_errors(path):
        walks = pipeline.analyse_recording(recording, config)
    for warning in warnings_of(recording, walks):
        click.echo(f"warning: {path}: {warning}", err=True)
    return walks


def _document(path: Path, walk: DeviceWalk) -> dict[str, Any]:
    start_s, end_s = walk.span_s
    cadence_hz = _cadence_hz(walk.steps)
    return {
        "recording": str(path),
        "device": walk.device,
        "steps": len(walk.steps),
        "duration_s": round(end_s - start_s, 3),
        "cadence_per_min": None if cadence_hz is None else round(60.0 * cadence_hz, 2),
        "modes": {mode.name: round(share, 4) for mode, share in mode_shares(walk.steps).items()},
    }


def _cadence_hz(found: Sequence[Step]) -> float | None:
    """Compute the steps per second while walking; the first step after a standstill has no interval before it."""
    intervals_s = [1.0 / step.frequency_hz for step in found if step.frequency_hz > 0.0]
    return len(intervals_s) / sum(intervals_s) if intervals_s else None


def _format_line(document: dict[str, Any]) -> str:
    words = [f"{document['steps']} steps in {document['duration_s']:.1f} s"]
    if document["cadence_per_min"] is not None:
        words.append(f"{document['cadence_per_min']:.1f} steps per minute")
    words += [f"{mode} {100.0 * share:.0f} %" for mode, share in document["modes"].items()]
    return f"{document['recording']}: {document['device']}: {', '.join(words)}"

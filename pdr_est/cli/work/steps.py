"""Work of `pdr-est steps`: the front end on each recording, and its steps as text, JSON or table."""

import json
from collections.abc import Sequence
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import Any

import click

from pdr_est import pipeline
from pdr_est.cli.call_paths import input_paths
from pdr_est.cli.error_context import prefix_errors
from pdr_est.cli.many_walks import Done, finish_many, refuse_other_file, work_on, write_summary
from pdr_est.cli.recording_part import RecordingPart
from pdr_est.cli.settings import resolve_config
from pdr_est.cli.walk_list import NamedPath, expand_paths, named_paths
from pdr_est.config import Config
from pdr_est.evaluate.carrying_modes import mode_shares
from pdr_est.io.tables.mapping import TableMapping
from pdr_est.io.writers.steps_table import write_steps_csv
from pdr_est.output.atomic_output import staged_file
from pdr_est.pipeline import DeviceWalk
from pdr_est.pipeline.warnings import warnings_of
from pdr_est.preprocessing.moments import Moment
from pdr_est.types.steps import Step


def find_steps(
    recordings: tuple[Path, ...],
    begin: Moment | None,
    end: Moment | None,
    devices: tuple[str, ...],
    mapping: TableMapping | None,
    output: Path | None,
    overwrite: bool,
    jobs: int,
    summary: Path | None,
    as_json: bool,
    detector: str | None,
    config_file: Path | None,
) -> None:
    """Print the number of steps of each recording, or write the table of the steps."""
    walks = named_paths(expand_paths(recordings, mapping))
    if summary is not None:
        refuse_other_file(summary)  # before the work
    if output is not None and len(walks) > 1:
        raise click.UsageError(
            f"-o takes the steps of one RECORDING, but {len(walks)} are given: run the command once for each"
        )
    config = resolve_config(config_file, detector=detector)
    with ExitStack() as stack:
        table = None if output is None else stack.enter_context(staged_file(output, overwrite, input_paths()))
        work = partial(_find_steps, config, RecordingPart(begin, end, devices, mapping), table)
        outcomes = list(work_on(work, walks, jobs))
        if output is not None:
            finish_many(outcomes[:1], None, quiet=True)  # before the table appears, so that there is none
    done = [outcome.done for outcome in outcomes if outcome.done is not None]
    documents = [document for one in done for document in one.document]
    if as_json and done:
        click.echo(json.dumps(documents, indent=2, ensure_ascii=False, allow_nan=False))
    elif done:
        click.echo("\n".join(one.text for one in done))
    if output is None:
        finish_many(outcomes, summary, quiet=True)
    elif summary is not None:
        write_summary(outcomes, summary)


def _find_steps(config: Config, part: RecordingPart, table: Path | None, walk: NamedPath) -> Done:
    """Run the front end on a recording."""
    path = walk.path
    recording = part.read([path])
    with prefix_errors(path):
        recording = part.cut(recording)
        devices = pipeline.analyse_recording(recording, config, at_the_end=False)
    if table is not None:
        write_steps_csv({device.device: device.steps for device in devices}, table)
    documents = [_document(path, device) for device in devices]
    row = {
        "steps": max(document["steps"] for document in documents),
        "duration_s": max(document["duration_s"] for document in documents),
        "cadence_per_min": documents[0]["cadence_per_min"],
        "mode": next(iter(documents[0]["modes"]), None),
        "devices": len(documents),
    }
    text = "\n".join(_format_line(document) for document in documents)
    return Done(row, warnings_of(recording, devices), text, documents)


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

"""Work of `pdr-est inspect`: the description of a recording with the hint where somebody walks."""

import json
from functools import partial
from pathlib import Path

import click

from pdr_est.cli.error_context import prefix_errors
from pdr_est.cli.many_walks import Done, finish_many, refuse_other_file, work_on
from pdr_est.cli.recording_part import RecordingPart
from pdr_est.cli.walk_list import NamedPath, expand_paths, named_paths
from pdr_est.cli.work.walking_hint import walking_hint
from pdr_est.io.formats.map_draft import write_map_draft
from pdr_est.io.tables.mapping import TableMapping
from pdr_est.preprocessing.moments import Moment
from pdr_est.preprocessing.quality.inspection import inspect_recording
from pdr_est.preprocessing.quality.inspection_text import format_inspection


def inspect_recordings(
    recordings: tuple[Path, ...],
    begin: Moment | None,
    end: Moment | None,
    devices: tuple[str, ...],
    mapping: TableMapping | None,
    jobs: int,
    summary: Path | None,
    as_json: bool,
    write_map: Path | None,
) -> None:
    """Describe what was recognised in each recording, or write a draft of a mapping for one."""
    if write_map is not None:
        if len(recordings) > 1:
            raise click.UsageError(f"--write-map describes one RECORDING, but {len(recordings)} are given")
        write_map_draft(recordings[0], write_map)
        click.echo(f"{write_map}: complete it, then use it with --map")
        return
    walks = named_paths(expand_paths(recordings, mapping))
    if summary is not None:
        refuse_other_file(summary)  # before the work
    work = partial(_inspect, RecordingPart(begin, end, devices, mapping))
    outcomes = list(work_on(work, walks, jobs))
    done = [outcome.done for outcome in outcomes if outcome.done is not None]
    if as_json and done:
        found = [one.document for one in done]
        click.echo(json.dumps(found[0] if len(walks) == 1 else found, indent=2, ensure_ascii=False))
    elif done:
        click.echo("\n\n".join(one.text for one in done))
    finish_many(outcomes, summary, quiet=as_json)


def _inspect(part: RecordingPart, walk: NamedPath) -> Done:
    recording = part.read([walk.path])
    with prefix_errors(walk.path):
        recording = part.cut(recording)
    inspection, hint = inspect_recording(recording), walking_hint(recording)
    text = format_inspection(inspection)
    faults = sum(len(device.findings) + len(device.warnings) for device in inspection.devices)
    row = {
        "format": inspection.format,
        "duration_s": inspection.duration_s,
        "devices": len(inspection.devices),
        "walking_from_s": None if hint is None else round(hint.begin_s, 1),
        "walking_to_s": None if hint is None else round(hint.end_s, 1),
        "steps": None if hint is None else hint.steps,
        "warnings": faults,
    }
    document = inspection.to_dict() | {"walking": None if hint is None else hint.to_dict()}
    return Done(row, text=text if hint is None else f"{text}\n{hint.words}", document=document)

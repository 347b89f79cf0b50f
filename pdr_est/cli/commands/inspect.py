"""`pdr-est inspect`: content of a recording, and what looks wrong with it."""

import json
from pathlib import Path

import click

from pdr_est.cli.options import PATH, map_option
from pdr_est.io import read
from pdr_est.io.formats.plain_csv.unknown import write_map_draft
from pdr_est.io.tables.mapping import TableMapping
from pdr_est.preprocessing.quality.inspection import inspect_recording
from pdr_est.preprocessing.quality.inspection_text import format_inspection


@click.command("inspect")
@click.argument("recordings", type=PATH, nargs=-1, required=True, metavar="RECORDING...")
@click.option("--json", "as_json", is_flag=True, help="Print JSON: one object, or a list for several recordings.")
@map_option
@click.option(
    "--write-map",
    type=PATH,
    metavar="FILE.yaml",
    help="Write a draft of a mapping for --map instead: what the columns of one RECORDING mean.",
)
def inspect_command(
    recordings: tuple[Path, ...], as_json: bool, mapping: TableMapping | None, write_map: Path | None
) -> None:
    """Describe what was recognised in each RECORDING: device, channels, rates, gaps, units, signs and faults."""
    if write_map is not None:
        if len(recordings) > 1:
            raise click.UsageError(f"--write-map describes one RECORDING, but {len(recordings)} are given")
        write_map_draft(recordings[0], write_map)
        click.echo(f"{write_map}: complete it, then use it with --map")
        return
    found = [inspect_recording(read(path, mapping)) for path in recordings]
    if as_json:
        documents = [inspection.to_dict() for inspection in found]
        click.echo(json.dumps(documents[0] if len(documents) == 1 else documents, indent=2, ensure_ascii=False))
        return
    click.echo("\n\n".join(format_inspection(inspection) for inspection in found))

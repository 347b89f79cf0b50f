"""`pdr-est inspect`: content of a recording, and what looks wrong with it."""

import json
from pathlib import Path

import click

from pdr_est.cli.options import PATH
from pdr_est.io import read
from pdr_est.preprocessing.quality.inspection import inspect_recording
from pdr_est.preprocessing.quality.inspection_text import format_inspection


@click.command("inspect")
@click.argument("recordings", type=PATH, nargs=-1, required=True, metavar="RECORDING...")
@click.option("--json", "as_json", is_flag=True, help="Print JSON: one object, or a list for several recordings.")
def inspect_command(recordings: tuple[Path, ...], as_json: bool) -> None:
    """Describe what was recognised in each RECORDING: device, channels, rates, gaps, units, signs and faults."""
    found = [inspect_recording(read(path)) for path in recordings]
    if as_json:
        documents = [inspection.to_dict() for inspection in found]
        click.echo(json.dumps(documents[0] if len(documents) == 1 else documents, indent=2, ensure_ascii=False))
        return
    click.echo("\n\n".join(format_inspection(inspection) for inspection in found))

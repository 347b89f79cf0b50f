"""`pdr-est inspect`: content of a recording, and what looks wrong with it."""

from typing import Any

import click

from pdr_est.cli.options import OUTPUT, PATH, jobs_option, recording_options, summary_option
from pdr_est.module_loading import loading_modules


@click.command("inspect")
@click.argument("recordings", type=PATH, nargs=-1, required=True, metavar="RECORDING...")
@recording_options
@jobs_option
@summary_option
@click.option("--json", "as_json", is_flag=True, help="Print JSON: one object, or a list for several recordings.")
@click.option(
    "--write-map",
    type=OUTPUT,
    metavar="FILE.yaml",
    help="Write a draft of a mapping for --map instead: what the columns of one RECORDING mean.",
)
def inspect_command(**options: Any) -> None:
    """Describe what was recognised in each RECORDING: device, channels, rates, gaps, units, signs and faults.

    A folder of several recordings stands for these, as does a pattern in quotation marks.
    """
    with loading_modules():
        from pdr_est.cli.work.inspect import inspect_recordings

    inspect_recordings(**options)

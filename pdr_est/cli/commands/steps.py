"""`pdr-est steps`: number of steps in a recording, also in one without gyroscope."""

from typing import Any

import click

from pdr_est.cli.options import (
    OUTPUT,
    PATH,
    config_option,
    detector_option,
    jobs_option,
    overwrite_option,
    recording_options,
    summary_option,
)
from pdr_est.module_loading import loading_modules


@click.command("steps")
@click.argument("recordings", type=PATH, nargs=-1, required=True, metavar="RECORDING...")
@recording_options
@detector_option
@config_option
@click.option(
    "-o",
    "--output",
    type=OUTPUT,
    metavar="FILE.csv",
    help="Write the table of steps to this file; for one RECORDING.",
)
@overwrite_option
@jobs_option
@summary_option
@click.option("--json", "as_json", is_flag=True, help="Print JSON: a list with one object for each device.")
def steps_command(**options: Any) -> None:
    """Find the steps in each RECORDING: their number, the cadence, and how the phone was carried.

    An accelerometer is enough; how the phone was carried is recognised only with a gyroscope. A folder of several
    recordings stands for these, as does a pattern in quotation marks.
    """
    with loading_modules():
        from pdr_est.cli.work.steps import find_steps

    find_steps(**options)

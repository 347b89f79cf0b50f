"""`pdr-est benchmark`: errors on public data sets, of one variant or of several side by side."""

from typing import Any

import click

from pdr_est.cli.choices import COMPARED, DEVICE_TURNS, EVERY_VALUE, SUITE_NAMES
from pdr_est.cli.options import OUTPUT, PATH, Command, config_option
from pdr_est.module_loading import loading_modules


def _axis_options(command: Command) -> Command:
    """Add an option for each setting that is compared, which takes one of its values or "all"."""
    for name, (values, default) in reversed(list(COMPARED.items())):
        text = f"Default: {default}; {EVERY_VALUE} compares them."
        command = click.option(f"--{name}", type=click.Choice((*values, EVERY_VALUE)), help=text)(command)
    return command


@click.command()
@click.argument("suite", type=click.Choice(SUITE_NAMES))
@click.option("--data", type=PATH, metavar="DIR", help="Folder with the data sets; speed needs none.")
@_axis_options
@click.option("--json", "json_file", type=OUTPUT, metavar="FILE", help="Write the numbers there as well.")
@click.option("--jobs", type=click.IntRange(min=1), default=1, show_default=True, help="Processes.")
@click.option("--limit", type=click.IntRange(min=1), help="Only the first walks.")
@click.option("--turn-device", metavar="TURN", help=f"Turn the device axes of every recording first: {DEVICE_TURNS}.")
@config_option
@click.option("-q", "--quiet", is_flag=True, help="No progress bar.")
def benchmark(**options: Any) -> None:
    """Score the walks of SUITE in DIR and print a table of its metrics; SUITE speed measures what the chain costs."""
    with loading_modules():
        from pdr_est.cli.work.benchmark import score_suite

    score_suite(**options)

"""`pdr-est convert`: a recording of any known format becomes one that other programs read."""

from typing import Any

import click

from pdr_est.cli.choices import RECORDING_FORMATS
from pdr_est.cli.options import OUTPUT, PATH, overwrite_option, recording_options
from pdr_est.module_loading import loading_modules


@click.command("convert")
@click.argument("recordings", type=PATH, nargs=-1, required=True, metavar="RECORDING...")
@click.option("-o", "--output", type=OUTPUT, required=True, metavar="OUT", help="File or folder to write.")
@click.option(
    "--format",
    "chosen",
    type=click.Choice(RECORDING_FORMATS),
    help="Format of OUT. Default: by its extension; without one a folder of sensor-logger.",
)
@recording_options
@overwrite_option
def convert_command(**options: Any) -> None:
    """Write RECORDING, of any format that `inspect` knows, in a documented one: SI units, up at rest.

    \b
    csv            the table of docs/recorder-formats.md
    parquet        the same columns
    sensor-logger  a folder with one table a sensor
    npz, hdf5      arrays of all sensors on common times, with RoNIN's names
    """  # noqa: D301  click reads the character \b
    with loading_modules():
        from pdr_est.cli.work.convert import convert_recording

    convert_recording(**options)

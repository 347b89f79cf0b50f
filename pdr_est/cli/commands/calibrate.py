"""`pdr-est calibrate`: a person's own step length from walks of known length or with known positions."""

from typing import Any

import click

from pdr_est.cli.options import (
    FIXES,
    FIXES_METAVAR,
    OUTPUT,
    PATH,
    config_option,
    height_and_gender_options,
    length_model_option,
    overwrite_option,
    recording_options,
)
from pdr_est.module_loading import loading_modules


@click.command("calibrate")
@click.argument("recordings", type=PATH, nargs=-1, required=True, metavar="RECORDING...")
@click.option(
    "--distance",
    "distances_m",
    type=float,
    multiple=True,
    metavar="M",
    help="True length of the walk in metres; once for each RECORDING, in the same order.",
)
@click.option(
    "--fixes",
    type=FIXES,
    multiple=True,
    metavar=FIXES_METAVAR,
    help="Known positions instead: once for each RECORDING, or once `recording` or `waypoints` for all.",
)
@recording_options
@click.option("-o", "--output", type=OUTPUT, required=True, metavar="FILE.yaml", help="Profile to write.")
@overwrite_option
@length_model_option
@height_and_gender_options
@config_option
def calibrate_command(**options: Any) -> None:
    """Fit a person's own step length to each RECORDING, and write it as a profile for `smooth --profile`.

    A RECORDING should hold one walk of known length and no other steps. Several walks give a better estimate than
    one; walks at different speeds also show how the steps change with the cadence.
    """
    with loading_modules():
        from pdr_est.cli.work.calibrate import fit_profile

    fit_profile(**options)

"""`pdr-est track`: estimates while samples arrive, from recordings that are replayed or from phones that record."""

from typing import Any

import click

from pdr_est.cli.commands.plan import plan_options
from pdr_est.cli.options import (
    OUTPUT,
    PATH,
    config_option,
    estimation_options,
    fixes_option,
    formats_option,
    recording_options,
)
from pdr_est.module_loading import loading_modules


@click.command("track")
@click.argument("recordings", type=PATH, nargs=-1, required=True, metavar="RECORDING...|-")
@click.option(
    "-o",
    "--output",
    type=OUTPUT,
    metavar="FILE",
    help="Write to this file, which appears when the walk has ended, instead of standard output.",
)
@click.option("--overwrite", is_flag=True, help="Replace the output FILE if it exists.")
@formats_option("Written beside FILE when the walk has ended. Default: none.")
@click.option("--realtime", is_flag=True, help="Replay at the speed of the recording, not as fast as possible.")
@click.option(
    "--platform",
    type=click.Choice(("ios", "android")),
    help="Platform of the phones that send to -. Default: detected.",
)
@fixes_option
@recording_options
@plan_options
@config_option
@estimation_options
def track_command(**options: Any) -> None:
    """Track a walk online: print one line of JSON for each estimate, as soon as there is one.

    Each RECORDING holds the phones of one walk, all on one clock; several phones also give estimates of the person,
    as device `fused`. With - the messages that Sensor Logger pushes are read from standard input, one a line. The
    filter is ekf, or particle with --plan; --estimator fixed-lag also prints delayed estimates.
    """
    with loading_modules():
        from pdr_est.cli.work.online.track import track_walk

    track_walk(**options)

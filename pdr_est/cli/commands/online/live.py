"""`pdr-est live`: a page that shows a walk while phones record it."""

from typing import Any

import click

from pdr_est.cli.commands.plan import plan_options
from pdr_est.cli.options import FIXES, FIXES_METAVAR, OUTPUT, PATH, config_option, estimation_options
from pdr_est.module_loading import loading_modules


@click.command("live")
@click.option("-o", "--output", type=OUTPUT, metavar="OUT", help="New folder for the walk. Default: live-DATE-TIME.")
@click.option(
    "--host",
    default="127.0.0.1",
    show_default=True,
    help="Address of this computer that phones reach; 0.0.0.0 for all. Without it only this computer does.",
)
@click.option(
    "--port",
    type=click.IntRange(0, 65534),
    default=8765,
    show_default=True,
    help="Port of the page; apps push to the next one if the page is encrypted. 0: any free port.",
)
@click.option(
    "--phyphox",
    "phyphox_addresses",
    multiple=True,
    metavar="ADDRESS",
    help="Address that phyphox shows for remote access; may be repeated.",
)
@click.option(
    "--platform", type=click.Choice(("ios", "android")), help="Platform of the phones that push. Default: detected."
)
@click.option(
    "--replay",
    "recordings",
    type=PATH,
    multiple=True,
    metavar="RECORDING",
    help="Show a recording in place of phones; may be repeated for several phones of one walk.",
)
@click.option(
    "--speed",
    type=click.FloatRange(0.01, 1000.0),
    default=1.0,
    show_default=True,
    metavar="N",
    help="Replay N times faster than the recording was made.",
)
@click.option(
    "--fixes",
    type=FIXES,
    metavar=FIXES_METAVAR,
    help="Known positions; of phones that push only `recording`, the positions that they send.",
)
@plan_options
@config_option
@estimation_options
def live_command(**options: Any) -> None:
    """Show a walk on a page while phones record it, and smooth it at the end.

    The command prints the address of the page. A phone takes part through its own browser on that page, with Sensor
    Logger's HTTP push, or with phyphox's remote access. Everything received is recorded in OUT at once. Ctrl-C or the
    button Stop ends the walk; then OUT/result has the smoothed walk, and Ctrl-C ends the server.
    """
    with loading_modules():
        from pdr_est.cli.work.online.live import show_live

    show_live(**options)

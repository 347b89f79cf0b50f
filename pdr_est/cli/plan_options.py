"""Options about floor plans, for the commands that make tracks."""

from collections.abc import Callable
from typing import Any

import click

from pdr_est.cli.options import PATH


def plan_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options --plan FILE, which may be repeated, and --floor NAME to a command."""
    plan = click.option(
        "--plan",
        "plans",
        type=PATH,
        multiple=True,
        metavar="FILE",
        help="Floor plan: GeoJSON in degrees or local metres, or a floor of the Indoor Location Competition 2.0. Of "
        "several floors one file each, or one that shows all.",
    )
    floor = click.option(
        "--floor", metavar="NAME", help="Floor on which the walk begins; needed where the plans show several."
    )
    return plan(floor(command))

"""`pdr-est plan`: a floor plan with its scale, and one made of a picture; options of other commands about plans."""

from collections.abc import Callable
from typing import Any

import click

from pdr_est.cli.options import OUTPUT, PATH
from pdr_est.module_loading import loading_modules


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


@click.command("plan")
@click.argument("plan", type=PATH, metavar="FILE")
@click.option("--floor", metavar="NAME", help="Floor of a plan that shows several; the name of one from a picture.")
@click.option("-o", "--output", type=OUTPUT, metavar="OUT", help="Folder for plan.html and plan.geojson.")
@click.option(
    "--start", type=(float, float), metavar="X Y", help="Mark a position in metres, and say whether it is walkable."
)
@click.option(
    "--point",
    "points",
    type=(float, float, float, float),
    multiple=True,
    metavar="COL ROW X Y",
    help="Of a picture: the pixel, from the upper left corner, of a known position in metres; give two.",
)
@click.option(
    "--darkness",
    type=click.FloatRange(0.0, 1.0),
    metavar="D",
    help="Of a picture: how dark a wall is, from 0 (white) to 1 (black). Default: found from the picture.",
)
@click.option(
    "--inside",
    type=(float, float),
    multiple=True,
    metavar="X Y",
    help="Of a picture: a position in a walkable room. Default: all rooms that are closed by walls.",
)
@click.option("--overwrite", is_flag=True, help="Replace the results of an earlier run in OUT.")
@click.option("-q", "--quiet", is_flag=True, help="Print nothing.")
def plan_command(**options: Any) -> None:
    """Describe the floor plan in FILE: its size, what of it is walkable, and the directions of its walls.

    FILE is GeoJSON in longitude and latitude or in local metres, or a floor of the Indoor Location Competition 2.0
    (its folder, or geojson_map.json). Of a picture, whose dark lines are walls, a plan is made: give two known
    points, and use OUT/plan.geojson afterwards.
    """
    with loading_modules():
        from pdr_est.cli.work.plan import describe_plan

    describe_plan(**options)

"""`pdr-est evaluate`: the errors of any trajectory against the truth."""

from typing import Any

import click

from pdr_est.cli.options import OUTPUT, PATH
from pdr_est.module_loading import loading_modules


@click.command("evaluate")
@click.argument("track", type=PATH, metavar="TRACK")
@click.option("--truth", type=PATH, required=True, metavar="FILE", help="True positions, in the same formats.")
@click.option("-o", "--output", type=OUTPUT, metavar="OUT", help="Folder for report.html and evaluation.json.")
@click.option(
    "--align",
    type=click.Choice(("none", "start", "rigid")),
    help="Move of the whole track before errors are shown. Default: none if both files state their place on the "
    "Earth, else rigid (the best rotation and translation).",
)
@click.option(
    "--time-offset", "time_offset_s", type=float, metavar="S", help="Seconds to add to the times of the track."
)
@click.option(
    "--standing",
    "standing_s",
    type=click.FloatRange(0.0, 1e6),
    default=0.0,
    metavar="S",
    help="Seconds that the walker stands before the first and after the last position of TRACK.",
)
@click.option(
    "--origin",
    type=(float, float),
    metavar="LAT LON",
    help="Place on the Earth of the origin of positions in metres, degrees, if only one file has degrees.",
)
@click.option(
    "--truth-sigma",
    "truth_sigma_m",
    type=click.FloatRange(0.0, 1e5),
    metavar="M",
    help="Standard deviation of the true positions per axis, metres. Default: the file's own; else 0.7 for "
    "waypoints, 0 for recorded poses.",
)
@click.option("--overwrite", is_flag=True, help="Replace the results of an earlier run in OUT.")
@click.option("-q", "--quiet", is_flag=True, help="Print nothing but warnings.")
def evaluate_command(**options: Any) -> None:
    """Score TRACK, a trajectory of any program, against the truth with the metrics of pdr-est.

    Both files are TUM (time x y z qx qy qz qw), a table with a header (time, and x and y in metres or latitude and
    longitude, such as timestamp,x,y,yaw,floor), GeoJSON with timed points, or GPX. Several devices in TRACK are
    scored each.
    """
    with loading_modules():
        from pdr_est.cli.work.evaluate import evaluate_track

    evaluate_track(**options)

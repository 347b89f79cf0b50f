"""`pdr-est smooth`: a recording becomes a folder with its track."""

from typing import Any

import click

from pdr_est.cli.commands.plan import plan_options
from pdr_est.cli.options import (
    OUTPUT,
    PATH,
    clock_options,
    config_option,
    estimation_options,
    fixes_option,
    formats_option,
    jobs_option,
    recording_options,
)
from pdr_est.module_loading import loading_modules


@click.command("smooth")
@click.argument("recordings", type=PATH, nargs=-1, required=True, metavar="RECORDING…")
@click.option("-o", "--output", type=OUTPUT, required=True, metavar="OUT", help="Folder for the results.")
@fixes_option
@plan_options
@click.option(
    "--truth",
    type=PATH,
    metavar="FILE",
    help="True positions of the walk, which measure the errors and are never used: a table, TUM, GeoJSON or GPX.",
)
@recording_options
@click.option(
    "--profile",
    type=PATH,
    metavar="FILE.yaml",
    help="Profile of the walker's own step length; with --learn it is made if there is none.",
)
@click.option("--learn", is_flag=True, help="Add to the profile what this walk tells of the step length.")
@click.option(
    "--distance", "distance_m", type=float, metavar="M", help="True length of the way in metres, for --learn."
)
@config_option
@estimation_options
@clock_options
@click.option("--each", is_flag=True, help="Each RECORDING is a walk of its own, not a device of the same walk.")
@jobs_option
@formats_option("Default: tum, geojson, and where the place on the Earth is known kml, gpx.")
@click.option(
    "--background",
    metavar="PLAN",
    help="What lies below the track in report.html: a picture with a world file, GeoJSON, a folder of map tiles, or "
    "https://…/{z}/{x}/{y}.png, which the page then loads.",
)
@click.option(
    "--report/--no-report",
    default=None,
    help="Write report.html. Default: for one walk, as it takes most of the time.",
)
@click.option("--overwrite", is_flag=True, help="Replace the results of an earlier run in OUT.")
@click.option("-q", "--quiet", is_flag=True, help="Show no progress bar and no summary; warnings are still shown.")
def smooth_command(**options: Any) -> None:
    """Turn RECORDING (a file, a folder or a zip) into a track with uncertainty, its files and its report.

    Several recordings are those of devices that one person carried at the same time. With --each, with a folder of
    several recordings, with --jobs, and if three or more were made at different times by their dates, each is a walk
    of its own: its results go to a folder of its name in OUT, and OUT/walks.csv has a row for each walk. Files of a
    folder that cannot be read count as walks that failed; the exit code is 2 if any did.
    """
    with loading_modules():
        from pdr_est.cli.work.smooth import smooth_walks

    smooth_walks(**options)

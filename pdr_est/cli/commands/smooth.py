"""`pdr-est smooth`: a recording becomes a folder with its track."""

from functools import partial
from pathlib import Path
from typing import Any

import click

from pdr_est.cli.clock_options import apply_clock_options, clock_options
from pdr_est.cli.fix_options import fix_tables, fixes_option
from pdr_est.cli.many_walks import (
    SUMMARY,
    jobs_option,
    print_summary,
    refuse_other_file,
    report_failures,
    tell,
    work_on,
    write_summary,
)
from pdr_est.cli.options import PATH, config_option, estimation_options, given_paths, resolve_config
from pdr_est.cli.profile_options import WalkersProfile
from pdr_est.cli.progress import progress_bar
from pdr_est.cli.recording_options import RecordingPart, recording_options
from pdr_est.cli.smoothing import REPORT, SmoothRequest, smooth_one_of_many, smooth_to_folder
from pdr_est.cli.walk_list import are_separate_walks, distinct_paths, expand_argument, named_paths
from pdr_est.clock_sync import ClockMethod
from pdr_est.errors import OutputError
from pdr_est.io.tables.mapping import TableMapping
from pdr_est.preprocessing.moments import Moment


@click.command("smooth")
@click.argument("recordings", type=PATH, nargs=-1, required=True, metavar="RECORDING…")
@click.option("-o", "--output", type=PATH, required=True, metavar="OUT", help="Folder for the results.")
@fixes_option
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
@click.option(
    "--report/--no-report",
    default=None,
    help="Write report.html. Default: for one walk, as it takes most of the time.",
)
@click.option("--overwrite", is_flag=True, help="Replace the results of an earlier run in OUT.")
@click.option("-q", "--quiet", is_flag=True, help="Show no progress bar and no summary; warnings are still shown.")
def smooth_command(
    recordings: tuple[Path, ...],
    output: Path,
    fixes: str | None,
    begin: Moment | None,
    end: Moment | None,
    devices: tuple[str, ...],
    mapping: TableMapping | None,
    profile: Path | None,
    learn: bool,
    distance_m: float | None,
    clock: ClockMethod | None,
    clock_offsets: tuple[tuple[str, float], ...],
    messages: Path | None,
    each: bool,
    jobs: int,
    report: bool | None,
    overwrite: bool,
    quiet: bool,
    **settings: Any,
) -> None:
    """Turn RECORDING (a file, a folder or a zip) into a track with uncertainty, its files and its report.

    Several recordings are those of devices that one person carried at the same time. With --each, with a folder of
    several recordings, with --jobs, and if three or more were made at different times by their dates, each is a walk
    of its own: its results go to a folder of its name in OUT, and OUT/walks.csv has a row for each walk.
    """
    own = WalkersProfile.of_options(profile, learn, distance_m)
    own.require_outside(output)
    config = apply_clock_options(resolve_config(**settings, profile=own.profile), clock, clock_offsets, messages)
    inputs = given_paths(*recordings, settings["config_file"], messages, *fix_tables([fixes]))
    part = RecordingPart(begin, end, devices, mapping)
    found = [expand_argument(argument, mapping) for argument in recordings]
    paths = distinct_paths(path for group in found for path in group)
    many = each or jobs > 1 or any(len(group) > 1 for group in found) or are_separate_walks(paths, mapping)
    with_report = not many if report is None else report
    request = SmoothRequest(config, fixes, part, messages, own, overwrite, tuple(inputs), with_report)
    if many:
        _smooth_many(paths, output, request, jobs, quiet)
        return
    result = smooth_to_folder(output, paths, request, quiet)
    for warning in result.warnings:
        click.echo(f"warning: {warning}", err=True)
    if not quiet:
        summary = result.summary
        shown = output / REPORT if with_report else output
        click.echo(f"{summary['distance_m']:.1f} m in {summary['steps']} steps -> {shown}")
        if config.start.pose().position_m is not None and summary["frame"] != "map":
            click.echo(f"frame: {summary['frame_meaning']}; give --heading, a second position, or fixes")
        for line in result.words:
            click.echo(line)


def _smooth_many(paths: tuple[Path, ...], output: Path, request: SmoothRequest, jobs: int, quiet: bool) -> None:
    """Smooth each recording into a folder of its own, and write the table of all."""
    if request.messages is not None or fix_tables([request.fixes]):
        raise click.UsageError("--messages and --fixes FILE.csv belong to one walk: smooth it alone")
    if request.own.distance_m is not None:
        raise click.UsageError("--distance is the length of one walk: smooth it alone")
    _prepare_folder(output, request)
    walks = named_paths(paths)
    outcomes = []
    with progress_bar("smoothing", total=len(walks), quiet=quiet) as bar:
        for outcome in work_on(partial(smooth_one_of_many, request, output), walks, jobs):
            tell(outcome)
            outcomes.append(outcome)
            bar.set_progress(len(outcomes), len(walks))
    write_summary(outcomes, output / SUMMARY)
    if not quiet:
        print_summary(outcomes)
        done = sum(outcome.done is not None for outcome in outcomes)
        click.echo(f"{done} of {len(walks)} walks -> {output}, {output / SUMMARY}")
    report_failures(outcomes)


def _prepare_folder(output: Path, request: SmoothRequest) -> None:
    """Make the folder of all results; raise OutputError where it must not be."""
    for source in request.inputs:
        if source.is_dir() and output.resolve().is_relative_to(source.resolve()):
            raise OutputError(f"{output}: lies inside the input {source}: choose a folder elsewhere")
    if (output / SUMMARY).exists() and not request.overwrite:
        raise OutputError(
            f"{output}: contains the results of an earlier run: allow overwriting (--overwrite) or choose another "
            "folder"
        )
    refuse_other_file(output / SUMMARY)
    try:
        output.mkdir(exist_ok=True)
    except OSError as error:
        raise OutputError(
            f"{output}: the folder cannot be made ({error.strerror}): choose another output folder"
        ) from error

"""Work of `pdr-est smooth`: one walk or many, and what is printed."""

from functools import partial
from pathlib import Path
from typing import Any

import click

from pdr_est.cli.call_paths import input_paths
from pdr_est.cli.clock_options import apply_clock_options
from pdr_est.cli.fix_options import PlanChoice, fix_tables
from pdr_est.cli.many_walks import (
    SUMMARY,
    print_summary,
    refuse_other_file,
    report_failures,
    tell,
    work_on,
    write_summary,
)
from pdr_est.cli.profile_options import WalkersProfile
from pdr_est.cli.progress import progress_bar
from pdr_est.cli.recording_part import RecordingPart
from pdr_est.cli.settings import resolve_config
from pdr_est.cli.walk_list import are_separate_walks, distinct_paths, expand_argument, named_paths
from pdr_est.cli.work.smoothing import REPORT, SmoothRequest, smooth_one_of_many, smooth_to_folder
from pdr_est.clock_sync import ClockMethod
from pdr_est.errors import OutputError
from pdr_est.estimators import AUTO
from pdr_est.io.tables.mapping import TableMapping
from pdr_est.preprocessing.moments import Moment
from pdr_est.report.background.reading import read_background


def smooth_walks(
    recordings: tuple[Path, ...],
    output: Path,
    fixes: str | None,
    plans: tuple[Path, ...],
    floor: str | None,
    truth: Path | None,
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
    formats: tuple[str, ...] | None,
    background: str | None,
    report: bool | None,
    overwrite: bool,
    quiet: bool,
    **settings: Any,
) -> None:
    """Smooth one walk, or each of many, into a folder of results."""
    own = WalkersProfile.of_options(profile, learn, distance_m)
    own.require_outside(output)
    config = apply_clock_options(resolve_config(**settings, profile=own.profile), clock, clock_offsets, messages)
    inputs = input_paths("profile" if learn else "")
    part = RecordingPart(begin, end, devices, mapping)
    found = [expand_argument(argument, mapping) for argument in recordings]
    paths = distinct_paths(path for group in found for path in group)
    many = each or jobs > 1 or any(len(group) > 1 for group in found) or are_separate_walks(paths, mapping, devices)
    with_report = not many if report is None else report
    below = None if background is None else read_background(background)
    chosen = PlanChoice.of_options(plans, floor)
    request = SmoothRequest(
        config, fixes, part, messages, own, overwrite, inputs, with_report, truth, formats, below, chosen
    )
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
        if chosen.paths and config.estimator.name == AUTO:
            click.echo(
                f"estimator: {summary['estimator']}, {summary['estimator_meaning']}; --estimator chooses another"
            )
        for line in (*result.found_place, *result.left_out, *result.words):
            click.echo(line)


def _smooth_many(paths: tuple[Path, ...], output: Path, request: SmoothRequest, jobs: int, quiet: bool) -> None:
    """Smooth each recording into a folder of its own, and write the table of all."""
    if request.messages is not None or fix_tables([request.fixes]):
        raise click.UsageError("--messages and --fixes FILE.csv belong to one walk: smooth it alone")
    if request.truth is not None:
        raise click.UsageError("--truth belongs to one walk: smooth it alone")
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

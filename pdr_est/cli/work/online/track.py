"""Work of `pdr-est track`: what is replayed or followed live, and where the estimates go."""

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TextIO

import click

from pdr_est.cli.call_paths import input_paths
from pdr_est.cli.error_context import prefix_errors
from pdr_est.cli.fix_options import RECORDED, PlanChoice, load_fixes, placed_by_plan, tell_notes_of_plan
from pdr_est.cli.recording_part import RecordingPart
from pdr_est.cli.settings import resolve_config
from pdr_est.cli.tracking_streams import follow_live, replay
from pdr_est.cli.work.bounded_notes import bounded_lines
from pdr_est.cli.work.online.track_files import OnlineTrackFiles
from pdr_est.clock_sync import coverage_warnings, devices_started_late, require_overlap
from pdr_est.config import Config
from pdr_est.estimators import SPECS
from pdr_est.io.formats.phone_apps.sensor_logger.live import Platform
from pdr_est.io.formats.phone_apps.sensor_logger.live_messages import LONGEST_LINE
from pdr_est.io.side_tables.position_fixes import fixes_within
from pdr_est.io.tables.mapping import TableMapping
from pdr_est.output.growing_file import growing_file
from pdr_est.preprocessing.moments import Moment
from pdr_est.preprocessing.quality.warnings import quality_warnings
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import Recording

_LIVE = Path("-")


def track_walk(
    recordings: tuple[Path, ...],
    output: Path | None,
    overwrite: bool,
    formats: tuple[str, ...] | None,
    realtime: bool,
    platform: Platform | None,
    fixes: str | None,
    plans: tuple[Path, ...],
    floor: str | None,
    begin: Moment | None,
    end: Moment | None,
    devices: tuple[str, ...],
    mapping: TableMapping | None,
    **settings: Any,
) -> None:
    """Print the estimates of the online filter for a replayed recording or for live messages."""
    config, part = resolve_config(**settings), RecordingPart(begin, end, devices, mapping)
    chosen = PlanChoice.of_options(plans, floor)
    if settings["estimator"] in SPECS and not SPECS[settings["estimator"]].online:
        online = " or ".join(name for name, spec in SPECS.items() if spec.online)
        raise click.UsageError(f"{settings['estimator']} needs the whole walk: use --estimator {online}")
    if settings["start"] is not None and config.start.pose().heading_rad is None and not plans:
        click.echo(
            "note: --start without --heading: the track begins at the given position; unless the phone knows north, "
            "its first step leads along x, so that it is turned arbitrarily",
            err=True,
        )
    files = _track_files(output, formats, overwrite, live=_LIVE in recordings)
    if _LIVE in recordings:
        if len(recordings) > 1 or realtime or fixes not in (None, RECORDED) or not part.is_all or mapping:
            raise click.UsageError(
                "- cannot be combined with other recordings, --realtime, --from, --to, --device, --map, or --fixes "
                "other than recording"
            )
        with _output_stream(output, overwrite) as stream:
            lines = bounded_lines(sys.stdin, LONGEST_LINE)
            plan = chosen.load(None)
            tell_notes_of_plan(plan)
            follow_live(lines, config, platform, fixes is not None, stream, plan)
        return
    if platform is not None:
        raise click.UsageError(
            "--platform is for phones that send to -; a recording knows its platform: leave the option out"
        )
    with _output_stream(output, overwrite) as stream:  # before anything is read: it may be an input
        recorded, known = _track_recordings(recordings, part, config, fixes, chosen, realtime, stream, files)
    if files is not None:
        files.write(recorded, known, config)


def _track_files(
    output: Path | None, formats: tuple[str, ...] | None, overwrite: bool, live: bool
) -> OnlineTrackFiles | None:
    """Prepare the files for other programs; None if no format is asked for."""
    if formats is None:
        return None
    if live:
        raise click.UsageError("--format is for recordings that are replayed: leave it out with -")
    if output is None:
        raise click.UsageError("--format writes files beside that of the estimates: give -o FILE as well")
    return OnlineTrackFiles(output, formats, overwrite, input_paths())


def _track_recordings(
    recordings: tuple[Path, ...],
    part: RecordingPart,
    config: Config,
    fixes: str | None,
    chosen: PlanChoice,
    realtime: bool,
    stream: TextIO,
    files: OnlineTrackFiles | None,
) -> tuple[Recording, tuple[PositionFix, ...]]:
    """Replay recordings; return what was tracked, and its fixes."""
    read_in = part.read_files(recordings)
    whole = part.join(read_in, recordings)
    plan = chosen.load(whole.origin)
    whole = placed_by_plan(whole, plan)
    with prefix_errors(", ".join(map(str, recordings))):
        recorded = part.cut(whole)
        if files is not None:
            files.require_possible(recorded, config)
    _refuse_apart(recorded, recordings)
    if len(whole.devices) > len(read_in[0].devices) and any(one.epoch_s is None for one in read_in):
        undated = "not every recording has a date: their times are assumed to count from the same moment"
        click.echo(f"warning: {undated}; `pdr-est smooth` estimates the clocks from the walk instead", err=True)
    known = load_fixes(fixes, whole, recordings[0])
    known = known if part.is_all else fixes_within(known, recorded)
    with prefix_errors(", ".join(map(str, recordings))):
        replay(recorded, known, config, realtime, stream, plan)
    tell_notes_of_plan(plan, recorded.devices)
    for device in recorded.devices:
        for words in dict.fromkeys((*device.warnings, *quality_warnings(device))):
            click.echo(f"warning: {device.name}: {words}", err=True)
    return recorded, known


def _refuse_apart(recorded: Recording, paths: Sequence[Path]) -> None:
    """Raise RecordingError for devices that did not record together; warn of one that starts late or ends early."""
    with prefix_errors(", ".join(map(str, paths))):
        require_overlap(recorded.devices, "track them one by one, or use `pdr-est smooth`, which finds their clocks")
    for name, notes in coverage_warnings(recorded.devices).items():
        for note in notes:
            click.echo(f"warning: {name}: {note}", err=True)
    late = devices_started_late(recorded.devices)
    if late:
        words = "started late, assumed to start where the other phones were at that time"
        click.echo(f"warning: {', '.join(late)}: {words}", err=True)


@contextmanager
def _output_stream(output: Path | None, overwrite: bool) -> Iterator[TextIO]:
    """Open the stream of the output; a file appears with the first estimate and can be followed."""
    if output is None:
        yield sys.stdout
        return
    with growing_file(output, overwrite, input_paths()) as stream:
        yield stream

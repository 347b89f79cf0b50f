"""`pdr-est track`: estimates while samples come, from recordings that are replayed or from phones that record."""

import json
import sys
import time
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TextIO

import click

from pdr_est.cli.error_context import naming
from pdr_est.cli.fix_options import chosen_fixes
from pdr_est.cli.options import PATH, config_option, resolve_config, walker_options
from pdr_est.clock_sync import begun_late, outside_others, refuse_apart
from pdr_est.config import Config
from pdr_est.errors import OutputError, PdrError, RecordingError
from pdr_est.io import read
from pdr_est.io.formats.sensor_logger.live import LiveNews, LiveReader, Platform
from pdr_est.online import Tracker, Update
from pdr_est.online.recording_stream import expected_devices, stream_slices
from pdr_est.preprocessing.merge import together
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import Recording
from pdr_est.types.sensors import SensorBlock

_LIVE = Path("-")


@click.command()
@click.argument("recordings", type=PATH, nargs=-1, required=True, metavar="RECORDING...|-")
@click.option("-o", "--output", type=PATH, metavar="FILE", help="Write there instead of to standard output.")
@click.option("--overwrite", is_flag=True, help="Replace the output FILE if it exists.")
@click.option("--realtime", is_flag=True, help="Replay as fast as it was recorded, not as fast as possible.")
@click.option(
    "--platform", type=click.Choice(("ios", "android")), help="Of the phones that send to -. Default: found out."
)
@click.option("--fixes", metavar="FILE.csv|recording", help="Known positions: a table, or those that are recorded.")
@config_option
@walker_options
def track(
    recordings: tuple[Path, ...],
    output: Path | None,
    overwrite: bool,
    realtime: bool,
    platform: Platform | None,
    fixes: str | None,
    **settings: Any,
) -> None:
    """Follow a walk online: one line of JSON an estimate, as soon as there is one.

    Each RECORDING holds the phones of one walk, all on one clock; several phones give estimates of the person, device
    fused, besides. With - the messages that Sensor Logger pushes are read from standard input, one a line. The filter
    is ekf; --estimator fixed-lag gives delayed estimates besides.
    """
    config = resolve_config(**settings)
    if settings["estimator"] not in (None, "ekf", "fixed-lag"):
        raise click.UsageError(f"{settings['estimator']} needs the whole walk: track with ekf or fixed-lag")
    if _LIVE in recordings:
        if len(recordings) > 1 or realtime or fixes not in (None, "recording"):
            raise click.UsageError("- stands alone, without --realtime, and with no --fixes but recording")
        with _lines(output, overwrite) as stream:
            _follow_live(sys.stdin, config, platform, fixes is not None, stream)
        return
    if platform is not None:
        raise click.UsageError("--platform is for the phones that send to -; recordings tell theirs")
    read_in = [read(path) for path in recordings]
    recorded = together(read_in)
    _refuse_apart(recorded, recordings)
    if len(recorded.devices) > len(read_in[0].devices) and any(one.epoch_s is None for one in read_in):
        words = "not every recording tells its date: their times are taken to count from one moment"
        click.echo(f"warning: {words}, which `pdr-est smooth` would not: it finds that out from the walk", err=True)
    known = chosen_fixes(fixes, recorded, recordings[0])
    with _lines(output, overwrite) as stream:
        _replay(recorded, known, config, realtime, stream)


def _refuse_apart(recorded: Recording, paths: Sequence[Path]) -> None:
    """Raise RecordingError for devices that did not record together; warn of one that begins late or ends early."""
    with naming(", ".join(map(str, paths))):
        refuse_apart(recorded.devices, "track them one by one, or use `pdr-est smooth`, which finds their clocks")
    for name, notes in outside_others(recorded.devices).items():
        for note in notes:
            click.echo(f"warning: {name}: {note}", err=True)
    late = begun_late(recorded.devices)
    if late:
        words = "begun late, taken to begin where the other phones were by then"
        click.echo(f"warning: {', '.join(late)}: {words}", err=True)


def _replay(
    recorded: Recording, fixes: Sequence[PositionFix], config: Config, realtime: bool, stream: TextIO
) -> None:
    devices = recorded.devices
    tracker = Tracker(config, expected_devices(devices, recorded.name, config))
    begun_s: float | None = None
    for moment in stream_slices(devices, fixes):
        if realtime:
            begun_s = time.monotonic() - moment.time_s if begun_s is None else begun_s
            time.sleep(max(moment.time_s + begun_s - time.monotonic(), 0.0))
        _push(tracker, moment.fixes, moment.blocks, stream)
    _finish(tracker, stream)


def _follow_live(
    lines: Iterable[str], config: Config, platform: Platform | None, with_fixes: bool, stream: TextIO
) -> None:
    reader, tracker = LiveReader(platform), Tracker(config)
    number = bad = 0
    last, heard = "", False
    for number, line in enumerate(_until_interrupted(lines), start=1):
        try:
            news = reader.push(line)
        except RecordingError as error:
            bad, last = bad + 1, str(error)
            click.echo(f"warning: line {number}: {error}: left out, {bad} so far", err=True)
            continue
        heard = heard or bool(news.blocks)
        _take(news, tracker, with_fixes, stream)
    rest = reader.flush()
    if not heard and not rest.blocks:
        reason = (
            "standard input is empty"
            if number == 0
            else f"none of {number} lines holds samples, the last bad one: {last}"
        )
        raise RecordingError(f"-: {reason}: send the messages of Sensor Logger's HTTP push, one a line")
    _take(rest, tracker, with_fixes, stream)
    _finish(tracker, stream)


def _until_interrupted(lines: Iterable[str]) -> Iterator[str]:
    """Ctrl-C while waiting for the next line ends the walk, so that what was held back is still told."""
    try:
        yield from lines
    except KeyboardInterrupt:
        return


def _take(news: LiveNews, tracker: Tracker, with_fixes: bool, stream: TextIO) -> None:
    for note in news.notes:
        click.echo(f"warning: {note}", err=True)
    _push(tracker, news.fixes if with_fixes else (), news.blocks, stream)


def _push(
    tracker: Tracker, fixes: Iterable[PositionFix], blocks: Iterable[tuple[str, SensorBlock]], stream: TextIO
) -> None:
    for fix in fixes:
        _write(_loudly(lambda fix=fix: tracker.push_fix(fix)), stream)  # type: ignore[misc]
    for name, block in blocks:
        _write(_loudly(lambda name=name, block=block: tracker.push(name, block)), stream)  # type: ignore[misc]


def _finish(tracker: Tracker, stream: TextIO) -> None:
    """The end of the walk, and what was lost on the way."""
    _write(_loudly(tracker.flush), stream)
    lost = [
        (tracker.refused_fixes, "fixes came too late and were refused"),
        (tracker.missed_fixes, "times a fix was not used for a device that had been standing for long"),
        (tracker.late_steps, "steps came too late for their place in the order of time, and were used after others"),
    ]
    for count, words in lost:
        if count:
            click.echo(f"in all: {count} {words}", err=True)
    for name in tracker.unheard:
        click.echo(f"warning: {name}: no samples of accelerometer and gyroscope, which a track needs", err=True)


def _loudly(work: Callable[[], list[Update]]) -> list[Update]:
    """What the tracker warns of goes to stderr."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        updates = work()
    for warning in caught:
        click.echo(f"warning: {warning.message}", err=True)
    return updates


@contextmanager
def _lines(output: Path | None, overwrite: bool) -> Iterator[TextIO]:
    """Where the lines go, at once: a file that grows."""
    if output is None:
        yield sys.stdout
        return
    try:
        stream = output.open("w" if overwrite else "x", encoding="utf-8")
    except FileExistsError:
        raise OutputError(f"{output}: exists: choose another name, or give --overwrite") from None
    except OSError as error:
        raise OutputError(f"{output}: cannot be written ({error.strerror}): choose another name") from error
    try:
        with stream:
            yield stream
    except PdrError:
        if not output.stat().st_size:
            output.unlink()
        raise


def _write(updates: Iterable[Update], stream: TextIO) -> None:
    for update in updates:
        stream.write(json.dumps(_document(update), allow_nan=False) + "\n")
        stream.flush()


def _document(update: Update) -> dict[str, Any]:
    return {
        "kind": update.kind,
        "device": update.device,
        "time_s": round(update.time_s, 6),
        "x_m": round(float(update.position_m[0]), 4),
        "y_m": round(float(update.position_m[1]), 4),
        "heading_rad": round(update.heading_rad, 6),
        "cov_xx_m2": float(update.covariance_m2[0, 0]),
        "cov_xy_m2": float(update.covariance_m2[0, 1]),
        "cov_yy_m2": float(update.covariance_m2[1, 1]),
        "sigma_heading_rad": update.sigma_heading_rad,
        "mode": update.mode.name,
        "step_length_m": round(update.step_length_m, 4),
    }

"""`pdr-est track`: estimates while samples come, from recordings that are replayed or from phones that record."""

import json
import sys
import time
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, TextIO

import click

from pdr_est.cli.fixes import chosen_fixes
from pdr_est.cli.options import PATH, config_option, resolve_config, walker_options
from pdr_est.config import Config
from pdr_est.errors import OutputError, RecordingError
from pdr_est.io import read
from pdr_est.io.recording import DeviceRecording, Recording
from pdr_est.io.sensor_logger_live import LiveNews, LiveReader, Platform
from pdr_est.online import Tracker, Update
from pdr_est.online.replay import expected, moments
from pdr_est.records import PositionFix

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

    Each RECORDING holds the phones of one walk, all on one clock. With - the messages that Sensor Logger pushes are
    read from standard input, one a line. --estimator fixed-lag gives delayed estimates besides the filter's.
    """
    config = resolve_config(**settings)
    if _LIVE in recordings:
        if len(recordings) > 1 or realtime or fixes not in (None, "recording"):
            raise click.UsageError("- stands alone, without --realtime, and with no --fixes but recording")
        with _lines(output, overwrite) as stream:
            _follow_live(sys.stdin, config, platform, fixes is not None, stream)
        return
    if platform is not None:
        raise click.UsageError("--platform is for the phones that send to -; recordings tell theirs")
    found = [(path, read(path)) for path in recordings]
    known = [fix for path, recording in found for fix in chosen_fixes(fixes, recording, path)]
    with _lines(output, overwrite) as stream:
        _replay(found, known, config, realtime, stream)


def _replay(
    found: list[tuple[Path, Recording]], fixes: list[PositionFix], config: Config, realtime: bool, stream: TextIO
) -> None:
    devices = _devices(found)
    tracker = Tracker(config, expected(devices, ", ".join(str(path) for path, _ in found), config))
    begun_s: float | None = None
    for moment in moments(devices, fixes):
        if realtime:
            begun_s = time.monotonic() - moment.time_s if begun_s is None else begun_s
            time.sleep(max(moment.time_s + begun_s - time.monotonic(), 0.0))
        for fix in moment.fixes:
            _write(_loudly(tracker, fix), stream)
        for name, block in moment.blocks:
            _write(tracker.push(name, block), stream)
    _write(tracker.flush(), stream)


def _devices(found: list[tuple[Path, Recording]]) -> list[DeviceRecording]:
    """All devices, with the name of their file where their own are not different."""
    devices = [(path, device) for path, recording in found for device in recording.devices]
    names = [device.name for _, device in devices]
    if len(set(names)) < len(names):
        devices = [(path, replace(device, name=f"{path.stem}/{device.name}")) for path, device in devices]
    names = [device.name for _, device in devices]
    if len(set(names)) < len(names):
        raise RecordingError(f"{', '.join(names)}: phones of one walk need names of their own: rename the files")
    return [device for _, device in devices]


def _follow_live(
    lines: Iterable[str], config: Config, platform: Platform | None, with_fixes: bool, stream: TextIO
) -> None:
    reader, tracker = LiveReader(platform), Tracker(config)
    number = bad = 0
    last = ""
    for number, line in enumerate(lines, start=1):
        try:
            news = reader.push(line)
        except RecordingError as error:
            bad, last = bad + 1, str(error)
            click.echo(f"warning: line {number}: {error}: left out, {bad} so far", err=True)
            continue
        _take(news, tracker, with_fixes, stream)
    if bad == number:
        reason = (
            "standard input is empty" if number == 0 else f"none of {number} lines could be read, the last: {last}"
        )
        raise RecordingError(f"-: {reason}: send the messages of Sensor Logger's HTTP push, one a line")
    _take(reader.flush(), tracker, with_fixes, stream)
    _write(tracker.flush(), stream)


def _take(news: LiveNews, tracker: Tracker, with_fixes: bool, stream: TextIO) -> None:
    for note in news.notes:
        click.echo(f"warning: {note}", err=True)
    for fix in news.fixes if with_fixes else ():
        _write(_loudly(tracker, fix), stream)
    for name, block in news.blocks:
        _write(tracker.push(name, block), stream)


def _loudly(tracker: Tracker, fix: PositionFix) -> list[Update]:
    """Push a fix; that it was refused goes to stderr."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        updates = tracker.push_fix(fix)
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
    with stream:
        yield stream


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

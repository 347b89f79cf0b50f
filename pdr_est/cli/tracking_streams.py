"""Online tracking of a replayed recording or of live messages: one line of JSON for each estimate."""

import gc
import json
import time
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import asdict
from typing import Any, TextIO

import click

from pdr_est.cli.work.bounded_notes import BoundedNotes
from pdr_est.config import Config
from pdr_est.errors import RecordingError
from pdr_est.estimators.person.track import NAME as PERSON
from pdr_est.io.formats.phone_apps.sensor_logger.live import LiveReader, LiveUpdate, Platform
from pdr_est.online import Tracker, Update
from pdr_est.online.recording_stream import expected_devices, stream_slices
from pdr_est.preprocessing.quality.clock_requirements import explain_empty_grid
from pdr_est.types.floor_plan import BuildingPlan, FloorPlan
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import Recording
from pdr_est.types.sensors import SensorBlock
from pdr_est.types.track_output.table import HEIGHT_COLUMNS

_PHONE_OF_THAT_NAME = f"{PERSON} (phone)"


def replay(
    recorded: Recording,
    fixes: Sequence[PositionFix],
    config: Config,
    realtime: bool,
    stream: TextIO,
    plan: FloorPlan | BuildingPlan | None = None,
) -> None:
    """Replay a recording through the tracker and write its estimates.

    Parameters
    ----------
    recorded : Recording
        Recording of all devices.
    fixes : sequence of PositionFix
        Known positions.
    config : Config
        Configuration.
    realtime : bool
        Wait so that the replay is as fast as the recording was.
    stream : TextIO
        Output, which receives one line for each estimate.
    plan : FloorPlan, BuildingPlan or None
        Floor plan of the walk.

    Raises
    ------
    RecordingError
        If no device has samples that can be used.
    """
    devices = recorded.devices
    tracker = Tracker(config, expected_devices(recorded, config), plan=plan)
    begun_s: float | None = None
    for moment in stream_slices(devices, fixes):
        if realtime:
            begun_s = time.monotonic() - moment.time_s if begun_s is None else begun_s
            time.sleep(max(moment.time_s + begun_s - time.monotonic(), 0.0))
        _push(tracker, moment.fixes, moment.blocks, stream)
    _finish(tracker, stream)
    unheard = [device for device in devices if device.name in tracker.unheard]
    if len(unheard) == len(devices):
        raise explain_empty_grid(unheard[0], recorded.place_of(unheard[0]), config.resample.max_gap_s)


def follow_live(
    lines: Iterable[str],
    config: Config,
    platform: Platform | None,
    with_fixes: bool,
    stream: TextIO,
    plan: FloorPlan | BuildingPlan | None = None,
) -> None:
    """Track the messages of Sensor Logger's HTTP push and write the estimates.

    Parameters
    ----------
    lines : iterable of str
        Messages, one each.
    config : Config
        Configuration.
    platform : str or None
        Platform of the phones; None detects it.
    with_fixes : bool
        Use the positions that the phones send.
    stream : TextIO
        Output, which receives one line for each estimate.
    plan : FloorPlan, BuildingPlan or None
        Floor plan of the walk.

    Raises
    ------
    RecordingError
        If no line holds samples.
    """
    reader = LiveReader(platform, None if plan is None else plan.origin)
    tracker, told = Tracker(config, plan=plan), BoundedNotes()
    number = bad = 0
    last, heard = "", False
    gc.collect()
    gc.freeze()  # what is loaded stays: looking through it now and then would delay estimates by 100 ms
    for number, line in enumerate(_until_interrupted(lines), start=1):
        try:
            news = reader.push(line)
        except RecordingError as error:
            bad, last = bad + 1, str(error)
            told.tell(f"line {number}: {error}: line ignored, {bad} so far")
            continue
        heard = heard or bool(news.blocks)
        _process_live_news(news, tracker, with_fixes, stream, told)
    rest = reader.flush()
    if not heard and not rest.blocks:
        reason = (
            "standard input is empty"
            if number == 0
            else f"none of {number} lines holds samples, the last bad one: {last}"
        )
        raise RecordingError(f"-: {reason}: send the messages of Sensor Logger's HTTP push, one a line")
    _process_live_news(rest, tracker, with_fixes, stream, told)
    _finish(tracker, stream)


def _until_interrupted(lines: Iterable[str]) -> Iterator[str]:
    """Yield lines until a signal ends the walk, so that estimates that were held back are still printed."""
    try:
        yield from lines
    except (KeyboardInterrupt, SystemExit):
        return


def _process_live_news(
    news: LiveUpdate, tracker: Tracker, with_fixes: bool, stream: TextIO, told: BoundedNotes
) -> None:
    for note in news.notes:
        told.tell(note)
    if any(name == PERSON for name, _ in news.blocks) and _PHONE_OF_THAT_NAME not in tracker.devices:
        told.tell(f"{PERSON}: the person is called that: this phone is called {_PHONE_OF_THAT_NAME}")
    blocks = [(_PHONE_OF_THAT_NAME if name == PERSON else name, block) for name, block in news.blocks]
    _push(tracker, news.fixes if with_fixes else (), blocks, stream)


def _push(
    tracker: Tracker, fixes: Iterable[PositionFix], blocks: Iterable[tuple[str, SensorBlock]], stream: TextIO
) -> None:
    for fix in fixes:
        _write_updates(_echo_warnings(lambda fix=fix: tracker.push_fix(fix)), stream)  # type: ignore[misc]
    for name, block in blocks:
        _write_updates(_echo_warnings(lambda name=name, block=block: tracker.push(name, block)), stream)  # type: ignore[misc]


def _finish(tracker: Tracker, stream: TextIO) -> None:
    """Flush the tracker and report what was lost."""
    _write_updates(_echo_warnings(tracker.flush), stream)
    lost = [
        (tracker.refused_fixes, "fixes came too late and were rejected"),
        (tracker.missed_fixes, "times a fix was not used for a device that had not moved for long"),
        (tracker.late_steps, "steps came too late for the order of time and were used after later ones"),
    ]
    for count, words in lost:
        if count:
            click.echo(f"in total: {count} {words}", err=True)
    for name in tracker.unheard:
        click.echo(f"warning: {name}: no samples of accelerometer and gyroscope, which a track needs", err=True)


def _echo_warnings(work: Callable[[], list[Update]]) -> list[Update]:
    """Print the warnings of the tracker on stderr."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        updates = work()
    for warning in caught:
        click.echo(f"warning: {warning.message}", err=True)
    return updates


def _write_updates(updates: Iterable[Update], stream: TextIO) -> None:
    """Write a line for each update; doubtful findings are also printed on stderr."""
    for update in updates:
        for finding in update.findings:
            if finding.doubtful:
                click.echo(f"warning: {finding.words}", err=True)
        stream.write(json.dumps(_update_to_json(update), allow_nan=False) + "\n")
        stream.flush()


def _update_to_json(update: Update) -> dict[str, Any]:
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
        **_height_to_json(update),
        **({"findings": [asdict(finding) for finding in update.findings]} if update.findings else {}),
    }


def _height_to_json(update: Update) -> dict[str, Any]:
    """Return height and floor, where they are known, under the names of the columns of `track.csv`."""
    if update.height_m is None:
        return {}
    values = (update.height_m, update.sigma_height_m, update.floor, update.floor_probability)
    return dict(zip(HEIGHT_COLUMNS, values, strict=True))

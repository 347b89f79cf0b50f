"""Work of `pdr-est live`: start the server, say where it is, and smooth the walk at the end."""

import asyncio
import tempfile
import threading
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, replace
from datetime import datetime
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pdr_est.cli.fix_options import RECORDED, PlanChoice, load_fixes, tell_notes_of_plan
from pdr_est.cli.recording_part import RecordingPart
from pdr_est.cli.settings import resolve_config
from pdr_est.config import Config
from pdr_est.config.commented_yaml import config_to_yaml
from pdr_est.errors import ConfigError, PdrError
from pdr_est.io.formats.phone_apps.sensor_logger.live import Platform
from pdr_est.live.limits import LiveLimits
from pdr_est.live.recording_files import LiveRecording
from pdr_est.live.session import LiveSession
from pdr_est.online.recording_stream import expected_devices
from pdr_est.output.atomic_output import write_text
from pdr_est.types.floor_plan import BuildingPlan, FloorPlan

if TYPE_CHECKING:
    from socket import socket

    from pdr_est.live.serving import Port

_PACKAGES = ("starlette", "uvicorn", "websockets", "segno", "cryptography")
_REPLAY_SAMPLES_PER_S = 1e6


@dataclass(frozen=True)
class _Walk:
    """Walk that is shown, with what is needed to feed it and to smooth it.

    `inputs` and `fixes` give the recordings and the option --fixes of `pdr-est smooth`, `chosen` its plans.
    """

    session: LiveSession
    feed: Callable[[], None] | None
    inputs: Callable[[], tuple[Path, ...]]
    fixes: Callable[[], str | None]
    chosen: PlanChoice


def show_live(
    output: Path | None,
    host: str,
    port: int,
    phyphox_addresses: tuple[str, ...],
    platform: Platform | None,
    recordings: tuple[Path, ...],
    speed: float,
    fixes: str | None,
    plans: tuple[Path, ...],
    floor: str | None,
    **settings: Any,
) -> None:
    """Serve the page of a walk until somebody ends it."""
    missing = [name for name in _PACKAGES if find_spec(name) is None]
    if missing:
        raise ConfigError(f"pdr-est live: needs {', '.join(missing)}: install pdr-est[live]")
    if recordings and (phyphox_addresses or platform):
        raise click.UsageError("--replay takes the place of phones: leave out --phyphox and --platform")
    if not recordings and fixes not in (None, RECORDED):
        raise click.UsageError("--fixes: of phones that record now only the word recording, or with --replay a table")
    from pdr_est.live.receivers.phyphox import base_address

    config = resolve_config(**settings)
    folder = Path(f"live-{datetime.now():%Y%m%d-%H%M%S}") if output is None else output
    chosen = PlanChoice.of_options(plans, floor)
    walk = _replayed(recordings, fixes, config, speed, chosen) if recordings else None
    for address in phyphox_addresses:
        base_address(address)
    with ExitStack() as opened:  # before the folder: a port that is taken leaves none behind
        sockets = _listen(host, port, walk is None, opened)
        plan = chosen.load(None) if walk is None else None
        recording = LiveRecording(folder)
        write_text(folder / "settings.yaml", config_to_yaml(config))
        walk = _recorded(recording, config, chosen, plan) if walk is None else walk
        asyncio.run(_serve(walk, folder, host, sockets, phyphox_addresses, platform, fixes is not None))


def _recorded(
    recording: LiveRecording, config: Config, chosen: PlanChoice, plan: FloorPlan | BuildingPlan | None
) -> _Walk:
    """Make a walk of phones that record now."""
    session = LiveSession(config, recording, plan=plan)
    tell_notes_of_plan(plan)

    def fixes() -> str | None:
        return str(recording.fixes) if recording.fixes else None

    return _Walk(session, None, lambda: recording.tables, fixes, chosen)


def _replayed(
    recordings: tuple[Path, ...], fixes: str | None, config: Config, speed: float, chosen: PlanChoice
) -> _Walk:
    """Make a walk of a recording; positions that somebody states on the page are not used at the end."""
    from pdr_est.live.replaying import replay_into

    part = RecordingPart(None, None, (), None)
    recorded = part.join(part.read_files(recordings), recordings)
    known = load_fixes(fixes, recorded, recordings[0])
    limits = replace(LiveLimits(), samples_per_s=_REPLAY_SAMPLES_PER_S, phones=max(len(recorded.devices), 1))
    plan = chosen.load(recorded.origin)
    session = LiveSession(config, None, limits, expected_devices(recorded, config), plan=plan)
    tell_notes_of_plan(plan, recorded.devices)
    feed = partial(replay_into, session, recorded, known, speed)
    return _Walk(session, feed, lambda: recordings, lambda: fixes, chosen)


async def _serve(
    walk: _Walk,
    folder: Path,
    host: str,
    sockets: "list[socket]",
    phyphox_addresses: tuple[str, ...],
    platform: Platform | None,
    with_fixes: bool,
) -> None:
    from pdr_est.live.addresses import new_token
    from pdr_est.live.receivers.phyphox import PhyphoxPhone
    from pdr_est.live.receivers.pushed import PushedMessages
    from pdr_est.live.server import LiveApp
    from pdr_est.live.serving import serve_ports

    session = walk.session
    page_token, push_token = new_token(), new_token()
    pushed = PushedMessages(session, platform, with_fixes) if walk.feed is None else None
    application = LiveApp(session, pushed, page_token, push_token)
    with tempfile.TemporaryDirectory(prefix="pdr-est-") as private:
        ports = _open_ports(application, Path(private), host, sockets, page_token, push_token)
        phones = [PhyphoxPhone(session, address) for address in phyphox_addresses]
        session.start()
        for phone in phones:
            phone.start()
        if walk.feed is not None:
            threading.Thread(target=walk.feed, name="replay", daemon=True).start()
        ended = asyncio.create_task(_finish(walk, application, folder))
        await serve_ports(ports, session.limits, session.stop, _for_ever())
        session.stop()
        await ended


def _listen(host: str, port: int, may_push: bool, opened: ExitStack) -> "list[socket]":
    """Open the port of the page, and one that apps push to if the page is encrypted."""
    from pdr_est.live.addresses import is_loopback
    from pdr_est.live.serving import listen_on

    sockets = [opened.enter_context(listen_on(host, port))]
    if may_push and not is_loopback(host):
        number = sockets[0].getsockname()[1]
        sockets.append(opened.enter_context(listen_on(host, number + 1 if port else 0)))
    return sockets


def _open_ports(
    application: Any, private: Path, host: str, sockets: "list[socket]", page_token: str, push_token: str
) -> "list[Port]":
    """Say where the ports are. Others reach the page encrypted, and apps push without encryption."""
    from pdr_est.live.addresses import host_for_others, is_loopback, make_certificate, qr_code_text
    from pdr_est.live.serving import Port

    listening = sockets[0]
    number, shown = listening.getsockname()[1], host_for_others(host)
    shown = f"[{shown}]" if ":" in shown else shown
    if is_loopback(host):
        click.echo(f"page: http://{shown}:{number}/{page_token}/")
        if application.may_push:
            click.echo(f"push: http://{shown}:{number}/{push_token}/push")
        return [Port(application.pages(), listening, application.knows)]
    certificate, key = make_certificate(private, [host_for_others(host), "localhost", "127.0.0.1"])
    address = f"https://{shown}:{number}/{page_token}/"
    click.echo(f"page: {address}")
    click.echo("note: the certificate was made just now and nobody has signed it: the browser asks once to trust it")
    ports = [Port(application.pages(), listening, application.knows, certificate, key)]
    for pushing in sockets[1:]:
        click.echo(f"push: http://{shown}:{pushing.getsockname()[1]}/{push_token}/push")
        ports.append(Port(application.push_only(), pushing, application.knows))
    click.echo(qr_code_text(address))
    return ports


async def _finish(walk: _Walk, application: Any, folder: Path) -> None:
    """Wait for the end of the walk, smooth it, and tell the pages."""
    from pdr_est.live.final_report import REPORT_FILE, smooth_walk_files

    session, result = walk.session, folder / "result"
    await asyncio.to_thread(session.ended.wait)
    inputs, fixes = walk.inputs(), walk.fixes()
    if not inputs:
        session.report_ready(None)
        click.echo(f"the walk has ended: nothing was received, {folder} holds only the settings", err=True)
        return
    options = [*(["--fixes", fixes] if fixes else []), *walk.chosen.arguments]
    command = " ".join(["pdr-est smooth", *map(str, inputs), *options])
    try:
        names = await asyncio.to_thread(smooth_walk_files, inputs, options, folder / "settings.yaml", result)
    except PdrError as error:
        session.tell(str(error))
        session.report_ready(None)
        click.echo(f"warning: {error}; again with: {command} -o {result}", err=True)
        return
    application.publish_report(result, names)
    session.report_ready(f"report/{REPORT_FILE}")
    click.echo(f"the walk has ended: {result / REPORT_FILE}; Ctrl-C ends the server")


async def _for_ever() -> None:
    await asyncio.Event().wait()

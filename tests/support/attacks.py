"""Targets of the fuzz test: sound inputs, their random damage, and what must hold whatever the damage is.

Whatever comes in, a call does its work or refuses the input in words, within bounded time and memory; what it writes
is finite, its covariances are positive semidefinite and its times increase; a refused call leaves nothing behind.
"""

import io
import json
import random
import zipfile
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import app_exports
import cli_recordings
import fabricated
import numpy as np
import table_layouts
import yaml
from confined_cli import ConfinedCli, complaints
from hypothesis import strategies as st
from mutations import WORDS, Attack, mutated, mutations
from table_walk import table_walk

from pdr_est.config import Config, config_to_dict
from pdr_est.errors import PdrError
from pdr_est.estimators import ESTIMATORS, estimate_walk
from pdr_est.types.measurements import (
    DeviceMeasurements,
    DeviceTether,
    HeadingPrior,
    PositionFix,
    StartPose,
    StepOdometry,
    TurnHypothesis,
)
from pdr_est.types.track import Track

Files = Mapping[str, bytes]

_NUMBERS = (0.0, 1e-12, 1e-3, 0.7, 3.0, 100.0, 1e4)
_MOST_CHANGES = 4


def _zipped(files: Files) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    return stream.getvalue()


@cache
def _recordings() -> Mapping[str, Callable[[], Files]]:
    walk = cli_recordings.make_walk()
    exported = cli_recordings.sensor_logger(walk)
    return {
        **{name: lambda make=make: {"walk.csv": make(table_walk())} for name, make in table_layouts.CLEAN.items()},
        **{name: lambda make=make: make(fabricated.make_walk(20.0)) for name, (_, make) in app_exports.APPS.items()},
        "Sensor Logger": lambda: exported,
        "Sensor Logger, zip": lambda: {"export.zip": _zipped(exported)},
        "ILC20": lambda: {"walk.txt": cli_recordings.ilc20_log(walk, 4).encode()},
    }


@cache
def recording(name: str) -> Files:
    """Return the files of a sound recording."""
    return _recordings()[name]()


@cache
def live_messages() -> bytes:
    """Return the messages that Sensor Logger pushes in 12 s of a walk with two phones, a line each."""
    walk, lines = table_walk(), []
    for second in range(12):
        for device in ("left", "right"):
            rows = range(50 * second, 50 * second + 50)
            payload = [
                {
                    "name": name,
                    "time": cli_recordings.START_NS + round(1e9 * float(walk.time_s[i])),
                    "values": dict(zip("xyz", map(float, values[i]), strict=True)),
                }
                for i in rows
                for name, values in (
                    ("gravity", walk.gravity),
                    ("accelerometer", walk.user),
                    ("gyroscope", walk.rate),
                )
            ]
            document = {"messageId": second, "sessionId": "s", "deviceId": device, "payload": payload}
            lines.append(json.dumps(document))
    return "\n".join(lines).encode()


def _keys(values: Mapping[str, Any], above: str = "") -> list[str]:
    """List the dotted keys of all settings, sections without those within."""
    return [
        key
        for name, value in values.items()
        for key in (_keys(value, f"{above}{name}.") if isinstance(value, dict) and value else [above + name])
    ]


def _nested(values: Sequence[tuple[str, Any]]) -> dict[str, Any]:
    document: dict[str, Any] = {}
    for key, value in values:
        *sections, name = key.split(".")
        within = document
        for section in sections:
            within = within.setdefault(section, {})
        within[name] = value
    return document


_FIXES = b"time_s,x_m,y_m,sigma_m\n2.0,1.0,0.0,1.0\n10.0,9.0,0.0,1.0\n20.0,21.0,2.0,1.0\n30.0,22.0,14.0,1.0\n"
_VALUES: st.SearchStrategy[Any] = st.one_of(
    st.sampled_from([*WORDS, None, True, [], {}, [1.0, 2.0], 0, -1, 1, 10**9, 10**30, 1e-9, 0.5, 1e300]),
    st.floats(allow_nan=True, allow_infinity=True),
    st.floats(0.0, 2.0),
    st.integers(-(10**6), 10**6),
)


def attacks(target: str) -> st.SearchStrategy[Attack]:
    """Make the strategy of attacks on a target, one of `TARGETS`."""
    some = st.lists(mutations(), min_size=1, max_size=_MOST_CHANGES).map(tuple)
    none: st.SearchStrategy[Any] = st.just(())
    if target == "settings":
        pairs = st.lists(
            st.tuples(st.sampled_from(_keys(config_to_dict(Config()))), _VALUES), min_size=1, max_size=3
        ).map(tuple)
        return st.builds(Attack, st.just(target), st.just("walk"), st.one_of(none, none, some), pairs)
    if target == "measurements":
        seeds = st.tuples(st.tuples(st.just("seed"), st.integers(0, 2**32 - 1)))
        return st.builds(Attack, st.just(target), st.sampled_from(ESTIMATORS), none, seeds)
    bases = sorted(_recordings()) if target == "recording" else ["walk"]
    return st.builds(Attack, st.just(target), st.sampled_from(bases), some)


def faults(attack: Attack, cli: ConfinedCli, folder: Path) -> list[str]:
    """Carry out an attack in an empty folder, and return in words what went wrong."""
    return _CARRIED_OUT[attack.target](attack, cli, folder)


def _attack_recording(attack: Attack, cli: ConfinedCli, folder: Path) -> list[str]:
    files = dict(recording(attack.base))
    chosen = sorted(files)[attack.changes[0].other % len(files)]
    files[chosen] = mutated(files[chosen], attack.changes)
    return _smooth(cli, folder, cli_recordings.as_folder(folder / "in", files), len(files))


def _attack_fixes(attack: Attack, cli: ConfinedCli, folder: Path) -> list[str]:
    cli_recordings.as_folder(folder / "in", recording("ax, gx"))
    (folder / "fixes.csv").write_bytes(mutated(_FIXES, attack.changes))
    return _smooth(cli, folder, folder / "in", 1, "--fixes", folder / "fixes.csv")


def _attack_settings(attack: Attack, cli: ConfinedCli, folder: Path) -> list[str]:
    cli_recordings.as_folder(folder / "in", recording("ax, gx"))
    document = yaml.safe_dump(_nested(attack.values)).encode()
    (folder / "settings.yaml").write_bytes(mutated(document, attack.changes))
    return _smooth(cli, folder, folder / "in", 1, "--config", folder / "settings.yaml")


def _smooth(cli: ConfinedCli, folder: Path, inputs: Path, files: int, *options: object) -> list[str]:
    path = next(iter(inputs.iterdir())) if files == 1 else inputs
    out = folder / "out"
    answer = cli.call("smooth", path, "-o", out, "--no-report", "--start", 0, 0, "--heading", 0, *options)
    found = list(complaints(answer))
    if answer.exit_code == 0:
        return found + track_faults(Track.from_csv(out / "track.csv"))
    left = [path.name for path in folder.iterdir() if path.name.startswith((".", "out"))]
    return found + ([f"left behind: {left}"] if left else [])


def _attack_live(attack: Attack, cli: ConfinedCli, folder: Path) -> list[str]:
    answer = cli.call("track", "-", "--platform", "android", stdin=mutated(live_messages(), attack.changes))
    found = list(complaints(answer))
    for line in answer.stdout.splitlines():
        update = json.loads(line)
        numbers = [value for value in update.values() if isinstance(value, float)]
        if not np.isfinite(numbers).all() or abs(update["x_m"]) > 1e6:
            found.append(f"an estimate that cannot be: {line[:300]}")
    return found


def _attack_measurements(attack: Attack, cli: ConfinedCli, folder: Path) -> list[str]:
    draw = random.Random(dict(attack.values)["seed"])
    names = [f"phone{i}" for i in range(draw.choice((1, 1, 2)))]
    fixes = [_fix(draw) for _ in range(draw.choice((0, 0, 1, 2, 8)))]
    devices = [_device(draw, name, fixes) for name in names]
    tethers = [
        DeviceTether(
            names[0], names[1], draw.uniform(0.0, 20.0), draw.choice((0.1, 1.0, 2.0)), draw.choice((0.01, 0.3))
        )
        for _ in range(draw.choice((0, 5)) if len(names) == 2 else 0)
    ]
    start = draw.choice((StartPose(), StartPose((0.0, 0.0), 0.0), StartPose((0.0, 0.0), None, 1.0)))
    try:
        track = estimate_walk(attack.base, devices, start, draw.choice((0.01, 0.11, 1.0)), tethers)  # type: ignore[arg-type]
    except PdrError as error:
        words = str(error)
        return [] if words and "\n" not in words else [f"a refusal of several lines: {words}"]
    return track_faults(track)


def _device(draw: random.Random, name: str, fixes: Sequence[PositionFix]) -> DeviceMeasurements:
    time_s, measured = 0.0, list[Any](fixes)
    for _ in range(draw.choice((0, 1, 2, 40))):
        begin_s, time_s = time_s, time_s + draw.choice((0.4, 0.5, 0.6, 5.0))
        turn_rad, sigma_rad = draw.choice((0.0, 0.1, 1.5, -3.1)), draw.choice((0.0, 0.02, 0.5, 3.0))
        variances = [draw.choice((0.0, 1e-6, 0.01, 1.0)) for _ in range(2)]
        covariance = np.diag([*variances, sigma_rad**2])
        either = (TurnHypothesis(0.7, turn_rad, 0.1, "one"), TurnHypothesis(0.3, turn_rad + 1.0, 0.2, "other"))
        hypotheses = either if draw.random() < 0.05 else ()
        length_m = draw.choice((0.0, 0.3, 0.7, 1.5))
        measured.append(
            StepOdometry(name, time_s, begin_s, length_m, turn_rad, covariance, turn_hypotheses=hypotheses)
        )
        if draw.random() < 0.1:
            measured.append(
                HeadingPrior(
                    name, time_s, draw.uniform(-4, 4), draw.choice((1e-3, 0.1, 2.0)), relative=draw.random() < 0.5
                )
            )
    return DeviceMeasurements(name, 0.0, tuple(sorted(measured, key=lambda one: one.time_s)))


def _fix(draw: random.Random) -> PositionFix:
    position_m = np.array([draw.choice((-1, 1)) * draw.choice(_NUMBERS) for _ in range(2)])
    sigma_m = draw.choice((1e-3, 0.1, 3.0, 100.0))
    time_s = draw.uniform(-5.0, 40.0)
    wander_m = draw.choice((0.0, 0.0, 3.0))
    return PositionFix(
        time_s, position_m, sigma_m**2 * np.eye(2), draw.choice(("a", "b")), draw.random() < 0.5, wander_m
    )


def track_faults(track: Track) -> list[str]:
    """Say in words what cannot be in a track."""
    numbers = (track.time_s, track.position_m, track.heading_rad, track.covariance_m2, track.sigma_heading_rad)
    if not all(np.isfinite(values).all() for values in numbers):
        return ["numbers that are not finite"]
    if track.region is not None:
        used = track.region.weight > 0.0
        if not (np.isfinite(track.region.mean_m[used]).all() and np.isfinite(track.region.covariance_m2[used]).all()):
            return ["a region that is not finite"]
    eigenvalues = np.linalg.eigvalsh(track.covariance_m2)
    backwards = (np.diff(track.time_s) < 0.0) & (track.device[1:] == track.device[:-1])
    found = {
        "a covariance that is not positive semidefinite": (
            eigenvalues[:, 0] < -1e-9 * (eigenvalues[:, 1] + 1e-9)
        ).any(),
        "times that run backwards": backwards.any(),
    }
    return [words for words, wrong in found.items() if wrong]


_CARRIED_OUT: Mapping[str, Callable[[Attack, ConfinedCli, Path], list[str]]] = {
    "recording": _attack_recording,
    "fixes": _attack_fixes,
    "settings": _attack_settings,
    "live": _attack_live,
    "measurements": _attack_measurements,
}
TARGETS = tuple(_CARRIED_OUT)

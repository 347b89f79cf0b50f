"""A made-up walk with known attitude, and its export as the recorder apps write it."""

import json
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array

START_NS = 1_718_030_736_000_000_000


@dataclass(frozen=True)
class Walk:
    """time_s: (n,); quaternion: (n, 4) w first, device -> z up; vectors (n, 3) in device axes, Android's signs."""

    time_s: Array
    quaternion: Array
    gravity: Array
    user: Array
    rate: Array

    @property
    def force(self) -> Array:
        return self.gravity + self.user


def make_walk(duration_s: float = 8.0, rate_hz: float = 100.0, pitch_rad: float = 0.6) -> Walk:
    """A phone in the hand of somebody who walks a curve: 2 Hz bounce, swaying, tilted by `pitch_rad`."""
    time_s = np.arange(0.0, duration_s, 1.0 / rate_hz)
    yaw = 0.3 * time_s + 0.2 * np.sin(2.0 * np.pi * time_s)
    pitch = pitch_rad + 0.1 * np.sin(4.0 * np.pi * time_s)
    roll = 0.1 * np.cos(2.0 * np.pi * time_s)
    rotation = Rotation.from_euler("ZXY", np.column_stack([yaw, pitch, roll]))
    upward = 2.0 * np.sin(4.0 * np.pi * time_s)
    between = (rotation[:-1].inv() * rotation[1:]).as_rotvec() * rate_hz
    return Walk(
        time_s=time_s,
        quaternion=np.roll(rotation.as_quat(), 1, axis=1),
        gravity=rotation.inv().apply(np.tile([0.0, 0.0, STANDARD_GRAVITY_MPS2], (len(time_s), 1))),
        user=rotation.inv().apply(np.column_stack([np.zeros((len(time_s), 2)), upward])),
        rate=np.vstack([between, between[-1:]]),
    )


def table(columns: Mapping[str, Sequence[Any] | Array], separator: str = ",", decimal: str = ".") -> bytes:
    """A CSV table; floats in their shortest exact form, texts as they are."""
    rows = zip(*columns.values(), strict=True)
    lines = [separator.join(columns)]
    lines += [separator.join(_cell(value, decimal) for value in row) for row in rows]
    return ("\n".join(lines) + "\n").encode()


def _cell(value: Any, decimal: str) -> str:
    return repr(float(value)).replace(".", decimal) if isinstance(value, float | np.floating) else str(value)


def xyz(values: Array, names: Sequence[str] = ("x", "y", "z")) -> dict[str, Array]:
    return dict(zip(names, values.T, strict=True))


def as_folder(path: Path, members: Mapping[str, bytes]) -> Path:
    for name, data in members.items():
        (path / name).parent.mkdir(parents=True, exist_ok=True)
        (path / name).write_bytes(data)
    return path


def as_zip(path: Path, members: Mapping[str, bytes]) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in members.items():
            archive.writestr(name, data)
    return path


def sensor_logger_columns(
    walk: Walk, *, sign: float = 1.0, elapsed: bool = True
) -> dict[str, dict[str, Sequence[Any] | Array]]:
    """Columns of a Sensor Logger export by sensor. sign: -1 for iOS without standardisation."""
    ticks = START_NS + np.round(walk.time_s * 1e9).astype(np.int64)
    clock: dict[str, Sequence[Any] | Array] = {"time": list(ticks)}
    if elapsed:
        clock["seconds_elapsed"] = walk.time_s + 0.07

    def vector(values: Array) -> dict[str, Sequence[Any] | Array]:
        return {**clock, **xyz(values[:, ::-1], ("z", "y", "x"))}

    w, x, y, z = walk.quaternion.T
    return {
        "Accelerometer": vector(sign * walk.user),
        "Gravity": vector(sign * walk.gravity),
        "Gyroscope": vector(walk.rate),
        "Orientation": {**clock, "qz": z, "qy": y, "qx": x, "qw": w, "roll": 0 * w, "pitch": 0 * w, "yaw": 0 * w},
    }


def metadata(platform: str, standardisation: str = "false") -> dict[str, Sequence[Any]]:
    return {
        "version": ["3"],
        "device name": ["TestPhone"],
        "recording epoch time": [str(START_NS // 10**6)],
        "recording time": ["2024-06-10_14-45-36"],
        "platform": [platform],
        "appVersion": ["1.64"],
        "standardisation": [standardisation],
    }


def sensor_logger_files(columns: Mapping[str, Mapping[str, Sequence[Any] | Array]]) -> dict[str, bytes]:
    return {f"{sensor}.csv": table(of_sensor) for sensor, of_sensor in columns.items()}


def sensor_logger_json(columns: Mapping[str, Mapping[str, Sequence[Any] | Array]]) -> bytes:
    """The JSON export: one list, every value a text."""
    readings = [
        {"sensor": sensor, **{name: _cell(value, ".") for name, value in zip(of_sensor, row, strict=True)}}
        for sensor, of_sensor in columns.items()
        for row in zip(*of_sensor.values(), strict=True)
    ]
    return json.dumps(readings).encode()

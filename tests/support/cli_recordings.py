"""Small recordings of a simulated walk as tables and exports, whole and damaged."""

import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pdr_est.frames import Array
from pdr_est.simulate import DeviceParams, Scenario, SensorParams, simulate_walk
from pdr_est.simulate.walker.walking_path import PathParams

TIME = ("time_s",)
ACC = ("acc_x_mps2", "acc_y_mps2", "acc_z_mps2")
GYR = ("gyr_x_radps", "gyr_y_radps", "gyr_z_radps")
QUATERNION = ("qw", "qx", "qy", "qz")
START_NS = 1_718_030_736_000_000_000


@dataclass(frozen=True)
class Walk:
    """A straight walk of 12 m at 50 Hz with one clock for all sensors.

    time_s: (n,) from 0; force, rate: (n, 3); attitude: (n, 4) w first; true_time_s, true_m: (m,), (m, 2).
    """

    time_s: Array
    force: Array
    rate: Array
    attitude: Array
    true_time_s: Array
    true_m: Array


def make_walk() -> Walk:
    sensors = SensorParams(rate_hz=50.0, time_jitter_s=0.0, record_attitude=True)
    scenario = Scenario(
        path=PathParams(vertices_m=((0.0, 0.0), (12.0, 0.0))), devices=(DeviceParams(sensors=sensors),)
    )
    recording = simulate_walk(scenario).recording
    device, truth = recording.devices[0], recording.truth.positions
    assert device.specific_force is not None
    assert device.rotation_rate is not None
    assert device.attitude is not None
    assert truth is not None
    time_s = np.round(device.specific_force.time_s - device.specific_force.time_s[0], 6)
    n = min(len(device.specific_force), len(device.rotation_rate), len(device.attitude))
    return Walk(
        time_s=time_s[:n],
        force=device.specific_force.values[:n],
        rate=device.rotation_rate.values[:n],
        attitude=device.attitude.values[:n],
        true_time_s=truth.time_s,
        true_m=truth.position_m,
    )


def lines_of(columns: Mapping[str, Array]) -> list[str]:
    """A table as lines of text, the header first. columns: title -> (n,)."""
    rows = np.column_stack(list(columns.values()))
    return [",".join(columns), *(",".join(repr(float(cell)) for cell in row) for row in rows)]


def columns_of(
    walk: Walk, *, time_s: Array | None = None, force: Array | None = None, rate: Array | None = None
) -> dict[str, Array]:
    """The documented columns of accelerometer and gyroscope, with some of them replaced."""
    time_s = walk.time_s if time_s is None else time_s
    force = walk.force if force is None else force
    rate = walk.rate if rate is None else rate
    return {"time_s": time_s, **_axes(ACC, force), **_axes(GYR, rate)}


def with_attitude(walk: Walk) -> dict[str, Array]:
    return columns_of(walk) | _axes(QUATERNION, walk.attitude)


def save(path: Path, lines: Sequence[str], end: str = "\n") -> Path:
    path.write_text(end.join([*lines, ""]), encoding="utf-8", newline="")
    return path


def with_cell(lines: Sequence[str], line: int, column: int, text: str) -> list[str]:
    """The lines with one cell replaced. line: counted from 1 with the header; column: from 0."""
    cells = lines[line - 1].split(",")
    cells[column] = text
    return [*lines[: line - 1], ",".join(cells), *lines[line:]]


def sensor_logger(walk: Walk, delay_s: Mapping[str, float] | None = None) -> dict[str, bytes]:
    """An Android export by Sensor Logger with a position every two seconds. delay_s: of a sensor's clock."""
    late = delay_s or {}
    sensors = {
        "TotalAcceleration": _axes(("x", "y", "z"), walk.force),
        "Gyroscope": _axes(("x", "y", "z"), walk.rate),
        "Magnetometer": _axes(("x", "y", "z"), walk.force + 30.0),
        "Orientation": _axes(QUATERNION, walk.attitude),
    }
    files = {
        f"{name}.csv": _sensor_table(walk.time_s + late.get(name, 0.0), columns) for name, columns in sensors.items()
    }
    at_s = np.arange(1.0, walk.time_s[-1], 2.0)
    north_m = np.interp(at_s, walk.true_time_s, walk.true_m[:, 0]) + 0.1 * at_s  # never the same place twice
    place = {"latitude": 48.0 + north_m / 111_195.0, "longitude": np.full(len(at_s), 11.0)}
    files["Location.csv"] = _sensor_table(at_s, place | {"horizontalAccuracy": np.full(len(at_s), 3.0)})
    files["Metadata.csv"] = b"version,device name,platform\n3,TestPhone,android\n"
    return files


def as_zip(path: Path, members: Mapping[str, bytes]) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in members.items():
            archive.writestr(name, data)
    return path


def as_folder(path: Path, members: Mapping[str, bytes]) -> Path:
    for name, data in members.items():
        (path / name).parent.mkdir(parents=True, exist_ok=True)
        (path / name).write_bytes(data)
    return path


def ilc20_log(walk: Walk, n_waypoints: int) -> str:
    """A log of the Indoor Location Competition with waypoints at equal intervals."""
    start_ms = START_NS // 10**6
    rows = [
        (time_s, f"{start_ms + round(1e3 * time_s)}\t{tag}\t{x}\t{y}\t{z}\t3")
        for tag, values in (("TYPE_ACCELEROMETER", walk.force), ("TYPE_GYROSCOPE", walk.rate))
        for time_s, (x, y, z) in zip(walk.time_s, values, strict=True)
    ]
    for time_s in np.linspace(walk.time_s[0], walk.time_s[-1], n_waypoints):
        x, y = (np.interp(time_s, walk.true_time_s, walk.true_m[:, axis]) for axis in (0, 1))
        rows.append((time_s, f"{start_ms + round(1e3 * time_s)}\tTYPE_WAYPOINT\t{x}\t{y}"))
    return "\n".join([f"#\tstartTime:{start_ms}", *(row for _, row in sorted(rows)), ""])


def _axes(names: Sequence[str], values: Array) -> dict[str, Array]:
    return dict(zip(names, values.T, strict=True))


def _sensor_table(time_s: Array, columns: Mapping[str, Array]) -> bytes:
    lines = [f"time,seconds_elapsed,{','.join(columns)}"]
    for moment_s, row in zip(time_s, np.column_stack(list(columns.values())), strict=True):
        ticks = START_NS + round(1e9 * float(moment_s))
        lines.append(",".join([str(ticks), repr(float(moment_s)), *(repr(float(cell)) for cell in row)]))
    return ("\n".join(lines) + "\n").encode()

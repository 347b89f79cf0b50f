"""A simulated walk of about 40 s with a turn, as columns from which tests write tables of every layout."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array, up_in_device
from pdr_est.simulate import DeviceParams, Scenario, SensorParams, simulate_walk
from pdr_est.simulate.walker.walking_path import PathParams

RATE_HZ = 50.0
DATE_FORM = "{y}-{m}-{d} {H}:{M}:{S}.{ms}"


@dataclass(frozen=True)
class TableWalk:
    """time_s: (n,) from 0 at 50 Hz; force, rate, gravity: (n, 3) m/s², rad/s, Android's signs; attitude: (n, 4)."""

    time_s: Array
    force: Array
    rate: Array
    gravity: Array
    attitude: Array

    @property
    def user(self) -> Array:
        return self.force - self.gravity

    @property
    def field(self) -> Array:
        """A magnetic field of 50 uT that is seen from the attitude."""
        return 5.0 * self.gravity + np.array([20.0, 5.0, 1.0])


@cache
def table_walk() -> TableWalk:
    sensors = SensorParams(rate_hz=RATE_HZ, time_jitter_s=0.0, record_attitude=True)
    path = PathParams(vertices_m=((0.0, 0.0), (22.0, 0.0), (22.0, 24.0)))
    device = simulate_walk(Scenario(path=path, devices=(DeviceParams(sensors=sensors),))).recording.devices[0]
    assert device.specific_force is not None
    assert device.rotation_rate is not None
    assert device.attitude is not None
    n = min(len(device.specific_force), len(device.rotation_rate), len(device.attitude), 2000)
    attitude = device.attitude.values[:n]
    return TableWalk(
        time_s=np.round(np.arange(n) / RATE_HZ, 6),
        force=np.round(device.specific_force.values[:n], 6),
        rate=np.round(device.rotation_rate.values[:n], 6),
        gravity=np.round(STANDARD_GRAVITY_MPS2 * up_in_device(attitude), 6),
        attitude=np.round(attitude, 6),
    )


def axes(titles: Sequence[str], values: Array) -> dict[str, Any]:
    """Columns of a vector, one title an axis."""
    return dict(zip(titles, values.T, strict=True))


def xyz(pattern: str, values: Array, names: str = "xyz") -> dict[str, Any]:
    """Columns of a vector by a pattern with {} for the axis."""
    return axes([pattern.format(name) for name in names], values)


def rows(columns: Mapping[str, Sequence[Any] | Array], separator: str = ",", decimal: str = ".") -> list[str]:
    """Lines of a table, the header first; floats with nine digits, everything else as it is."""
    lines = [separator.join(columns)]
    for row in zip(*columns.values(), strict=True):
        lines.append(separator.join(cell(value, decimal) for value in row))
    return lines


def cell(value: Any, decimal: str = ".") -> str:
    return f"{value:.9g}".replace(".", decimal) if isinstance(value, float | np.floating) else str(value)


def dates(time_s: Array, form: str = DATE_FORM, start: str = "2031-02-03T04:05:06.789") -> list[str]:
    """Times as text; {h} is the hour without a zero in front, {b} the name of the month."""
    stamps = np.datetime64(start, "ms") + np.round(time_s * 1000.0).astype("timedelta64[ms]")
    result = []
    for stamp in stamps.tolist():
        result.append(
            form.format(
                y=stamp.year,
                m=f"{stamp.month:02d}",
                d=f"{stamp.day:02d}",
                b=stamp.strftime("%b"),
                H=f"{stamp.hour:02d}",
                h=stamp.hour,
                M=f"{stamp.minute:02d}",
                S=f"{stamp.second:02d}",
                ms=f"{stamp.microsecond // 1000:03d}",
            )
        )
    return result

"""Random spellings of one table: names, order, units, clocks, separators and columns that mean nothing."""

import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from table_walk import TableWalk, cell, dates

from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array

DEG = np.pi / 180.0
FORCE_NAMES = (
    "acc_{}", "Acc{U}", "accel_{}", "Accelerometer {U}", "acceleration_{}", "ACCELEROMETER {U}", "a{}", "{}_acc",
    "{U}-Acceleration", "accelerometer.{}", "linear_acceleration.{}", "Beschleunigung {}", "加速度{U}",
    "aceleración {}", "accélération {}", "acc[{i}]", "imu_acc_{}", "accelerationIncludingGravity.{}", "acc1_{}",
    "{U}軸加速度", "{U}轴加速度", "가속도 {U}", "Акселерометр {U}", "ускорение {}", "aceleração {}", "versnelling {}",
    "przyspieszenie {}", "Beschleunigung in {}-Richtung", "{U}-axis acceleration", "accelerazione asse {}", "ACC{U}1",
)  # fmt: skip
RATE_NAMES = (
    "gyro_{}", "Gyr{U}", "gyr_{}", "Gyroscope {U}", "rotationRate.{}", "GYROSCOPE {U}", "w{}", "{}_gyro", "omega_{}",
    "angular_velocity.{}", "ang_vel_{}", "angularVelocity{U}", "Winkelgeschwindigkeit {}", "角速度{U}",
    "giroscopio {}", "vitesse angulaire {}", "gyro[{i}]", "imu_gyro_{}", "g{}", "gyr1_{}", "ω_{}", "ω{}",
    "Giróscopo {}", "{U}軸角速度", "{U}轴角速度", "각속도 {U}", "Гироскоп {U}", "угловая скорость {}", "Żyroskop {U}",
    "hoeksnelheid {}", "{U}-axis angular velocity", "velocità angolare {}", "velocidade angular {}", "GYRO{U}1",
)  # fmt: skip
FORCE_UNITS = {
    "m/s^2": 1.0, "m/s²": 1.0, "m/s2": 1.0, "m.s-2": 1.0, "m s^-2": 1.0, "meters per second squared": 1.0,
    "g": STANDARD_GRAVITY_MPS2, "mg": STANDARD_GRAVITY_MPS2 / 1e3, "g's": STANDARD_GRAVITY_MPS2,
}  # fmt: skip
RATE_UNITS = {
    "rad/s": 1.0, "rad.s-1": 1.0, "rad s⁻¹": 1.0, "radians per second": 1.0, "deg/s": DEG, "°/s": DEG, "dps": DEG,
    "degrees/sec": DEG, "mdps": DEG / 1e3,
}  # fmt: skip
SUFFIXES = {"m/s^2": "mps2", "g": "g", "mg": "mg", "rad/s": "radps", "deg/s": "dps", "mdps": "mdps"}
UNIT_STYLES = (
    "{name} ({unit})", "{name} [{unit}]", "{name}[{unit}]", "{name}_{suffix}", "{name} {{{unit}}}",
    "{name} in {unit}", "{name} / {unit}", "{name}: {unit}",
)  # fmt: skip
DATE_FORMS = (
    "{y}-{m}-{d} {H}:{M}:{S}.{ms}", "{y}-{m}-{d}T{H}:{M}:{S}.{ms}Z", "{y}/{m}/{d} {H}:{M}:{S}.{ms}",
    "{d}.{m}.{y} {H}:{M}:{S}.{ms}", "{d}-{b}-{y} {H}:{M}:{S}.{ms}", "{y}-{m}-{d} {h}:{M}:{S}.{ms}",
    "{y}-{m}-{d} {H}:{M}:{S}:{ms}", "{y}{m}{d}_{H}{M}{S}_{ms}", "{H}:{M}:{S}.{ms}",
)  # fmt: skip


@dataclass(frozen=True)
class SpeltTable:
    """data: the file; title and description say what was done, for messages of a failing test."""

    data: bytes
    header: str


def spelt_table(walk: TableWalk, draw: random.Random) -> SpeltTable:
    """A table of the walk in a random spelling; everything in it can be understood."""
    columns = [
        _clock(walk, draw),
        *_sensor(walk.force, FORCE_NAMES, FORCE_UNITS, draw),
        *_sensor(walk.rate, RATE_NAMES, RATE_UNITS, draw),
        *_junk(walk, draw),
    ]
    if len({title for title, _ in columns}) < len(columns):
        return spelt_table(walk, draw)
    draw.shuffle(columns)
    separator, decimal = draw.choice(((",", "."), (";", "."), ("\t", "."), (";", ","), ("|", ".")))
    lines = [separator.join(title for title, _ in columns)]
    lines += [separator.join(row) for row in zip(*(_cells(values, decimal) for _, values in columns), strict=True)]
    above = draw.choice(([], [], [""], ["# recorded by a test"], ["My logger 1.2", "Start: today"]))
    encoding = draw.choice(("utf-8", "utf-8", "utf-8-sig", "utf-16"))
    return SpeltTable(draw.choice(("\n", "\r\n")).join([*above, *lines, ""]).encode(encoding), lines[0])


def _cells(values: Sequence[Any] | Array, decimal: str) -> list[str]:
    return [cell(value, decimal) for value in values]


def _sensor(
    values: Array, names: Sequence[str], units: dict[str, float], draw: random.Random
) -> list[tuple[str, Array]]:
    """Three columns: one name and unit for all, and about half of them with another name or stated unit."""
    usual_name, usual_unit = draw.choice(names), draw.choice(list(units))
    usual_style = draw.choice((None, *UNIT_STYLES))
    columns = []
    for i, axis in enumerate("xyz"):
        name, unit, style = usual_name, usual_unit, usual_style
        if draw.random() < 0.5:
            name = draw.choice(names)
            if draw.random() < 0.5:
                unit, style = draw.choice(list(units)), draw.choice(UNIT_STYLES)
        title = name.format(axis, U=axis.upper(), i=i)
        if style is not None and (unit in SUFFIXES or "suffix" not in style):
            title = style.format(name=title, unit=unit, suffix=SUFFIXES.get(unit, ""))
        elif style is not None:
            title = f"{title} ({unit})"
        columns.append((title, values[:, i] / units[unit]))
    return columns


def _clock(walk: TableWalk, draw: random.Random) -> tuple[str, Any]:
    """The time in a random unit, from zero, since boot or since 1970, or as a date."""
    kind = draw.choice(("s", "ms", "us", "ns", "date"))
    name = draw.choice(("time", "Timestamp", "t", "Time", "zeit", "时间", "tiempo", "temps", "время", "czas", "시간"))
    if kind == "date":
        return name, dates(walk.time_s, draw.choice(DATE_FORMS))
    if draw.random() < 0.5:
        name = draw.choice(("{} ({})", "{} [{}]", "{}_{}")).format(name, kind)
    start_ns = draw.choice((0, 0, 77_000_000_000, 1_898_772_976_119_087_000, 1_927_000_000_000_000_000))
    per_tick = {"s": 10**9, "ms": 10**6, "us": 10**3, "ns": 1}[kind]
    ticks_ns = start_ns + np.round(walk.time_s * 1e9).astype(np.int64)
    if kind == "s":
        return name, [f"{tick // 10**9}.{tick % 10**9:09d}"[:-3] for tick in ticks_ns.tolist()]
    return name, (ticks_ns // per_tick).tolist()


def _junk(walk: TableWalk, draw: random.Random) -> list[tuple[str, Any]]:
    """Columns that mean nothing here, or another sensor."""
    n = len(walk.time_s)
    makers: dict[str, Callable[[], Any]] = {
        "index": lambda: list(range(n)),
        "label": lambda: ["walking"] * n,
        "battery": lambda: [97] * n,
        "temperature": lambda: np.full(n, 25.5),
        "mag_x,mag_y,mag_z": lambda: walk.field,
        "pressure": lambda: np.full(n, 1008.25),
        "step_count": lambda: (np.arange(n) // 30).tolist(),
        "heart_rate": lambda: ["None"] * n,
    }
    columns: list[tuple[str, Any]] = []
    for titles in draw.sample(list(makers), draw.randint(0, 4)):
        values = makers[titles]()
        names = titles.split(",")
        columns += [(names[0], values)] if len(names) == 1 else list(zip(names, np.asarray(values).T, strict=True))
    return columns

"""The simulated walk in every layout of a plain table that was found in the wild, one function a layout."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from table_walk import TableWalk, dates, rows, xyz

from pdr_est.frames import STANDARD_GRAVITY_MPS2 as G
from pdr_est.frames import Array

DEG = np.pi / 180.0
BOOT_22_DAYS_NS = 1_898_772_976_119_087
UNIX_NS = 1_927_000_000_000_000_000
Columns = Mapping[str, Sequence[Any] | Array]


def text(lines: Sequence[str], encoding: str = "utf-8") -> bytes:
    return ("\n".join(lines) + "\n").encode(encoding)


def plain(walk: TableWalk, time: Any = None, title: str = "time") -> dict[str, Any]:
    """Columns time, acc_x …, gyro_x … in s, m/s² and rad/s."""
    clock = walk.time_s if time is None else time
    return {title: clock, **xyz("acc_{}", walk.force), **xyz("gyro_{}", walk.rate)}


def ticks(walk: TableWalk, per_s: int, start: int) -> list[int]:
    return (start + np.round(walk.time_s * per_s).astype(np.int64)).tolist()


def user_and_gravity(walk: TableWalk) -> bytes:
    """Core Motion: gravity and user acceleration in g, Apple's sign."""
    return text(
        rows(
            {
                "timestamp": walk.time_s,
                **xyz("userAcceleration.{}", -walk.user / G),
                **xyz("gravity.{}", -walk.gravity / G),
                **xyz("rotationRate.{}", walk.rate),
            }
        )
    )


def wrist_motion(walk: TableWalk) -> bytes:
    """The watch of Sensor Logger: `acceleration` is without gravity."""
    columns = {
        "time": ticks(walk, 10**9, UNIX_NS),
        "seconds_elapsed": [f"np.float64({t})" for t in walk.time_s],
        **{f"rotationRate{axis}": walk.rate[:, i] for i, axis in enumerate("XYZ")},
        **{f"gravity{axis}": -walk.gravity[:, i] / G for i, axis in enumerate("XYZ")},
        **{f"acceleration{axis}": -walk.user[:, i] / G for i, axis in enumerate("XYZ")},
    }
    return text(rows(columns))


def table_of(
    force: str, rate: str, *, time: str = "time", force_unit: float = 1.0, rate_unit: float = 1.0, names: str = "xyz"
) -> Callable[[TableWalk], bytes]:
    """A layout with titles by pattern and values in units."""

    def make(walk: TableWalk) -> bytes:
        columns = {
            time: walk.time_s,
            **xyz(force, walk.force / force_unit, names),
            **xyz(rate, walk.rate / rate_unit, names),
        }
        return text(rows(columns))

    return make


def physics_toolbox(walk: TableWalk) -> bytes:
    columns = {
        "time": walk.time_s,
        **xyz("gF{}", walk.force / G),
        **xyz("a{}", walk.user),
        **xyz("w{}", walk.rate),
    }
    return text(rows(columns))


def physics_toolbox_blank_line(walk: TableWalk) -> bytes:
    columns = {
        "time": walk.time_s,
        **xyz("gF{}", walk.force / G),
        **xyz("w{}", walk.rate),
        **xyz("B{}", walk.field),
        "": [""] * len(walk.time_s),
    }
    return text(["", *rows(columns)])


def physics_toolbox_ios(walk: TableWalk) -> bytes:
    stamps = dates(walk.time_s, "{y}-{m}-{d} {h}:{M}:{S}.{ms}0")
    stamps[0] = ""
    return text(rows({"time": stamps, **xyz("gF{}", -walk.force / G), **xyz("w{}", walk.rate)}))


def clock_layout(form: str) -> Callable[[TableWalk], bytes]:
    return lambda walk: text(rows(plain(walk, dates(walk.time_s, form))))


def two_time_columns(walk: TableWalk) -> bytes:
    columns = {
        "timestamp": dates(walk.time_s, "{y}-{m}-{d} {H}:{M}:{S}"),
        "milliseconds": ticks(walk, 1000, 1),
        **xyz("acc_{}", walk.force),
        **xyz("gyro_{}", walk.rate),
    }
    return text(rows(columns))


def seconds_and_nanoseconds(walk: TableWalk) -> bytes:
    stamps = ticks(walk, 10**9, UNIX_NS + 123_456_789)
    columns = {
        "header.stamp.secs": [stamp // 10**9 for stamp in stamps],
        "header.stamp.nsecs": [stamp % 10**9 for stamp in stamps],
        **xyz("linear_acceleration.{}", walk.force),
        **xyz("angular_velocity.{}", walk.rate),
    }
    return text(rows(columns))


def date_and_time_columns(walk: TableWalk) -> bytes:
    columns = {
        "Date": dates(walk.time_s, "{d}/{m}/{y}"),
        "Time": dates(walk.time_s, "{H}:{M}:{S}.{ms}"),
        **xyz("acc_{}", walk.force),
        **xyz("gyro_{}", walk.rate),
    }
    return text(rows(columns))


def over_midnight(walk: TableWalk) -> bytes:
    return text(rows(plain(walk, dates(walk.time_s, "{H}:{M}:{S}.{ms}", "2031-02-03T23:59:50.000"))))


def with_cells(walk: TableWalk, word: str) -> bytes:
    """The accelerometer misses every tenth sample."""
    columns = plain(walk)
    columns["acc_x"] = [word if i % 10 == 5 else f"{x:.6f}" for i, x in enumerate(walk.force[:, 0])]
    return text(rows(columns))


def euroc(walk: TableWalk) -> bytes:
    columns = {
        "#timestamp [ns]": ticks(walk, 10**9, UNIX_NS),
        **xyz("w_RS_S_{} [rad s^-1]", walk.rate),
        **xyz("a_RS_S_{} [m s^-2]", walk.force),
    }
    return text(rows(columns))


def long_table(walk: TableWalk) -> bytes:
    lines = ["timestamp,sensor,x,y,z"]
    for i, tick in enumerate(ticks(walk, 1000, UNIX_NS // 10**6)):
        for name, values, delay in (("Accelerometer", walk.force, 0), ("Gyroscope", walk.rate, 3)):
            lines.append(f"{tick + delay},{name}," + ",".join(f"{value:.6f}" for value in values[i]))
    return text(lines)


def android_types(walk: TableWalk) -> bytes:
    """A long table with the numbers of Android's sensor types, and a sensor that nobody uses."""
    lines = ["sensor_type;time_ns;v0;v1;v2"]
    for i, tick in enumerate(ticks(walk, 10**9, BOOT_22_DAYS_NS)):
        for number, values in ((1, walk.force), (4, walk.rate), (5, walk.rate)):
            lines.append(f"{number};{tick};" + ";".join(f"{value:.6f}" for value in values[i]))
    return text(lines)


def tagged_rows(walk: TableWalk) -> bytes:
    lines = ["$COL,IMU,time,wx,wy,wz,ax,ay,az,temp", "$UNIT,IMU,s,deg/s,deg/s,deg/s,g,g,g,deg C", "$DATA"]
    for i, t in enumerate(walk.time_s):
        cells = ",".join(f"{value:.7f}" for value in (*(walk.rate[i] / DEG), *(walk.force[i] / G)))
        lines.append(f"$IMU,{t:.3f},{cells},25.0")
        if i % 50 == 0:
            lines.append(f"$VBAT,{t:.3f},4.1")
    return text(lines)


def prefix_rows(walk: TableWalk) -> bytes:
    """Rows that begin with the sensor's name, without titles, as many loggers write them."""
    lines = []
    for i, tick in enumerate(ticks(walk, 1000, UNIX_NS // 10**6)):
        for name, values in (("ACC", walk.force), ("GYR", walk.rate)):
            lines.append(f"{name},{tick}," + ",".join(f"{value:.6f}" for value in values[i]))
    return text(lines)


def xsens_dot(walk: TableWalk) -> bytes:
    columns = {
        "PacketCounter": list(range(len(walk.time_s))),
        "SampleTimeFine": ticks(walk, 10**6, 3_000_000_000),
        "Euler_X": np.ones(len(walk.time_s)),
        **xyz("Acc_{}", walk.force, "XYZ"),
        **xyz("Gyr_{}", walk.rate / DEG, "XYZ"),
    }
    return text(["sep=,", "DeviceTag:,DOT A", "OutputRate:,50Hz", "", *rows(columns)])


def browser(walk: TableWalk) -> bytes:
    """DeviceMotion events: alpha turns about z, beta about x, gamma about y."""
    columns = {
        "timeStamp": 1000.0 * walk.time_s,
        **xyz("accelerationIncludingGravity.{}", walk.force),
        **xyz("acceleration.{}", walk.user),
        "rotationRate.alpha": walk.rate[:, 2] / DEG,
        "rotationRate.beta": walk.rate[:, 0] / DEG,
        "rotationRate.gamma": walk.rate[:, 1] / DEG,
    }
    return text(rows(columns))


def browser_in_order(walk: TableWalk) -> bytes:
    """DeviceMotion events of a browser whose alpha turns about x."""
    columns = {
        "timeStamp": 1000.0 * walk.time_s,
        **xyz("accelerationIncludingGravity.{}", walk.force),
        **{f"rotationRate.{name}": walk.rate[:, i] / DEG for i, name in enumerate(("alpha", "beta", "gamma"))},
    }
    return text(rows(columns))


def quoted_decimal_commas(walk: TableWalk) -> bytes:
    lines = rows(plain(walk), separator="|", decimal=",")
    return text([lines[0].replace("|", ","), *('"' + line.replace("|", '","') + '"' for line in lines[1:])])


def edited(edit: Callable[[list[str]], list[str]]) -> Callable[[TableWalk], bytes]:
    """The plain table with changed lines."""
    return lambda walk: text(edit(rows(plain(walk))))


CLEAN: Mapping[str, Callable[[TableWalk], bytes]] = {
    "user acceleration and gravity": user_and_gravity,
    "WristMotion": wrist_motion,
    "ax, gx": table_of("a{}", "g{}"),
    "ax in g, gx in deg/s": table_of("a{}", "g{}", force_unit=G, rate_unit=DEG),
    "ax, wx": table_of("a{}", "w{}"),
    "accel_x, ang_vel_x": table_of("accel_{}", "ang_vel_{}"),
    "Physics Toolbox": physics_toolbox,
    "Physics Toolbox, blank line": physics_toolbox_blank_line,
    "mg and mdps": table_of("acc_{}", "gyro_{}", force_unit=G / 1000.0, rate_unit=DEG / 1000.0),
    "mg and mdps in titles": table_of("acc_{} (mg)", "gyro_{} (mdps)", force_unit=G / 1000.0, rate_unit=DEG / 1000.0),
    "boot clock in ns": lambda w: text(rows(plain(w, ticks(w, 10**9, BOOT_22_DAYS_NS), "timestamp"))),
    "boot clock in ms": lambda w: text(rows(plain(w, ticks(w, 1000, BOOT_22_DAYS_NS // 10**6), "timestamp"))),
    "boot clock in us": lambda w: text(rows(plain(w, ticks(w, 10**6, BOOT_22_DAYS_NS // 10**3), "timestamp"))),
    "two time columns": two_time_columns,
    "seconds and nanoseconds": seconds_and_nanoseconds,
    "date and time of day in two columns": date_and_time_columns,
    "time of day over midnight": over_midnight,
    "UTF-16": lambda w: text(rows(plain(w)), "utf-16"),
    "UTF-16 without a mark": lambda w: text(rows(plain(w)), "utf-16-be"),
    "byte-order mark": lambda w: text(rows(plain(w)), "utf-8-sig"),
    "Latin-1 units": lambda w: text(
        rows({"t": w.time_s, **xyz("acc {} (m/s²)", w.force), **xyz("gyro {} (°/s)", w.rate / DEG)}), "latin-1"
    ),
    "units in the wrong encoding": lambda w: text(
        rows({"t": w.time_s, **xyz("acc {} (m/sÂ²)", w.force), **xyz("gyro {} (Â°/s)", w.rate / DEG)})
    ),
    "NULs at the beginning": lambda w: b"\0\0\0\0" + text(rows(plain(w))),
    "CR at the ends of lines": lambda w: text(rows(plain(w))).replace(b"\n", b"\r"),
    "blank lines first": edited(lambda lines: ["", "", "", *lines]),
    "prose first": edited(lambda lines: ["Recorded with MyLogger 1.2", "Start,2031-02-03 04:05:06", *lines]),
    "sep=": edited(lambda lines: ["sep=,", *lines]),
    "comment lines": edited(lambda lines: ["# a", "# b, c", *lines]),
    "a row of units": edited(lambda lines: [lines[0], "s,m/s^2,m/s^2,m/s^2,rad/s,rad/s,rad/s", *lines[1:]]),
    "trailing separators": edited(lambda lines: [lines[0], *(line + "," for line in lines[1:])]),
    "date with a colon before ms": clock_layout("{y}-{m}-{d} {H}:{M}:{S}:{ms}"),
    "MATLAB's date": clock_layout("{d}-{b}-{y} {H}:{M}:{S}.{ms}"),
    "date with slashes": clock_layout("{y}/{m}/{d} {H}:{M}:{S}.{ms}"),
    "German date": clock_layout("{d}.{m}.{y} {H}:{M}:{S}.{ms}"),
    "hour of one digit": clock_layout("{y}-{m}-{d} {h}:{M}:{S}.{ms}0"),
    "date without separators": clock_layout("{y}{m}{d}_{H}{M}{S}_{ms}"),
    "time of day": clock_layout("{H}:{M}:{S}.{ms}"),
    "ISO 8601": clock_layout("{y}-{m}-{d}T{H}:{M}:{S}.{ms}+01:00"),
    "ROS": table_of("linear_acceleration.{}", "angular_velocity.{}", time="timestamp"),
    "x_acc": table_of("{}_acc", "{}_gyro", time="timestamp"),
    "acc_x_g": table_of("acc_{}_g", "gyro_{}_dps", time="time_s", force_unit=G, rate_unit=DEG),
    "EuRoC": euroc,
    "LinearX with gravity": table_of(
        " Linear{}", " Angular{}", time="Timestamp", force_unit=G, rate_unit=DEG, names="XYZ"
    ),
    "linX, angX": table_of("lin{}", "ang{}", names="XYZ"),
    "German": table_of("Beschleunigung {} (m/s²)", "Winkelgeschwindigkeit {} (rad/s)", time="Zeit (s)"),
    "Chinese": table_of("加速度{}", "角速度{}", time="时间", names="XYZ"),
    "Japanese": table_of("加速度センサー{}軸", "ジャイロ{}軸", time="時刻", names="XYZ"),
    "Spanish": table_of("aceleración {}", "giroscopio {}", time="tiempo (s)"),
    "French": table_of("accélération {}", "vitesse angulaire {}", time="temps (s)"),
    "brackets count axes": table_of("accel[{}]", "gyro[{}]", names="012"),
    "browser": browser,
    "browser that counts x, y, z": browser_in_order,
    "Chinese in GB 18030": lambda w: text(
        rows(
            {
                "时间": dates(w.time_s),
                **xyz("加速度{}(g)", w.force / G, "XYZ"),
                **xyz("角速度{}(°/s)", w.rate / DEG, "XYZ"),
            }
        ),
        "gb18030",
    ),
    "days of a spreadsheet": lambda w: text(rows(plain(w, [f"{47882.17 + t / 86400.0:.9f}" for t in w.time_s]))),
    "axes without a name beside gx": table_of("{}", "g{}"),
    "row numbers in front": edited(lambda lines: ["," + lines[0], *(f"{i},{x}" for i, x in enumerate(lines[1:]))]),
    "quoted cells": edited(lambda lines: ['"' + line.replace(",", '","') + '"' for line in lines]),
    "blanks between date and time": lambda w: text(
        [line.replace(",", " ") for line in rows({"stamp": dates(w.time_s), **plain(w, title="t")} | {"t": w.time_s})]
    ),
    "quoted decimal commas": quoted_decimal_commas,
    "semicolon and decimal comma": lambda w: text(rows(plain(w), ";", ",")),
    "pipes": lambda w: text(rows(plain(w), "|")),
    "runs of blanks": lambda w: text([line.replace(",", "   ") for line in rows(plain(w))]),
    "long table": long_table,
    "long table with Android's types": android_types,
    "tagged rows": tagged_rows,
    "rows that begin with the sensor": prefix_rows,
    "Xsens DOT": xsens_dot,
}
"""Layouts that hold the walk without anything to complain of."""

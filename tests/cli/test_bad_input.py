"""Whatever is wrong with an input: one line with file, place and remedy, exit code 2, and nothing is left behind."""

import gzip
import os
import re
import struct
from pathlib import Path

import numpy as np
import pytest
from cli_recordings import (
    ACC,
    GYR,
    Walk,
    as_zip,
    columns_of,
    lines_of,
    save,
    sensor_logger,
    with_cell,
)
from cli_runs import refused, run, smooth_refused, smoothed

from pdr_est.io.formats.registry import FORMATS

pytestmark = pytest.mark.usefixtures("without_report")

NO_TRACK = "steps can be found but no heading and no track: record it too"


def both_refuse(recording: Path, folder: Path, pattern: str) -> str:
    """`smooth` and `inspect` refuse a recording with the same line, which begins with its path."""
    line = smooth_refused(recording, folder)
    assert line == refused("inspect", recording)
    assert line.startswith(str(recording))
    assert re.search(pattern, line), line
    return line


def only_inspected(recording: Path, folder: Path, pattern: str, *options: object) -> str:
    """`smooth` refuses a recording that `inspect` still describes; its output is returned."""
    line = smooth_refused(recording, folder, *options)
    assert line.startswith(str(recording))
    assert re.search(pattern, line), line
    described = run("inspect", recording)
    assert described.exit_code == 0
    assert described.stderr == ""
    return described.stdout


@pytest.fixture
def outs(tmp_path: Path) -> Path:
    """Where the output folder would lie."""
    return tmp_path / "outs"


# --- files -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("content", "pattern"),
    [
        (b"", r"the file is empty \(0 bytes\); export it again"),
        (gzip.compress(b""), "empty"),
        (b"PK\x03\x04 and no more", "damaged or truncated zip archive .*; export or copy it again"),
        (
            "time_s,acc_x_mps2\n1,2\n".encode("utf-16"),
            "among the columns 'time_s', 'acc_x_mps2'; the",
        ),
        (b"\0" * 1000, "unknown format"),
        (b"\n \n\n", "unknown format"),
    ],
    ids=["empty", "empty gzip", "truncated zip", "UTF-16", "zeros", "blank"],
)
def test_files_without_a_recording(content: bytes, pattern: str, tmp_path: Path, outs: Path) -> None:
    path = tmp_path / "walk.csv"
    path.write_bytes(content)
    both_refuse(path, outs, pattern)


@pytest.mark.parametrize("keep", [12, 5000, -4])
def test_truncated_gzip(keep: int, tmp_path: Path, outs: Path, lines: list[str]) -> None:
    path = tmp_path / "walk.csv.gz"
    path.write_bytes(gzip.compress("\n".join(lines).encode())[:keep])
    both_refuse(path, outs, "truncated gzip data; copy or download it again")


def test_an_unknown_format_lists_the_known_ones(tmp_path: Path, outs: Path) -> None:
    walk = save(tmp_path / "walk.txt", ["hello", "world"])
    line = both_refuse(walk, outs, r"unknown format: no rows of numbers .*--map.* known formats are .*; see docs/")
    assert all(known.NAME in line for known in FORMATS)


def test_paths_that_lead_to_no_recording(tmp_path: Path, outs: Path) -> None:
    (tmp_path / "one").symlink_to("two")
    (tmp_path / "two").symlink_to("one")
    (tmp_path / "folders" / "in" / "folders").mkdir(parents=True)
    os.mkfifo(tmp_path / "pipe")
    as_zip(tmp_path / "empty.zip", {})
    for name, pattern in {
        "nowhere.csv": "no such file or folder; check the path",
        "one": "a symbolic link to a missing file; check the path",
        "folders": "contains no files; give the file, folder or zip",
        "pipe": "neither a file nor a folder",
        "empty.zip": "contains no files",
        "x" * 300: "cannot be read .*; check its permissions",
    }.items():
        both_refuse(tmp_path / name, outs, pattern)


def test_a_folder_of_several_walks_names_them(tmp_path: Path, outs: Path, lines: list[str]) -> None:
    for name in ("b.csv", "a.csv"):
        (tmp_path / "walks").mkdir(exist_ok=True)
        save(tmp_path / "walks" / name, lines)
    words = r"contains 2 plain CSV recordings \(a\.csv, b\.csv\); choose one of them"
    assert re.search(words, refused("track", tmp_path / "walks"))
    assert re.search(words, refused("calibrate", tmp_path / "walks", "--distance", 12, "-o", tmp_path / "c.yaml"))


def test_a_folder_may_hold_links_to_itself_and_pipes(tmp_path: Path, lines: list[str]) -> None:
    folder = tmp_path / "recording"
    folder.mkdir()
    save(folder / "walk.csv", lines)
    (folder / "again").symlink_to(folder)
    os.mkfifo(folder / "pipe")
    assert smoothed(folder, tmp_path / "out").stderr == ""


def test_archives_that_would_harm_are_refused_unpacked(tmp_path: Path, outs: Path, export: dict[str, bytes]) -> None:
    path = as_zip(tmp_path / "escape.zip", {**export, "../evil.csv": b"x"})
    both_refuse(path, outs, r"member '\.\./evil\.csv' points outside the archive; pack the recording again")
    bomb = bytearray(as_zip(tmp_path / "bomb.zip", export).read_bytes())
    for magic, offset in ((b"PK\x01\x02", 24), (b"PK\x03\x04", 22)):
        at = bomb.find(magic)
        bomb[at + offset : at + offset + 4] = struct.pack("<I", 0xFFFFFFFE)
    (tmp_path / "bomb.zip").write_bytes(bomb)
    both_refuse(tmp_path / "bomb.zip", outs, r"claims to unpack to 4\.0 GiB, the limit is 2\.0 GiB; give")
    assert not list(tmp_path.rglob("evil.csv"))


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"], ids=["unix", "windows", "old mac"])
def test_names_and_line_ends_of_any_system(end: str, tmp_path: Path, lines: list[str]) -> None:
    path = save(tmp_path / "Übung 歩く.csv", lines, end)
    path.chmod(0o444)
    tmp_path.chmod(0o555)
    try:
        result = smoothed(path, tmp_path.parent / f"out-{tmp_path.name}")
    finally:
        tmp_path.chmod(0o755)
    assert " m in " in result.stdout


# --- values in a table -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("line", [2, 60, 500])
def test_text_in_a_number_column(line: int, tmp_path: Path, lines: list[str]) -> None:
    result = smoothed(save(tmp_path / "walk.csv", with_cell(lines, line, 2, "9.8.1")), tmp_path / "out")
    assert result.stderr.splitlines() == [
        f"warning: device: 1 of {len(lines) - 1} rows are damaged and left out (line {line}: '9.8.1' in column "
        "'acc_y_mps2')"
    ]


@pytest.mark.parametrize(("row", "n"), [("1.0,2.0", 2), ("1,2,3,4,5,6,7,8", 8)])
def test_rows_of_another_length(row: str, n: int, tmp_path: Path, lines: list[str]) -> None:
    path = save(tmp_path / "walk.csv", [*lines[:40], row, *lines[40:]])
    assert (
        f"rows are damaged and left out (line 41: {n} cells instead of 7)" in smoothed(path, tmp_path / "out").stderr
    )


def test_a_quote_that_is_never_closed(tmp_path: Path, lines: list[str]) -> None:
    path = save(tmp_path / "walk.csv", with_cell(lines, 40, 1, '"9.8'))
    assert "rows are damaged and left out (line 40: " in smoothed(path, tmp_path / "out").stderr


def test_many_damaged_rows(tmp_path: Path, outs: Path, lines: list[str]) -> None:
    path = save(tmp_path / "walk.csv", [line if i % 10 else line + ",9" for i, line in enumerate(lines, start=2)])
    both_refuse(path, outs, r"rows are damaged \(line \d+: 8 cells instead of 7, .*\); export the recording again")


def test_nan_and_inf_are_dropped_and_counted(tmp_path: Path, lines: list[str]) -> None:
    table = lines
    for line, text in ((10, "nan"), (20, "inf"), (30, "-Infinity"), (40, "NaN"), (50, "1e200")):
        table = with_cell(table, line, 1, text)
    time_s = table[59].split(",")[0]
    table = [*table[:59], f"{time_s},nan,nan,nan,nan,nan,nan", *table[60:]]
    result = smoothed(save(tmp_path / "walk.csv", table), tmp_path / "out")
    total = len(lines) - 1
    assert result.stderr.splitlines() == [
        f"warning: device: specific force: 6 of {total} rows are left out: NaN or infinite values",
        f"warning: device: rotation rate: 1 of {total} rows are left out: NaN or infinite values",
    ]


def test_nothing_but_nan(walk: Walk, tmp_path: Path, outs: Path) -> None:
    nothing = np.full_like(walk.rate, np.nan)
    path = save(tmp_path / "walk.csv", lines_of(columns_of(walk, rate=nothing)))
    only_inspected(path, outs, f"no gyroscope .*: left out because all {len(nothing)} rows contain NaN.*{NO_TRACK}")
    path = save(tmp_path / "walk.csv", lines_of(columns_of(walk, force=nothing, rate=nothing)))
    both_refuse(
        path, outs, r"neither accelerometer nor gyroscope has values \(specific force: left out .*record again"
    )


def test_a_header_and_no_rows(tmp_path: Path, outs: Path, lines: list[str]) -> None:
    both_refuse(
        save(tmp_path / "walk.csv", lines[:1]), outs, "titles of a table and no rows below them; record again"
    )


# --- missing and contradicting sensors -------------------------------------------------------------------------


def test_no_gyroscope(walk: Walk, tmp_path: Path, outs: Path) -> None:
    columns = columns_of(walk)
    path = save(tmp_path / "walk.csv", lines_of({name: columns[name] for name in ("time_s", *ACC)}))
    described = only_inspected(path, outs, f"no gyroscope, so {NO_TRACK}")
    assert "no gyroscope: steps and distance are possible, headings and a track are not" in described


def test_no_accelerometer(walk: Walk, tmp_path: Path, outs: Path) -> None:
    columns = columns_of(walk)
    path = save(tmp_path / "walk.csv", lines_of({name: columns[name] for name in ("time_s", *GYR)}))
    described = only_inspected(path, outs, "no accelerometer, without which nothing can be estimated: record it")
    assert "no accelerometer: rotations of the device are possible" in described


def test_no_attitude_of_the_device(tmp_path: Path, outs: Path, lines: list[str]) -> None:
    path = save(tmp_path / "walk.csv", lines)
    pattern = "the device recorded no attitude: set attitude.source: vqf in the configuration"
    only_inspected(path, outs, pattern, "--attitude", "device")


def test_a_gyroscope_of_zeros_is_a_warning(walk: Walk, tmp_path: Path) -> None:
    path = save(tmp_path / "walk.csv", lines_of(columns_of(walk, rate=np.zeros_like(walk.rate))))
    stderr = smoothed(path, tmp_path / "out").stderr
    assert "warning: device: all values of the gyroscope are zero, the sensor is missing or faulty" in stderr


@pytest.mark.parametrize(
    ("force", "rate", "pattern"),
    [
        (1.0 / 9.80665, 1.0, r"accelerometer was read as m/s\^2, but acceleration is in g: .* as in acc_x \(g\)"),
        (1.0, 180.0 / np.pi, r"gyroscope was read as rad/s, but rotation rate is in deg/s: .* as in gyr_x \(deg/s\)"),
    ],
    ids=["g", "deg/s"],
)
def test_units_that_contradict_the_header(
    force: float, rate: float, pattern: str, walk: Walk, tmp_path: Path, outs: Path
) -> None:
    path = save(tmp_path / "walk.csv", lines_of(columns_of(walk, force=force * walk.force, rate=rate * walk.rate)))
    assert "contradicts its values" in only_inspected(path, outs, pattern)
    assert re.search(pattern, refused("steps", path))


def test_units_without_a_header_are_found(walk: Walk, tmp_path: Path) -> None:
    columns = columns_of(walk, force=walk.force / 9.80665, rate=np.rad2deg(walk.rate))
    titles = dict(zip(columns, ("time", "acc_x", "acc_y", "acc_z", "gyr_x", "gyr_y", "gyr_z"), strict=True))
    path = save(tmp_path / "walk.csv", lines_of({titles[name]: column for name, column in columns.items()}))
    distance_m, text = smoothed(path, tmp_path / "out").stdout.split(" m in ")
    assert float(distance_m) == pytest.approx(12.0, rel=0.15)
    assert "report.html" in text


# --- an export with a damaged member ---------------------------------------------------------------------------


@pytest.mark.parametrize("damage", [b"", b"time,seconds_elapsed,x,y,z\n"], ids=["0 bytes", "header only"])
def test_a_channel_without_rows(damage: bytes, export: dict[str, bytes], tmp_path: Path, outs: Path) -> None:
    dispensable = ("Location", "Magnetometer", "Orientation")
    path = as_zip(tmp_path / "walk.zip", export | {f"{sensor}.csv": damage for sensor in dispensable})
    assert smoothed(path, tmp_path / "out").stderr.splitlines() == [
        f"warning: device: {sensor} is in the export but has no rows" for sensor in dispensable
    ]
    path = as_zip(tmp_path / "walk.zip", {**export, "Gyroscope.csv": damage})
    only_inspected(path, outs, rf"no gyroscope \(Gyroscope is in the export but has no rows\), so {NO_TRACK}")
    path = as_zip(tmp_path / "walk.zip", {**export, "TotalAcceleration.csv": damage})
    both_refuse(
        path, outs, "TotalAcceleration has no rows and no other sensor replaces it; export the recording again"
    )


def test_a_channel_of_nan_that_a_track_can_do_without(export: dict[str, bytes], tmp_path: Path) -> None:
    table = b"\n".join(
        line if number == 0 else b",".join([*line.split(b",")[:2], b"nan,nan,nan"])
        for number, line in enumerate(export["Magnetometer.csv"].splitlines())
    )
    path = as_zip(tmp_path / "walk.zip", {**export, "Magnetometer.csv": table})
    assert "warning: device: Magnetometer: left out because all" in smoothed(path, tmp_path / "out").stderr


def test_a_damaged_member_is_named(export: dict[str, bytes], tmp_path: Path, outs: Path) -> None:
    rows = export["Gyroscope.csv"].splitlines()
    for damaged, pattern in (
        ([*rows[:100], rows[100][:22]], r", member Gyroscope\.csv, line 101: 2 fields instead of 5"),
        ([*rows[:100], b"x" + rows[100], *rows[101:]], r", member Gyroscope\.csv, line 101, column 'time': 'x17"),
    ):
        path = as_zip(tmp_path / "walk.zip", {**export, "Gyroscope.csv": b"\n".join(damaged)})
        both_refuse(path, outs, pattern)


def test_two_walks_in_one_archive(export: dict[str, bytes], tmp_path: Path, outs: Path) -> None:
    members = {f"{folder}/{name}": data for folder in ("monday", "sunday") for name, data in export.items()}
    path = as_zip(tmp_path / "walks.zip", members)
    both_refuse(path, outs, r"contains 2 Sensor Logger recordings \(monday, sunday\); choose one of them")


# --- clocks ----------------------------------------------------------------------------------------------------


def test_two_clocks_an_hour_apart(walk: Walk, tmp_path: Path, outs: Path) -> None:
    path = as_zip(tmp_path / "walk.zip", sensor_logger(walk, {"Gyroscope": 3600.0}))
    pattern = (
        r"the channels do not overlap in time \(accelerometer 0\.00 to \d+\.\d\d s, gyroscope 3600\.00 to "
        r"36\d+\.\d\d s\): check the recorder's clocks"
    )
    described = only_inspected(path, outs, pattern)
    assert "accelerometer and gyroscope never run at the same time: a track is not possible" in described


def test_clocks_that_hardly_overlap_are_a_warning(walk: Walk, tmp_path: Path) -> None:
    path = as_zip(tmp_path / "walk.zip", sensor_logger(walk, {"Gyroscope": float(walk.time_s[-1]) - 0.5}))
    stderr = smoothed(path, tmp_path / "out").stderr
    assert re.search(r"warning: device: 2 gaps or clock jumps, \d+\.\d s in all, listed by `pdr-est inspect`", stderr)


@pytest.mark.parametrize(
    ("samples", "pattern"),
    [(1, "the accelerometer has a single sample: record for longer"), (2, "too few samples .*: record for longer")],
)
def test_hardly_any_sample(samples: int, pattern: str, tmp_path: Path, outs: Path, lines: list[str]) -> None:
    only_inspected(save(tmp_path / "walk.csv", lines[: 1 + samples]), outs, pattern)


@pytest.mark.parametrize(
    ("scale", "shift_s", "pattern"),
    [
        (0.0, 5.0, r"all \d+ time stamps of the accelerometer are 5\.00 s, the clock does not advance: give the"),
        (1.0, 1.7e18, r"all \d+ time stamps .* are 17\d{17} s, the clock does not advance: give the"),
        (1e9, 0.0, r"begin with 0\.00, .* and span \d\S+ s with \d+ samples, more than a year: .* in seconds"),
        (
            1e3,
            0.0,
            r"samples of the accelerometer lie 20 s apart, more than resample\.max_gap_s = 0\.5, and .* in seconds",
        ),
        (-1.0, 0.0, "the time stamps of the accelerometer run backwards: sort its rows by time"),
    ],
    ids=["constant", "nanoseconds", "nanoseconds from 0", "milliseconds", "backwards"],
)
def test_useless_clocks(scale: float, shift_s: float, pattern: str, walk: Walk, tmp_path: Path, outs: Path) -> None:
    columns = columns_of(walk, time_s=walk.time_s * scale + shift_s)
    only_inspected(save(tmp_path / "walk.csv", lines_of(columns)), outs, pattern)


@pytest.mark.parametrize(("first", "step"), [(18 * 10**18, 20_000_000), (10**25, 10**20), (64 * 10**16, 20_000)])
def test_no_time_crashes_a_command(first: int, step: int, walk: Walk, tmp_path: Path) -> None:
    lines = [line.partition(",")[2] for line in lines_of(columns_of(walk))]
    clock = ["time", *(str(first + step * i) for i in range(len(lines) - 1))]
    path = save(tmp_path / "walk.csv", [f"{time},{rest}" for time, rest in zip(clock, lines, strict=True)])
    for arguments in (("inspect", path), ("steps", path), ("steps", path, "--from", "4:05:06"), ("track", path)):
        result = run(*arguments)
        assert result.exit_code in (0, 2), arguments
        assert result.exception is None or isinstance(result.exception, SystemExit)


def test_times_beyond_any_clock(walk: Walk, tmp_path: Path, outs: Path) -> None:
    path = save(tmp_path / "walk.csv", lines_of(columns_of(walk, time_s=walk.time_s + 1e300)))
    both_refuse(path, outs, r"specific force: left out because all \d+ rows have no finite time; .*; record again")


@pytest.mark.parametrize("stamp", ["1e12", "-1e12", "1000", "172800"])
def test_one_wrong_time_stamp_costs_its_row_and_is_told(tmp_path: Path, lines: list[str], stamp: str) -> None:
    whole = smoothed(save(tmp_path / "whole.csv", lines), tmp_path / "whole")
    damaged = smoothed(save(tmp_path / "walk.csv", with_cell(lines, 301, 0, stamp)), tmp_path / "damaged")
    assert "specific_force: 1 of 720 samples are left out because their time stamps contradict" in damaged.stderr
    assert "gap" not in damaged.stderr
    assert "in 17 steps" in whole.output
    assert "in 17 steps" in damaged.output

"""Tables of the simulated walk with clocks of every kind."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from table_layouts import ticks
from table_walk import TableWalk, dates, rows, table_walk, xyz

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.io import read
from pdr_est.types.recording import Recording

START = np.datetime64("2031-02-03T04:05:06.789", "ms")
START_S = START.astype(np.int64) / 1e3


@pytest.fixture(scope="module")
def walk() -> TableWalk:
    return table_walk()


def recording_of(folder: Path, walk: TableWalk, clock: Mapping[str, Any], lines: Sequence[str] = ()) -> Recording:
    """The walk with these columns for its time; other lines follow the first thousand rows."""
    table = rows({**clock, **xyz("acc_{}", walk.force), **xyz("gyro_{}", walk.rate)})
    (folder / "walk.csv").write_text("\n".join([*table[:1001], *lines, *table[1001:]]) + "\n", encoding="utf-8")
    return read(folder / "walk.csv")


def assert_clock(recording: Recording, walk: TableWalk) -> None:
    force = recording.devices[0].specific_force
    assert force is not None
    np.testing.assert_allclose(force.values, walk.force, atol=2e-5)
    np.testing.assert_allclose(force.time_s - force.time_s[0], walk.time_s, atol=2e-3)


def decimals(values: Array, digits: int) -> list[str]:
    return [f"{value:.{digits}f}" for value in values]


CLOCKS: Mapping[str, tuple[str, Callable[[TableWalk], Any]]] = {
    "minutes": ("time (min)", lambda walk: decimals(walk.time_s / 60.0, 8)),
    "minutes in words": ("Zeit in Minuten", lambda walk: decimals(walk.time_s / 60.0, 8)),
    "hours": ("time_h", lambda walk: decimals(walk.time_s / 3600.0, 10)),
    ".NET": ("timestamp", lambda walk: ticks(walk, 10**7, round(1e7 * (62_135_596_800 + START_S)))),
    "Windows": ("timestamp", lambda walk: ticks(walk, 10**7, round(1e7 * (11_644_473_600 + START_S)))),
    "spreadsheet": ("time", lambda walk: decimals(25_569.0 + (START_S + walk.time_s) / 86_400.0, 11)),
    "MATLAB": ("time", lambda walk: decimals(719_529.0 + (START_S + walk.time_s) / 86_400.0, 11)),
    "Chinese": ("时间", lambda walk: dates(walk.time_s, "{y}年{m}月{d}日 {H}时{M}分{S}.{ms}秒")),
    "time of day in Chinese": ("时间", lambda walk: dates(walk.time_s, "{H}时{M}分{S}秒{ms}毫秒")),
}


@pytest.mark.parametrize("kind", CLOCKS)
def test_the_clock_is_understood(kind: str, tmp_path: Path, walk: TableWalk) -> None:
    title, clock = CLOCKS[kind]
    recording = recording_of(tmp_path, walk, {title: clock(walk)})
    assert_clock(recording, walk)
    assert not any("unit" in words for words in recording.devices[0].warnings)
    if kind in (".NET", "Windows"):
        assert recording.epoch_s == pytest.approx(START_S, abs=1e-3)
    if kind in ("spreadsheet", "MATLAB", "Chinese"):
        assert recording.epoch_s is None
        assert recording.tells_local_date
        assert recording.local_epoch_s == pytest.approx(START_S, abs=2e-3)
    if kind == "time of day in Chinese":
        assert not recording.tells_local_date
        assert recording.local_epoch_s == pytest.approx(START_S % 86_400.0)


def test_a_unit_that_cannot_be_told_is_refused_with_the_remedy(tmp_path: Path, walk: TableWalk) -> None:
    words = r"column 'time' goes from 0.0, 0.00033333, .* in 2000 rows, 0.6663 s if .* --map \(time: \{column: 'time'"
    with pytest.raises(RecordingError, match=words):
        recording_of(tmp_path, walk, {"time": decimals(walk.time_s / 60.0, 8)})


def test_a_doubtful_unit_of_the_header_is_told(tmp_path: Path, walk: TableWalk) -> None:
    recording = recording_of(tmp_path, walk, {"time (s)": decimals(walk.time_s / 60.0, 8)})
    (words,) = [words for words in recording.devices[0].warnings if "doubtful" in words]
    assert "time spans 0.6663 s for 2000 rows, 3000 a second" in words
    assert "--map" in words


def test_units_of_100_ns_are_told_from_us_and_told(tmp_path: Path, walk: TableWalk) -> None:
    recording = recording_of(tmp_path, walk, {"timestamp": ticks(walk, 10**7, 0)})
    assert_clock(recording, walk)
    assert any("units of 100 ns are taken" in words and "--map" in words for words in recording.devices[0].warnings)


@pytest.mark.parametrize("count", [1, 3])
def test_rows_whose_time_is_not_set_are_left_out_and_told(count: int, tmp_path: Path, walk: TableWalk) -> None:
    clock = {"time": ticks(walk, 10**9, round(START_S) * 10**9)}
    recording = recording_of(tmp_path, walk, clock, ["0,0,0,0,0,0,0"] * count)
    assert_clock(recording, walk)
    assert recording.epoch_s == round(START_S)
    (words,) = [words for words in recording.devices[0].warnings if "left out" in words]
    assert f"their time is 0, that is not set: {count} of {2000 + count} (row 1001" in words


@pytest.mark.parametrize(
    "titles",
    [
        ("year", "month", "day", "hour", "minute", "second", "ms"),
        ("Year", "Month", "Day", "Hour", "Min", "Sec", ""),
        ("YYYY", "MM", "DD", "hh", "mm", "ss", "ms"),
        ("年", "月", "日", "时", "分", "秒", "毫秒"),
        ("Jahr", "Monat", "Tag", "Stunde", "Minute", "Sekunde", "Millisekunden"),
        ("", "", "", "hour", "minute", "second", "msec"),
    ],
)
def test_a_column_for_each_part_of_the_date(titles: Sequence[str], tmp_path: Path, walk: TableWalk) -> None:
    forms = ("{y}", "{m}", "{d}", "{H}", "{M}", "{S}" if titles[-1] else "{S}.{ms}", "{ms}")
    clock = {
        title: [cell if "." in cell else str(int(cell)) for cell in dates(walk.time_s, form)]
        for title, form in zip(titles, forms, strict=True)
        if title
    }
    recording = recording_of(tmp_path, walk, clock)
    assert_clock(recording, walk)
    assert recording.tells_local_date == bool(titles[0])


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ("acc_time", "gyro_time"),
        ("Timestamp (Accelerometer)", "Timestamp (Gyroscope)"),
        ("time", "time"),
        ("time_acc_s", "time_gyr_s"),
    ],
)
def test_sensors_with_clocks_of_their_own(first: str, second: str, tmp_path: Path, walk: TableWalk) -> None:
    """The accelerometer at 50 Hz beside the gyroscope at 12.5 Hz, which begins 4 ms later."""
    slow = slice(None, None, 4)
    left = rows({first: walk.time_s, **xyz("acc_{}", walk.force)})
    right = rows({second: walk.time_s[slow] + 0.004, **xyz("gyro_{}", walk.rate[slow])})
    right += [",,,"] * (len(left) - len(right))
    lines = [f"{a},{b}" for a, b in zip(left, right, strict=True)]
    (tmp_path / "walk.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    device = read(tmp_path / "walk.csv").devices[0]
    assert device.specific_force is not None
    assert device.rotation_rate is not None
    np.testing.assert_allclose(device.specific_force.time_s, walk.time_s, atol=1e-9)
    np.testing.assert_allclose(device.rotation_rate.time_s, walk.time_s[slow] + 0.004, atol=1e-9)
    np.testing.assert_allclose(device.rotation_rate.values, walk.rate[slow], atol=2e-5)
    assert any(f"clocks of their own: {first} of specific force" in words for words in device.decisions)
    assert not any("left out" in words for words in device.warnings)


def test_two_clocks_of_all_rows_stay_one_table(tmp_path: Path, walk: TableWalk) -> None:
    recording = recording_of(tmp_path, walk, {"time": ticks(walk, 1000, 0), "gyro_time": walk.time_s})
    assert_clock(recording, walk)
    assert not any("clocks of their own" in words for words in recording.devices[0].decisions)


def test_unpadded_fractions_are_told(tmp_path: Path, walk: TableWalk) -> None:
    stamps = [stamp.rsplit(".", 1) for stamp in dates(walk.time_s)]
    recording = recording_of(tmp_path, walk, {"time": [f"{second}.{int(ms)}" for second, ms in stamps]})
    assert_clock(recording, walk)
    assert any("the digits behind the seconds count ms" in words for words in recording.devices[0].decisions)

"""Drafts of mappings: with the draft of a recording that is understood, the same samples are read as without it."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from table_layouts import CLEAN, DEG, UNIX_NS, G, plain, text, ticks
from table_walk import TableWalk, rows, table_walk, xyz

from pdr_est.errors import ConfigError, RecordingError
from pdr_est.io import read
from pdr_est.io.formats.map_draft import write_map_draft
from pdr_est.io.tables.mapping_file import load_mapping, mapping_from_dict
from pdr_est.types.recording import DeviceRecording

NEED_NONE = {"WristMotion": "read as Sensor Logger", "EuRoC": "read as EuRoC", "tagged rows": "read as FlySight"}
CANNOT = {"rows that begin with the sensor": "of several kinds with columns of their own"}
OTHER = {"browser that counts x, y, z"}  # the order of its axes is found by gravity, and no title states it


@pytest.fixture(scope="module")
def walk() -> TableWalk:
    return table_walk()


def assert_same(a: DeviceRecording, b: DeviceRecording) -> None:
    assert a.signals().keys() == b.signals().keys()
    for name, signal in a.signals().items():
        np.testing.assert_allclose(b.signals()[name].values, signal.values, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(b.signals()[name].time_s, signal.time_s, atol=1e-9)


def assert_drafted(path: Path, draft: Path) -> None:
    write_map_draft(path, draft)
    mapped, plainly = read(path, load_mapping(draft)), read(path)
    assert [device.name for device in mapped.devices] == [device.name for device in plainly.devices]
    for a, b in zip(plainly.devices, mapped.devices, strict=True):
        assert_same(a, b)
    assert len(mapped.fixes) == len(plainly.fixes)


@pytest.mark.parametrize("layout", sorted(CLEAN.keys() - NEED_NONE.keys() - CANNOT.keys() - OTHER))
def test_the_draft_of_every_layout_reads_the_same(tmp_path: Path, walk: TableWalk, layout: str) -> None:
    (tmp_path / "walk.csv").write_bytes(CLEAN[layout](walk))
    assert_drafted(tmp_path / "walk.csv", tmp_path / "map.yaml")


@pytest.mark.parametrize("layout", [*NEED_NONE, *CANNOT])
def test_what_a_mapping_cannot_describe_is_said(tmp_path: Path, walk: TableWalk, layout: str) -> None:
    name = "WristMotion.csv" if layout == "WristMotion" else "walk.csv"
    (tmp_path / name).write_bytes(CLEAN[layout](walk))
    with pytest.raises(RecordingError, match=(NEED_NONE | CANNOT)[layout]):
        write_map_draft(tmp_path / name, tmp_path / "map.yaml")
    assert not (tmp_path / "map.yaml").exists()


def folder_of(place: Path, files: Mapping[str, bytes]) -> Path:
    place.mkdir()
    for name, data in files.items():
        (place / name).write_bytes(data)
    return place


def test_the_draft_of_a_folder_reads_the_same(tmp_path: Path, walk: TableWalk) -> None:
    stamps = ticks(walk, 1000, UNIX_NS // 10**6)
    files = {
        "my acc 1.csv": text(rows({"t (ms)": stamps, **xyz("{} (g)", walk.force / G)})),
        "gyro.txt": text([f"{t} {v[0]} {v[1]} {v[2]}" for t, v in zip(stamps, walk.rate, strict=True)]),
        "magnetometer.csv": text(rows({"time": stamps, **xyz("{}", walk.field)})),
    }
    assert_drafted(folder_of(tmp_path / "walk", files), tmp_path / "map.yaml")


def test_the_draft_of_several_devices_reads_them_all(tmp_path: Path, walk: TableWalk) -> None:
    lines = [rows({**plain(walk), "device": [name] * len(walk.time_s)}) for name in ("a", "b")]
    (tmp_path / "walk.csv").write_bytes(text([*lines[0], *lines[1][1:]]))
    assert_drafted(tmp_path / "walk.csv", tmp_path / "map.yaml")


def test_files_without_time_are_read_with_their_rate(tmp_path: Path, walk: TableWalk) -> None:
    files = {
        f"{name}_exp01.txt": text([" ".join(map(str, v)) for v in values])
        for name, values in (("acc", walk.force / G), ("gyro", walk.rate))
    }
    place = folder_of(tmp_path / "walk", files)
    write_map_draft(place, tmp_path / "map.yaml")
    draft = (tmp_path / "map.yaml").read_text()
    assert draft.count("# time: {column: ?, unit: s}   # or {rate_hz: 50}") == 2
    with pytest.raises(ConfigError, match=r"acc_exp01.txt: no section time; add it"):
        load_mapping(tmp_path / "map.yaml")
    (tmp_path / "full.yaml").write_text(draft.replace("# time: {column: ?, unit: s}   # or ", "time: "))
    device = read(place, load_mapping(tmp_path / "full.yaml")).devices[0]
    assert device.specific_force is not None
    assert device.rotation_rate is not None
    np.testing.assert_allclose(device.specific_force.values, walk.force, atol=1e-3)
    np.testing.assert_allclose(device.rotation_rate.values, walk.rate, atol=1e-6)
    np.testing.assert_allclose(device.rotation_rate.time_s, walk.time_s, atol=1e-9)


def test_a_unit_may_be_a_number(tmp_path: Path, walk: TableWalk) -> None:
    counts = {
        "micros": ticks(walk, 10**6, 523),
        **xyz("a{}", np.round(walk.force / G * 16384).astype(int)),
        **xyz("g{}", np.round(walk.rate / DEG * 131).astype(int)),
    }
    (tmp_path / "walk.csv").write_bytes(text(rows(counts)))
    stated = {
        "time": {"column": "micros", "unit": 1e-6},
        "accelerometer": {"x": "ax", "y": "ay", "z": "az", "unit": G / 16384},
        "gyroscope": {"x": "gx", "y": "gy", "z": "gz", "unit": DEG / 131},
    }
    device = read(tmp_path / "walk.csv", mapping_from_dict(stated)).devices[0]
    assert device.specific_force is not None
    assert device.rotation_rate is not None
    np.testing.assert_allclose(device.specific_force.values, walk.force, atol=1e-3)
    np.testing.assert_allclose(device.rotation_rate.values, walk.rate, atol=1e-4)


def test_sensors_may_have_rows_and_a_time_of_their_own(tmp_path: Path, walk: TableWalk) -> None:
    lines = ["k;n;p;q;r"]
    for i, tick in enumerate(ticks(walk, 1000, 7)):
        lines.append(f"A;{tick};{walk.force[i, 0]};{walk.force[i, 1]};{walk.force[i, 2]}")
        lines.append(f"W;{tick};{walk.rate[i, 0]};{walk.rate[i, 1]};{walk.rate[i, 2]}")
    (tmp_path / "walk.csv").write_bytes(text(lines))
    axes = {"x": "p", "y": "q", "z": "r"}
    stated = {
        "time": {"column": "n", "unit": "ms"},
        "sensor": {"column": "k"},
        "accelerometer": {"rows": "A", **axes},
        "gyroscope": {"rows": "W", **axes, "time": {"rate_hz": 50}},
    }
    device = read(tmp_path / "walk.csv", mapping_from_dict(stated)).devices[0]
    assert device.rotation_rate is not None
    np.testing.assert_allclose(device.rotation_rate.values, walk.rate, atol=1e-6)
    stated["gyroscope"] = {"rows": "G", **axes}
    with pytest.raises(RecordingError, match="no row has 'G' in column 'k', which has A, W; correct it"):
        read(tmp_path / "walk.csv", mapping_from_dict(stated))


AXES = {"x": "a", "y": "b", "z": "c"}


@pytest.mark.parametrize(
    ("document", "message"),
    [
        (
            {"time": {"column": "?"}, "accelerometer": AXES},
            r"time: '\?' is left over from the draft; write the title",
        ),
        ({"time": {"column": "t"}, "accelerometer": {**AXES, "y": "-?"}}, r"accelerometer: '-\?' is left over"),
        (
            {"time": {"column": "t"}, "accelerometer": {**AXES, "y": True}},
            "True is no column; give its title, in quot",
        ),
        ({"time": {"column": "t"}, "accelerometer": {**AXES, "y": "a"}}, "one column for two of x, y, z"),
        ({"time": {"column": "t"}, "accelerometer": {**AXES, "unit": 0}}, "unit 0 is no number of SI units"),
        ({"time": {"column": "t"}, "accelerometer": {**AXES, "unit": -9.8}}, "unit -9.8 is no number of SI units"),
        ({"time": {"column": "t", "rate_hz": 50}, "accelerometer": AXES}, "both column and rate_hz; give one"),
        ({"time": "t", "accelerometer": AXES}, "time: not a list of keys with values"),
        ({"time": {"column": "t"}, "accelerometer": "a"}, "accelerometer: not a list of keys with values"),
        ({"time": {"column": "t"}, "accelerometer": {**AXES, "rows": "A"}}, "rows without a column that names them"),
        ({"time": {"column": "t"}, "sensor": {"column": "s"}, "accelerometer": AXES}, "no rows; say which name"),
        ({"files": {}}, "files: names no file"),
        ({"files": ["a.csv"]}, "files: names no file"),
        ({"files": {"a.csv": {"accelerometer": AXES}}}, "a.csv: no section time; add it"),
        ({"files": {"a.csv": {"time": {"rate_hz": 5}}}}, "a.csv: no section of a sensor; add it"),
        ({"files": {"a.csv": {"time": {"rate_hz": 5}, "magnetometer": AXES}}}, "no section accelerometer, .* in any"),
        ({"files": {}, "time": {"column": "t"}}, "unknown key 'time'; known are files"),
    ],
)
def test_mistakes_are_named(document: object, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        mapping_from_dict(document, "map.yaml")


def test_a_file_that_is_not_there_is_named(tmp_path: Path, walk: TableWalk) -> None:
    place = folder_of(tmp_path / "walk", {"acc.csv": text(rows(plain(walk)))})
    stated = {"files": {"gyro.csv": {"time": {"rate_hz": 50}, "gyroscope": AXES}}}
    with pytest.raises(RecordingError, match=r"names the file 'gyro.csv', which is not there; there are acc.csv"):
        read(place, mapping_from_dict(stated))


def test_a_draft_states_the_sign_that_an_app_is_known_by(tmp_path: Path, walk: TableWalk) -> None:
    (tmp_path / "walk.csv").write_bytes(CLEAN["user acceleration and gravity"](walk))
    write_map_draft(tmp_path / "walk.csv", tmp_path / "map.yaml")
    assert "sign: down" in (tmp_path / "map.yaml").read_text()


def test_tables_one_below_the_other_are_not_drafted(tmp_path: Path, walk: TableWalk) -> None:
    parts = [
        rows({"time": walk.time_s, **xyz(f"{name}_{{}}", v)})
        for name, v in (("acc", walk.force), ("gyro", walk.rate))
    ]
    (tmp_path / "walk.csv").write_bytes(text([*parts[0], "", *parts[1]]))
    with pytest.raises(RecordingError, match="tables one below the other, which a mapping cannot describe"):
        write_map_draft(tmp_path / "walk.csv", tmp_path / "map.yaml")

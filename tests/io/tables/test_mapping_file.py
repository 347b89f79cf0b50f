"""Mapping files: what a person states of a table is believed, mistakes in it are named, and drafts can be used."""

from pathlib import Path

import numpy as np
import pytest
from table_layouts import DEG, G, plain, text
from table_walk import TableWalk, rows, table_walk, xyz

from pdr_est.errors import ConfigError, OutputError, RecordingError
from pdr_est.io import read
from pdr_est.io.formats.map_draft import write_map_draft
from pdr_est.io.tables.mapping_file import load_mapping, mapping_from_dict

FORCE = {"x": "acc_x", "y": "acc_y", "z": "acc_z"}


@pytest.fixture(scope="module")
def walk() -> TableWalk:
    return table_walk()


@pytest.mark.parametrize("tick_s", [0.7, 0.016, 1.0 / 1024.0, 2.5])
def test_a_tick_may_be_any_number_of_seconds(tmp_path: Path, walk: TableWalk, tick_s: float) -> None:
    columns = {"ticks": (walk.time_s / tick_s).tolist(), **xyz("acc_{}", walk.force), **xyz("gyro_{}", walk.rate)}
    (tmp_path / "walk.csv").write_bytes(text(rows(columns)))
    sensors = {"accelerometer": FORCE, "gyroscope": {axis: f"gyro_{axis}" for axis in "xyz"}}
    mapping = mapping_from_dict({"time": {"column": "ticks", "unit": tick_s}, **sensors})
    force = read(tmp_path / "walk.csv", mapping).devices[0].specific_force
    assert force is not None
    np.testing.assert_allclose(force.time_s, walk.time_s, atol=2e-3)


def test_everything_can_be_stated(tmp_path: Path, walk: TableWalk) -> None:
    columns = {
        "Zeit": (1000.0 * walk.time_s).round().astype(int).tolist(),
        **dict(zip(("p", "q", "r"), (-walk.force / G).T, strict=True)),
        **dict(zip(("u", "v", "w"), (walk.rate / DEG).T, strict=True)),
        **dict(zip("abcd", walk.attitude.T, strict=True)),
        "Luft": np.full(len(walk.time_s), 1000.0),
        "N": 60.0 + 1e-5 * np.floor(walk.time_s),
        "E": np.full(len(walk.time_s), 24.0),
        "Radius": np.full(len(walk.time_s), 7.0),
    }
    (tmp_path / "walk.csv").write_bytes(text(rows(columns)))
    (tmp_path / "map.yaml").write_text(
        "time: {column: Zeit, unit: ms}\n"
        "accelerometer: {x: p, y: q, z: r, unit: g, sign: down}\n"
        "gyroscope: {x: u, y: v, z: w, unit: deg/s}\n"
        "quaternion: {w: a, x: b, y: c, z: d}\n"
        "pressure: {column: Luft, unit: hPa}\n"
        "location: {latitude: N, longitude: E, accuracy: Radius}\n"
    )
    recording = read(tmp_path / "walk.csv", load_mapping(tmp_path / "map.yaml"))
    device = recording.devices[0]
    assert device.specific_force is not None
    assert device.rotation_rate is not None
    assert device.attitude is not None
    assert device.pressure is not None
    np.testing.assert_allclose(device.specific_force.time_s, walk.time_s)
    np.testing.assert_allclose(device.specific_force.values, walk.force, atol=2e-5)
    np.testing.assert_allclose(device.rotation_rate.values, walk.rate, atol=2e-5)
    np.testing.assert_allclose(device.attitude.values, walk.attitude, atol=1e-6)
    assert device.pressure.values[0] == 100_000.0
    assert len(recording.fixes) == 40
    assert recording.fixes[3].covariance_m2[0, 0] == 49.0
    assert device.warnings == ()


@pytest.mark.parametrize("column", ["-column 3", -3, "-3"])
def test_axes_can_be_turned_and_columns_numbered(tmp_path: Path, walk: TableWalk, column: int | str) -> None:
    turned = np.column_stack([walk.force[:, 0], walk.force[:, 2], -walk.force[:, 1]])
    (tmp_path / "walk.txt").write_bytes(text(rows(xyz("{}", turned))[1:]))
    mapping = mapping_from_dict({"time": {"rate_hz": 50}, "accelerometer": {"x": 1, "y": column, "z": 2}})
    device = read(tmp_path / "walk.txt", mapping).devices[0]
    assert device.specific_force is not None
    np.testing.assert_allclose(device.specific_force.values, walk.force, atol=1e-6)
    np.testing.assert_allclose(device.specific_force.time_s, walk.time_s, atol=1e-9)


def test_a_stated_sign_is_taken_and_its_contradiction_told(tmp_path: Path, walk: TableWalk) -> None:
    columns = {**plain(walk), **dict(zip(("qw", "qx", "qy", "qz"), walk.attitude.T, strict=True))}
    (tmp_path / "walk.csv").write_bytes(text(rows(columns)))
    quaternion = {axis: f"q{axis}" for axis in "wxyz"}
    stated = {"time": {"column": "time"}, "accelerometer": {**FORCE, "sign": "down"}, "quaternion": quaternion}
    device = read(tmp_path / "walk.csv", mapping_from_dict(stated)).devices[0]
    assert device.specific_force is not None
    np.testing.assert_allclose(device.specific_force.values, -walk.force, atol=1e-6)
    assert any("acceleration and attitude contradict each other" in words for words in device.warnings)


def test_a_stated_order_of_axes_is_not_searched_again(tmp_path: Path, walk: TableWalk) -> None:
    turned = dict(zip(("alpha", "beta", "gamma"), np.roll(walk.rate, 1, axis=1).T, strict=True))
    columns = {"time": walk.time_s, **xyz("acc_{}", walk.force), **turned}
    (tmp_path / "walk.csv").write_bytes(text(rows(columns)))
    stated = {"x": "alpha", "y": "beta", "z": "gamma"}
    mapping = mapping_from_dict({"time": {"column": "time"}, "accelerometer": FORCE, "gyroscope": stated})
    device = read(tmp_path / "walk.csv", mapping).devices[0]
    assert device.rotation_rate is not None
    np.testing.assert_allclose(device.rotation_rate.values, np.roll(walk.rate, 1, axis=1), atol=1e-6)


def test_a_draft_can_be_used_after_a_line_is_completed(tmp_path: Path, walk: TableWalk) -> None:
    columns = plain(walk)
    del columns["time"]
    (tmp_path / "walk.csv").write_bytes(text(rows({**columns, "hum": walk.time_s})))
    write_map_draft(tmp_path / "walk.csv", tmp_path / "map.yaml")
    draft = (tmp_path / "map.yaml").read_text()
    assert "#   1: acc_x = " in draft
    assert "# not used: hum" in draft
    with pytest.raises(ConfigError, match="no section time; add it"):
        load_mapping(tmp_path / "map.yaml")
    (tmp_path / "full.yaml").write_text("time: {rate_hz: 50}\n" + draft)
    device = read(tmp_path / "walk.csv", load_mapping(tmp_path / "full.yaml")).devices[0]
    assert device.rotation_rate is not None
    np.testing.assert_allclose(device.rotation_rate.values, walk.rate, atol=1e-6)


def test_a_draft_names_the_units_that_titles_state(tmp_path: Path, walk: TableWalk) -> None:
    columns = {
        "time (ms)": 1000.0 * walk.time_s,
        **xyz("acc {} (mg)", 1e3 * walk.force / G),
        **xyz("gyro {} [dps]", walk.rate / DEG),
        **xyz("mag {} (Gauss)", walk.field / 100.0),
    }
    (tmp_path / "walk.csv").write_bytes(text(rows(columns)))
    write_map_draft(tmp_path / "walk.csv", tmp_path / "map.yaml")
    found = load_mapping(tmp_path / "map.yaml")
    assert found.clocks[0].factor == 1e-3
    assert {q.name: set(one.factors) for q, one in found.columns.items()} == {
        "FORCE": {1e-3 * G},
        "RATE": {DEG},
        "FIELD": {100.0},
    }


def test_a_draft_replaces_no_file(tmp_path: Path, walk: TableWalk) -> None:
    (tmp_path / "walk.csv").write_bytes(text(rows(plain(walk))))
    (tmp_path / "map.yaml").write_text("mine")
    with pytest.raises(OutputError, match="exists"):
        write_map_draft(tmp_path / "walk.csv", tmp_path / "map.yaml")
    assert (tmp_path / "map.yaml").read_text() == "mine"


@pytest.mark.parametrize(
    ("document", "message"),
    [
        ({"time": {"column": "t"}, "accelerometre": FORCE}, "unknown key 'accelerometre'; known are accelerometer"),
        ({"time": {"column": "t"}, "accelerometer": {"x": "a", "y": "b"}}, "accelerometer: no z; name the column"),
        (
            {"time": {"column": "t"}, "accelerometer": {**FORCE, "unit": "mph"}},
            "unknown unit .mph. of the",
        ),
        ({"time": {"column": "t"}, "accelerometer": {**FORCE, "sign": "left"}}, "unknown sign 'left'; known are up"),
        (
            {
                "time": {"column": "t"},
                "accelerometer": {**FORCE, "sign": "up"},
                "linear_acceleration": {**FORCE, "sign": "down"},
            },
            "sign up of accelerometer and sign down of linear_acceleration contradict each other; a device has one",
        ),
        (
            {"time": {"column": "t"}, "accelerometer": {**FORCE, "sign": ["up"]}},
            r"unknown sign \['up'\]; known are up",
        ),
        ({"time": {"column": "t"}, "gyroscope": {**FORCE, "sign": "up"}}, "gyroscope: unknown key 'sign'"),
        (
            {"time": {"rate_hz": "fast"}, "accelerometer": FORCE},
            "rate_hz 'fast' is not a rate; give",
        ),
        ({"accelerometer": FORCE}, "no section time; add it"),
        ({"time": {"column": "t"}}, "no section accelerometer, linear_acceleration or gyroscope; add it"),
        ({"time": {"column": "t"}, "accelerometer": FORCE, "location": {"latitude": "a"}}, "location: no longitude"),
        ([1, 2], "not a list of keys with values"),
    ],
)
def test_mistakes_in_a_mapping_are_named(document: object, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        mapping_from_dict(document, "map.yaml")


def test_a_mapping_with_an_absent_column_lists_those_that_are_there(tmp_path: Path, walk: TableWalk) -> None:
    (tmp_path / "walk.csv").write_bytes(text(rows(plain(walk))))
    mapping = mapping_from_dict({"time": {"column": "Zeit"}, "accelerometer": FORCE})
    with pytest.raises(RecordingError, match="names the column 'Zeit', which is not among 'time', 'acc_x'"):
        read(tmp_path / "walk.csv", mapping)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("a: [", r"map\.yaml, line 1: is not valid YAML"),
        ("\udcff", r"map\.yaml: is not UTF-8 text"),
        (
            "time: {rate_hz: 50}\ngyroscope: {x: a, y: b, z: c}\ntime: {rate_hz: 20}\n",
            "line 3: .*'time' stands twice",
        ),
        ("time: &t [1, *t]", "an alias contains itself"),
    ],
)
def test_a_file_that_is_no_strict_yaml(tmp_path: Path, content: str, message: str) -> None:
    (tmp_path / "map.yaml").write_bytes(content.encode("utf-8", "surrogateescape"))
    with pytest.raises(ConfigError, match=message):
        load_mapping(tmp_path / "map.yaml")

"""Codes for a missing value, zeros and spikes are left out and told before they decide sign, unit or track."""

from pathlib import Path

import numpy as np
import pytest
from table_layouts import DEG, G, plain, text
from table_walk import TableWalk, rows, table_walk, xyz

from pdr_est.frames import Array
from pdr_est.io import read
from pdr_est.io.tables.values.impossible_values import find_impossible_rows
from pdr_est.types.recording import DeviceRecording


@pytest.fixture(scope="module")
def walk() -> TableWalk:
    return table_walk()


def device_of(folder: Path, data: bytes) -> DeviceRecording:
    (folder / "walk.csv").write_bytes(data)
    return read(folder / "walk.csv").devices[0]


def spoilt(values: Array, at: Array, code: float, axes: slice = slice(None)) -> Array:
    result = values.copy()
    result[at, axes] = code
    return result


def assert_kept(device: DeviceRecording, walk: TableWalk, at: Array, force_sign: float = 1.0) -> None:
    """The other rows are those of the walk, and the loss is told with its number."""
    kept = np.setdiff1d(np.arange(len(walk.time_s)), at)
    assert device.specific_force is not None
    assert device.rotation_rate is not None
    np.testing.assert_allclose(device.specific_force.values, force_sign * walk.force[kept], atol=2e-5)
    assert any(f"{len(at)} of {len(walk.time_s)} rows are left out" in words for words in device.warnings)


CODES = [-1.0, -99.0, -999.0, -9999.0, 999.0, 32767.0, -32768.0, 65535.0, 1e9, 0.0]


@pytest.mark.parametrize("code", CODES)
@pytest.mark.parametrize("every", [2, 100, 700])
@pytest.mark.parametrize("unit", [1.0, G], ids=["m/s^2", "g"])
def test_a_code_in_all_axes(tmp_path: Path, walk: TableWalk, code: float, every: int, unit: float) -> None:
    at = np.arange(5, len(walk.time_s), every)
    columns = {"time": walk.time_s, **xyz("acc_{}", spoilt(walk.force / unit, at, code)), **xyz("gyro_{}", walk.rate)}
    assert_kept(device_of(tmp_path, text(rows(columns))), walk, at)


@pytest.mark.parametrize("code", [-999.0, -9999.0, 32767.0])
def test_a_code_in_one_axis(tmp_path: Path, walk: TableWalk, code: float) -> None:
    at = np.arange(5, len(walk.time_s), 10)
    columns = {**plain(walk), "acc_x": spoilt(walk.force, at, code, slice(0, 1))[:, 0]}
    assert_kept(device_of(tmp_path, text(rows(columns))), walk, at)


@pytest.mark.parametrize("code", [-1.0, -999.0, -9999.0])
@pytest.mark.parametrize("unit", [1.0, DEG], ids=["rad/s", "deg/s"])
def test_a_code_of_the_gyroscope(tmp_path: Path, walk: TableWalk, code: float, unit: float) -> None:
    at = np.arange(5, len(walk.time_s), 50)
    columns = {**plain(walk), **xyz("gyro_{}", spoilt(walk.rate / unit, at, code))}
    device = device_of(tmp_path, text(rows(columns)))
    assert device.rotation_rate is not None
    np.testing.assert_allclose(device.rotation_rate.values, np.delete(walk.rate, at, axis=0), atol=2e-5)
    assert any("rotation rate: 40 of 2000 rows are left out" in words for words in device.warnings)


def test_rows_of_zeros_are_left_out_of_every_sensor(tmp_path: Path, walk: TableWalk) -> None:
    at = np.flatnonzero(np.random.default_rng(3).random(len(walk.time_s)) < 0.04)
    columns = {
        "time": walk.time_s,
        **xyz("acc_{}", spoilt(walk.force, at, 0.0)),
        **xyz("gyro_{}", spoilt(walk.rate, at, 0.0)),
    }
    device = device_of(tmp_path, text(rows(columns)))
    assert_kept(device, walk, at)
    assert device.rotation_rate is not None
    assert len(device.rotation_rate) == len(walk.time_s) - len(at)


def test_a_gyroscope_at_rest_keeps_its_zeros(tmp_path: Path, walk: TableWalk) -> None:
    still = np.arange(600)
    columns = {**plain(walk), **xyz("gyro_{}", spoilt(walk.rate, still, 0.0))}
    device = device_of(tmp_path, text(rows(columns)))
    assert device.rotation_rate is not None
    assert len(device.rotation_rate) == len(walk.time_s)


@pytest.mark.parametrize("head", [["time,x,y,z"], []], ids=["axes without a sensor", "no header"])
def test_codes_hide_no_gravity(tmp_path: Path, walk: TableWalk, head: list[str]) -> None:
    at = np.arange(5, len(walk.time_s), 100)
    lines = rows({"time": walk.time_s, **xyz("{}", spoilt(walk.force, at, -999.0))})[1:]
    device = device_of(tmp_path, text([*head, *lines]))
    assert device.specific_force is not None
    np.testing.assert_allclose(device.specific_force.values, np.delete(walk.force, at, axis=0), atol=2e-5)


@pytest.mark.parametrize(("axis", "value"), [(0, 400.0), (2, -900.0)])
def test_lone_spikes_of_the_accelerometer(tmp_path: Path, walk: TableWalk, axis: int, value: float) -> None:
    at = np.array([17, 800, 1500])
    force = walk.force.copy()
    force[at, axis] = value + np.sign(value) * at
    columns = {**plain(walk), **xyz("acc_{}", force)}
    assert_kept(device_of(tmp_path, text(rows(columns))), walk, at)


@pytest.mark.parametrize("unit", [1.0, DEG], ids=["rad/s", "deg/s"])
def test_a_lone_spike_of_the_gyroscope(tmp_path: Path, walk: TableWalk, unit: float) -> None:
    rate = walk.rate / unit
    rate[700, 2] = 120.0 / unit
    device = device_of(tmp_path, text(rows({**plain(walk), **xyz("gyro_{}", rate)})))
    assert device.rotation_rate is not None
    assert len(device.rotation_rate) == len(walk.time_s) - 1


def test_a_sensor_at_its_limit_loses_nothing() -> None:
    time_s = np.arange(0.0, 60.0, 0.02)
    swing = 25.0 * np.sin(2.0 * np.pi * 0.9 * time_s) ** 9
    noise = np.random.default_rng(1).normal(0.0, 0.05, (len(time_s), 3))
    clipped = np.clip(np.column_stack([swing, 0.3 * swing, np.zeros_like(swing)]) + noise, -8.7, 8.7)
    assert not find_impossible_rows(list(clipped.T), never_zero=False, largest=40.0).rows.any()


def test_coarse_values_at_rest_lose_nothing() -> None:
    values = np.round(np.random.default_rng(2).normal(0.0, 0.6, (3000, 3)))
    assert not find_impossible_rows(list(values.T), never_zero=False, largest=40.0).rows.any()


def test_a_quiet_sensor_with_empty_rows_between_loses_nothing() -> None:
    rng = np.random.default_rng(4)
    values = np.round(rng.normal(0.0, 0.01, (4000, 3)), 3)
    values[1000:1400] = np.round(rng.normal(0.0, 1.5, (400, 3)), 1)
    apart = np.full((8000, 3), np.nan)
    apart[::2] = values
    assert not find_impossible_rows(list(apart.T), never_zero=False, largest=40.0).rows.any()


@pytest.mark.parametrize("sensor", ["force", "rate"])
@pytest.mark.parametrize(("axes", "jump"), [(slice(None), 40.0), (slice(1, 2), -70.0)], ids=["all axes", "one axis"])
def test_lone_jumps_within_the_range_of_a_phone(
    tmp_path: Path, walk: TableWalk, sensor: str, axes: slice, jump: float
) -> None:
    at = np.array([40, 333, 900, 1500])
    values = getattr(walk, sensor).copy()
    values[at, axes] += jump if sensor == "force" else 0.4 * jump
    signals = {"force": walk.force, "rate": walk.rate, sensor: values}
    columns = {"time": walk.time_s, **xyz("acc_{}", signals["force"]), **xyz("gyro_{}", signals["rate"])}
    device = device_of(tmp_path, text(rows(columns)))
    read_values = device.specific_force if sensor == "force" else device.rotation_rate
    assert read_values is not None
    np.testing.assert_allclose(read_values.values, np.delete(getattr(walk, sensor), at, axis=0), atol=2e-5)
    assert any(
        "4 of 2000 rows are left out" in words and "lone values far away" in words for words in device.warnings
    )


def test_a_hard_knock_is_no_lone_jump(walk: TableWalk) -> None:
    knocked = walk.force.copy()
    knocked[500:503] += np.array([[30.0], [80.0], [-40.0]])
    assert not find_impossible_rows(list(knocked.T), never_zero=True, lone_jumps=True).rows.any()

"""Formats that others read: what is written comes back, and what has no place is named."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import polars as pl
import pytest

from pdr_est.errors import OutputError, RecordingError
from pdr_est.io import read
from pdr_est.io.formats.exchange.left_out import left_out
from pdr_est.io.formats.exchange.parquet_table import write_parquet_recording
from pdr_est.io.formats.exchange.sensor_logger_folder import write_sensor_logger_folder
from pdr_est.io.formats.exchange.synchronised_arrays import synchronised_arrays, write_hdf5, write_npz
from pdr_est.io.formats.plain_csv.writer import write_plain_csv
from pdr_est.simulate import DeviceParams, Scenario, SensorParams, simulate_walk
from pdr_est.simulate.walker.walking_path import PathParams
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import GeoOrigin, Recording, Signal
from pdr_est.types.sensors import AttitudeReference


@pytest.fixture(scope="module")
def recording() -> Recording:
    """A walk of 8 m whose sensors have clocks of their own, with attitude, magnetic field and true poses."""
    sensors = SensorParams(rate_hz=50.0, record_attitude=True)
    path = PathParams(vertices_m=((0.0, 0.0), (8.0, 0.0)))
    made = simulate_walk(Scenario(path=path, devices=(DeviceParams(sensors=sensors),))).recording
    return replace(made, devices=tuple(replace(one, pressure=pressure(one)) for one in made.devices))


def pressure(device) -> Signal:
    time_s = device.specific_force.time_s[::10]
    return Signal(time_s, 101_325.0 - 0.5 * np.arange(len(time_s))[:, None])


def same(a: Signal | None, b: Signal | None, time_s: float = 0.0, values: float = 0.0) -> None:
    """Both are None, or equal up to these differences."""
    assert (a is None) == (b is None)
    if a is not None and b is not None:
        np.testing.assert_allclose(a.time_s, b.time_s, rtol=0.0, atol=time_s)
        np.testing.assert_allclose(a.values, b.values, rtol=0.0, atol=values)


def test_a_parquet_file_comes_back_bit_by_bit(recording: Recording, tmp_path: Path) -> None:
    write_parquet_recording(recording, tmp_path / "walk.parquet")
    back = read(tmp_path / "walk.parquet")
    assert (back.name, back.format) == ("walk", "Parquet")
    before, after = recording.devices[0], back.devices[0]
    for name in ("specific_force", "rotation_rate", "magnetic_field", "attitude", "pressure"):
        same(getattr(after, name), getattr(before, name))
    assert back.truth.positions is not None
    assert recording.truth.positions is not None
    np.testing.assert_array_equal(back.truth.positions.position_m, recording.truth.positions.position_m)


def test_a_parquet_file_and_a_table_hold_the_same(recording: Recording, tmp_path: Path) -> None:
    write_plain_csv(recording, tmp_path / "walk.csv")
    write_parquet_recording(recording, tmp_path / "walk.parquet")
    table, parquet = read(tmp_path / "walk.csv").devices[0], read(tmp_path / "walk.parquet").devices[0]
    for name in ("specific_force", "rotation_rate", "magnetic_field", "attitude", "pressure"):
        same(getattr(table, name), getattr(parquet, name))


def test_other_parquet_files_are_refused_and_other_columns_named(recording: Recording, tmp_path: Path) -> None:
    path = tmp_path / "other.parquet"
    pl.DataFrame({"a": [1.0], "b": [2.0]}).write_parquet(path)
    with pytest.raises(RecordingError, match=r"without the documented columns time_s, acc_x_mps2.*it has a, b"):
        read(path)
    path.write_bytes(path.read_bytes()[:40])
    with pytest.raises(RecordingError, match="damaged Parquet file"):
        read(path)
    write_parquet_recording(recording, path)
    pl.read_parquet(path).with_columns(pl.lit(1.0).alias("heart_rate")).write_parquet(path)
    assert "columns not used: heart_rate" in read(path).devices[0].decisions
    pl.read_parquet(path).with_columns(pl.lit("x").alias("acc_x_mps2")).write_parquet(path)
    with pytest.raises(RecordingError, match="the column acc_x_mps2 holds String; write numbers"):
        read(path)


@pytest.mark.parametrize("epoch_s", [None, 1_718_030_736.25])
def test_a_sensor_logger_folder_comes_back(epoch_s: float | None, recording: Recording, tmp_path: Path) -> None:
    origin = GeoOrigin(48.1, 11.6)
    (device,) = recording.devices
    device = replace(device, attitude_reference=AttitudeReference.MAGNETIC_NORTH)
    fixes = tuple(PositionFix(t, np.array([t, -2.0 * t]), np.eye(2) * 9.0, "gps") for t in (1.0, 3.0, 5.0))
    marked = (PositionFix(2.0, np.array([1.5, -0.25]), np.eye(2)),)
    given = replace(recording, devices=(device,), origin=origin, fixes=fixes, waypoints=marked, epoch_s=epoch_s)
    write_sensor_logger_folder(given, tmp_path)
    back = read(tmp_path)
    assert back.format == "Sensor Logger"
    zero_s = min(device.specific_force.time_s[0], device.rotation_rate.time_s[0])
    shifted = device.with_times(lambda time_s: time_s - zero_s)
    for name in ("specific_force", "rotation_rate", "magnetic_field", "attitude", "pressure"):
        same(getattr(back.devices[0], name), getattr(shifted, name), time_s=2e-6, values=1e-9)
    assert back.devices[0].attitude_reference is AttitudeReference.MAGNETIC_NORTH
    assert back.devices[0].warnings == ()
    if epoch_s is not None:
        assert back.epoch_s == pytest.approx(epoch_s + zero_s, abs=1e-6)
    apart_m = [fix.position_m - back.fixes[0].position_m for fix in back.fixes]
    np.testing.assert_allclose(apart_m, [[0, 0], [2, -4], [4, -8]], atol=0.01)
    assert [float(np.sqrt(fix.covariance_m2[0, 0])) for fix in back.fixes] == pytest.approx([3.0] * 3)
    np.testing.assert_allclose(back.waypoints[0].position_m, [1.5, -0.25])
    assert back.waypoints[0].time_s == pytest.approx(2.0 - zero_s, abs=1e-6)


def test_arrays_on_common_times_come_back(recording: Recording, tmp_path: Path) -> None:
    write_npz(recording, tmp_path / "walk.npz")
    back = read(tmp_path / "walk.npz")
    before, after = recording.devices[0], back.devices[0]
    assert before.specific_force is not None
    assert after.specific_force is not None
    assert after.rotation_rate is not None
    kept = np.isin(before.specific_force.time_s, after.specific_force.time_s)
    assert kept.mean() > 0.98
    np.testing.assert_array_equal(after.specific_force.values, before.specific_force.values[kept])
    np.testing.assert_array_equal(after.rotation_rate.time_s, after.specific_force.time_s)
    rate = before.rotation_rate
    assert rate is not None
    at = np.interp(after.rotation_rate.time_s, rate.time_s, rate.values[:, 2])
    np.testing.assert_allclose(after.rotation_rate.values[:, 2], at, atol=1e-12)
    assert after.attitude is not None
    np.testing.assert_allclose(np.linalg.norm(after.attitude.values, axis=1), 1.0)
    assert back.truth.positions is not None
    with np.load(tmp_path / "walk.npz", allow_pickle=False) as arrays:
        assert {*arrays} == {*(f"synced/{name}" for name in ("time", "acce", "gyro", "game_rv")), "pose/tango_pos"}


def test_arrays_leave_out_what_would_be_invented(recording: Recording) -> None:
    (device,) = recording.devices
    rate = device.rotation_rate
    assert rate is not None
    seen = (rate.time_s < 2.0) | (rate.time_s > 4.0)
    torn = replace(device, rotation_rate=Signal(rate.time_s[seen], rate.values[seen]))
    time_s = synchronised_arrays(replace(recording, devices=(torn,)))["synced/time"]
    assert not ((time_s > 2.05) & (time_s < 3.95)).any()
    assert (time_s > 4.05).any()


def test_damaged_arrays_are_refused(recording: Recording, tmp_path: Path) -> None:
    arrays = synchronised_arrays(recording)
    np.savez(tmp_path / "short.npz", **(arrays | {"synced/gyro": arrays["synced/gyro"][:-1]}))
    with pytest.raises(RecordingError, match=r"gyro has the shape .* write it again"):
        read(tmp_path / "short.npz")
    np.savez(tmp_path / "object.npz", **(arrays | {"synced/gyro": np.array([{"a": 1}], dtype=object)}))
    with pytest.raises(RecordingError, match="damaged array"):
        read(tmp_path / "object.npz")


def test_hdf5_is_ronins_layout_or_says_what_is_missing(recording: Recording, tmp_path: Path) -> None:
    try:
        import h5py  # noqa: F401
    except ImportError:
        with pytest.raises(OutputError, match=r"needs the package h5py: .* or write .npz instead"):
            write_hdf5(recording, tmp_path / "data.hdf5")
        return
    write_hdf5(recording, tmp_path / "data.hdf5")
    back, npz = read(tmp_path / "data.hdf5").devices[0], tmp_path / "walk.npz"
    write_npz(recording, npz)
    assert back.specific_force is not None
    other = read(npz).devices[0].specific_force
    assert other is not None
    np.testing.assert_allclose(back.specific_force.values, other.values)
    np.testing.assert_allclose(back.specific_force.time_s, other.time_s - other.time_s[0], atol=1e-9)


def test_several_devices_and_no_gyroscope_are_refused(recording: Recording, tmp_path: Path) -> None:
    (device,) = recording.devices
    pair = replace(recording, devices=(device, replace(device, name="other")))
    with pytest.raises(OutputError, match=r"2 devices .* write each into its own with --device"):
        write_npz(pair, tmp_path / "walk.npz")
    with pytest.raises(OutputError, match=r"2 devices"):
        write_sensor_logger_folder(pair, tmp_path)
    bare = replace(recording, devices=(replace(device, rotation_rate=None),))
    with pytest.raises(OutputError, match="arrays need accelerometer and gyroscope: convert to CSV instead"):
        write_npz(bare, tmp_path / "walk.npz")


def test_what_has_no_place_is_named(recording: Recording) -> None:
    fixes = (PositionFix(1.0, np.zeros(2), np.eye(2)),)
    words = left_out(replace(recording, fixes=fixes, epoch_s=1.7e9), ("positions",))
    assert "1 position fixes" in words
    assert "the date of time zero" in words
    assert not any("true positions" in one for one in words)


def test_each_writer_tells_what_it_left_out(recording: Recording, tmp_path: Path) -> None:
    (device,) = recording.devices
    device = replace(
        device,
        model="X1",
        platform="ios",
        usual_axes=False,
        attitude_reference=AttitudeReference.TRUE_NORTH,
        linear_acceleration=device.specific_force,
    )
    positions = recording.truth.positions
    assert positions is not None
    sparse = replace(positions, time_s=positions.time_s[::400], position_m=positions.position_m[::400])
    fixes = tuple(PositionFix(t, np.zeros(2), np.eye(2), source) for t, source in ((1.0, "gps"), (2.0, "marker")))
    given = replace(
        recording,
        devices=(device,),
        truth=replace(recording.truth, positions=sparse),
        fixes=fixes,
        origin=GeoOrigin(48.1, 11.6),
    )
    always = ("acceleration without gravity", "axes are not those of a phone", "true-north", "platform, ios")
    (tmp_path / "export").mkdir()
    for write, name, others in (
        (write_plain_csv, "walk.csv", ("2 position fixes", "device, X1")),
        (write_parquet_recording, "walk.parquet", ("2 position fixes", "device, X1")),
        (write_npz, "walk.npz", ("2 position fixes", "device, X1", "air pressure", "true positions")),
        (write_sensor_logger_folder, "export", ("1 position fixes", "true positions")),
    ):
        told = "; ".join(write(given, tmp_path / name))
        assert [words for words in (*always, *others) if words not in told] == [], name
        assert ("air pressure" in told) == (name == "walk.npz")
    assert "true positions" not in "; ".join(write_npz(recording, tmp_path / "dense.npz"))


def test_a_sensor_that_never_overlaps_is_told_and_not_written(recording: Recording, tmp_path: Path) -> None:
    (device,) = recording.devices
    assert device.specific_force is not None
    time_s = device.specific_force.time_s
    late = Signal(time_s + 1e4, np.ones((len(time_s), 3)))
    told = write_npz(replace(recording, devices=(replace(device, magnetic_field=late),)), tmp_path / "walk.npz")
    assert any("magnet, which has no sample" in words for words in told)
    assert read(tmp_path / "walk.npz").devices[0].magnetic_field is None
    # Files of earlier versions have an array without any number.
    arrays = synchronised_arrays(recording)
    empty = {"synced/magnet": np.full((len(arrays["synced/time"]), 3), np.nan)}
    np.savez(tmp_path / "old.npz", **arrays, **empty)
    old = read(tmp_path / "old.npz").devices[0]
    assert old.magnetic_field is None
    assert old.specific_force is not None
    assert "magnet: left out because it has no rows" in old.warnings

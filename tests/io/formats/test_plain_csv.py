"""Plain tables: the project's own format comes back bit by bit, foreign headers are understood or refused."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fabricated import Walk, make_walk, table, xyz
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from pdr_est.errors import OutputError, RecordingError
from pdr_est.frames import Array
from pdr_est.io.formats.plain_csv import reader as plain_csv
from pdr_est.io.formats.plain_csv.writer import write_plain_csv
from pdr_est.io.formats.registry import read
from pdr_est.io.tables.quantities import CANONICAL
from pdr_est.io.text.container import Source
from pdr_est.types.ground_truth import TruePositions, Truth
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import DeviceRecording, Recording, Signal

PARTS = {"specific_force": 3, "rotation_rate": 3, "magnetic_field": 3, "attitude": 4, "pressure": 1}
ACC, GYR = ("acc_x_mps2", "acc_y_mps2", "acc_z_mps2"), ("gyr_x_radps", "gyr_y_radps", "gyr_z_radps")


@pytest.fixture(scope="module")
def walk() -> Walk:
    return make_walk(duration_s=4.0)


def save(path: Path, columns: dict[str, Any], separator: str = ",", decimal: str = ".") -> Path:
    path.write_bytes(table(columns, separator, decimal))
    return path


def canonical(walk: Walk) -> dict[str, Any]:
    return {"time_s": walk.time_s, **xyz(walk.force, ACC), **xyz(walk.rate, GYR)}


def device_of(path: Path) -> DeviceRecording:
    recording = read(path)
    assert recording.format == "plain CSV"
    return recording.devices[0]


def assert_holds(signal: Signal | None, time_s: Array, values: Array) -> None:
    assert signal is not None
    np.testing.assert_array_equal(signal.time_s, time_s)
    np.testing.assert_array_equal(signal.values, values)


finite = st.floats(-1e30, 1e30)  # the largest that is taken for a measurement
clock = st.integers(1, 30).flatmap(
    # Few distinct values: stamps repeat, go backwards and coincide between sensors.
    lambda n: hnp.arrays(np.float64, n, elements=st.integers(0, 12).map(lambda k: k / 7.0))
)


@st.composite
def signals(draw: st.DrawFn, width: int) -> Signal:
    time_s = draw(clock)
    values = draw(hnp.arrays(np.float64, (len(time_s), width), elements=finite))
    values[~values.any(axis=1)] = 1.0  # zeros on all axes are no measurement of a field or a force
    return Signal(time_s, values)


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_what_is_written_is_read_bit_by_bit(tmp_path: Path, data: st.DataObject) -> None:
    optional = {name: st.none() | signals(width) for name, width in PARTS.items()}
    drawn = {name: data.draw(strategy, label=name) for name, strategy in optional.items()}
    drawn["specific_force"] = data.draw(signals(3), label="specific_force")
    if drawn["pressure"] is not None:
        drawn["pressure"] = Signal(drawn["pressure"].time_s, np.abs(drawn["pressure"].values) + 1.0)
    path = tmp_path / "walk.csv"
    write_plain_csv(Recording("walk", "test", (DeviceRecording(**drawn),)), path)
    device = plain_csv.read_source(Source.open(path)).devices[0]
    for name, signal in drawn.items():
        back = getattr(device, name)
        if signal is None:
            assert back is None
            continue
        assert back.time_s.tobytes() == signal.time_s.tobytes()
        assert np.array_equal(back.values, signal.values)


def test_zeros_beside_empty_cells_are_measured(tmp_path: Path) -> None:
    """Rows without a sample of the other sensor have empty cells, so that rows of zeros are what was measured."""
    rate = Signal(np.arange(60) / 50.0, np.repeat([[1.0, 0.0, 0.0], [0.0, 0.0, 0.0]], [4, 56], axis=0))
    force = Signal(np.arange(40) / 50.0 + 0.005, np.full((40, 3), 5.7))
    path = tmp_path / "walk.csv"
    write_plain_csv(Recording("walk", "test", (DeviceRecording(specific_force=force, rotation_rate=rate),)), path)
    back = plain_csv.read_source(Source.open(path)).devices[0]
    assert_holds(back.rotation_rate, rate.time_s, rate.values)


def test_sensors_of_different_rates_share_rows_only_at_equal_times(tmp_path: Path, walk: Walk) -> None:
    slow = Signal(walk.time_s[::4], walk.gravity[::4])
    shifted = Signal(walk.time_s + 0.005, walk.rate)
    true = TruePositions(np.array([0.0, 1.0]), np.array([[0.0, 0.5], [1.0, 2.0]]), 0.1, "poses")
    device = DeviceRecording(
        specific_force=Signal(walk.time_s, walk.force), rotation_rate=shifted, magnetic_field=slow
    )
    path = tmp_path / "walk.csv"
    write_plain_csv(Recording("walk", "test", (device,), truth=Truth(positions=true)), path)
    assert len(path.read_text().splitlines()) == 1 + 2 * len(walk.time_s)
    recording = read(path)
    back = recording.devices[0]
    assert_holds(back.specific_force, walk.time_s, walk.force)
    assert_holds(back.rotation_rate, shifted.time_s, walk.rate)
    assert_holds(back.magnetic_field, slow.time_s, slow.values)
    assert recording.truth.positions is not None
    np.testing.assert_array_equal(recording.truth.positions.position_m, true.position_m)
    assert back.warnings == ()


def test_the_writer_refuses_what_does_not_fit(tmp_path: Path, walk: Walk) -> None:
    device = DeviceRecording(specific_force=Signal(walk.time_s, walk.force))
    with pytest.raises(OutputError, match=r"2 devices \(.*\) do not fit into one file; .* --device NAME"):
        write_plain_csv(Recording("walk", "test", (device, device)), tmp_path / "walk.csv")
    with pytest.raises(OutputError, match="no samples"):
        write_plain_csv(Recording("walk", "test", (DeviceRecording(),)), tmp_path / "walk.csv")
    with pytest.raises(OutputError, match="cannot be written"):
        write_plain_csv(Recording("walk", "test", (device,)), tmp_path / "absent" / "walk.csv")


@pytest.mark.parametrize(("separator", "decimal"), [(",", "."), (";", "."), ("\t", "."), (";", ","), ("\t", ",")])
def test_all_separators_and_decimal_marks(tmp_path: Path, walk: Walk, separator: str, decimal: str) -> None:
    device = device_of(save(tmp_path / "walk.csv", canonical(walk), separator, decimal))
    assert_holds(device.specific_force, walk.time_s, walk.force)
    assert_holds(device.rotation_rate, walk.time_s, walk.rate)


FOREIGN = [
    ("TimeStamp[ms]", 1e3, "Acc{}[m/s^2]", 1.0, "Gyro{}[rad/s]", 1.0),
    ("Time", 1e9, "Accel_{}", 1.0, "Gyro_{}", 1.0),
    ("t", 1.0, "accelerometer {} (g)", 1 / 9.80665, "gyroscope {} (deg/s)", 180 / np.pi),
    ("seconds_elapsed", 1.0, "a{}", 1 / 9.80665, "rotationRate.{}", 180 / np.pi),
    ("timestamp (us)", 1e6, "Acceleration {} (m/s²)", 1.0, "GYR_{} [°/s]", 180 / np.pi),
]


@pytest.mark.parametrize(("time", "per_s", "acc", "acc_scale", "gyr", "gyr_scale"), FOREIGN)
def test_foreign_headers_with_and_without_units(
    tmp_path: Path, walk: Walk, time: str, per_s: float, acc: str, acc_scale: float, gyr: str, gyr_scale: float
) -> None:
    columns = {
        time: (walk.time_s + 5.0) * per_s,
        **xyz(walk.force * acc_scale, [acc.format(axis) for axis in "XYZ"]),
        **xyz(walk.rate * gyr_scale, [gyr.format(axis) for axis in "xyz"]),
    }
    device = device_of(save(tmp_path / "walk.csv", columns))
    assert device.specific_force is not None
    assert device.rotation_rate is not None
    np.testing.assert_allclose(device.specific_force.time_s, walk.time_s, atol=1e-6)
    np.testing.assert_allclose(device.specific_force.values, walk.force, rtol=1e-9)
    np.testing.assert_allclose(device.rotation_rate.values, walk.rate, rtol=1e-9)
    in_g = acc_scale != 1.0  # recorders in g have either sign
    assert ["the sign of the acceleration is not certain" in words for words in device.warnings] == [True] * in_g


def test_core_motion_titles_have_apples_signs(tmp_path: Path, walk: Walk) -> None:
    titles = [f"accelerometerAcceleration{axis}(G)" for axis in "XYZ"]
    rates = [f"motionRotationRate{axis}(rad/s)" for axis in "XYZ"]
    columns = {
        "accelerometerTimestamp_sinceReboot(s)": walk.time_s + 77.0,
        "loggingTime(txt)": [f"2024-06-10T14:45:{36 + t:09.6f}+03:00" for t in walk.time_s],
        **xyz(-walk.force / 9.80665, titles),
        **xyz(walk.rate, rates),
    }
    recording = read(save(tmp_path / "walk.csv", columns))
    force = recording.devices[0].specific_force
    assert force is not None
    np.testing.assert_allclose(force.values, walk.force, rtol=1e-9)
    np.testing.assert_allclose(force.time_s, walk.time_s, atol=1e-6)
    assert recording.epoch_s == pytest.approx(1_718_019_936.0)


def test_header_and_values_that_contradict_are_reported(tmp_path: Path, walk: Walk) -> None:
    columns = canonical(walk)
    for name in ACC:
        columns[name] = columns[name] / 9.80665
    for name in GYR:
        columns[name] = np.degrees(columns[name])
    device = device_of(save(tmp_path / "walk.csv", columns))
    assert_holds(device.rotation_rate, walk.time_s, np.degrees(walk.rate))
    assert sum("contradicts its values" in words for words in device.warnings) == 2


def test_a_canonical_file_with_downward_force_is_reported_and_not_changed(tmp_path: Path, walk: Walk) -> None:
    columns = {
        "time_s": walk.time_s,
        **xyz(-walk.force, ACC),
        **dict(zip(("qw", "qx", "qy", "qz"), walk.quaternion.T, strict=True)),
    }
    device = device_of(save(tmp_path / "walk.csv", columns))
    assert_holds(device.specific_force, walk.time_s, -walk.force)
    assert any("contradict" in words for words in device.warnings)


def test_dates_without_zone_give_no_unix_time(tmp_path: Path, walk: Walk) -> None:
    columns = {
        "Time": [f"2025-02-25 11:02:{9 + t:06.3f}" for t in walk.time_s],
        **xyz(walk.force, ("Accel_X", "Accel_Y", "Accel_Z")),
    }
    recording = read(save(tmp_path / "walk.csv", columns))
    assert recording.epoch_s is None
    force = recording.devices[0].specific_force
    assert force is not None
    np.testing.assert_allclose(force.time_s, walk.time_s, atol=1e-9)


def test_a_wrong_date_is_left_out_and_told(tmp_path: Path, walk: Walk) -> None:
    good = [f"2025-02-25T11:02:{9 + t:06.3f}Z" for t in walk.time_s]
    columns = {"Time": [*good[:3], "2025-02-25T11:62:00Z", *good[4:]], **xyz(walk.force, ("Acc_X", "Acc_Y", "Acc_Z"))}
    device = device_of(save(tmp_path / "walk.csv", columns))
    assert device.specific_force is not None
    np.testing.assert_array_equal(device.specific_force.values, np.delete(walk.force, 3, axis=0))
    assert any("'2025-02-25T11:62:00Z' in row 4" in words for words in device.warnings)


def test_times_in_several_zones_are_one_clock(tmp_path: Path, walk: Walk) -> None:
    times = [
        f"2025-02-25T{11 + i % 2}:02:{9 + t:06.3f}{'+01:00' if i % 2 else 'Z'}" for i, t in enumerate(walk.time_s)
    ]
    device = device_of(save(tmp_path / "walk.csv", {"Time": times, **xyz(walk.force, ("Acc_X", "Acc_Y", "Acc_Z"))}))
    assert device.specific_force is not None
    np.testing.assert_allclose(device.specific_force.time_s, walk.time_s, atol=1e-9)


def test_dashes_are_empty_cells(tmp_path: Path, walk: Walk) -> None:
    data = table({**canonical(walk), "pressure_pa": ["-"] * len(walk.time_s), "Lux[lux]": ["-"] * len(walk.time_s)})
    path = tmp_path / "walk.csv"
    path.write_bytes(data)
    device = device_of(path)
    assert device.pressure is None
    assert_holds(device.specific_force, walk.time_s, walk.force)


def test_repeated_positions_are_one_fix(tmp_path: Path, walk: Walk) -> None:
    second = np.floor(walk.time_s)
    columns = {**canonical(walk), "Latitude": 60.0 + 1e-5 * second, "Longitude": np.full(len(second), 24.0)}
    recording = read(save(tmp_path / "walk.csv", columns))
    assert [fix.time_s for fix in recording.fixes] == [0.0, 1.0, 2.0, 3.0]
    fix: PositionFix = recording.fixes[2]
    assert fix.position_m == pytest.approx([0.0, 2e-5 * 111_412], abs=0.02)
    np.testing.assert_array_equal(fix.covariance_m2, 9.0 * np.eye(2))
    assert (fix.source, fix.robust, recording.truth.positions) == ("gps", True, None)


def test_nan_and_infinite_samples_are_left_out_with_a_warning(tmp_path: Path, walk: Walk) -> None:
    columns = canonical(walk)
    columns["gyr_y_radps"] = columns["gyr_y_radps"].copy()
    columns["gyr_y_radps"][[4, 9]] = [np.nan, np.inf]
    device = device_of(save(tmp_path / "walk.csv", columns))
    kept = np.delete(np.arange(len(walk.time_s)), [4, 9])
    assert_holds(device.rotation_rate, walk.time_s[kept], walk.rate[kept])
    assert any("rotation rate: 2 of 400 rows" in words for words in device.warnings)


def test_text_in_a_number_column_is_left_out_with_line_and_column(tmp_path: Path, walk: Walk) -> None:
    path = save(tmp_path / "walk.csv", canonical(walk))
    lines = path.read_text().splitlines()
    lines[8] = lines[8].replace(lines[8].split(",")[1], "walked")
    path.write_text("\n".join(lines))
    device = device_of(path)
    kept = np.delete(np.arange(len(walk.time_s)), 7)
    assert_holds(device.specific_force, walk.time_s[kept], walk.force[kept])
    assert any("line 9: 'walked' in column 'acc_x_mps2'" in words for words in device.warnings)


def test_columns_without_values_are_an_error_when_nothing_is_left(tmp_path: Path) -> None:
    path = tmp_path / "walk.csv"
    path.write_text(",".join(("time_s", *ACC)) + "\n0.0,,,\n0.1,,,\n")
    with pytest.raises(RecordingError, match="neither accelerometer nor gyroscope has values"):
        read(path)


def test_one_sample_is_read(tmp_path: Path) -> None:
    path = tmp_path / "walk.csv"
    path.write_text(",".join(("time_s", *ACC)) + "\n0.5,0.1,0.2,9.8\n")
    assert_holds(device_of(path).specific_force, np.array([0.5]), np.array([[0.1, 0.2, 9.8]]))


@pytest.mark.parametrize(
    "header",
    ["", "time_s", "a,b,c", "time_s,acc_x_mps2,acc_y_mps2", "acc_x_mps2,acc_y_mps2,acc_z_mps2", "0.1,0.2,9.8"],
)
def test_an_unknown_header_is_not_taken(tmp_path: Path, header: str) -> None:
    path = tmp_path / "walk.csv"
    path.write_text(f"{header}\n1,2,3\n")
    assert not plain_csv.sniff(Source.open(path))


def test_the_documented_titles_are_distinct() -> None:
    titles = [title for names in CANONICAL.values() for title in names]
    assert len(titles) == len(set(titles))


@pytest.mark.slow
def test_real_tables_are_physically_right(shared_data: Path) -> None:
    paths = sorted((shared_data / "known-distance").glob("*.csv.gz")) + sorted(
        (shared_data / "phone-gps").glob("*.csv.gz")
    )
    assert paths
    for path in paths:
        recording = read(path)
        device = recording.devices[0]
        assert device.specific_force is not None
        assert device.rotation_rate is not None
        assert np.linalg.norm(device.specific_force.values.mean(axis=0)) == pytest.approx(10.0, abs=2.7)
        assert len(recording.fixes) == 0 or 100 < len(recording.fixes) < 400
        assert (device.attitude is not None) == (path.parent.name == "phone-gps")

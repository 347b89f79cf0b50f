"""Details of layouts: units that are not known, separators at the end of rows, thousands, packings, units but g."""

from pathlib import Path

import numpy as np
import pytest
from read_tables import assert_same_samples, device_of
from table_layouts import DEG, plain, text, ticks
from table_walk import TableWalk, rows, table_walk, xyz

from pdr_est.errors import RecordingError
from pdr_est.types.recording import DeviceRecording


@pytest.fixture(scope="module")
def walk() -> TableWalk:
    return table_walk()


def assert_walk(device: DeviceRecording, walk: TableWalk) -> None:
    assert_same_samples(device, walk)
    assert device.specific_force is not None
    np.testing.assert_allclose(device.specific_force.time_s, walk.time_s, atol=1e-3)


def test_a_row_of_units_with_some_that_are_not_known(tmp_path: Path, walk: TableWalk) -> None:
    """Shimmer writes raw columns without a unit and the field in `local_flux` beside the calibrated ones."""
    lines = rows(
        {
            "Timestamp": ticks(walk, 1000, 0),
            **xyz("Accel_{}_CAL", walk.force),
            **xyz("Gyro_{}_CAL", walk.rate / DEG),
            **xyz("Temp_{}_RAW", np.round(walk.force * 83.0)),
            **xyz("Light_{}_RAW", np.round(walk.force * 7.0)),
            **xyz("Mag_{}_CAL", walk.field / 50.0),
        }
    )
    units = ["ms", *["m/(s^2)"] * 3, *["deg/s"] * 3, *["no_units"] * 6, *["local_flux"] * 3]
    assert_walk(device_of(tmp_path, text([lines[0], ",".join(units), *lines[1:]])), walk)


def test_a_separator_at_the_end_of_every_row_damages_none(tmp_path: Path, walk: TableWalk) -> None:
    lines = [line.replace(",", "\t") + "\t" for line in rows(plain(walk))]
    for end in ("", "\n", "\n\n \t\n"):
        device = device_of(tmp_path, ("\n".join(lines) + end).encode())
        assert_walk(device, walk)
        assert device.warnings == ()


def test_thousands_that_are_set_apart_in_the_clock_alone(tmp_path: Path, walk: TableWalk) -> None:
    lines = [line.replace(",", ";") for line in rows(plain(walk))]
    kept = [f"{int(float(line.split(';')[0]) * 1000 + 0.5):,};{line.partition(';')[2]}" for line in lines[1:]]
    device = device_of(tmp_path, text([lines[0], *kept]))
    assert_walk(device, walk)
    assert device.warnings == ()


def test_decimal_commas_with_three_places_are_no_thousands(tmp_path: Path, walk: TableWalk) -> None:
    lines = [line.replace(",", ";") for line in rows(plain(walk))]
    kept = [f"{float(line.split(';')[0]):.3f}".replace(".", ",") + f";{line.partition(';')[2]}" for line in lines[1:]]
    assert_walk(device_of(tmp_path, text([lines[0], *kept])), walk)


def test_gravity_and_the_motion_without_it_as_la_and_g(tmp_path: Path, walk: TableWalk) -> None:
    columns = {"t": walk.time_s, **xyz("g{}", walk.gravity), **xyz("la{}", walk.user), **xyz("w{}", walk.rate)}
    assert_walk(device_of(tmp_path, text(rows(columns))), walk)


@pytest.mark.parametrize(
    ("head", "name"),
    [(b"BZh91AY&SY", "a bzip2 file"), (b"\xfd7zXZ\0\0", "an xz file"), (b"7z\xbc\xaf\x27\x1c", "a 7z archive")],
)
def test_a_packing_that_is_not_read_is_named(tmp_path: Path, head: bytes, name: str) -> None:
    with pytest.raises(RecordingError, match=f"it is {name}: unpack it"):
        device_of(tmp_path, head + bytes(range(256)) * 8)


def test_a_unit_that_is_not_g_is_not_called_g(tmp_path: Path, walk: TableWalk) -> None:
    columns = {"time": walk.time_s, **xyz("acc_{} (cm/s^2)", 100.0 * walk.force), **xyz("gyro_{} (rad/s)", walk.rate)}
    device = device_of(tmp_path, text(rows(columns)))
    assert_walk(device, walk)
    assert "recorders in this unit have either sign" in " ".join(device.decisions)


def test_times_since_the_row_before_are_no_clock(tmp_path: Path, walk: TableWalk) -> None:
    columns = plain(walk)
    steps = {"delta_ms": 20 + np.arange(len(walk.time_s)) % 3 - 1}
    lines = rows({**steps, **{title: values for title, values in columns.items() if title != "time"}})
    with pytest.raises(RecordingError, match=r"'delta_ms' holds the time since the row before.*rate_hz: 50"):
        device_of(tmp_path, text(lines))


def test_titles_in_windows_1251(tmp_path: Path, walk: TableWalk) -> None:
    columns = {"время": walk.time_s, **xyz("ускорение {}", walk.force), **xyz("угловая скорость {}", walk.rate)}
    assert_walk(device_of(tmp_path, ("\n".join(rows(columns)) + "\n").encode("cp1251")), walk)


def test_calibrated_columns_beside_raw_ones_count(tmp_path: Path, walk: TableWalk) -> None:
    counts = {**xyz("a{}_raw", np.round(1670.0 * walk.force)), **xyz("g{}_raw", np.round(7500.0 * walk.rate))}
    columns = {"time": walk.time_s, **counts, **xyz("a{}", walk.force), **xyz("g{}", walk.rate / DEG)}
    assert_walk(device_of(tmp_path, text(rows(columns))), walk)


def test_no_numbered_values_without_a_sensor(tmp_path: Path, walk: TableWalk) -> None:
    columns = {"time": walk.time_s, **{f"value_{i}": walk.force[:, i] for i in range(3)}}
    with pytest.raises(RecordingError, match="no accelerometer or gyroscope"):
        device_of(tmp_path, text(rows(columns)))

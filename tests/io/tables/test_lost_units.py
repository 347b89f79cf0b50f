"""Values whose unit is lost are refused with the reason, and ordinary ones never are."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from table_layouts import text
from table_walk import rows, table_walk, xyz

from pdr_est.errors import RecordingError
from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array
from pdr_est.io import read
from pdr_est.types.recording import DeviceRecording


def device_of(folder: Path, force: Array, rate: Array) -> DeviceRecording:
    columns = {"time": table_walk().time_s, **xyz("acc_{}", force), **xyz("gyro_{}", rate)}
    (folder / "walk.csv").write_bytes(text(rows(columns)))
    return read(folder / "walk.csv").devices[0]


def from_0_to_1(values: Array) -> Array:
    return np.asarray((values - values.min(axis=0)) / np.ptp(values, axis=0))


def from_minus_1_to_1(values: Array) -> Array:
    return 2.0 * from_0_to_1(values) - 1.0


def standardised(values: Array) -> Array:
    return np.asarray((values - values.mean(axis=0)) / values.std(axis=0))


@pytest.mark.parametrize("scaled", [from_0_to_1, from_minus_1_to_1, standardised])
@pytest.mark.parametrize("sensor", ["acc_x", "gyro_x"])
def test_normalised_values_are_refused(tmp_path: Path, scaled: Callable[[Array], Array], sensor: str) -> None:
    walk = table_walk()
    force, rate = (scaled(walk.force), walk.rate) if sensor == "acc_x" else (walk.force, scaled(walk.rate))
    with pytest.raises(RecordingError, match=rf"{sensor}, .* were normalised, because each axis "):
        device_of(tmp_path, force, rate)


@pytest.mark.parametrize("counts", [64, 256, 2048, 16384])
def test_counts_are_refused_with_what_one_is(tmp_path: Path, counts: int) -> None:
    walk = table_walk()
    integers = np.round(walk.force / STANDARD_GRAVITY_MPS2 * counts)
    with pytest.raises(RecordingError, match="counts of a sensor chip, state what one is with --map") as told:
        device_of(tmp_path, integers, walk.rate)
    found = re.search(r"unit: ([0-9.e-]+) for the accelerometer", str(told.value))
    assert found is not None
    assert float(found[1]) == pytest.approx(STANDARD_GRAVITY_MPS2 / counts, rel=0.03)


@pytest.mark.parametrize("unit", [1.0, 1000.0 / STANDARD_GRAVITY_MPS2, 100.0], ids=["m/s^2", "mg", "cm/s^2"])
def test_integers_in_a_usual_unit_are_read(tmp_path: Path, unit: float) -> None:
    walk = table_walk()
    device = device_of(tmp_path, np.round(walk.force * unit), walk.rate)
    assert device.specific_force is not None
    np.testing.assert_allclose(device.specific_force.values, walk.force, atol=0.51 / unit + 0.5)


def test_an_odd_unit_of_gravity_is_named_as_such(tmp_path: Path) -> None:
    walk = table_walk()
    (words,) = (w for w in device_of(tmp_path, 10.0 * walk.force, walk.rate).warnings if "mean acceleration" in w)
    assert "gravity in no usual unit" in words
    assert "state the unit with --map" in words


def test_integers_of_a_gyroscope_may_be_counts(tmp_path: Path) -> None:
    walk = table_walk()
    warnings = device_of(tmp_path, walk.force, np.round(np.degrees(walk.rate) * 65.5)).warnings
    assert any("if they are the counts of a sensor chip" in words for words in warnings)
    assert not any(
        "counts of a sensor chip" in words
        for words in device_of(tmp_path, walk.force, np.round(np.degrees(walk.rate))).warnings
    )

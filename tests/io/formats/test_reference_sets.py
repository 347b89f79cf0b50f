"""Data sets with their reference positions: RIDI, EuRoC and TUM VI, IPIN 2021."""

from pathlib import Path

import numpy as np
import pytest
from app_exports import Files, ns, plain_rows, titled
from fabricated import START_NS, Walk, as_folder, make_walk, table

from pdr_est.io import read
from pdr_est.types.recording import Recording


@pytest.fixture(scope="module")
def walk() -> Walk:
    return make_walk(duration_s=6.0)


def assert_is_walk(recording: Recording, walk: Walk) -> None:
    device = recording.devices[0]
    assert device.specific_force is not None
    assert device.rotation_rate is not None
    assert device.specific_force.values == pytest.approx(walk.force, abs=1e-6)
    assert device.rotation_rate.values == pytest.approx(walk.rate, abs=1e-6)
    assert device.specific_force.time_s == pytest.approx(walk.time_s, abs=2e-3)


def test_ridi_has_the_rotation_vector_and_the_positions(tmp_path: Path, walk: Walk) -> None:
    columns = {
        "": list(range(len(walk.time_s))),
        "time": ns(walk),
        **titled("gyro_{}", walk.rate, "xyz"),
        **titled("acce_{}", walk.force, "xyz"),
        **titled("linacce_{}", walk.user, "xyz"),
        **titled("grav_{}", walk.gravity, "xyz"),
        **titled("magnet_{}", 30.0 + walk.rate, "xyz"),
        **titled("pos_{}", np.column_stack([walk.time_s, 2.0 * walk.time_s, 0.0 * walk.time_s]), "xyz"),
        **titled("ori_{}", np.roll(walk.quaternion, 1, axis=1), "wxyz"),
        **titled("rv_{}", walk.quaternion, "wxyz"),
    }
    recording = read(as_folder(tmp_path, {"processed/data.csv": table(columns)}))
    assert recording.format == "RIDI"
    assert_is_walk(recording, walk)
    device, true = recording.devices[0], recording.truth.positions
    assert device.attitude is not None
    assert true is not None
    assert device.attitude.values == pytest.approx(walk.quaternion)
    assert true.position_m[:, 1] == pytest.approx(2.0 * walk.time_s)
    assert any("ori_w" in decision for decision in device.decisions)


def euroc_files(walk: Walk) -> Files:
    motion = table(
        {
            "#timestamp [ns]": ns(walk, START_NS),
            **titled("w_RS_S_{} [rad s^-1]", walk.rate, "xyz"),
            **titled("a_RS_S_{} [m s^-2]", walk.force, "xyz"),
        }
    )
    reference = table(
        {
            "#timestamp [ns]": [stamp + 500_000_000 for stamp in ns(walk, START_NS)],
            **titled(" p_RS_R_{} [m]", np.column_stack([walk.time_s, 3.0 * walk.time_s, walk.time_s]), "xyz"),
        }
    )
    return {
        "mav0/imu0/data.csv": motion,
        "mav0/imu0/sensor.yaml": b"rate_hz: 100\n",
        "mav0/mocap0/data.csv": reference,
    }


def test_euroc_has_the_positions_of_the_folder_beside(tmp_path: Path, walk: Walk) -> None:
    recording = read(as_folder(tmp_path, euroc_files(walk)))
    assert recording.format == "EuRoC, TUM VI"
    assert_is_walk(recording, walk)
    true = recording.truth.positions
    assert true is not None
    assert true.time_s[0] == pytest.approx(0.5)
    assert true.position_m[:, 1] == pytest.approx(3.0 * walk.time_s)


def test_the_inertial_table_of_euroc_alone_is_enough(tmp_path: Path, walk: Walk) -> None:
    (tmp_path / "data.csv").write_bytes(euroc_files(walk)["mav0/imu0/data.csv"])
    recording = read(tmp_path / "data.csv")
    assert_is_walk(recording, walk)
    assert recording.truth.positions is None


def test_ipin_2021_has_waypoints_and_pressure(tmp_path: Path, walk: Walk) -> None:
    stamps = [f"{START_NS / 1e6 + 1e3 * t:.18e}" for t in walk.time_s]
    files = {
        "acc.csv": plain_rows(stamps, *walk.force.T, separator=" "),
        "gyr.csv": plain_rows(stamps, *walk.rate.T, separator=" "),
        "bar.csv": plain_rows(stamps, 1016.0 + 0.1 * np.sin(walk.time_s), separator=" "),
        "ref.csv": b"1718030737000 566578.7 5932830.4 19.6\n1718030739000 566580.7 5932835.4 19.6\n",
        "plan.geojson": b"{}",
    }
    recording = read(as_folder(tmp_path, files))
    assert recording.format == "IPIN 2021"
    assert_is_walk(recording, walk)
    device, true = recording.devices[0], recording.truth.positions
    assert device.pressure is not None
    assert true is not None
    assert np.median(device.pressure.values) == pytest.approx(101_600.0, rel=1e-3)
    assert true.time_s == pytest.approx([1.0, 3.0])
    assert true.position_m == pytest.approx(np.array([[0.0, 0.0], [2.0, 5.0]]))
    assert "files not used: plan.geojson" in device.decisions

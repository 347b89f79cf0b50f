"""OxIOD, WeAllWalk and MotionSense: Core Motion's units, signs and attitude, and each set's truth.

The synthetic phone stands upright (device y up) and turns left: roll 0, pitch 90 degrees, growing yaw, so that
gravity is (0, -1, 0) g and the whole turn shows in the y component of the rotation rate.
"""

import gzip
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from pdr_est.errors import RecordingError
from pdr_est.frames import STANDARD_GRAVITY_MPS2, twist_about_vertical, up_in_device
from pdr_est.io import read
from pdr_est.types.recording import DeviceRecording

N = 40
TURN_RADPS = 0.5
USER_G = (0.1, 0.2, -0.3)
FORCE_MPS2 = np.array([-0.1, 0.8, 0.3]) * STANDARD_GRAVITY_MPS2
UPRIGHT_QUATERNION_XYZW = (np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5))


def angles(row: int, rate_hz: float) -> list[float]:
    return [0.0, np.pi / 2, TURN_RADPS * row / rate_hz]


def lines(rows: Sequence[Sequence[float]]) -> str:
    return "".join(",".join(f"{value:.6f}" for value in row) + "\n" for row in rows)


def oxiod_table() -> str:
    rate, gravity, magnetic = [0.0, TURN_RADPS, 0.0], [0.0, -1.0, 0.0], [-20.0, 1.0, 2.0]
    return lines([[1504279978.9, *angles(i, 100), *rate, *gravity, *USER_G, *magnetic] for i in range(N)])


def weallwalk_table(n: int = N) -> str:
    rest = [0.0, 0.0, 0.0, -1.0, *[0.0] * 6, 5.0, 6.0, 7.0, 0.0, 0.0]
    rotation = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0]
    quaternion = [1.01 * value for value in UPRIGHT_QUATERNION_XYZW]
    head = [*angles(0, 25), *rotation, *quaternion, 0.0, TURN_RADPS, 0.0, *USER_G, 0.0, -1.0, 0.0]
    return lines([[i / 25, *head, *rest] for i in range(n)])


def check_upright(device: DeviceRecording, rate_hz: float) -> None:
    """Units and signs of the synthetic phone."""
    assert device.specific_force is not None
    assert device.rotation_rate is not None
    assert device.attitude is not None
    assert device.warnings == ()
    assert_allclose(device.specific_force.time_s, np.arange(N) / rate_hz, atol=1e-9)
    assert_allclose(device.specific_force.values, np.tile(FORCE_MPS2, (N, 1)), atol=1e-5)
    assert_array_equal(device.rotation_rate.values[0], [0.0, TURN_RADPS, 0.0])
    assert_allclose(up_in_device(device.attitude.values), np.tile([0.0, 1.0, 0.0], (N, 1)), atol=1e-5)


def attitude_agrees_with_gyroscope(device: DeviceRecording) -> None:
    """On average specific force is gravity upwards, and the attitude turns as the gyroscope says."""
    assert device.attitude is not None
    assert device.rotation_rate is not None
    assert device.specific_force is not None
    time_s, up = device.attitude.time_s, up_in_device(device.attitude.values)
    assert (up * device.specific_force.values).sum(1).mean() == pytest.approx(9.8, abs=0.5)
    turned_rad = np.diff(np.unwrap(twist_about_vertical(device.attitude.values)))
    gyroscope_rad = (up * device.rotation_rate.values).sum(1)[1:] * np.diff(time_s)
    window = np.ones(max(1, int(1.0 / np.median(np.diff(time_s)))))
    turned, integrated = (np.convolve(angle_rad, window, "valid") for angle_rad in (turned_rad, gyroscope_rad))
    calm = np.abs(turned) < np.pi  # an unwrap across an upside-down moment is no turn
    assert np.corrcoef(turned[calm], integrated[calm])[0, 1] > 0.7


# --- OxIOD -----------------------------------------------------------------------------------------------------


def test_oxiod_table_with_poses_beside_it(tmp_path: Path) -> None:
    (tmp_path / "imu7.csv").write_text(oxiod_table())
    poses = [[59601, 1.5e11, 0.1 * i, -0.2 * i, 9.0, 0.0, 0.0, 0.0, 1.0] for i in range(N + 3)]
    (tmp_path / "tango7.csv.gz").write_bytes(gzip.compress(lines(poses).encode()))
    (tmp_path / "tango8.csv").write_text(lines(poses[:5]))
    for path in (tmp_path / "imu7.csv", tmp_path):
        recording = read(path)
        (device,) = recording.devices
        assert (recording.format, recording.name, recording.epoch_s) == ("OxIOD", "imu7", 1504279978.9)
        check_upright(device, 100.0)
        assert device.attitude is not None
        assert_allclose(twist_about_vertical(device.attitude.values), TURN_RADPS * np.arange(N) / 100, atol=1e-5)
        truth = recording.truth.positions
        assert truth is not None
        assert truth.source == "poses"
        assert_allclose(truth.time_s, np.arange(N) / 100)
        assert_allclose(truth.position_m[-1], [0.1 * (N - 1), -0.2 * (N - 1)])
        assert recording.notes == (f"truth from tango7.csv, row by row: {N + 3} poses, {N} sensor rows",)


def test_oxiod_without_poses_and_with_gaps_in_them(tmp_path: Path) -> None:
    path = tmp_path / "imu1.csv"
    path.write_text(oxiod_table())
    assert read(path).truth.positions is None
    rows = lines([[0, 0, i, i, 0, 0, 0, 0, 1] for i in range(N)]).splitlines()
    rows[1] = rows[1].replace("1.000000,1.000000,", "NaN,NaN,", 1)
    (tmp_path / "vi1.csv").write_text("\n".join(rows))
    truth = read(path).truth.positions
    assert truth is not None
    assert_allclose(truth.time_s[:2], [0.0, 0.02])
    (tmp_path / "vi1.csv").write_text("0,0,NaN,NaN,0,0,0,0,1\n" * N)
    with pytest.raises(RecordingError, match=r"vi1\.csv: no finite position"):
        read(path)


def test_oxiod_rows_that_are_not_finite(tmp_path: Path) -> None:
    rows = oxiod_table().splitlines()
    rows[30] = rows[30].replace("0.200000", "nan")
    (tmp_path / "imu1.csv").write_text("\n".join(rows))
    (device,) = read(tmp_path).devices
    assert device.warnings == (f"specific force: 1 of {N} rows are left out: NaN or infinite values",)


def test_sixteen_numbers_that_are_not_core_motion_are_not_oxiod(tmp_path: Path) -> None:
    (tmp_path / "imu1.csv").write_text(oxiod_table().replace("-1.000000", "1.000000"))
    with pytest.raises(RecordingError, match="unknown format"):
        read(tmp_path / "imu1.csv")


def test_real_oxiod_walks(shared_data: Path) -> None:
    for name in ("imu1", "imu5"):
        path = next((shared_data / "oxiod/large-scale/floor1/syn").glob(f"{name}.csv*"))
        recording = read(path)
        attitude_agrees_with_gyroscope(recording.devices[0])
        truth = recording.truth.positions
        assert truth is not None
        assert np.ptp(truth.position_m, axis=0).min() > 10.0  # x and y span the loop: they are the horizontal plane


def test_real_oxiod_loop_turns_the_same_way_in_truth_and_attitude(shared_data: Path) -> None:
    recording = read(next((shared_data / "oxiod/large-scale/floor1/syn").glob("imu1.csv*")))
    attitude, truth = recording.devices[0].attitude, recording.truth.positions
    assert attitude is not None
    assert truth is not None
    course_rad = np.unwrap(np.arctan2(*np.diff(truth.position_m[::100], axis=0).T[::-1]))
    yaw_rad = np.unwrap(twist_about_vertical(attitude.values))[::100]
    n = min(len(course_rad), len(yaw_rad))
    window = np.ones(6)
    turns = [np.convolve(np.diff(angle[:n]), window, "valid") for angle in (course_rad, yaw_rad)]
    assert np.corrcoef(*turns)[0, 1] > 0.7


# --- WeAllWalk -------------------------------------------------------------------------------------------------

ANNOTATION = """<?xml version="1.0" encoding="UTF-8"?>
<root><Segments>
<PathSegment><Direction>E</Direction><Steps>
  <Step><WhichFoot>R</WhichFoot><Time>0.9</Time></Step><Step><WhichFoot>L</WhichFoot><Time>0.4</Time></Step>
</Steps></PathSegment>
<PathSegment><Direction>TurnEtoS</Direction><TurnTime>1.1000</TurnTime><TurnInDegrees>-90</TurnInDegrees>
  <Steps><Step><WhichFoot>L</WhichFoot><Time>1.2</Time></Step></Steps></PathSegment>
</Segments></root>
"""


@pytest.fixture
def weallwalk(tmp_path: Path) -> Path:
    """A walk with two phones and its annotation, in the folders of the data set."""
    for folder in ("sensor", "xml"):
        (tmp_path / folder).mkdir()
    (tmp_path / "sensor/iPhoneSensors_T1_ID2_1L_WC.csv").write_text(weallwalk_table())
    (tmp_path / "sensor/iPhoneSensors_T1_ID2_2R_WC.csv.gz").write_bytes(gzip.compress(weallwalk_table().encode()))
    (tmp_path / "xml/T1_ID2_WC.xml").write_text(ANNOTATION)
    return tmp_path


@pytest.mark.parametrize(
    "path",
    [
        "sensor/iPhoneSensors_T1_ID2_1L_WC.csv",
        "sensor/iPhoneSensors_T1_ID2_2R_WC.csv.gz",
        "xml/T1_ID2_WC.xml",
        "sensor",
        "xml",
        ".",
    ],
)
def test_a_weallwalk_walk_is_found_from_any_of_its_files(weallwalk: Path, path: str) -> None:
    recording = read(weallwalk / path)
    assert (recording.format, recording.name, recording.notes) == ("WeAllWalk", "T1_ID2_WC", ())
    assert [device.name for device in recording.devices] == ["1L", "2R"]
    for device in recording.devices:
        check_upright(device, 25.0)
        assert device.attitude is not None
        assert device.magnetic_field is not None
        assert_allclose(device.attitude.values[0], [np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0], atol=1e-6)
        assert_array_equal(device.magnetic_field.values[0], [5.0, 6.0, 7.0])
    steps, turns = recording.truth.steps, recording.truth.turns
    assert steps is not None
    assert turns is not None
    assert (steps.time_s.tolist(), steps.foot.tolist()) == ([0.4, 0.9, 1.2], ["L", "R", "L"])
    assert_allclose([turns.time_s, turns.angle_rad], [[1.1], [-np.pi / 2]])
    assert recording.truth.step_count == 3


def test_weallwalk_with_one_phone_and_no_annotation(weallwalk: Path) -> None:
    (weallwalk / "sensor/iPhoneSensors_T1_ID2_2R_WC.csv.gz").unlink()
    (weallwalk / "xml/T1_ID2_WC.xml").unlink()
    recording = read(weallwalk / "sensor")
    assert [device.name for device in recording.devices] == ["1L"]
    assert recording.devices[0].warnings == ("the walk's other phone 2R is missing",)
    assert recording.notes == ("no annotation (XML) of this walk, so no ground truth",)
    assert recording.truth.steps is None


def test_a_weallwalk_annotation_alone_and_a_damaged_one(weallwalk: Path) -> None:
    (weallwalk / "xml/T1_ID2_WC.xml").write_text(ANNOTATION.replace("1.1000", "soon"))
    with pytest.raises(RecordingError, match=r"T1_ID2_WC\.xml: TurnTime 'soon' of a PathSegment is not a number"):
        read(weallwalk)
    (weallwalk / "xml/T1_ID2_WC.xml").write_text(ANNOTATION[:-20])
    with pytest.raises(RecordingError, match=r"T1_ID2_WC\.xml: cannot be read as an annotation"):
        read(weallwalk)
    for path in (weallwalk / "sensor").iterdir():
        path.unlink()
    with pytest.raises(RecordingError, match="the sensor table of this walk is missing"):
        read(weallwalk / "xml")


def test_a_weallwalk_annotation_cannot_expand_entities(weallwalk: Path) -> None:
    bomb = '<!DOCTYPE root [<!ENTITY a "' + "x" * 100 + '">]>'
    (weallwalk / "xml/T1_ID2_WC.xml").write_text(ANNOTATION.replace("<root>", bomb + "<root>"))
    with pytest.raises(RecordingError, match="cannot be read as an annotation"):
        read(weallwalk)


def test_several_weallwalk_walks_are_named(weallwalk: Path) -> None:
    (weallwalk / "sensor/iPhoneSensors_T2_ID2_1L_WC.csv").write_text(weallwalk_table())
    with pytest.raises(RecordingError, match=r"contains 2 WeAllWalk recordings \(T1_ID2_WC, T2_ID2_WC\); choose one"):
        read(weallwalk)


def test_real_weallwalk_walks(shared_data: Path) -> None:
    paths = sorted((shared_data / "weallwalk/xml").glob("*.xml*"))
    assert paths
    for path in paths[::6]:
        recording = read(path)
        assert len(recording.devices) == 2
        assert recording.truth.steps is not None
        assert recording.truth.turns is not None
        assert set(recording.truth.steps.foot) == {"L", "R"}
        for device in recording.devices:
            assert device.warnings == ()
            attitude_agrees_with_gyroscope(device)


# --- MotionSense -----------------------------------------------------------------------------------------------

MOTIONSENSE_HEADER = ",".join(
    [
        "",
        *("attitude.roll", "attitude.pitch", "attitude.yaw"),
        *("gravity.x", "gravity.y", "gravity.z"),
        *("rotationRate.x", "rotationRate.y", "rotationRate.z"),
        *("userAcceleration.x", "userAcceleration.y", "userAcceleration.z"),
    ]
)


def motionsense_table() -> str:
    rows = [[i, *angles(i, 50), 0.0, -1.0, 0.0, 0.0, TURN_RADPS, 0.0, *USER_G] for i in range(N)]
    return MOTIONSENSE_HEADER + "\n" + lines(rows)


@pytest.mark.parametrize(("folder", "activity"), [("wlk_7", "walking"), ("dws_1", "downstairs"), ("mine", None)])
def test_motionsense_table(tmp_path: Path, folder: str, activity: str | None) -> None:
    path = tmp_path / folder / "sub_1.csv"
    path.parent.mkdir()
    path.write_text(motionsense_table())
    for given in (path, path.parent):
        recording = read(given)
        (device,) = recording.devices
        assert (recording.format, recording.name, recording.truth.activity) == ("MotionSense", "sub_1", activity)
        check_upright(device, 50.0)


def test_motionsense_text_in_a_number_column(tmp_path: Path) -> None:
    rows = motionsense_table().splitlines()
    rows[4] = rows[4].replace("0.200000", "fast")
    (tmp_path / "sub_1.csv").write_text("\n".join(rows))
    with pytest.raises(
        RecordingError, match=r"sub_1\.csv, line 5, column 'userAcceleration\.y': 'fast' is not a num"
    ):
        read(tmp_path)


def test_attitude_that_contradicts_gravity_is_a_warning(tmp_path: Path) -> None:
    (tmp_path / "sub_1.csv").write_text(motionsense_table().replace(",0.000000,-1.000000", ",-1.000000,0.000000"))
    (device,) = read(tmp_path).devices
    assert any("up directions of recorded attitude and gravity differ" in text for text in device.warnings)


def test_real_motionsense_walks(shared_data: Path) -> None:
    # Not person 1, whose accelerometer is wrong by a quarter of gravity while walking.
    for folder, activity in (("wlk_7", "walking"), ("jog_9", "jogging")):
        path = next((shared_data / "motionsense" / folder).glob("sub_12.csv*"))
        recording = read(path)
        assert recording.truth.activity == activity
        attitude_agrees_with_gyroscope(recording.devices[0])

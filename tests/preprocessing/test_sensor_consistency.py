"""Accelerometer and gyroscope that contradict each other or gravity are told, and sound ones never are."""

import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from table_walk import table_walk

from pdr_est.frames import Array
from pdr_est.preprocessing.quality.consistency import consistency_warnings
from pdr_est.preprocessing.quality.inspection import inspect_recording
from pdr_est.preprocessing.quality.warnings import quality_warnings
from pdr_est.simulate import preset, simulate_walk
from pdr_est.types.recording import DeviceRecording, Recording, Signal

WALKS = ["l_shape", "office_loop", "mmpdr_indoor_swing", "mmpdr_indoor_pocket", "mmpdr_indoor_multi"]


@cache
def device(name: str = "office_loop") -> DeviceRecording:
    return simulate_walk(preset(name)).recording.devices[0]


def mapped(signal: Signal | None, matrix: Array, offset: float | Array = 0.0) -> Signal:
    assert signal is not None
    return Signal(signal.time_s, signal.values @ matrix.T + offset)


def with_axes(rows: list[list[float]], name: str = "office_loop") -> DeviceRecording:
    """rows: of the matrix from the true rotation rate to the recorded one."""
    sound = device(name)
    return replace(sound, rotation_rate=mapped(sound.rotation_rate, np.array(rows)))


@pytest.mark.parametrize("name", WALKS)
def test_nothing_is_told_of_sound_sensors(name: str) -> None:
    assert consistency_warnings(device(name)) == ()


@pytest.mark.parametrize("name", ["l_shape", "office_loop", "mmpdr_indoor_pocket"])
def test_the_bias_of_raw_sensors_is_no_fault_of_the_axes(name: str) -> None:
    sound = device(name)
    biased = mapped(sound.rotation_rate, np.eye(3), np.radians([4.0, -3.0, 2.0]))
    (words,) = consistency_warnings(replace(sound, rotation_rate=biased))
    assert words.startswith("the gyroscope reads at least 0.0")
    assert "subtract what it reads while it lies still" in words


@pytest.mark.parametrize("name", ["l_shape", "office_loop", "mmpdr_indoor_pocket"])
def test_the_bias_of_a_phone_is_not_told(name: str) -> None:
    sound = device(name)
    biased = mapped(sound.rotation_rate, np.eye(3), np.radians([1.0, -0.7, 0.5]))
    assert consistency_warnings(replace(sound, rotation_rate=biased)) == ()


@pytest.mark.parametrize(
    ("rows", "fits"),
    [([[-1, 0, 0], [0, -1, 0], [0, 0, -1]], "(-x, -y, -z)"), ([[1, 0, 0], [0, 0, 1], [0, 1, 0]], "(x, z, y)")],
)
def test_a_fault_that_is_only_possible_is_told_as_such(rows: list[list[float]], fits: str) -> None:
    walk = table_walk()
    rate = Signal(walk.time_s, walk.rate @ np.array(rows, dtype=float).T)
    short = DeviceRecording("phone", specific_force=Signal(walk.time_s, walk.force), rotation_rate=rate)
    (words,) = consistency_warnings(short)
    assert words.startswith("gyroscope and accelerometer may contradict each other")
    assert fits in words


@pytest.mark.parametrize(
    ("rows", "fits"),
    [
        ([[0, 0, 1], [1, 0, 0], [0, 1, 0]], "(y, z, x)"),
        ([[0, 1, 0], [1, 0, 0], [0, 0, 1]], "(y, x, z)"),
        ([[1, 0, 0], [0, 0, -1], [0, 1, 0]], "(x, z, -y)"),
        ([[1, 0, 0], [0, -1, 0], [0, 0, 1]], "(x, -y, z)"),
    ],
)
def test_axes_in_another_order_or_sign_are_told_with_what_fits(rows: list[list[float]], fits: str) -> None:
    (words,) = consistency_warnings(with_axes(rows))
    assert words.startswith("gyroscope and accelerometer contradict each other")
    assert fits in words


@pytest.mark.parametrize("gain", [0.5, 0.7])
def test_an_axis_of_the_gyroscope_that_reads_too_little_is_told_with_its_gain(gain: float) -> None:
    sound = device("mmpdr_indoor_multi")
    weak = mapped(sound.rotation_rate, np.diag([1.0, gain, 1.0]))
    (words,) = consistency_warnings(replace(sound, rotation_rate=weak))
    found = re.search(r"its y axis reads (\d\.\d\d) \+- (\d\.\d\d) of the truth", words)
    assert found is not None
    assert float(found[1]) == pytest.approx(gain, abs=0.06)


def test_the_yaw_of_a_phone_that_never_tilts_may_have_any_gain() -> None:
    sound = device("l_shape")
    assert sound.specific_force is not None
    up = sound.specific_force.values.mean(axis=0)
    up /= np.linalg.norm(up)
    halved = np.eye(3) - 0.5 * np.outer(up, up)
    assert consistency_warnings(replace(sound, rotation_rate=mapped(sound.rotation_rate, halved))) == ()


def test_a_gyroscope_of_another_walk_fits_in_no_way() -> None:
    sound = device("mmpdr_indoor_pocket")
    assert sound.rotation_rate is not None
    time_s = sound.rotation_rate.time_s
    turning = np.column_stack([np.sin(0.7 * time_s), np.cos(0.9 * time_s), np.sin(1.1 * time_s)])
    (words,) = consistency_warnings(replace(sound, rotation_rate=Signal(time_s, turning)))
    assert "no other axes, signs, gain or delay" in words


@pytest.mark.parametrize(("late_s", "words"), [(0.8, "0.8 s earlier"), (-0.8, "0.8 s later")])
def test_a_clock_that_is_late_or_early_is_told_where_the_posture_changes(late_s: float, words: str) -> None:
    sound = device("mmpdr_indoor_multi")
    assert sound.rotation_rate is not None
    late = Signal(sound.rotation_rate.time_s + late_s, sound.rotation_rate.values)
    (told,) = consistency_warnings(replace(sound, rotation_rate=late))
    assert f"{words} than its time stamps say" in told


def test_a_wrong_unit_is_told_alone() -> None:
    sound = device()
    (words,) = consistency_warnings(
        replace(sound, rotation_rate=mapped(sound.rotation_rate, np.degrees(1.0) * np.eye(3)))
    )
    assert "in deg/s" in words


@pytest.mark.parametrize(
    ("gain", "offset", "told"),
    [
        ([1.0, 1.0, 0.71], [0.0, 0.0, 0.0], r"instead of 9\.8"),
        ([1.0, 1.0, 0.6], [0.0, 0.0, 0.0], r"the z axis reads 0\.(5[789]|6)"),
        ([1.0, 1.0, 1.0], [0.0, 0.0, 4.0], r"the z axis reads \+"),
        ([1.3, 1.3, 1.3], [0.0, 0.0, 0.0], r"all axes read 1\.(29|30)"),
    ],
)
@pytest.mark.parametrize("gyroscope", [True, False])
def test_a_gravity_that_is_not_9_8_is_told_with_the_axis(
    gain: list[float], offset: list[float], told: str, gyroscope: bool
) -> None:
    sound = device("office_loop")
    wrong = replace(sound, specific_force=mapped(sound.specific_force, np.diag(gain), np.array(offset)))
    if not gyroscope:
        wrong = replace(wrong, rotation_rate=None)
    if not gyroscope and (gain[0] > 1.0 or offset[2] > 0.0):
        # Too long a gravity may be that of a swinging phone.
        assert consistency_warnings(wrong) == ()
        return
    (words,) = consistency_warnings(wrong)
    assert words.startswith("gravity is ")
    assert re.search(told, words)


@pytest.mark.parametrize("name", WALKS)
def test_the_errors_of_good_sensors_are_not_told(name: str) -> None:
    sound = device(name)
    fair = mapped(sound.specific_force, np.diag([1.02, 0.97, 1.03]), np.array([0.1, -0.1, 0.15]))
    assert consistency_warnings(replace(sound, specific_force=fair)) == ()
    assert consistency_warnings(replace(sound, specific_force=fair, rotation_rate=None)) == ()


def test_several_postures_tell_the_axis_and_its_gain() -> None:
    time_s = np.arange(0.0, 90.0, 0.02)
    turns = [(0.0, 0.5, 0.87), (0.9, 0.3, 0.32), (0.1, 0.99, 0.1), (-0.6, 0.5, 0.62)]
    up = np.repeat(np.array(turns), len(time_s) // len(turns) + 1, axis=0)[: len(time_s)]
    up = 9.80665 * up / np.linalg.norm(up, axis=1, keepdims=True)
    noise = np.random.default_rng(4).normal(scale=0.05, size=up.shape)
    read = Signal(time_s, up * np.array([1.0, 0.71, 1.0]) + noise)
    (words,) = consistency_warnings(DeviceRecording(specific_force=read))
    assert "the y axis reads 0.71 +- 0.0" in words
    assert "all axes" not in words


def test_inspect_and_the_warnings_of_a_walk_tell_it() -> None:
    swapped = with_axes([[0, 0, 1], [1, 0, 0], [0, 1, 0]])
    (inspected,) = inspect_recording(Recording("walk", "test", (swapped,))).devices
    for told in (inspected.findings, quality_warnings(swapped)):
        assert any("contradict each other" in words for words in told)


def test_a_device_without_acceleration_is_not_checked() -> None:
    assert consistency_warnings(replace(device(), specific_force=None)) == ()
    assert consistency_warnings(DeviceRecording()) == ()

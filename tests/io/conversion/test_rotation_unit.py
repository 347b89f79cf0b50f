"""The unit of a rotation rate is found from the motion that the accelerometer saw, also while a person stands."""

from functools import cache

import numpy as np
import pytest

from pdr_est.io.conversion.rotation_unit import detect_rotation_unit, motion_log_ratio, rotation_unit_warnings
from pdr_est.simulate import preset, simulate_walk
from pdr_est.types.recording import DeviceRecording, Signal

DEGREES = 180.0 / np.pi


@cache
def phone(name: str) -> DeviceRecording:
    return simulate_walk(preset(name)).recording.devices[0]


def signals(name: str, factor: float = 1.0) -> tuple[Signal, Signal]:
    device = phone(name)
    assert device.specific_force is not None
    assert device.rotation_rate is not None
    return Signal(device.rotation_rate.time_s, factor * device.rotation_rate.values), device.specific_force


def standing(noise_radps: float = 0.006, noise_mps2: float = 0.02) -> tuple[Signal, Signal]:
    time_s = np.arange(0.0, 60.0, 0.02)
    noise = np.random.default_rng(1).normal(size=(2, len(time_s), 3))
    return Signal(time_s, noise_radps * noise[0]), Signal(time_s, np.array([0.0, 5.0, 8.4]) + noise_mps2 * noise[1])


def test_the_ratio_is_that_of_root_mean_square_and_standard_deviation() -> None:
    time_s = np.arange(0.0, 20.0, 0.01)
    wave = np.sin(np.pi * time_s)[:, None]
    ratio = motion_log_ratio(
        Signal(time_s, wave * [0.0, 0.3, 0.0]), Signal(time_s, wave * [1.2, 0.0, 0.0] + [0.0, 0.0, 9.8])
    )
    assert ratio == pytest.approx(np.log(0.25), abs=1e-3)


@pytest.mark.parametrize(("unit", "factor"), [("rad/s", 1.0), ("deg/s", DEGREES), ("mdeg/s", 1e3 * DEGREES)])
@pytest.mark.parametrize("walk", ["l_shape", "mmpdr_indoor_swing", "standing"])
def test_every_unit_is_found(walk: str, unit: str, factor: float) -> None:
    if walk == "standing":
        calm, force = standing()
        rate = Signal(calm.time_s, factor * calm.values)
    else:
        rate, force = signals(walk, factor)
    conversion = detect_rotation_unit(rate, force)
    assert conversion.factor == pytest.approx(1.0 / factor)
    assert unit in conversion.decision
    assert conversion.warning == ""


@pytest.mark.parametrize("walk", ["l_shape", "mmpdr_indoor_swing"])
def test_rounds_per_minute_are_found_or_doubted(walk: str) -> None:
    conversion = detect_rotation_unit(*signals(walk, 30.0 / np.pi))
    assert conversion.factor == pytest.approx(np.pi / 30.0) or "rpm" in conversion.warning


def test_a_single_damaged_number_changes_nothing() -> None:
    rate, force = signals("l_shape", DEGREES)
    for value in (1e30, np.nan):
        damaged = rate.values.copy()
        damaged[7, 1] = value
        assert detect_rotation_unit(Signal(rate.time_s, damaged), force).factor == pytest.approx(1.0 / DEGREES)


def test_a_ratio_of_no_unit_is_doubted() -> None:
    rate, force = signals("l_shape", 1e-4)
    assert "doubtful" in detect_rotation_unit(rate, force).warning


def test_without_accelerometer_the_size_decides() -> None:
    rate, _ = signals("l_shape", DEGREES)
    conversion = detect_rotation_unit(rate, None)
    assert conversion.factor == pytest.approx(1.0 / DEGREES)
    assert "percentile" in conversion.decision


@pytest.mark.parametrize("walk", ["l_shape", "mmpdr_indoor_swing"])
def test_only_a_wrong_unit_is_warned_of(walk: str) -> None:
    assert rotation_unit_warnings(*signals(walk)) == ()
    (words,) = rotation_unit_warnings(*signals(walk, DEGREES))
    assert "in deg/s" in words
    assert "0.01745" in words
    (words,) = rotation_unit_warnings(*signals(walk, 1.0 / DEGREES))
    assert "converted from deg/s twice" in words


def test_a_device_that_lies_perfectly_still_is_not_judged() -> None:
    time_s = np.arange(0.0, 20.0, 0.02)
    lying = Signal(time_s, np.tile([0.0, 0.0, 9.81], (len(time_s), 1)))
    still = Signal(time_s, np.full((len(time_s), 3), 1e-4))
    assert rotation_unit_warnings(still, lying) == ()
    assert detect_rotation_unit(still, lying).warning

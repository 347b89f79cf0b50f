"""Raw signals of a device become a recording: gravity, units and signs are settled by what the device recorded."""

from functools import cache

import numpy as np
import pytest
from fabricated import Walk, make_walk

from pdr_est.frames import STANDARD_GRAVITY_MPS2
from pdr_est.io.conversion.raw_device import RawDevice, RawSensor, RawSignal
from pdr_est.simulate import SimulatedWalk, preset, simulate_walk
from pdr_est.types.recording import Signal


@cache
def walked() -> SimulatedWalk:
    return simulate_walk(preset("office_loop")).with_fixes(1.0, 1.0)


def raw(sensor: str, factor: float) -> RawSignal:
    signal: Signal = getattr(walked().recording.devices[0], sensor)
    return RawSignal(Signal(signal.time_s, factor * signal.values), sensor)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("per_mps2", [1.0 / STANDARD_GRAVITY_MPS2, 1e3 / STANDARD_GRAVITY_MPS2])
@pytest.mark.parametrize("per_radps", [1.0, 180.0 / np.pi])
def test_a_held_phone_needs_no_word_about_units_and_signs(sign: float, per_mps2: float, per_radps: float) -> None:
    device = RawDevice(
        {
            RawSensor.FORCE: raw("specific_force", sign * per_mps2),
            RawSensor.RATE: raw("rotation_rate", per_radps),
        },
        fixes=walked().recording.fixes,
    ).convert()
    true = walked().recording.devices[0]
    assert device.specific_force is not None
    assert device.rotation_rate is not None
    assert true.specific_force is not None
    assert true.rotation_rate is not None
    np.testing.assert_allclose(device.specific_force.values, true.specific_force.values, atol=1e-9)
    np.testing.assert_allclose(device.rotation_rate.values, true.rotation_rate.values, atol=1e-9)
    assert device.warnings == ()


def test_fixes_overrule_the_screen() -> None:
    upside_down = np.diag([1.0, -1.0, -1.0])
    signals = {
        sensor: RawSignal(Signal(one.signal.time_s, one.signal.values @ upside_down), one.title)
        for sensor, one in (
            (RawSensor.FORCE, raw("specific_force", 1.0 / STANDARD_GRAVITY_MPS2)),
            (RawSensor.RATE, raw("rotation_rate", 1.0)),
        )
    }
    with_fixes = RawDevice(dict(signals), fixes=walked().recording.fixes).convert()
    without = RawDevice(dict(signals)).convert()
    assert with_fixes.specific_force is not None
    assert without.specific_force is not None
    # The screen faces down: only the fixes can know that this is true.
    assert without.specific_force.values[:, 2].mean() > 0.0
    assert with_fixes.specific_force.values[:, 2].mean() < 0.0
    assert any("turns of the position fixes" in words for words in with_fixes.decisions)


@pytest.fixture(scope="module")
def walk() -> Walk:
    return make_walk()


def test_gravity_is_restored_by_the_attitude(walk: Walk) -> None:
    signals = {
        RawSensor.LINEAR: RawSignal(Signal(walk.time_s, walk.user), "linear", 1.0),
        RawSensor.RATE: RawSignal(Signal(walk.time_s, walk.rate), "gyro", 1.0),
        RawSensor.ATTITUDE: RawSignal(Signal(walk.time_s, walk.quaternion), "attitude"),
    }
    device = RawDevice(dict(signals), sign=1.0, sign_reason="Android").convert()
    assert device.specific_force is not None
    np.testing.assert_allclose(device.specific_force.values, walk.force, atol=1e-9)
    assert any("restored" in words for words in device.warnings)
    assert not any("is without gravity" in words for words in device.warnings)
    undecided = RawDevice(dict(signals)).convert()
    assert any("the sign of linear" in words and "not known" in words for words in undecided.warnings)
    del signals[RawSensor.ATTITUDE]
    bare = RawDevice(signals, sign=1.0, sign_reason="Android").convert()
    assert bare.specific_force is None
    assert bare.linear_acceleration is not None
    assert any("steps can be counted" in words for words in bare.warnings)

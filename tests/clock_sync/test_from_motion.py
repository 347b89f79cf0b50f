"""The clock of a phone from its walk: simulated phones on one body, with clocks that are known exactly."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from pdr_est.clock_sync import ClockEstimate, apply_clock, estimate_clock_from_motion
from pdr_est.errors import RecordingError
from pdr_est.simulate import (
    DeviceParams,
    HeldPhone,
    Pause,
    PocketPhone,
    Scenario,
    SensorParams,
    preset,
    simulate_walk,
)
from pdr_est.types.recording import DeviceRecording, Signal

CLOCKS = [(0.0, 0.0), (2.0, 1e-4), (-2.0, -1e-4), (3600.0, 1e-4), (-7200.5, -1e-4)]
EXACT_S = 0.02


@cache
def phones(kind: str = "pockets", rate_hz: float = 50.0) -> tuple[DeviceRecording, DeviceRecording]:
    """Two phones on a loop of 148 m with a pause, and their clocks in step."""
    scenario: Scenario = preset("office_loop")
    carries = (PocketPhone(side="left"), PocketPhone(side="right") if kind == "pockets" else HeldPhone())
    sensors = SensorParams(rate_hz=rate_hz)
    devices = tuple(DeviceParams(name=f"phone{i}", carry=carry, sensors=sensors) for i, carry in enumerate(carries))
    gait = replace(scenario.gait, pauses=(Pause(at_m=60.0, duration_s=5.0),))
    one, two = simulate_walk(replace(scenario, devices=devices, gait=gait, seed=3)).recording.devices
    return one, two


def with_clock(device: DeviceRecording, offset_s: float, skew: float, after_s: float = 0.0) -> DeviceRecording:
    """What the device would have recorded with another clock, begun after_s later."""

    def moved(signal: Signal | None) -> Signal | None:
        if signal is None:
            return None
        later = signal.time_s >= signal.time_s[0] + after_s
        return Signal((1.0 + skew) * signal.time_s[later] + offset_s, signal.values[later])

    return replace(device, specific_force=moved(device.specific_force), rotation_rate=moved(device.rotation_rate))


def worst_s(clock: ClockEstimate, offset_s: float, skew: float, reference: DeviceRecording) -> float:
    """Largest error over the whole walk."""
    assert reference.specific_force is not None
    time_s = reference.specific_force.time_s
    return float(np.abs(clock.offset_at(time_s) - skew * time_s - offset_s).max())


@pytest.mark.parametrize(("offset_s", "skew"), CLOCKS)
@pytest.mark.parametrize("rate_hz", [25.0, 100.0])
def test_clocks_of_pocket_phones_are_found(offset_s: float, skew: float, rate_hz: float) -> None:
    one, two = phones(rate_hz=rate_hz)
    clock = estimate_clock_from_motion(one, with_clock(two, offset_s, skew))
    assert clock.doubts == ()
    assert worst_s(clock, offset_s, skew, one) < EXACT_S


@pytest.mark.parametrize(("offset_s", "skew"), CLOCKS)
def test_a_phone_in_the_hand_is_within_what_is_claimed(offset_s: float, skew: float) -> None:
    """A hand feels the strikes differently, by a constant that no recording tells: never a step, though."""
    one, two = phones("hand")
    clock = estimate_clock_from_motion(one, with_clock(two, offset_s, skew))
    assert clock.doubts == ()
    assert worst_s(clock, offset_s, skew, one) < 3.0 * clock.sigma_s


@pytest.mark.parametrize("after_s", [8.0, 30.0])
def test_a_recording_that_began_later_is_found_too(after_s: float) -> None:
    one, two = phones()
    clock = estimate_clock_from_motion(one, with_clock(two, -2.0, 1e-4, after_s))
    assert clock.doubts == ()
    assert worst_s(clock, -2.0, 1e-4, one) < EXACT_S


def test_exchanging_the_phones_inverts_the_clock() -> None:
    one, two = phones()
    other = with_clock(two, 2.0, 1e-4)
    there, back = estimate_clock_from_motion(one, other), estimate_clock_from_motion(other, one)
    assert there.offset_s == pytest.approx(-float(back.offset_at(np.array(there.at_s + there.offset_s))), abs=0.01)


def test_applied_it_brings_the_clocks_together() -> None:
    one, two = phones()
    again = estimate_clock_from_motion(
        one, apply_clock(with_clock(two, 2.0, 1e-4), estimate_clock_from_motion(one, with_clock(two, 2.0, 1e-4)))
    )
    assert worst_s(again, 0.0, 0.0, one) < 0.01


def test_it_works_without_a_gyroscope() -> None:
    one, two = (replace(device, rotation_rate=None) for device in phones())
    clock = estimate_clock_from_motion(one, with_clock(two, 2.0, 1e-4))
    assert worst_s(clock, 2.0, 1e-4, one) < EXACT_S


@pytest.mark.parametrize("jump_s", [1.9, 5.0])
def test_a_clock_that_jumps_is_doubted(jump_s: float) -> None:
    one, two = phones()
    assert two.specific_force is not None
    force = two.specific_force
    middle_s = float(force.time_s.mean())
    jumped = replace(
        two, specific_force=Signal(np.where(force.time_s < middle_s, 0.0, jump_s) + force.time_s, force.values)
    )
    assert estimate_clock_from_motion(one, jumped).poor


def test_phones_of_different_walks_are_doubted() -> None:
    one, _ = phones()
    _, stranger = simulate_walk(
        replace(preset("straight"), devices=(DeviceParams(), DeviceParams(name="b", carry=PocketPhone())), seed=11)
    ).recording.devices
    assert estimate_clock_from_motion(one, stranger).poor


def test_phones_that_lie_still_are_doubted() -> None:
    rng = np.random.default_rng(0)
    time_s = np.arange(0.0, 60.0, 0.02)
    still = [
        DeviceRecording(name, specific_force=Signal(time_s, [0.0, 0.0, 9.81] + 0.02 * rng.standard_normal((3000, 3))))
        for name in ("a", "b")
    ]
    assert estimate_clock_from_motion(*still).poor


def test_unusable_recordings_are_refused() -> None:
    one, two = phones()
    with pytest.raises(RecordingError, match="no accelerometer"):
        estimate_clock_from_motion(one, replace(two, specific_force=None))
    assert two.specific_force is not None
    short = Signal(two.specific_force.time_s[:50], two.specific_force.values[:50])
    with pytest.raises(RecordingError, match="less than the 5 s from which its clock"):
        estimate_clock_from_motion(one, replace(two, specific_force=short))

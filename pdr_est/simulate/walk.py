"""From a scenario to a recording with its exact truth."""

from dataclasses import dataclass, replace
from enum import IntEnum

import numpy as np

from pdr_est.errors import ConfigError
from pdr_est.frames import Array
from pdr_est.io.recording import DeviceRecording, Recording, TruePositions, TrueSteps, TrueTurns, Truth
from pdr_est.records import PositionFix
from pdr_est.simulate.body import Body
from pdr_est.simulate.path import Path
from pdr_est.simulate.phone import Carry
from pdr_est.simulate.rigid_body import RigidMotion
from pdr_est.simulate.scenario import DeviceParams, Scenario, check
from pdr_est.simulate.sensors import RecordedSensor, record, record_exactly, sampling_times
from pdr_est.simulate.walker import Steps, plan_steps

_TRUTH_HZ = 10.0


class _Stream(IntEnum):
    """Purposes of random numbers, each with a stream of its own: changing one leaves the others as they are."""

    STEPS = 0
    HAND = 1
    ACCELEROMETER = 2
    GYROSCOPE = 3
    ATTITUDE = 4
    FIXES = 5


@dataclass(frozen=True)
class SimulatedDevice:
    """One device: its true motion at the true sampling times, and its sensors as recorded."""

    name: str
    motion: RigidMotion
    accelerometer: RecordedSensor
    gyroscope: RecordedSensor


@dataclass(frozen=True)
class SimulatedWalk:
    """A recording and all that is true about it.

    steps: every step, exactly. truth_time_s: (n,) at 10 Hz; truth_position_m: (n, 2) the point on the path that
    the trunk sways about, east and north; truth_heading_rad: (n,) walking direction, continuous.
    devices: in the order of the recording's.
    """

    scenario: Scenario
    recording: Recording
    steps: Steps
    truth_time_s: Array
    truth_position_m: Array
    truth_heading_rad: Array
    distance_m: float
    devices: tuple[SimulatedDevice, ...]
    body: Body

    @property
    def step_count(self) -> int:
        """How many steps the walker took."""
        return len(self.steps)

    def position_at(self, time_s: Array) -> Array:
        """True positions (n, 2) at any times (n,), as in `truth_position_m`."""
        return self.body.on_path_at(time_s)[0]

    def heading_at(self, time_s: Array) -> Array:
        """True walking directions (n,) at any times (n,), rad, continuous."""
        return self.body.on_path_at(time_s)[1]

    def with_fixes(self, every_s: float, sigma_m: float, seed: int = 0) -> "SimulatedWalk":
        """The same walk with position fixes at every_s, 2 every_s, ...; Gaussian errors of sigma_m per axis.

        Raise ConfigError if every_s or sigma_m is not positive.
        """
        if not (every_s > 0.0 and sigma_m > 0.0):
            raise ConfigError(f"fixes every {every_s} s with sigma {sigma_m} m: both must be positive")
        time_s = np.arange(every_s, self.steps.end_s + 1e-9, every_s)
        error_m = sigma_m * _stream(seed, _Stream.FIXES).standard_normal((len(time_s), 2))
        measured = self.position_at(time_s) + error_m
        fixes = tuple(
            PositionFix(float(t), position, sigma_m**2 * np.eye(2), source="simulated")
            for t, position in zip(time_s, measured, strict=True)
        )
        return replace(self, recording=replace(self.recording, fixes=fixes))


def simulate_walk(scenario: Scenario) -> SimulatedWalk:
    """Walk a scenario. Raise ConfigError if a value is out of range or the path cannot be rounded as asked."""
    check(scenario)
    path = Path(scenario.path)
    steps = plan_steps(scenario.gait, path.length_m, _stream(scenario.seed, _Stream.STEPS))
    body = Body(path, steps, scenario.gait.height_m, scenario.body)
    devices = tuple(
        _simulate_device(device, body, steps.end_s, scenario.seed, number)
        for number, device in enumerate(scenario.devices)
    )
    time_s = sampling_times(steps.end_s, _TRUTH_HZ)
    position_m, heading_rad = body.on_path_at(time_s)
    truth = Truth(
        positions=TruePositions(time_s, position_m, sigma_m=0.0, source="poses"),
        steps=TrueSteps(steps.time_s, steps.foot),
        turns=TrueTurns(body.time_at(path.corner_m), path.turn_rad),
        step_count=len(steps),
        distance_m=path.length_m,
    )
    recording = Recording(
        name=scenario.name,
        format="simulated",
        devices=tuple(
            _recorded(parameters, device, scenario.seed, number)
            for number, (parameters, device) in enumerate(zip(scenario.devices, devices, strict=True))
        ),
        truth=truth,
        notes=(f"simulated, seed {scenario.seed}",),
    )
    return SimulatedWalk(scenario, recording, steps, time_s, position_m, heading_rad, path.length_m, devices, body)


def _simulate_device(device: DeviceParams, body: Body, end_s: float, seed: int, number: int) -> SimulatedDevice:
    time_s = sampling_times(end_s, device.sensors.rate_hz)
    carry: Carry = device.carry
    motion = carry.motion(body.at(time_s), _stream(seed, _Stream.HAND, number))
    force, rate = motion.specific_force_mps2, motion.rotation_rate_radps
    sensors = device.sensors
    return SimulatedDevice(
        name=device.name,
        motion=motion,
        accelerometer=record(
            time_s, force, sensors.accelerometer, sensors, _stream(seed, _Stream.ACCELEROMETER, number)
        ),
        gyroscope=record(time_s, rate, sensors.gyroscope, sensors, _stream(seed, _Stream.GYROSCOPE, number)),
    )


def _recorded(parameters: DeviceParams, device: SimulatedDevice, seed: int, number: int) -> DeviceRecording:
    sensors, motion = parameters.sensors, device.motion
    attitude = None
    if sensors.record_attitude:
        rng = _stream(seed, _Stream.ATTITUDE, number)
        attitude = record_exactly(motion.time_s, motion.quaternion, sensors, rng)
    return DeviceRecording(
        name=device.name,
        model="simulated",
        platform="simulated",
        specific_force=device.accelerometer.signal,
        rotation_rate=device.gyroscope.signal,
        attitude=attitude,
        decisions=("units and signs: exact, simulated",),
    )


def _stream(seed: int, purpose: _Stream, number: int = 0) -> np.random.Generator:
    return np.random.default_rng([seed, int(purpose), number])

"""From a scenario to a recording with its exact truth."""

from dataclasses import dataclass, replace
from enum import IntEnum

import numpy as np

from pdr_est.errors import ConfigError
from pdr_est.frames import Array
from pdr_est.simulate.carrying.mode_changes import carried_motion, true_modes
from pdr_est.simulate.motion.rigid_body import RigidMotion
from pdr_est.simulate.scenario import DeviceParams, Scenario, check
from pdr_est.simulate.sensors.errors import RecordedSensor, SensorErrors, record, record_exactly, sampling_times
from pdr_est.simulate.sensors.magnetic_field import field_ut
from pdr_est.simulate.walker.path import Path
from pdr_est.simulate.walker.step_schedule import Steps, plan_steps
from pdr_est.simulate.walker.trunk import Body
from pdr_est.types.ground_truth import TrueModes, TruePositions, TrueSteps, TrueTurns, Truth
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import DeviceRecording, Recording

_TRUTH_HZ = 10.0


class _Stream(IntEnum):
    """Purposes of random numbers, each with a stream of its own: changing one leaves the others as they are."""

    STEPS = 0
    HAND = 1
    ACCELEROMETER = 2
    GYROSCOPE = 3
    ATTITUDE = 4
    FIXES = 5
    MAGNETOMETER = 6


@dataclass(frozen=True)
class SimulatedDevice:
    """One device: its true motion at the true sampling times, how it was carried, and its sensors as recorded."""

    name: str
    motion: RigidMotion
    modes: TrueModes
    accelerometer: RecordedSensor
    gyroscope: RecordedSensor
    magnetometer: RecordedSensor | None


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
        _simulate_device(scenario, number, path, body, steps.end_s) for number in range(len(scenario.devices))
    )
    time_s = sampling_times(steps.end_s, _TRUTH_HZ)
    position_m, heading_rad = body.on_path_at(time_s)
    truth = Truth(
        positions=TruePositions(time_s, position_m, sigma_m=0.0, source="poses"),
        steps=TrueSteps(steps.time_s, steps.foot),
        turns=TrueTurns(body.time_at(path.corner_m), path.turn_rad),
        step_count=len(steps),
        distance_m=path.length_m,
        modes=devices[0].modes,
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


def _simulate_device(scenario: Scenario, number: int, path: Path, body: Body, end_s: float) -> SimulatedDevice:
    device, seed = scenario.devices[number], scenario.seed
    sensors = device.sensors
    time_s = sampling_times(end_s, sensors.rate_hz)
    hands = [_stream(seed, _Stream.HAND, number)]
    hands += [_stream(seed, _Stream.HAND, number, further) for further in range(len(device.changes))]
    motion = carried_motion(body, time_s, device.carry, device.changes, hands)

    def recorded(ideal: Array, errors: SensorErrors, stream: _Stream) -> RecordedSensor:
        return record(time_s, ideal, errors, sensors, _stream(seed, stream, number))

    magnetometer = None
    if sensors.magnetometer is not None:
        field = motion.in_device(field_ut(motion.position_m, scenario.earth, scenario.irons, path))
        magnetometer = recorded(field, sensors.magnetometer, _Stream.MAGNETOMETER)
    return SimulatedDevice(
        name=device.name,
        motion=motion,
        modes=true_modes(device.carry, device.changes),
        accelerometer=recorded(motion.specific_force_mps2, sensors.accelerometer, _Stream.ACCELEROMETER),
        gyroscope=recorded(motion.rotation_rate_radps, sensors.gyroscope, _Stream.GYROSCOPE),
        magnetometer=magnetometer,
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
        magnetic_field=None if device.magnetometer is None else device.magnetometer.signal,
        attitude=attitude,
        decisions=("units and signs: exact, simulated",),
    )


def _stream(seed: int, purpose: _Stream, *numbers: int) -> np.random.Generator:
    return np.random.default_rng([seed, int(purpose), *(numbers or (0,))])

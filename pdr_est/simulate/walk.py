"""From a scenario to a recording with its exact truth."""

from dataclasses import dataclass, replace
from enum import IntEnum

import numpy as np

from pdr_est.errors import ConfigError
from pdr_est.frames import Array
from pdr_est.simulate.carrying.mode_changes import carried_motion, true_modes
from pdr_est.simulate.motion.rigid_body import RigidMotion
from pdr_est.simulate.riding.riding_body import RidingBody
from pdr_est.simulate.scenario import DeviceParams, Scenario, check_scenario
from pdr_est.simulate.sensors.magnetic_field import magnetic_field_ut
from pdr_est.simulate.sensors.sensor_errors import (
    RecordedSensor,
    SensorErrors,
    air_pressure_pa,
    record_signal,
    record_without_errors,
    sampling_times,
)
from pdr_est.simulate.walker.step_schedule import StepSchedule, plan_steps
from pdr_est.simulate.walker.walking_body import WalkingBody
from pdr_est.simulate.walker.walking_path import WalkingPath
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
    RIDES = 7
    BAROMETER = 8


@dataclass(frozen=True)
class SimulatedDevice:
    """Simulated device: true motion, carrying modes and recorded sensors.

    Attributes
    ----------
    name : str
        Name of the device.
    motion : RigidMotion
        True motion at the true sampling times.
    modes : TrueModes
        True carrying modes over time.
    accelerometer, gyroscope : RecordedSensor
        Recorded sensors with the errors that were drawn for them.
    magnetometer, barometer : RecordedSensor or None
        The same, or None for a device without it.
    """

    name: str
    motion: RigidMotion
    modes: TrueModes
    accelerometer: RecordedSensor
    gyroscope: RecordedSensor
    magnetometer: RecordedSensor | None
    barometer: RecordedSensor | None = None


@dataclass(frozen=True)
class SimulatedWalk:
    """Recording of a simulated walk with everything that is true about it.

    Attributes
    ----------
    scenario : Scenario
        Parameters that the walk was made from.
    recording : Recording
        Recording as a reader would return it.
    steps : StepSchedule
        True steps.
    truth_time_s : Array
        Times of the true track, (n,), s, at 10 Hz.
    truth_position_m : Array
        Point on the path that the trunk sways about, (n, 2), m, east and north.
    truth_heading_rad : Array
        Walking direction, (n,), rad, continuous.
    distance_m : float
        Length of the path that is walked, m; rides are not part of it.
    devices : tuple of SimulatedDevice
        Devices in the order of the recording.
    body : WalkingBody
        Motion of the trunk as a function of time.
    """

    scenario: Scenario
    recording: Recording
    steps: StepSchedule
    truth_time_s: Array
    truth_position_m: Array
    truth_heading_rad: Array
    distance_m: float
    devices: tuple[SimulatedDevice, ...]
    body: WalkingBody

    @property
    def step_count(self) -> int:
        """Return the number of steps that the walker took."""
        return len(self.steps)

    def position_at(self, time_s: Array) -> Array:
        """Compute true positions (n, 2), m, at any times (n,), s, as in `truth_position_m`."""
        return self.body.on_path_at(time_s)[0]

    def heading_at(self, time_s: Array) -> Array:
        """Compute true walking directions (n,), rad, continuous, at any times (n,), s."""
        return self.body.on_path_at(time_s)[1]

    def with_fixes(self, every_s: float, sigma_m: float, seed: int = 0) -> "SimulatedWalk":
        """Add position fixes at every_s, 2 every_s, ... to the recording.

        Parameters
        ----------
        every_s : float
            Interval between the fixes, s.
        sigma_m : float
            Standard deviation of the Gaussian errors of each axis, m.
        seed : int
            Seed of the errors.

        Raises
        ------
        ConfigError
            If every_s or sigma_m is not positive.
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
    """Simulate the walk of a scenario.

    Raises
    ------
    ConfigError
        If a value is out of its range or the path cannot be rounded with the given radius.
    """
    check_scenario(scenario)
    path = WalkingPath(scenario.path)
    steps = plan_steps(scenario.gait, path.length_m, _stream(scenario.seed, _Stream.STEPS))
    body = _body(scenario, path, steps)
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


def _body(scenario: Scenario, path: WalkingPath, steps: StepSchedule) -> WalkingBody:
    """Make the walker's trunk, which rides where the scenario has rides."""
    common = path, steps, scenario.gait.height_m, scenario.body
    if not scenario.rides:
        return WalkingBody(*common)
    rngs = [_stream(scenario.seed, _Stream.RIDES, number) for number in range(len(scenario.rides))]
    return RidingBody(*common, scenario.rides, rngs)


def _simulate_device(
    scenario: Scenario, number: int, path: WalkingPath, body: WalkingBody, end_s: float
) -> SimulatedDevice:
    """Simulate the motion of a device and record its sensors."""
    device, seed = scenario.devices[number], scenario.seed
    sensors = device.sensors
    time_s = sampling_times(end_s, sensors.rate_hz)
    hands = [_stream(seed, _Stream.HAND, number)]
    hands += [_stream(seed, _Stream.HAND, number, further) for further in range(len(device.changes))]
    motion = carried_motion(body, time_s, device.carry, device.changes, hands)

    def recorded(ideal: Array, errors: SensorErrors, stream: _Stream) -> RecordedSensor:
        return record_signal(time_s, ideal, errors, sensors, _stream(seed, stream, number))

    barometer = magnetometer = None
    if sensors.barometer is not None:
        barometer = recorded(air_pressure_pa(motion.up.value), sensors.barometer, _Stream.BAROMETER)
    if sensors.magnetometer is not None:
        field = motion.in_device(magnetic_field_ut(motion.position_m, scenario.earth, scenario.irons, path))
        magnetometer = recorded(field, sensors.magnetometer, _Stream.MAGNETOMETER)
    return SimulatedDevice(
        name=device.name,
        motion=motion,
        modes=true_modes(device.carry, device.changes),
        accelerometer=recorded(motion.specific_force_mps2, sensors.accelerometer, _Stream.ACCELEROMETER),
        gyroscope=recorded(motion.rotation_rate_radps, sensors.gyroscope, _Stream.GYROSCOPE),
        magnetometer=magnetometer,
        barometer=barometer,
    )


def _recorded(parameters: DeviceParams, device: SimulatedDevice, seed: int, number: int) -> DeviceRecording:
    """Build the device's part of the recording."""
    sensors, motion = parameters.sensors, device.motion
    attitude = None
    if sensors.record_attitude:
        rng = _stream(seed, _Stream.ATTITUDE, number)
        attitude = record_without_errors(motion.time_s, motion.quaternion, sensors, rng)
    return DeviceRecording(
        name=device.name,
        model="simulated",
        platform="simulated",
        specific_force=device.accelerometer.signal,
        rotation_rate=device.gyroscope.signal,
        magnetic_field=None if device.magnetometer is None else device.magnetometer.signal,
        attitude=attitude,
        pressure=None if device.barometer is None else device.barometer.signal,
        decisions=("units and signs: exact, simulated",),
    )


def _stream(seed: int, purpose: _Stream, *numbers: int) -> np.random.Generator:
    """Make the generator of one purpose; `numbers` tell devices and carrying models apart."""
    return np.random.default_rng([seed, int(purpose), *(numbers or (0,))])

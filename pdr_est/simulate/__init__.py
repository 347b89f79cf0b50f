"""Simulated walks with exact truth: a walking body, the phones it carries, and their sensors.

`simulate_walk(preset("office_loop"))` is the shortest way to a recording. Every motion is an exact function of
time, so the truth does not depend on the sampling rate.

* `scenario`: all parameters of a walk. `walk`: from a scenario to a recording with its truth.
* `walker`: path, steps and moving trunk of the walker. `carrying`: phones in the hand, in a swinging hand, in a
  pocket.
* `sensors`: errors of the sensors and the magnetic field. `motion`: differentiable signals that all motion is made
  of.
* `riding`: vehicles and lifts that carry the walker during pauses of the walk.
* `people`: randomly drawn walkers and populations. `presets`: named scenarios and the walks of the papers.
"""

from pdr_est.simulate.carrying.held_phone import HeldPhone
from pdr_est.simulate.carrying.mode_changes import ModeChange
from pdr_est.simulate.carrying.pocket_phone import PocketPhone
from pdr_est.simulate.carrying.swinging_phone import SwingingPhone
from pdr_est.simulate.people.person import SimulatedPerson, sample_person
from pdr_est.simulate.presets.mmpdr import mmpdr_indoor, mmpdr_mode_walks, mmpdr_published, park_348
from pdr_est.simulate.presets.named_scenarios import PRESETS, preset
from pdr_est.simulate.presets.psp import (
    PSP_GYROSCOPE_BIAS_RADPS,
    PSP_TESTS,
    PspLegs,
    PspTrajectory,
    psp_path,
    psp_walks,
)
from pdr_est.simulate.presets.riding import riding_walk
from pdr_est.simulate.presets.robust_dr import ROBUST_DR_TRIALS, robust_dr_trials, waypoint_passes
from pdr_est.simulate.presets.uptime import UptimeTrip, uptime_trip
from pdr_est.simulate.riding.riding_body import Ride
from pdr_est.simulate.riding.vehicles import VEHICLES, VehicleParams
from pdr_est.simulate.scenario import DeviceParams, Scenario
from pdr_est.simulate.sensors.compass_orientation import with_compass_orientation
from pdr_est.simulate.sensors.magnetic_field import EarthField, MagneticDipole, scatter_dipoles
from pdr_est.simulate.sensors.sensor_errors import (
    NO_SENSOR_ERRORS,
    PHONE_BAROMETER,
    PHONE_MAGNETOMETER,
    SensorErrors,
    SensorParams,
)
from pdr_est.simulate.walk import SimulatedDevice, SimulatedWalk, simulate_walk
from pdr_est.simulate.walker.gait_stretches import GaitStretch, PacedStretch, RunningStretch, StairStretch
from pdr_est.simulate.walker.step_schedule import Pause, StepSchedule, WalkerGaitParams
from pdr_est.simulate.walker.walking_body import BodyParams, BodyTurn
from pdr_est.simulate.walker.walking_path import PathParams, WalkingPath

__all__ = [
    "NO_SENSOR_ERRORS",
    "PHONE_BAROMETER",
    "PHONE_MAGNETOMETER",
    "PRESETS",
    "PSP_GYROSCOPE_BIAS_RADPS",
    "PSP_TESTS",
    "ROBUST_DR_TRIALS",
    "VEHICLES",
    "BodyParams",
    "BodyTurn",
    "DeviceParams",
    "EarthField",
    "GaitStretch",
    "HeldPhone",
    "MagneticDipole",
    "ModeChange",
    "PacedStretch",
    "PathParams",
    "Pause",
    "PocketPhone",
    "PspLegs",
    "PspTrajectory",
    "Ride",
    "RunningStretch",
    "Scenario",
    "SensorErrors",
    "SensorParams",
    "SimulatedDevice",
    "SimulatedPerson",
    "SimulatedWalk",
    "StairStretch",
    "StepSchedule",
    "SwingingPhone",
    "UptimeTrip",
    "VehicleParams",
    "WalkerGaitParams",
    "WalkingPath",
    "mmpdr_indoor",
    "mmpdr_mode_walks",
    "mmpdr_published",
    "park_348",
    "preset",
    "psp_path",
    "psp_walks",
    "riding_walk",
    "robust_dr_trials",
    "sample_person",
    "scatter_dipoles",
    "simulate_walk",
    "uptime_trip",
    "waypoint_passes",
    "with_compass_orientation",
]

"""Simulated walks with exact truth: a walking body, the phones it carries, and their sensors.

`simulate_walk(preset("office_loop"))` is the shortest way to a recording. Every motion is an exact function of
time, so the truth does not depend on the sampling rate.
"""

from pdr_est.simulate.carrying.held import HeldPhone
from pdr_est.simulate.carrying.mode_changes import ModeChange
from pdr_est.simulate.carrying.pocket import PocketPhone
from pdr_est.simulate.carrying.swinging import SwingingPhone
from pdr_est.simulate.people.person import Person, sample_person
from pdr_est.simulate.presets.mmpdr import PRESETS, mmpdr_indoor, mmpdr_mode_walks, park_348, preset
from pdr_est.simulate.presets.psp import PSP_TESTS, Trajectory, psp_path, psp_walks
from pdr_est.simulate.presets.robust_dr import ROBUST_DR_TRIALS, robust_dr_trials, waypoint_passes
from pdr_est.simulate.scenario import DeviceParams, Scenario
from pdr_est.simulate.sensors.errors import PERFECT, PHONE_MAGNETOMETER, SensorErrors, SensorParams
from pdr_est.simulate.sensors.magnetic_field import EarthField, Iron, scattered_irons
from pdr_est.simulate.walk import SimulatedDevice, SimulatedWalk, simulate_walk
from pdr_est.simulate.walker.path import Path, PathParams
from pdr_est.simulate.walker.step_schedule import GaitParams, Pause, Steps
from pdr_est.simulate.walker.trunk import BodyParams

__all__ = [
    "PERFECT",
    "PHONE_MAGNETOMETER",
    "PRESETS",
    "PSP_TESTS",
    "ROBUST_DR_TRIALS",
    "BodyParams",
    "DeviceParams",
    "EarthField",
    "GaitParams",
    "HeldPhone",
    "Iron",
    "ModeChange",
    "Path",
    "PathParams",
    "Pause",
    "Person",
    "PocketPhone",
    "Scenario",
    "SensorErrors",
    "SensorParams",
    "SimulatedDevice",
    "SimulatedWalk",
    "Steps",
    "SwingingPhone",
    "Trajectory",
    "mmpdr_indoor",
    "mmpdr_mode_walks",
    "park_348",
    "preset",
    "psp_path",
    "psp_walks",
    "robust_dr_trials",
    "sample_person",
    "scattered_irons",
    "simulate_walk",
    "waypoint_passes",
]

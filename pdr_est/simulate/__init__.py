"""Simulated walks with exact truth: a walking body, the phones it carries, and their sensors.

`simulate_walk(preset("office_loop"))` is the shortest way to a recording. Every motion is an exact function of
time, so the truth does not depend on the sampling rate.
"""

from pdr_est.simulate.body import BodyParams
from pdr_est.simulate.magnetic import EarthField, Iron, scattered_irons
from pdr_est.simulate.modes import ModeChange
from pdr_est.simulate.path import Path, PathParams
from pdr_est.simulate.person import Person, sample_person
from pdr_est.simulate.phone import HeldPhone
from pdr_est.simulate.pocket import PocketPhone
from pdr_est.simulate.presets import PRESETS, mmpdr_indoor, mmpdr_mode_walks, park_348, preset
from pdr_est.simulate.presets_psp import PSP_TESTS, Trajectory, psp_path, psp_walks
from pdr_est.simulate.presets_robust_dr import ROBUST_DR_TRIALS, robust_dr_trials, waypoint_passes
from pdr_est.simulate.scenario import DeviceParams, Scenario
from pdr_est.simulate.sensors import PERFECT, PHONE_MAGNETOMETER, SensorErrors, SensorParams
from pdr_est.simulate.swing import SwingingPhone
from pdr_est.simulate.walk import SimulatedDevice, SimulatedWalk, simulate_walk
from pdr_est.simulate.walker import GaitParams, Pause, Steps

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

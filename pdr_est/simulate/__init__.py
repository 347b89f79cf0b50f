"""Simulated walks with exact truth: a walking body, the phones it carries, and their sensors.

`simulate_walk(preset("office_loop"))` is the shortest way to a recording. Every motion is an exact function of
time, so the truth does not depend on the sampling rate.
"""

from pdr_est.simulate.body import BodyParams
from pdr_est.simulate.path import Path, PathParams
from pdr_est.simulate.phone import HeldPhone
from pdr_est.simulate.scenario import PRESETS, DeviceParams, Scenario, preset
from pdr_est.simulate.sensors import PERFECT, SensorErrors, SensorParams
from pdr_est.simulate.walk import SimulatedDevice, SimulatedWalk, simulate_walk
from pdr_est.simulate.walker import GaitParams, Pause, Steps

__all__ = [
    "PERFECT",
    "PRESETS",
    "BodyParams",
    "DeviceParams",
    "GaitParams",
    "HeldPhone",
    "Path",
    "PathParams",
    "Pause",
    "Scenario",
    "SensorErrors",
    "SensorParams",
    "SimulatedDevice",
    "SimulatedWalk",
    "Steps",
    "preset",
    "simulate_walk",
]

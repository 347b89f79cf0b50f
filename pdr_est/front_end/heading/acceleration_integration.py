"""Heading of Robust DR: the direction of the integrated acceleration.

The accelerometer's reading is averaged over 200 ms in device axes, projected onto the horizontal plane with the
latest attitude, and averaged over 200 ms again. The trapezoidal rule integrates it over the latest 1.4 s, about two
steps; the heading at a step is the direction of the integral up to the step.

Readings of the paper. (1) Both averages are running means, as in the step detector `relative-threshold`. (2) Their
delay of 0.2 s is left in: the paper speaks of the current heading. (3) Before 1.4 s of a walk are there the integral
runs over what there is. (4) Samples between bouts of walking belong to no step; filters and integral restart.

Deviation. The paper's attitude tells north, ours has an arbitrary zero of the yaw, and so have the headings.

Over whole steps of an even walk acceleration integrates to nothing: what remains is where the window cuts the second
step, and errors of the tilt. The paper reports no accuracy of the heading by itself. On the office loops of OxIOD its
median error is 22 and 40 degrees in the hand, 31 to 74 in pockets, and 57 to 80 in bags, about the mean error of the
walk.

References
----------
Robust DR: Jin et al., WCNC 2011, sections III-B and III-E.
"""

from dataclasses import replace

import numpy as np

from pdr_est.frames import Array
from pdr_est.front_end.heading.level_frame import to_level
from pdr_est.front_end.signal.blocks import part
from pdr_est.front_end.signal.moving_average import MovingAverage
from pdr_est.front_end.signal.vectors import specific_force
from pdr_est.params import Window, params
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import Step


@params
class AccelerationIntegrationParams:
    """Windows of Robust DR's heading."""

    pre_window_s: Window = 0.2
    """Window of the average before the projection, s (the paper's 200 ms)."""
    post_window_s: Window = 0.2
    """Window of the average after the projection, s (the paper's 200 ms)."""
    integration_s: Window = 1.4
    """Window of the integral, s (the paper's 1.4 s)."""


class AccelerationIntegration:
    """Stage Step -> Step that fills in the heading by integrated acceleration.

    Parameters
    ----------
    rate_hz : float
        Sampling rate of the level samples.
    parameters : AccelerationIntegrationParams
        Windows.
    """

    latency_s = 0.0

    def __init__(self, rate_hz: float, parameters: AccelerationIntegrationParams) -> None:
        self._pre_average = MovingAverage(parameters.pre_window_s, rate_hz)
        self._post_average = MovingAverage(parameters.post_window_s, rate_hz)
        self._intervals = max(round(parameters.integration_s * rate_hz), 1)
        self._rate_hz = rate_hz
        self._level: Array = np.empty((0, 2))  # latest accelerations, east and north
        self._next: tuple[int, int] | None = None  # segment and index of the sample to come

    def push(self, item: Step, /) -> list[Step]:
        """Give a step its heading."""
        samples = self._new_samples(item.samples)
        force = self._pre_average.push(specific_force(samples.up, samples.acceleration_mps2))
        level: Array = self._post_average.push(to_level(force, samples.up, samples.yaw_rad))
        self._level = np.concatenate([self._level, level])[-self._intervals - 1 :]
        east, north = (np.trapezoid(column, dx=1.0 / self._rate_hz) for column in self._level.T)
        return [replace(item, heading_rad=float(np.arctan2(north, east)))]

    def flush(self) -> list[Step]:
        """Return nothing: no step is held back."""
        return []

    def _reset(self) -> None:
        self._pre_average.reset()
        self._post_average.reset()
        self._level = np.empty((0, 2))

    def _new_samples(self, samples: LevelBlock) -> LevelBlock:
        """Return the samples that no step before had; restart if samples are missing in between."""
        segment, index = self._next or (samples.segment, samples.first_index)
        if samples.segment != segment or samples.first_index > index:
            self._reset()
            index = samples.first_index
        seen = min(max(index - samples.first_index, 0), len(samples))
        self._next = (samples.segment, samples.first_index + len(samples))
        return part(samples, seen, len(samples))

"""Measurements: everything that an estimator knows about a walk.

The front end emits `StepOdometry` and `HeadingPrior`, the user gives `PositionFix` and `StartPose`, and
`DeviceTether` joins several devices of one person. An estimator that understands these records works with every
front end.
"""

from dataclasses import dataclass

import numpy as np

from pdr_est.frames import Array
from pdr_est.types.floor_plan import FloorPlan as FloorPlan
from pdr_est.types.floor_plan import PresentFloor as PresentFloor
from pdr_est.types.steps import CarryingMode
from pdr_est.types.steps import TurnHypothesis as TurnHypothesis

START_SOURCE = "start"
"""Source of the start position where it is used like a fix; no other fix may have it."""

LATE_START_S = 5.0
"""A device that starts recording at most this long after another is taken to start at the same place (our choice)."""


@dataclass(frozen=True)
class StepOdometry:
    """Motion of one device from the end of the previous step to the end of this one.

    The walker turns by `heading_change_rad` and then moves `length_m` straight ahead.

    Attributes
    ----------
    device
        Name of the device.
    time_s
        End of the step, s.
    start_s
        Start of the movement, s.
    length_m
        Step length, m.
    heading_change_rad
        Heading change since the previous step, rad, counter-clockwise.
    covariance
        (3, 3) covariance of (forward m, left m, heading rad) in the body frame at the end of the step.
    mode
        Carrying mode of the device.
    observed
        False for the odometry that bridges a gap in the recording.
    turn_hypotheses
        Possible heading changes of a step before which the phone was put elsewhere; empty for any other step.
        `heading_change_rad` and `covariance` are then their mean and covariance, for estimators that take no notice
        of hypotheses.
    """

    device: str
    time_s: float
    start_s: float
    length_m: float
    heading_change_rad: float
    covariance: Array
    mode: CarryingMode = CarryingMode.UNKNOWN
    observed: bool = True
    turn_hypotheses: tuple[TurnHypothesis, ...] = ()


@dataclass(frozen=True)
class HeadingPrior:
    """Heading of a device at one time, from a heading controller or the dominant directions of a building.

    Attributes
    ----------
    device
        Name of the device.
    time_s
        Time of the heading, s.
    heading_rad
        Heading, rad; in the map frame unless `relative`.
    sigma_rad
        Standard deviation, rad.
    robust
        True for a measurement that may be an outlier and is weighted by a robust kernel.
    relative
        True when the heading counts from a direction that is unknown in the map and common to all relative priors of
        the device. Such priors constrain the angles between parts of a walk and carry no information about north.
    """

    device: str
    time_s: float
    heading_rad: float
    sigma_rad: float
    robust: bool = True
    relative: bool = False


@dataclass(frozen=True)
class PositionFix:
    """Known position in the map frame.

    The error of a fix has two parts. One is independent from fix to fix. The other wanders slowly and is common to
    the fixes of one source: in each coordinate it is a first-order Gauss-Markov process, whose standard deviation may
    grow from one fix to the next, and shrinks only with the correlation time.

    Attributes
    ----------
    time_s
        Time of the fix, s on the clock of the recording.
    position_m
        (2,) east and north, m.
    covariance_m2
        (2, 2) covariance of the independent part of the error, m².
    source
        Origin of the fix in words, such as "waypoint" or "gps"; the wandering error is common to a source.
    robust
        True for a position that may be an outlier and is weighted by a robust kernel.
    sigma_wander_m
        Standard deviation of the wandering part at this fix in each coordinate, m; 0 for a source without one.
    wander_time_s
        Correlation time of the wandering part, s.
    clock_known
        True if the time is certainly right, as for points that are marked on the device itself. Estimators suspect
        the clock of any other source to be wrong by some seconds. What the first fix of a source says counts.
    """

    time_s: float
    position_m: Array
    covariance_m2: Array
    source: str = "waypoint"
    robust: bool = False
    sigma_wander_m: float = 0.0
    wander_time_s: float = 60.0
    clock_known: bool = False

    @property
    def total_covariance_m2(self) -> Array:
        """Covariance (2, 2) of both parts of the error, m²."""
        return np.asarray(self.covariance_m2) + self.sigma_wander_m**2 * np.eye(2)


@dataclass(frozen=True)
class DeviceTether:
    """Upper bound on the distance between two devices on one body.

    Attributes
    ----------
    device_a, device_b
        Names of the devices.
    time_s
        Time at which the bound holds, s.
    max_distance_m
        Largest possible distance, m.
    sigma_m
        Standard deviation of the distance when the bound is active, m.

    References
    ----------
    Jin, Soh, Motani, Wong: "A Robust Dead Reckoning Pedestrian Tracking System with Low Cost Sensors", PerCom 2011,
    where the bound is 2R.
    """

    device_a: str
    device_b: str
    time_s: float
    max_distance_m: float
    sigma_m: float


@dataclass(frozen=True)
class LoopClosure:
    """Statement that the walk of a device ends where it began.

    Attributes
    ----------
    device
        Name of the device.
    sigma_m
        Standard deviation of the distance between end and start, m, in each coordinate.
    """

    device: str
    sigma_m: float


Measurement = StepOdometry | HeadingPrior | PositionFix | DeviceTether | LoopClosure | FloorPlan | PresentFloor
"""Any one measurement."""


@dataclass(frozen=True)
class StartPose:
    """Pose at which the walk begins. A value of None is unknown and is estimated from the fixes.

    With neither a start nor fixes the track is in a frame of its own: origin at the start, first step along x.

    Attributes
    ----------
    position_m
        East and north, m.
    heading_rad
        Heading, rad, counter-clockwise from east.
    sigma_position_m
        Standard deviation of the position, m, in each coordinate.
    sigma_heading_rad
        Standard deviation of the heading, rad.
    """

    position_m: tuple[float, float] | None = None
    heading_rad: float | None = None
    sigma_position_m: float = 0.0
    sigma_heading_rad: float = 0.0


@dataclass(frozen=True)
class DeviceMeasurements:
    """All measurements of the walk of one device.

    Attributes
    ----------
    device
        Name of the device.
    start_s
        Time of its start pose, s.
    measurements
        The measurements; odometry in order of time.
    """

    device: str
    start_s: float
    measurements: tuple[Measurement, ...]

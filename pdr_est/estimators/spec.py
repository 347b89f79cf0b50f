"""Define the contract of an estimator, and the record of its abilities.

Whoever has to know what an estimator can do reads its `EstimatorSpec`; nobody compares names.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from pdr_est.frames import Array
from pdr_est.types.measurements import (
    DeviceMeasurements,
    DeviceTether,
    FloorPlan,
    HeadingPrior,
    LoopClosure,
    PositionFix,
    PresentFloor,
    StartPose,
    StepOdometry,
)
from pdr_est.types.track import Track


@dataclass(frozen=True)
class EstimatorSpec:
    """Abilities of an estimator.

    Attributes
    ----------
    name
        Name in tracks, messages and tables.
    smooths
        Each pose uses the whole walk. Such an estimator gets the odometry and the heading priors that are known only
        at the end of the walk, such as those of dominant directions, and a tether at the end of the walk.
    online
        It also works while the devices record, and places a device that begins late by itself; for the others the
        track of a late device is extended backwards to the start of the walk.
    delayed
        Online it gives delayed estimates besides those of the filter.
    uses_fixes
        Position fixes are measurements. Otherwise the start, as far as it is unknown, is found from them, and they
        are used for nothing else.
    uses_closure
        It makes use of `LoopClosure`: the walk ends where it began.
    uses_tethers
        It makes use of tethers between devices.
    uses_plan
        It makes use of a `FloorPlan`, which then stands among the measurements of each device, or of a `PresentFloor`
        for each change of floor.
    weighs_alternatives
        It weighs by itself what the measurements leave open, such as a start heading that nobody gave. Any other
        smoother of the package works on one alternative at a time (`estimators/alternatives`).
    sampled
        Its result is that of random samples, exact up to their number: mean and covariance of a posterior that need
        not be Gaussian.
    needs_gtsam
        It loads gtsam, which takes about a second.
    """

    name: str
    smooths: bool = False
    online: bool = False
    delayed: bool = False
    uses_fixes: bool = True
    uses_closure: bool = False
    uses_tethers: bool = False
    uses_plan: bool = False
    weighs_alternatives: bool = False
    sampled: bool = False
    needs_gtsam: bool = False


@runtime_checkable
class Estimator(Protocol):
    """Contract of an estimator: measurements of all devices of one walk in, track out.

    It keeps no state between calls and does not change its arguments.
    """

    @property
    def spec(self) -> EstimatorSpec:
        """Abilities of the estimator."""
        ...

    def estimate(
        self,
        devices: Sequence[DeviceMeasurements],
        tethers: Sequence[DeviceTether],
        start: StartPose,
        sigma_length_scale: float,
    ) -> Track:
        """Estimate the track of every device.

        Parameters
        ----------
        devices
            Measurements of each device, in order of time. A position fix of a walk with several devices stands among
            the measurements of each of them, though it is one piece of knowledge about one walker:
            `pdr_est.estimators.timelines_of` gives each device its share.
        tethers
            Tethers between the devices; empty for a single device.
        start
            Start pose, as far as it is known.
        sigma_length_scale
            Standard deviation of the length scale of the walker, whose expected value is 1.

        Returns
        -------
        Track
            Start and end of each step of each device, device by device in the order of `devices`, with covariances
            in the map frame. `pdr_est.estimators.common.timeline.track_from_nodes` makes it from a timeline.

        Raises
        ------
        EstimationError
            For measurements that give no track.
        """
        ...


@dataclass(frozen=True)
class OnlinePose:
    """Pose of a device at the start of the walk or at the end of a step, from a filter of the user's own.

    Attributes
    ----------
    device
        Name of the device.
    time_s
        Time of the pose, s: the time of the `StepOdometry` that led to it.
    position_m
        (2,) east and north in the map frame, m.
    heading_rad
        Heading, rad, counter-clockwise from east.
    covariance
        (3, 3) covariance of east (m), north (m) and heading (rad).
    """

    device: str
    time_s: float
    position_m: Array
    heading_rad: float
    covariance: Array


class OnlineFilter(Protocol):
    """Filter of one walk that is fed while the devices record. Its whole state is picklable."""

    def push(
        self, measurement: StepOdometry | HeadingPrior | PositionFix | LoopClosure | FloorPlan | PresentFloor
    ) -> list[OnlinePose]:
        """Take one measurement; return the poses that are new or have changed.

        Measurements come in order of time, those of all devices in one sequence. A heading prior follows the step at
        whose end it stands; a fix comes once, whatever the number of devices; the loop closures of a closed walk come
        at its end. There are no tethers. Where the spec of the estimator says `uses_plan`, a floor plan comes first;
        of a building that of every floor as a `PresentFloor`, that of the start last, and then each change of floor.
        """
        ...

    def flush(self) -> list[OnlinePose]:
        """Return what was held back; called once, at the end of the walk."""
        ...


class OnlineEstimator(Estimator, Protocol):
    """Contract of an estimator whose spec says `online`, for use in a `Tracker`."""

    def begin(self, devices: Sequence[str], start: StartPose, sigma_length_scale: float) -> OnlineFilter:
        """Make the filter of a walk.

        Parameters
        ----------
        devices
            Names of the devices that are known when the first measurement comes.
        start
            Start pose, as far as it is known.
        sigma_length_scale
            Standard deviation of the length scale of the walker.
        """
        ...

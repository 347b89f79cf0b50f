"""Results of one walk: the front-end output of each device, and the track estimated from it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import overload

from pdr_est.frames import Array
from pdr_est.types.clock import ClockEstimate
from pdr_est.types.findings import Finding
from pdr_est.types.floor_plan import FloorPlan, PresentFloor
from pdr_est.types.height import HeightProfile
from pdr_est.types.measurements import HeadingPrior, PositionFix, StepOdometry
from pdr_est.types.sensors import Gap, LevelBlock
from pdr_est.types.steps import Step
from pdr_est.types.track import Track


@dataclass(frozen=True)
class DominantDirections:
    """Dominant directions of a building, estimated from the walk.

    The straight segments of the walk are divided into n pieces; arrays have one entry for each piece.

    Attributes
    ----------
    number
        Most probable number of directions, at equal angles.
    log_odds
        Log odds of this number, with headings that are steady enough to tell it, against all else.
    used
        True when the evidence suffices, or the number was given.
    spacing_rad
        Angle between neighbouring directions, rad.
    drift_per_sqrt_s
        Drift of the heading of the phone that fits the walk best, rad/√s.
    rate_radps
        Constant rate of the drift, by the bias of the gyroscope, rad/s: the most probable one where the directions
        are used, else its mean with the probability of such directions.
    drift_rad
        (n,) rad, heading drift since the first piece without that of the constant rate.
    sigma_rad
        (n,) rad, standard deviation of the heading after subtracting the drift.
    path_heading_rad
        (n,) rad, direction that the piece follows, counted from the heading of the first piece, not wrapped.
    follows
        (n,) probability that the piece follows a dominant direction.
    """

    number: int
    log_odds: float
    used: bool
    spacing_rad: float
    drift_per_sqrt_s: float
    rate_radps: float
    drift_rad: Array
    sigma_rad: Array
    path_heading_rad: Array
    follows: Array


_Measured = StepOdometry | HeadingPrior


class DeferredOdometry(Sequence[_Measured]):
    """Measurements of a device that are computed when they are first looked at: a smoother does not need them.

    Parameters
    ----------
    compute
        Function that returns them; one that can be pickled.
    """

    def __init__(self, compute: Callable[[], Sequence[_Measured]]) -> None:
        self._compute: Callable[[], Sequence[_Measured]] | None = compute
        self._known: tuple[_Measured, ...] = ()

    @overload
    def __getitem__(self, index: int) -> _Measured: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[_Measured, ...]: ...
    def __getitem__(self, index: int | slice) -> _Measured | tuple[_Measured, ...]:
        return self._all[index]

    def __len__(self) -> int:
        return len(self._all)

    def __eq__(self, other: object) -> bool:
        return self._all == (other._all if isinstance(other, DeferredOdometry) else other)

    def __hash__(self) -> int:
        return hash(self._all)

    def __repr__(self) -> str:
        return repr(self._all)

    @property
    def _all(self) -> tuple[_Measured, ...]:
        if self._compute is not None:
            self._known, self._compute = tuple(self._compute()), None
        return self._known


@dataclass(frozen=True)
class DeviceWalk:
    """Output of the front end for the recording of one device.

    Attributes
    ----------
    device
        Name of the device.
    start_s
        Time of the first usable sample, s.
    level
        Samples on the working grid with the direction of gravity.
    steps
        Detected steps with length and heading.
    odometry
        Motion step by step, as a causal front end computes it; computed when it is first looked at, where a smoother
        has its own.
    whole_walk_odometry
        The same with corrections that need the whole walk, for estimators that smooth.
    directions
        Dominant directions of the building; None where none were sought, as for a filter.
    has_heading
        False for a device without gyroscope: its steps have a length but no heading, and there is no odometry.
    clock
        Clock model against the first device, where one was estimated.
    warnings
        Warnings of the reader and of the clock synchronisation.
    gaps
        Gaps of the recording.
    dropped_samples
        Number of samples left out, by reason.
    findings
        What of the device's measurements does not fit together: of those for estimators that smooth, where there are
        any.
    height
        Height and floor of the walker; None without air pressure.
    """

    device: str
    start_s: float
    level: tuple[LevelBlock, ...]
    steps: tuple[Step, ...]
    odometry: Sequence[_Measured]
    whole_walk_odometry: Sequence[_Measured] = ()
    directions: DominantDirections | None = None
    has_heading: bool = True
    clock: ClockEstimate | None = None
    warnings: tuple[str, ...] = ()
    gaps: tuple[Gap, ...] = ()
    dropped_samples: dict[str, int] = field(default_factory=dict)
    findings: tuple[Finding, ...] = ()
    height: HeightProfile | None = None

    def knows_north(self, by_the_end: bool = True) -> bool:
        """Tell whether any heading is known against north, to a smoother by the end of the walk or to a filter."""
        odometry = self.whole_walk_odometry if by_the_end else self.odometry
        return any(isinstance(one, HeadingPrior) and not one.relative for one in odometry)

    @property
    def span_s(self) -> tuple[float, float]:
        """Times of the first and the last sample that the front end could use, s."""
        return float(self.level[0].time_s[0]), float(self.level[-1].time_s[-1])

    @property
    def walking_span_s(self) -> tuple[float, float]:
        """Times of the first usable sample and of the end of the last step, s; of the last sample without steps."""
        walks = self.has_heading and bool(self.steps)
        return self.start_s, self.steps[-1].time_s if walks else self.span_s[1]

    def __repr__(self) -> str:
        start_s, end_s = self.span_s
        return f"DeviceWalk({self.device!r}: {len(self.steps)} steps, {end_s - start_s:.1f} s)"


@dataclass(frozen=True)
class SmoothedWalk:
    """A track with the intermediate results that led to it.

    Attributes
    ----------
    track
        Tracks of all devices, and of the person where there are several devices.
    devices
        Front-end output of each device.
    fixes
        Position fixes that the estimator was given.
    timings_s
        CPU seconds by part of the pipeline.
    warnings
        Doubts about recording, walk and settings, in words, and the doubtful ones of the findings of the track.
    fixes_used
        False for an estimator that only aligns the track with the fixes.
    plan
        Floor plan of the walk, of several floors the plan that most steps were made on; None where none was given.
    floors
        Floors of a walk for which the plans of several were given, in order of time.
    """

    track: Track
    devices: tuple[DeviceWalk, ...]
    fixes: tuple[PositionFix, ...] = ()
    timings_s: dict[str, float] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    fixes_used: bool = True
    plan: FloorPlan | None = None
    floors: tuple[PresentFloor, ...] = ()

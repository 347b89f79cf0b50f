"""What the system knows of a walk: of each device what its front end found, and of all of them the track."""

from dataclasses import dataclass, field

from pdr_est.frames import Array
from pdr_est.types.clock import ClockEstimate
from pdr_est.types.measurements import HeadingPrior, PositionFix, StepOdometry
from pdr_est.types.sensors import Gap, LevelBlock
from pdr_est.types.steps import Step
from pdr_est.types.track import Track


@dataclass(frozen=True)
class DominantDirections:
    """What a walk tells of a building. number: of the most probable directions; log_odds: of them against none.
    used: whether that suffices, or the number was given. spacing_rad: between them. drift_per_sqrt_s: rad per root
    second, of the phone's headings, by the level that the walk fits best. Per piece of the straight
    stretches: drift_rad (n,) of the heading since the first piece, sigma_rad (n,) of the heading less its drift,
    path_heading_rad (n,) the direction it follows, with the zero of the first piece, not wrapped, and follows (n,)
    the probability that it follows one."""

    number: int
    log_odds: float
    used: bool
    spacing_rad: float
    drift_per_sqrt_s: float
    drift_rad: Array
    sigma_rad: Array
    path_heading_rad: Array
    follows: Array


@dataclass(frozen=True)
class DeviceWalk:
    """What the front end found in one device's recording. start_s: time of the first usable sample.

    odometry: its motion step by step. whole_walk_odometry: the same with what only the whole walk tells, for
    estimators that smooth. directions: the dominant directions of the building, as far as the walk shows them.
    clock: against that of the first device, where it was estimated. warnings: of the reader and of the clock.
    has_heading is False for a device without gyroscope: its steps have a length but no heading, and no odometry.
    """

    device: str
    start_s: float
    level: tuple[LevelBlock, ...]
    steps: tuple[Step, ...]
    odometry: tuple[StepOdometry | HeadingPrior, ...]
    whole_walk_odometry: tuple[StepOdometry | HeadingPrior, ...] = ()
    directions: DominantDirections | None = None
    has_heading: bool = True
    clock: ClockEstimate | None = None
    warnings: tuple[str, ...] = ()
    gaps: tuple[Gap, ...] = ()
    dropped_samples: dict[str, int] = field(default_factory=dict)

    @property
    def span_s(self) -> tuple[float, float]:
        """Times of the first and the last sample that the front end could use."""
        return float(self.level[0].time_s[0]), float(self.level[-1].time_s[-1])

    @property
    def stepping_s(self) -> tuple[float, float]:
        """Times of the first usable sample and of the end of the last step, or of the last sample without any."""
        return self.start_s, max((m.time_s for m in self.odometry[-2:]), default=self.span_s[1])


@dataclass(frozen=True)
class SmoothedWalk:
    """A track with what led to it. timings_s: CPU seconds per part of the chain. fixes_used: False for an estimator
    that only aligns the track with the fixes."""

    track: Track
    devices: tuple[DeviceWalk, ...]
    fixes: tuple[PositionFix, ...] = ()
    timings_s: dict[str, float] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    fixes_used: bool = True

"""The top of the system: a recording becomes measurements, measurements become a track."""

from dataclasses import dataclass, field

from pdr_est.records import Gap, LevelBlock, PositionFix, Step, StepOdometry
from pdr_est.track import Track

__all__ = ["DeviceWalk", "Gap", "SmoothedWalk"]


@dataclass(frozen=True)
class DeviceWalk:
    """What the front end found in one device's recording."""

    device: str
    level: tuple[LevelBlock, ...]
    steps: tuple[Step, ...]
    odometry: tuple[StepOdometry, ...]
    gaps: tuple[Gap, ...] = ()
    dropped_samples: dict[str, int] = field(default_factory=dict)


@dataclass(frozen=True)
class SmoothedWalk:
    """A track with what led to it. timings_s: CPU seconds per part of the chain."""

    track: Track
    devices: tuple[DeviceWalk, ...]
    fixes: tuple[PositionFix, ...] = ()
    timings_s: dict[str, float] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()

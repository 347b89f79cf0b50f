"""A recording after the front end, ready for the estimator of one variant."""

import time
from collections.abc import Sequence

import numpy as np

from pdr_est import pipeline
from pdr_est.config import Config
from pdr_est.estimators.person.track import NAME as FUSED
from pdr_est.experiment.held_out import HeldOut, HeldOutProtocol
from pdr_est.pipeline import DeviceWalk
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import Recording
from pdr_est.types.track import Track


class AnalysedWalk:
    """A recorded walk after the front end; runs the estimator on demand and adds up the CPU time.

    Parameters
    ----------
    recording : Recording
        The recording with its ground truth.
    devices : sequence of DeviceWalk
        Result of the front end for each device.
    config : Config
        Settings of the variant.
    front_end_seconds : float
        CPU time that the front end took.
    protocol : HeldOutProtocol, optional
        Rule that selects the true positions which the estimator gets as fixes; without it there are no fixes.

    learns : bool
        True if the walk also shows its walker's length scale, for metrics of other walks.

    Attributes
    ----------
    seconds : float
        CPU time of the chain so far.
    tracks : list of (fixes, Track)
        Tracks that were estimated so far, with the fixes that they were given.
    fixed_tracks : dict
        Device, or "fused" for the person -> its track with fixes, as it was scored.
    """

    def __init__(
        self,
        recording: Recording,
        devices: Sequence[DeviceWalk],
        config: Config,
        front_end_seconds: float = 0.0,
        protocol: HeldOutProtocol | None = None,
        learns: bool = False,
    ) -> None:
        self.recording = recording
        self.devices = tuple(devices)
        self.config = config
        self.seconds = front_end_seconds
        self.tracks: list[tuple[tuple[PositionFix, ...], Track]] = []
        self.fixed_tracks: dict[str, Track] = {}
        self.learns = learns
        self._protocol = protocol

    @property
    def held_out(self) -> HeldOut | None:
        """Division of the true positions into fixes and held-out points; None without fixes or true positions."""
        truth = self.recording.truth.positions
        return None if truth is None or self._protocol is None else self._protocol.held_out(truth)

    @property
    def track_names(self) -> tuple[str, ...]:
        """Names of the devices, and of the person if an estimator made a track of several."""
        names = tuple(device.device for device in self.devices)
        return (*names, FUSED) if self.tracks and FUSED in self.tracks[0][1].devices else names

    def span_of(self, name: str) -> tuple[float, float]:
        """Return the times, s, of the first and the last sample that the front end could use.

        Parameters
        ----------
        name : str
            A device, or the person, whose span is that of all devices.
        """
        own = [device for device in self.devices if device.device == name] or self.devices
        begins_s, ends_s = zip(*(device.span_s for device in own), strict=True)
        return min(begins_s), max(ends_s)

    def track(self, fixes: Sequence[PositionFix] = ()) -> Track:
        """Estimate the track from the sensors and these fixes only; equal fixes cost one run of the estimator."""
        for given, known in self.tracks:
            if _equal(given, fixes):
                return known
        started = time.process_time()
        track = pipeline.estimate_tracks(self.devices, self.config, fixes)
        self.seconds += time.process_time() - started
        self.tracks.append((tuple(fixes), track))
        return track

    def track_with_fixes(self, name: str, fixes: Sequence[PositionFix]) -> Track:
        """Estimate the track of a device, or of the person, with fixes, and keep it in `fixed_tracks`."""
        self.fixed_tracks[name] = self.track(fixes).of_device(name)
        return self.fixed_tracks[name]


def _equal(some: Sequence[PositionFix], others: Sequence[PositionFix]) -> bool:
    return len(some) == len(others) and all(
        one.time_s == other.time_s
        and np.array_equal(one.position_m, other.position_m)
        and np.array_equal(one.covariance_m2, other.covariance_m2)
        and (one.source, one.robust) == (other.source, other.robust)
        and (one.sigma_wander_m, one.wander_time_s) == (other.sigma_wander_m, other.wander_time_s)
        for one, other in zip(some, others, strict=True)
    )

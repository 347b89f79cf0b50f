"""A recording after the front end, ready for the estimator of one variant."""

import time
from collections.abc import Sequence

import numpy as np

from pdr_est import pipeline
from pdr_est.config import Config
from pdr_est.estimators.person.track import NAME as FUSED
from pdr_est.experiment.held_out import HeldOut, HeldOutProtocol
from pdr_est.pipeline import DeviceWalk
from pdr_est.pipeline.map_directions import with_plan_directions
from pdr_est.types.floor_plan import FloorPlan
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import Recording
from pdr_est.types.track import Track

NO_PLAN = "no floor plan beside the recording"


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
    plan : FloorPlan or str
        Floor plan of the walk, or the reason why there is none.

    Attributes
    ----------
    seconds : float
        CPU time of the chain so far.
    tracks : list of (fixes, Track)
        Tracks that were estimated so far, with the fixes that they were given.
    fixed_tracks : dict
        Device, or "fused" for the person -> its track with fixes, as it was scored.
    plan : FloorPlan or None
        Floor plan of the walk.
    without_plan : str
        Reason why there is no plan; empty if there is one.
    """

    def __init__(
        self,
        recording: Recording,
        devices: Sequence[DeviceWalk],
        config: Config,
        front_end_seconds: float = 0.0,
        protocol: HeldOutProtocol | None = None,
        learns: bool = False,
        plan: FloorPlan | str = NO_PLAN,
    ) -> None:
        self.recording = recording
        self.devices = tuple(devices)
        self.config = config
        self.seconds = front_end_seconds
        self.tracks: list[tuple[tuple[PositionFix, ...], Track]] = []
        self.fixed_tracks: dict[str, Track] = {}
        self.learns = learns
        self.plan = None if isinstance(plan, str) else plan
        self.without_plan = plan if isinstance(plan, str) else ""
        self._devices_on_plan: tuple[DeviceWalk, ...] | None = None
        self._on_plan: list[tuple[tuple[PositionFix, ...], Track]] = []
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

    def track_on_plan(self, fixes: Sequence[PositionFix]) -> Track:
        """Estimate the track from the sensors, these fixes and the floor plan, which also gives directions."""
        for given, known in self._on_plan:
            if _equal(given, fixes):
                return known
        started = time.process_time()
        config = with_plan_directions(self.config, self.plan, self.config.estimator.make(on_plan=True).spec)
        devices = self._devices_on_plan
        if devices is None:
            devices = self.devices if config == self.config else pipeline.analyse_recording(self.recording, config)
            self._devices_on_plan = devices
        track = pipeline.estimate_tracks(devices, config, fixes, plan=self.plan)
        self.seconds += time.process_time() - started
        self._on_plan.append((tuple(fixes), track))
        return track

    @property
    def last_on_plan(self) -> Track | None:
        """Track on the floor plan that was estimated last; None without any."""
        return self._on_plan[-1][1] if self._on_plan else None

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

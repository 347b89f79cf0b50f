"""Walks of several devices as measurements, divided into events that reach the online estimator in any order."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from pdr_est.config import Config, DevicesParams, EstimatorParams, StartParams
from pdr_est.estimators import estimate_walk
from pdr_est.estimators.common.tethers import TetherParams, tethers_between
from pdr_est.front_end.step_noise import step_covariance
from pdr_est.online import OnlineParams
from pdr_est.online.walk_estimator import WalkEstimator
from pdr_est.types.measurements import (
    DeviceMeasurements,
    HeadingPrior,
    LoopClosure,
    PositionFix,
    StartPose,
    StepOdometry,
    TurnHypothesis,
)
from pdr_est.types.track import Track

LATENCY_S = 1.0  # of the front end: a step is known that long after its end
SIGMA_SCALE = Config().odometry.sigma_length_scale
TETHER = TetherParams(max_distance_m=0.5, sigma_m=0.02, every_s=2.0)
EAST = StartPose((0.0, 0.0), 0.0)
Measured = StepOdometry | HeadingPrior


@dataclass(frozen=True)
class Block:
    """Measurements of a device, whose samples reach up to a time."""

    device: int
    end_s: float
    measurements: tuple[Measured, ...]


Event = Block | PositionFix


@dataclass(frozen=True)
class Walk:
    """Measurements of each device, the times at which their recordings begin and end, and fixes."""

    devices: tuple[tuple[Measured, ...], ...]
    begins_s: tuple[float, ...]
    ends_s: tuple[float, ...]
    fixes: tuple[PositionFix, ...] = ()
    start: StartPose = field(default=EAST)

    def blocks(self, device: int, cuts_s: Iterable[float]) -> list[Block]:
        """Divide the measurements of a device at some times of its samples."""
        found, begin_s = [], -np.inf
        for end_s in [*sorted(cut for cut in cuts_s if cut < self.ends_s[device]), self.ends_s[device]]:
            known = (m for m in self.devices[device] if begin_s < m.time_s + LATENCY_S <= end_s)
            found.append(Block(device, end_s, tuple(known)))
            begin_s = end_s
        return found


def walk_of(
    rng: np.random.Generator,
    devices: int = 2,
    seconds: float = 20.0,
    begins_s: Sequence[float] = (),
    pauses: bool = True,
    lost_headings: bool = False,
    fixes_s: Sequence[float] = (),
    start: StartPose = EAST,
) -> Walk:
    """Make a walk to the east; each device drifts to its own side, so that tethers have something to do."""
    begins = [*begins_s, *[0.0] * devices][:devices]
    measured = tuple(tuple(_steps(rng, d, begins[d], seconds, pauses, lost_headings)) for d in range(devices))
    ends = tuple(max((m.time_s for m in own), default=begins[d]) + 2.0 * LATENCY_S for d, own in enumerate(measured))
    fixes = tuple(fix_at(s, 1.4 * s, rng.normal()) for s in fixes_s)
    return Walk(measured, tuple(begins), ends, fixes, start)


def with_placements(walk: Walk, rng: np.random.Generator, share: float) -> Walk:
    """Let the phones be put elsewhere before a share of the steps: straight on or round a corner."""
    turns = (TurnHypothesis(0.7, 0.0, 0.1, "straight on"), TurnHypothesis(0.3, np.pi / 2, 0.1, "corner"))

    def placed(step: Measured) -> Measured:
        if isinstance(step, HeadingPrior) or rng.random() > share:
            return step
        covariance = step_covariance(0.7, 0.07, 0.1, 0.8)
        return replace(step, heading_change_rad=0.3 * np.pi / 2, covariance=covariance, turn_hypotheses=turns)

    return replace(walk, devices=tuple(tuple(placed(one) for one in own) for own in walk.devices))


def wandering_fix(fix: PositionFix) -> PositionFix:
    """Return a robust fix of a source whose error wanders."""
    return replace(fix, source="gps", robust=True, sigma_wander_m=2.0, wander_time_s=10.0)


def fix_at(time_s: float, east_m: float, north_m: float) -> PositionFix:
    return PositionFix(time_s, np.array([east_m, north_m]), 0.5 * np.eye(2))


def _steps(
    rng: np.random.Generator, device: int, begin_s: float, seconds: float, pauses: bool, lost_headings: bool
) -> Iterable[Measured]:
    time_s = begin_s + 0.3
    while time_s < seconds:
        start_s = time_s + (rng.uniform(1.5, 4.0) if pauses and rng.random() < 0.08 else 0.0)
        end_s = start_s + rng.uniform(0.4, 0.6)
        sigma_rad = 1.0 if lost_headings and rng.random() < 0.06 else 0.03
        turn_rad = 0.03 * (-1) ** device + 0.02 * rng.standard_normal()
        covariance = step_covariance(0.7, 0.07, 0.1, sigma_rad)
        yield StepOdometry(str(device), end_s, start_s, 0.7, turn_rad, covariance)
        if rng.random() < 0.2:
            yield HeadingPrior(str(device), end_s, 0.1 * rng.standard_normal(), 0.2, relative=True)
        time_s = end_s


def config_of(walk: Walk, estimator: str = "ekf") -> Config:
    """Make the configuration for a walk."""
    position_m, start = walk.start.position_m, StartParams()
    if position_m is not None:
        start = replace(start, x_m=position_m[0], y_m=position_m[1])
    if walk.start.heading_rad is not None:
        start = replace(start, heading_rad=walk.start.heading_rad)
    chosen = EstimatorParams(name=estimator)  # type: ignore[arg-type]
    return replace(Config(), estimator=chosen, start=start, devices=DevicesParams(tether=TETHER))


def estimator_of(walk: Walk, estimator: str = "ekf", join: bool = True, **online: float) -> WalkEstimator:
    """Make an online estimator, which knows of all devices from the beginning if they `join`."""
    made = WalkEstimator(config_of(walk, estimator), OnlineParams(**online))  # type: ignore[arg-type]
    for _ in range(len(walk.devices) if join else 0):
        made.add_device()
    return made


class Follower:
    """Gives events to an online estimator, and keeps the last filtered pose of each step."""

    def __init__(self, walk: Walk, estimator: WalkEstimator) -> None:
        self.walk, self.estimator = walk, estimator
        self.poses: dict[tuple[int, float], tuple[np.ndarray, np.ndarray]] = {}

    def take(self, event: Event) -> int:
        """Handle one event; return how many poses it changed."""
        if isinstance(event, Block):
            span_s = self.walk.begins_s[event.device], event.end_s
            self.estimator.extend(event.device, span_s, event.measurements, LATENCY_S)
        else:
            self.estimator.add_fix(event)
        return self._keep()

    def finish(self, closing_sigma_m: float | None = None) -> "Follower":
        """End the walk, which may be closed."""
        self.estimator.finish(closing_sigma_m)
        self._keep()
        return self

    def _keep(self) -> int:
        found = self.estimator.take_filtered()
        self.poses.update({(one.device, one.node.time_s): (one.pose, one.covariance) for one in found})
        return len(found)


def follow(walk: Walk, events: Iterable[Event], **online: float) -> Follower:
    """Give all events to a new estimator, and end the walk."""
    follower = Follower(walk, estimator_of(walk, **online))
    for event in events:
        follower.take(event)
    return follower.finish()


def in_time_order(walk: Walk, every_s: float = 1.0) -> list[Event]:
    """Divide all devices at the same times; each fix comes with its time."""
    cuts_s = np.arange(every_s, max(walk.ends_s), every_s)
    blocks = [block for device in range(len(walk.devices)) for block in walk.blocks(device, cuts_s)]
    return sorted([*blocks, *walk.fixes], key=lambda one: one.end_s if isinstance(one, Block) else one.time_s)


def offline(walk: Walk, closing_sigma_m: float | None = None) -> Track:
    """Estimate the walk with the offline EKF."""
    devices = []
    for device, own in enumerate(walk.devices):
        closure = [] if closing_sigma_m is None else [LoopClosure(str(device), closing_sigma_m)]
        devices.append(DeviceMeasurements(str(device), walk.begins_s[device], (*own, *walk.fixes, *closure)))
    spans_s = {str(d): (walk.begins_s[d], walk.ends_s[d]) for d in range(len(walk.devices))}
    tethers = tethers_between(spans_s, TETHER) if len(walk.devices) > 1 else []
    return estimate_walk("ekf", devices, config_of(walk).start.pose(), SIGMA_SCALE, tethers)


def assert_same(follower: Follower, track: Track) -> None:
    """Check that the last filtered poses equal the offline track to the last bit."""
    expected = {
        (int(track.device[i]), float(track.time_s[i])): (track.position_m[i], track.covariance_m2[i])
        for i in range(len(track))
    }
    assert sorted(follower.poses) == sorted(expected)
    for key, (pose, covariance) in follower.poses.items():
        assert np.array_equal(pose[:2], expected[key][0]), key
        assert np.array_equal(covariance[:2, :2], expected[key][1]), key

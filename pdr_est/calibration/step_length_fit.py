"""A person's own step length from walks of known length, or with fixes: Bayesian linear regression.

Of a walk is observed y = ln(true length / the model's length). The model of it is y = s + e (x - x_ref) + noise,
where x is the mean over the walk of the logarithm of the cadence, weighted by step length: to first order how the
walk's length follows the exponent of `WalkerParams`. x_ref is the mean of x over the walks. Beforehand, scale s and
exponent e are normally distributed, s about 0 and e about `MEAN_EXPONENT`. Walks of one cadence tell the scale alone:
the exponent then stays what it was, and changes nothing at that cadence.

Why cadence, and why the exponent is not 0 beforehand: within a person, step length rises with cadence. Their ratio,
the walk ratio, is nearly constant, and MMPDR eq. 9 has the square root. The default model follows acceleration and so
cadence only in part: a constant ratio leaves it an exponent of about 0.8, eq. 9 one of about 0.3. Over the walks of
the set known-distance it is 0.59, over those of stride-length 0.15.

The exponent expected beforehand is that of eq. 9; it lies between what the two sets show. Expecting 0.4 brings the
mean error on known-distance from 5.4 to 4.2 %, but that on stride-length from 4.6 to 6.2 %. Calibrated metrics never
see the walk that they score, but the numbers below were chosen with these two sets in view, which are therefore no
independent evidence for them.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pdr_est.config import Config
from pdr_est.errors import ConfigError, RecordingError
from pdr_est.frames import Array
from pdr_est.front_end.odometry import OdometryParams
from pdr_est.front_end.step_length import WalkerParams
from pdr_est.front_end.step_length.cadence import PaceMeter
from pdr_est.front_end.step_length.walker import LEAST_SCALE, MOST_SCALE, walking_cadence_hz
from pdr_est.pipeline import DeviceWalk, estimate
from pdr_est.types.measurements import PositionFix
from pdr_est.types.steps import Step

SIGMA_LOG_SCALE = OdometryParams().sigma_length_scale  # of people, each over the model
MEAN_EXPONENT, SIGMA_EXPONENT = 0.3, 0.2  # of people's length over the model, by cadence
SIGMA_WALK = 0.05  # of one person's walks, in the logarithm of their length
SIGMA_LOG_CADENCE = 0.15  # of one person's ordinary walks, in the logarithm of their cadence
_LARGEST_SIGMA_OF_FIXES = 0.2


@dataclass(frozen=True)
class PacedSteps:
    """The steps of a device for a calibration. start_s, end_s: (n,) of their movement; length_m: (n,) by the
    model; log_cadence: (n,) logarithm of the steps per second around it, as of a walk (`walking_cadence_hz`)."""

    start_s: Array
    end_s: Array
    length_m: Array
    log_cadence: Array

    @classmethod
    def of(cls, steps: Sequence[Step]) -> "PacedSteps":
        meter = PaceMeter()
        return cls(
            start_s=np.array([step.start_s for step in steps]),
            end_s=np.array([step.event.time_s for step in steps]),
            length_m=np.array([step.length_m for step in steps]),
            log_cadence=np.array([math.log(walking_cadence_hz(meter.at(step).cadence_hz)) for step in steps]),
        )

    def personal(self, walker: WalkerParams) -> "PacedSteps":
        """The same steps with their lengths corrected by personal constants."""
        factor = np.array([walker.personal_factor(value) for value in np.exp(self.log_cadence)])
        return replace(self, length_m=self.length_m * factor)

    def weighted(self, weight: Array) -> "PacedSteps":
        """The same steps, each only for a share (n,) of its length and time."""
        return replace(
            self, start_s=self.end_s - weight * (self.end_s - self.start_s), length_m=weight * self.length_m
        )


@dataclass(frozen=True)
class Observation:
    """Of one walk. log_ratio: ln(true length / the model's length), with sigma as far as it is not known exactly.
    log_cadence: mean ln of the steps per second, by length of step."""

    log_ratio: float
    sigma: float
    log_cadence: float


@dataclass(frozen=True)
class Calibration:
    """Posterior of a walker's constants. mean: (2,) of ln scale and exponent; covariance: (2, 2).
    reference_cadence_hz: where the exponent changes nothing. sigma_next: of the logarithm of the length of the next
    walk, whose cadence is as uncertain as those of the walks observed and of people's ordinary walks."""

    mean: Array
    covariance: Array
    reference_cadence_hz: float
    sigma_next: float

    def walker(self, body: WalkerParams) -> WalkerParams:
        """The body's height and gender with these constants."""
        return replace(
            body,
            length_scale=math.exp(self.mean[0]),
            cadence_exponent=float(self.mean[1]),
            reference_cadence_hz=self.reference_cadence_hz,
        )


def observe_distance(steps: Sequence[PacedSteps], distance_m: float, place: str) -> Observation:
    """A walk of known length, m, from the steps of each of its devices, whose lengths are averaged.

    place: what to call the walk. Raises RecordingError without a step, for a distance that is not above 0, and for
    one that is too far from the model's to be in metres.
    """
    if not (math.isfinite(distance_m) and distance_m > 0.0):
        raise RecordingError(f"{place}: a distance of {distance_m:g} m: give the length of the way in metres")
    length_m = _mean_length_m(steps, place)
    _refuse_scale(distance_m / length_m, place, f"{length_m:.1f} m by its steps and {distance_m:g} m as given")
    return observation(steps, distance_m / length_m)


def observe_fixes(
    walks: Sequence[DeviceWalk], config: Config, fixes: Sequence[PositionFix], place: str
) -> Observation:
    """A walk with position fixes: what they alone tell of the scale, by the configured smoother.

    Raises ConfigError for an estimator that makes no use of fixes; RecordingError without a step, when the fixes
    hardly tell the scale, and when it is out of range; what `estimate` raises.
    """
    if not config.estimator.make().spec.uses_fixes:
        raise ConfigError(
            f"estimator.name = {config.estimator.name}: makes no use of fixes: choose ekf or factor-graph, or give "
            "the distance"
        )
    steps = [PacedSteps.of(walk.steps) for walk in walks]
    _mean_length_m(steps, place)
    usual = replace(config, odometry=replace(config.odometry, sigma_length_scale=SIGMA_LOG_SCALE))
    found = [_scale_alone(walk, usual, fixes, place) for walk in walks]
    scale = float(np.mean([value for value, _ in found]))
    _refuse_scale(scale, place, f"the fixes make the steps {scale:.2f} times as long")
    # The devices are carried along one way past the same fixes: together they know little more than one.
    return observation(steps, scale, max(sigma for _, sigma in found) / scale)


def observation(steps: Sequence[PacedSteps], scale: float, sigma: float = 0.0) -> Observation:
    """What a walk with at least one step, seen by one device or several, tells of its walker.

    scale: true length / the model's; sigma: how uncertain it is, over the scale.
    """
    length_m = np.concatenate([device.length_m for device in steps])
    log_cadence = np.concatenate([device.log_cadence for device in steps])
    return Observation(
        log_ratio=math.log(scale),
        sigma=sigma,
        log_cadence=float(np.average(log_cadence, weights=length_m)),
    )


def fit(observations: Sequence[Observation]) -> Calibration:
    """The posterior of a walker's constants, from at least one walk."""
    log_cadence = np.array([seen.log_cadence for seen in observations])
    reference = float(log_cadence.mean())
    away = log_cadence - reference
    design = np.column_stack([np.ones(len(away)), away])
    prior_mean = np.array([0.0, MEAN_EXPONENT])
    prior = np.diag([SIGMA_LOG_SCALE**-2, SIGMA_EXPONENT**-2])
    weight = 1.0 / (SIGMA_WALK**2 + np.array([seen.sigma for seen in observations]) ** 2)
    covariance = np.asarray(np.linalg.inv(prior + design.T * weight @ design), dtype=np.float64)
    log_ratio = np.array([seen.log_ratio for seen in observations])
    mean = covariance @ (prior @ prior_mean + design.T @ (weight * log_ratio))
    next_away = SIGMA_LOG_CADENCE**2 + float(np.mean(away**2))
    return Calibration(
        mean=mean,
        covariance=covariance,
        reference_cadence_hz=walking_cadence_hz(math.exp(reference)),  # rounded, not beyond the bounds
        sigma_next=math.sqrt(SIGMA_WALK**2 + covariance[0, 0] + covariance[1, 1] * next_away),
    )


def _mean_length_m(steps: Sequence[PacedSteps], place: str) -> float:
    lengths_m = [float(device.length_m.sum()) for device in steps]
    if not lengths_m or min(lengths_m) <= 0.0:
        raise RecordingError(f"{place}: no step found: nothing to calibrate with; leave this walk out")
    return float(np.mean(lengths_m))


def _refuse_scale(scale: float, place: str, words: str) -> None:
    if not LEAST_SCALE <= scale <= MOST_SCALE:
        raise RecordingError(
            f"{place}: {words}, a scale of {scale:.2f} that is not between {LEAST_SCALE:g} and "
            f"{MOST_SCALE:g}: give metres, and the whole way of this recording"
        )


def _scale_alone(walk: DeviceWalk, config: Config, fixes: Sequence[PositionFix], place: str) -> tuple[float, float]:
    """What the fixes say of the scale, with its sigma: the smoother's answer less its prior, which is normal about 1.

    The prior comes again in `fit`, once for all walks.
    """
    track = estimate([walk], config, fixes)
    prior = config.odometry.sigma_length_scale**-2
    both = track.sigma_length_scale**-2
    sigma = math.inf if both <= prior else (both - prior) ** -0.5
    if sigma > _LARGEST_SIGMA_OF_FIXES:
        raise RecordingError(
            f"{place}: its fixes hardly tell how long the steps are: give some farther apart, or the distance"
        )
    return (both * track.length_scale - prior) / (both - prior), sigma

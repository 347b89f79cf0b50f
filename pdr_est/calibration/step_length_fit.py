"""A person's own step length from walks of known length, or with fixes: Bayesian linear regression.

Each walk gives y = ln(true length / the model's length). The model of it is y = s + e (x - x_ref) + noise, where x is
the mean over the walk of the logarithm of the cadence, weighted by step length: to first order the effect of the
exponent of `WalkerParams` on the length of the walk. x_ref is the mean of x over the walks, weighted by what they
tell. The noise is the deviation of a walk from its walker (`SIGMA_WALK`) and the error of the observation. The priors
of scale s and exponent e are normal, s about 0 and e about `MEAN_EXPONENT`. Walks of one cadence determine the scale
alone: the exponent then keeps its prior, and changes nothing at that cadence.

The exponent depends on cadence, and its prior mean is not 0, because within a person step length rises with cadence.
Their ratio, the walk ratio, is nearly constant, and MMPDR eq. 9 has the square root. The default model follows this
in part. Over the walks of the set known-distance it leaves an exponent of 0.43, over those of stride-length 0.15.

The prior mean lies between the values of the two sets. Calibrated metrics never see the walk that they score, but the
numbers below were chosen with these two sets in view, which are therefore no independent evidence for them.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.front_end.odometry import OdometryParams
from pdr_est.front_end.step_length import WalkerParams
from pdr_est.front_end.step_length.cadence import PaceMeter
from pdr_est.front_end.step_length.walker import LEAST_SCALE, MOST_SCALE, walking_cadence_hz
from pdr_est.types.steps import Step

SIGMA_LOG_SCALE = OdometryParams().sigma_length_scale  # of people, each over the model
MEAN_EXPONENT, SIGMA_EXPONENT = 0.3, 0.2  # of people's length over the model, by cadence
SIGMA_WALK = 0.05  # of one person's walks, in the logarithm of their length
SIGMA_LOG_CADENCE = 0.15  # of one person's ordinary walks, in the logarithm of their cadence


@dataclass(frozen=True)
class CalibrationSteps:
    """Steps of a device for a calibration.

    Attributes
    ----------
    start_s, end_s : Array
        Start and end of the movement of each step, (n,), s.
    length_m : Array
        Lengths by the step-length model, (n,), m.
    log_cadence : Array
        Natural logarithm of the steps per second around each step, (n,), as computed by `walking_cadence_hz`.
    """

    start_s: Array
    end_s: Array
    length_m: Array
    log_cadence: Array

    @classmethod
    def from_steps(cls, steps: Sequence[Step]) -> "CalibrationSteps":
        """Collect the steps of a device."""
        meter = PaceMeter()
        return cls(
            start_s=np.array([step.start_s for step in steps]),
            end_s=np.array([step.event.time_s for step in steps]),
            length_m=np.array([step.length_m for step in steps]),
            log_cadence=np.array([math.log(walking_cadence_hz(meter.at(step).cadence_hz)) for step in steps]),
        )

    def with_personal_constants(self, walker: WalkerParams) -> "CalibrationSteps":
        """Correct the lengths by the personal constants of a walker."""
        factor = np.array([walker.personal_factor(value) for value in np.exp(self.log_cadence)])
        return replace(self, length_m=self.length_m * factor)

    def weighted(self, weight: Array) -> "CalibrationSteps":
        """Keep only a fraction (n,) of the length and time of each step."""
        return replace(
            self, start_s=self.end_s - weight * (self.end_s - self.start_s), length_m=weight * self.length_m
        )


@dataclass(frozen=True)
class ScaleObservation:
    """Length scale that one walk shows.

    Attributes
    ----------
    log_ratio : float
        ln(true length / the model's length).
    sigma : float
        Standard deviation of log_ratio; 0 if the true length is known exactly.
    log_cadence : float
        Mean logarithm of the steps per second, weighted by step length.
    """

    log_ratio: float
    sigma: float
    log_cadence: float


@dataclass(frozen=True)
class NotLearnt:
    """Reason why a walk tells nothing of the step length of its walker.

    Attributes
    ----------
    reason : str
        The reason in words, with the remedy.
    doubtful : bool
        True where the walk should have told something, so that the user should look at it; False for a walk without
        anything to learn from.
    """

    reason: str
    doubtful: bool = True


@dataclass(frozen=True)
class Calibration:
    """Posterior of a walker's constants.

    Attributes
    ----------
    mean : Array
        Logarithm of the scale, and exponent, (2,).
    covariance : Array
        Their covariance, (2, 2).
    reference_cadence_hz : float
        Cadence at which the exponent changes nothing, Hz.
    sigma_next : float
        Standard deviation of the logarithm of the next walk's length. The cadence of that walk is taken as uncertain
        as those of the walks observed and of people's ordinary walks together.
    """

    mean: Array
    covariance: Array
    reference_cadence_hz: float
    sigma_next: float

    def walker(self, body: WalkerParams) -> WalkerParams:
        """Put these constants into a record with the walker's height and gender."""
        return replace(
            body,
            length_scale=math.exp(self.mean[0]),
            cadence_exponent=float(self.mean[1]),
            reference_cadence_hz=self.reference_cadence_hz,
        )


def observe_distance(
    steps: Sequence[CalibrationSteps], distance_m: float, place: str, missing_share: float = 0.0
) -> ScaleObservation:
    """Observe the scale of a walk of known length; the lengths of several devices are averaged.

    Nobody knows how much of the way lies in the gaps of a recording: none of it if the walker stood, and as much as
    in the rest of the time otherwise. Every part between these is taken as equally probable.

    Parameters
    ----------
    steps : sequence of CalibrationSteps
        Steps of each device.
    distance_m : float
        True length, m.
    place : str
        Name of the walk in messages.
    missing_share : float
        Share of the walking that lies in gaps of the recording at most, from 0 to below 1.

    Raises
    ------
    RecordingError
        Without a step, for a distance that is not positive, and for one that is too far from the model's to be in
        metres.
    """
    refuse_distance(distance_m, place)
    log_span = -math.log1p(-missing_share)
    length_m = mean_length_m(steps, place) * math.exp(0.5 * log_span)
    refuse_scale(distance_m / length_m, place, f"{length_m:.1f} m by its steps and {distance_m:g} m as given")
    return observe_scale(steps, distance_m / length_m, log_span / math.sqrt(12.0))


def observe_scale(steps: Sequence[CalibrationSteps], scale: float, sigma: float = 0.0) -> ScaleObservation:
    """Make the observation of a walk with at least one step from its scale.

    Parameters
    ----------
    steps : sequence of CalibrationSteps
        Steps of each device.
    scale : float
        True length / the model's length.
    sigma : float
        Standard deviation of the scale, relative to it.
    """
    length_m = np.concatenate([device.length_m for device in steps])
    log_cadence = np.concatenate([device.log_cadence for device in steps])
    return ScaleObservation(
        log_ratio=math.log(scale),
        sigma=sigma,
        log_cadence=float(np.average(log_cadence, weights=length_m)),
    )


def fit_calibration(observations: Sequence[ScaleObservation], sigma_walk: float = SIGMA_WALK) -> Calibration:
    """Compute the posterior of a walker's constants from at least one walk.

    Parameters
    ----------
    observations : sequence of ScaleObservation
        What the walks show.
    sigma_walk : float
        Standard deviation of the logarithm of a walk's scale about that of the walker; larger for walks of several
        people who are described by one set of constants.
    """
    log_cadence = np.array([seen.log_cadence for seen in observations])
    weight = 1.0 / (sigma_walk**2 + np.array([seen.sigma for seen in observations]) ** 2)
    reference = float(np.average(log_cadence, weights=weight))
    away = log_cadence - reference
    design = np.column_stack([np.ones(len(away)), away])
    prior_mean = np.array([0.0, MEAN_EXPONENT])
    prior = np.diag([SIGMA_LOG_SCALE**-2, SIGMA_EXPONENT**-2])
    covariance = np.asarray(np.linalg.inv(prior + design.T * weight @ design), dtype=np.float64)
    log_ratio = np.array([seen.log_ratio for seen in observations])
    mean = covariance @ (prior @ prior_mean + design.T @ (weight * log_ratio))
    next_away = SIGMA_LOG_CADENCE**2 + float(np.average(away**2, weights=weight))
    return Calibration(
        mean=mean,
        covariance=covariance,
        reference_cadence_hz=walking_cadence_hz(math.exp(reference)),  # rounded, not beyond the bounds
        sigma_next=math.sqrt(sigma_walk**2 + covariance[0, 0] + covariance[1, 1] * next_away),
    )


def mean_length_m(steps: Sequence[CalibrationSteps], place: str) -> float:
    """Compute the length of the way, m, as the mean over the devices; raise RecordingError without a step."""
    lengths_m = [float(device.length_m.sum()) for device in steps]
    if not lengths_m or min(lengths_m) <= 0.0:
        raise RecordingError(f"{place}: no step found: nothing to calibrate with; leave this walk out")
    return float(np.mean(lengths_m))


def refuse_distance(distance_m: float, place: str) -> None:
    """Raise RecordingError for a distance that is not positive."""
    if not (math.isfinite(distance_m) and distance_m > 0.0):
        raise RecordingError(f"{place}: a distance of {distance_m:g} m: give the length of the way in metres")


def refuse_scale(scale: float, place: str, description: str) -> None:
    """Raise RecordingError for a scale that nobody has: it is an error of units, or of the recording."""
    if not LEAST_SCALE <= scale <= MOST_SCALE:
        raise RecordingError(
            f"{place}: {description}, a scale of {scale:.2f} that is not between {LEAST_SCALE:g} and "
            f"{MOST_SCALE:g}: give metres, and the whole way of this recording, or leave this walk out"
        )

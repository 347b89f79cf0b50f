"""The metrics of a track that was read from a file, each with the alignment that it has."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from types import MappingProxyType

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.evaluate.consistency import coverage95, nees_mean
from pdr_est.evaluate.position_errors import LEAST_POINTS, leg_metrics, open_metrics, point_errors
from pdr_est.evaluate.rigid_alignment import RigidTransform, best_alignment, start_alignment
from pdr_est.evaluate.time_association import Association, associate
from pdr_est.frames import Array
from pdr_est.types.ground_truth import TruePositions
from pdr_est.types.track import Track

NO_COVARIANCE = "the file of the track states no covariance"
"""Reason why a track has no metrics of its covariances."""


class Alignment(StrEnum):
    """Move of the whole track before its errors are measured."""

    NONE = "none"
    START = "start"
    RIGID = "rigid"

    @property
    def words(self) -> str:
        """Describe the alignment in words."""
        return {
            Alignment.NONE: "no alignment: the track as it is, in the frame of the truth",
            Alignment.START: "aligned at the start: first true position, and direction to the first one 20 m away",
            Alignment.RIGID: "best rotation and translation of the whole track, no scale",
        }[self]

    def transform(self, pairs: Association) -> RigidTransform:
        """Compute the move of the track from at least two pairs."""
        if self is Alignment.NONE:
            return RigidTransform(0.0, np.zeros(2))
        find = start_alignment if self is Alignment.START else best_alignment
        return find(pairs.track_m, pairs.truth_m)


TRACK_METRICS: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        "error_map_m": (
            "none",
            "mean distance to the true positions",
        ),
        "error_open_m": (
            "start",
            "mean distance to the true positions after the first, which the track is moved to, after turning it "
            "towards the first one at least 20 m away",
        ),
        "final_drift": ("start", "distance to the last true position after that, per length of the true way"),
        "ate_rigid_m": ("rigid", "root of the mean squared distance after the best rotation and translation"),
        "length_ratio": ("needs none", "length of the track per length of the true way; 1 is right"),
        "leg_length_mae_m": ("needs none", "mean error of the distances between successive true positions"),
        "leg_vector_mae_m": (
            "best rotation",
            "mean error of the displacements between successive true positions",
        ),
        "leg_turn_mae_m": ("needs none", "the same, each displacement as seen from the one before it"),
        "coverage95": ("none", "share of the true positions inside the stated 95 % region; 0.95 is right"),
        "nees_mean": ("none", "mean squared error in units of the stated covariance; 2 is right"),
    }
)
"""Metric -> alignment of the track that it has by its definition, and its meaning."""


@dataclass(frozen=True)
class TrajectoryScore:
    """Scores of the track of one device.

    Attributes
    ----------
    device
        Name of the device.
    metrics
        Value of each metric, by name.
    missing
        Metric -> reason why there is no value.
    alignment
        Move of the track for `error_m` and `transform`.
    transform
        That move.
    pairs
        The true positions that are scored, with those of the track before the move.
    error_m
        (n,) m, error at each of them after the move.
    """

    device: str
    metrics: Mapping[str, float]
    alignment: Alignment
    transform: RigidTransform
    pairs: Association
    error_m: Array
    missing: Mapping[str, str] = field(default_factory=dict)

    @property
    def error_quantiles_m(self) -> dict[str, float]:
        """Mean, median, 90th percentile and greatest error after the move, m."""
        return {
            "mean": float(self.error_m.mean()),
            "median": float(np.median(self.error_m)),
            "p90": float(np.percentile(self.error_m, 90.0)),
            "max": float(self.error_m.max()),
        }


def score_trajectory(
    track: Track, truth: TruePositions, alignment: Alignment, standing_s: float = 0.0, place: str = "the track"
) -> TrajectoryScore:
    """Score the track of one device at the true positions.

    Every metric is that of the benchmark suites (`metric_definitions`). `error_map_m`, the mean error without any
    alignment, and the metrics of the covariances are computed only with `Alignment.NONE`: elsewhere the track need
    not lie in the frame of the truth.

    Parameters
    ----------
    track
        Track of one device, on the clock of the truth.
    truth
        The true positions.
    alignment
        Move of the track for the errors at each true position.
    standing_s
        Time that the walker stands before the first and after the last position of the track, s. True positions up
        to 1 s beyond that are scored, too.
    place
        What to call the track in messages.

    Raises
    ------
    RecordingError
        If fewer than two true positions lie within the time of the track.
    """
    span_s = (float(track.time_s[0]) - standing_s, float(track.time_s[-1]) + standing_s)
    pairs = associate(track, truth.time_s, truth.position_m, span_s)
    if len(pairs) < LEAST_POINTS:
        raise RecordingError(
            f"{place}: {len(pairs)} of {len(truth.time_s)} true positions lie within its time, {span_s[0]:.3f} to "
            f"{span_s[1]:.3f} s: at least {LEAST_POINTS} are needed, on the same clock"
        )
    metrics, missing = open_metrics(track, pairs, truth.source), {}
    if not truth.dense:
        metrics |= leg_metrics(pairs.track_m, pairs.truth_m)[0]
    if alignment is Alignment.NONE:
        metrics["error_map_m"] = float(point_errors(pairs.track_m, pairs.truth_m).mean())
    else:
        missing["error_map_m"] = "the track is aligned, because it need not lie in the frame of the truth"
    consistency, reason = consistency_metrics(pairs, truth.sigma_m)
    if alignment is not Alignment.NONE and not reason:
        consistency, reason = {}, "the track is aligned, and its covariances are those before the alignment"
    metrics |= consistency
    missing |= dict.fromkeys(("coverage95", "nees_mean"), reason) if reason else {}
    undefined = [name for name, value in metrics.items() if not np.isfinite(value)]
    transform = alignment.transform(pairs)
    return TrajectoryScore(
        device=str(track.device[0]),
        metrics={name: value for name, value in metrics.items() if name not in undefined},
        alignment=alignment,
        transform=transform,
        pairs=pairs,
        error_m=point_errors(transform.apply(pairs.track_m), pairs.truth_m),
        missing=missing | dict.fromkeys(undefined, "the truth has no length"),
    )


def consistency_metrics(pairs: Association, truth_sigma_m: float) -> tuple[dict[str, float], str]:
    """Compute `coverage95` and `nees_mean` of a track that lies in the frame of the truth.

    Parameters
    ----------
    pairs
        The true positions with those of the track.
    truth_sigma_m
        Standard deviation of the true positions per axis, m.

    Returns
    -------
    values : dict
        Metrics by name; empty if they cannot be computed.
    reason : str
        Reason why they cannot; empty if they can.
    """
    covariance_m2 = pairs.covariance_m2 + truth_sigma_m**2 * np.eye(2)
    if not np.isfinite(covariance_m2).all():
        return {}, NO_COVARIANCE
    if (np.linalg.det(covariance_m2) <= 0.0).any():
        return {}, "a covariance of the track is zero, and so is the error of the truth"
    error_m = pairs.track_m - pairs.truth_m
    return {
        "coverage95": coverage95(error_m, pairs.covariance_m2, truth_sigma_m),
        "nees_mean": nees_mean(error_m, pairs.covariance_m2, truth_sigma_m),
    }, ""

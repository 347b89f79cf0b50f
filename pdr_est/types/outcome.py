"""What is shown of one track of one walk with one variant."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from pdr_est.frames import Array


@dataclass(frozen=True)
class TrackOutcome:
    """A scored track beside its truth.

    labels: keys of the walk to group by -> value. mode: recognised for most of the walking time. metrics: name ->
    value, None when it cannot be told. steps: detected; true_steps: taken, None when not known. mode_shares: of the
    walking time. with_fixes: whether the track shown was given fixes; else it is aligned at its start.

    position_m: (n, 2) poses of the track in the frame of the truth. truth_m: (k, 2) true positions, none when they
    are not known. At (p,) true positions that the estimator was not given: way_m, the distance walked until there;
    error_m; squared, the error in units of its stated covariance (squared Mahalanobis distance, 2 is right on
    average), empty without fixes. counts: name -> number of points or steps that the metrics are based on.
    predicted: label -> number of steps that got it, where steps are classified.
    """

    walk: str
    track: str
    variant: str
    labels: Mapping[str, str]
    mode: str
    metrics: Mapping[str, float | None]
    steps: int
    true_steps: int | None
    mode_shares: Mapping[str, float]
    with_fixes: bool
    position_m: Array
    truth_m: Array
    way_m: Array
    error_m: Array
    squared: Array
    counts: Mapping[str, int] = field(default_factory=dict)
    predicted: Mapping[str, int] = field(default_factory=dict)

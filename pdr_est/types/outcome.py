"""One scored track of an experiment, as the comparison report shows it."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from pdr_est.frames import Array


@dataclass(frozen=True)
class TrackOutcome:
    """A track of one walk and one variant, scored against the truth.

    Attributes
    ----------
    walk, track, variant
        Names of the walk, of the device (or "fused") and of the variant.
    labels
        Properties of the walk by which tables are grouped.
    mode
        Carrying mode recognised for most of the walking time.
    metrics
        Value of each metric; None where it cannot be computed.
    steps
        Number of detected steps; None for a track that was read from a file.
    true_steps
        Number of steps taken; None where it is unknown.
    mode_shares
        Fraction of the walking time in each carrying mode.
    with_fixes
        True when the track was estimated with position fixes; otherwise it is aligned with the truth at its start.
    position_m
        (n, 2) m, track in the frame of the truth.
    truth_m
        (k, 2) m, true positions; empty where they are unknown.
    way_m
        (p,) m, distance walked until each true position that the estimator was not given.
    error_m
        (p,) m, position error there.
    squared
        (p,) squared Mahalanobis distance of the error (2 is right on average); empty without fixes or covariance.
    counts
        Number of points or steps that the metrics are based on, by name.
    predicted
        Number of steps that got each label, where steps are classified.
    findings
        Number of doubtful findings about the walk, with the fixes that the track was estimated with.
    on_plan_m
        (n, 2) m, track that was estimated with the floor plan, in the frame of the plan; empty without one.
    """

    walk: str
    track: str
    variant: str
    labels: Mapping[str, str]
    mode: str
    metrics: Mapping[str, float | None]
    steps: int | None
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
    findings: int = 0
    on_plan_m: Array = field(default_factory=lambda: np.empty((0, 2)))

    @property
    def drawn_m(self) -> Array:
        """Positions (n, 2), m, of the track that a map shows: of that with the floor plan, if there is one."""
        return self.on_plan_m if len(self.on_plan_m) else self.position_m
